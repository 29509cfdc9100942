// SPDX-License-Identifier: MIT OR Apache-2.0
// Verdicts on what a browser computed, and the list of failures that are known.

/** Reads `key | output | reason` lines; `*` is any output. */
export function parseExpected(text) {
    const expected = [];
    for (const [index, line] of text.split("\n").entries()) {
        const content = line.trim();
        if (!content || content.startsWith("#")) continue;
        const parts = content.split(" | ").map((part) => part.trim());
        if (parts.length !== 3 || parts.some((part) => !part)) {
            throw new Error(`expected_failures, line ${index + 1}: write \`pass:permutation entry points | output | reason\``);
        }
        const [key, output, reason] = parts;
        expected.push({ key, output, reason, line: index + 1 });
    }
    return expected;
}

/**
 * One row for each output of each pass, over all its cases. A case is `{key, outputs: [{name, compared, off, worst, changed}]}` or
 * `{key, error}`; `tolerances(key, output)` gives what is allowed.
 */
export function summarise(cases, tolerances) {
    const rows = new Map();
    for (const { key, scene, error, outputs = [] } of cases) {
        for (const output of error ? [{ name: "*", error }] : outputs) {
            const id = `${key} | ${output.name}`;
            const fresh = { key, output: output.name, cases: 0, compared: 0, off: 0, worst: 0, share: 0, changed: false, errors: [] };
            const row = rows.get(id) ?? { ...fresh, tolerance: tolerances(key, output.name) };
            rows.set(id, row);
            row.cases += 1;
            if (output.error) {
                row.errors.push(output.error);
                continue;
            }
            row.compared += output.compared;
            row.off += output.off;
            // Each case must keep to the share by itself.
            row.share = Math.max(row.share, output.compared ? output.off / output.compared : 0);
            if (output.worst > row.worst) Object.assign(row, { worst: output.worst, where: { scene, at: output.at, values: output.values } });
            row.changed ||= output.changed;
        }
    }
    return [...rows.values()].sort((a, b) => (a.key + a.output < b.key + b.output ? -1 : 1));
}

/** What is wrong with a row; null for nothing. */
export function fault(row) {
    if (row.errors.length > 0) return row.errors[0];
    if (row.compared === 0) return "nothing was compared";
    if (row.share > row.tolerance.outliers) {
        const percent = (share) => `${(100 * share).toFixed(2)} %`;
        return `${percent(row.share)} of a case is beyond the tolerance, and ${percent(row.tolerance.outliers)} may be`;
    }
    return null;
}

/** Marks each row `passed`, `failed` or `expected`, and lists every finding, which are all to be mended. */
export function judge(rows, expected, taken, snapshots) {
    const findings = [];
    const used = new Set();
    for (const row of rows) {
        row.fault = fault(row);
        const known = expected.find((entry) => entry.key === row.key && (entry.output === "*" || entry.output === row.output));
        if (!row.fault) {
            row.verdict = "passed";
            continue;
        }
        row.verdict = known ? "expected" : "failed";
        row.reason = known?.reason;
        if (known) used.add(known);
        else findings.push(`${row.key}, ${row.output}: ${row.fault}`);
    }
    for (const entry of expected) {
        if (!used.has(entry)) findings.push(`expected_failures, line ${entry.line}: ${entry.key}, ${entry.output} does not fail`);
    }
    const keys = new Set(rows.map((row) => row.key));
    for (const name of snapshots.keys()) {
        const entries = taken.filter((entry) => entry.snapshot === name);
        if (entries.length === 0) findings.push(`snapshot ${name} was not taken while the passes were recorded`);
        for (const { key, output } of entries) {
            const row = rows.find((other) => other.key === key && other.output === output);
            if (!key) findings.push(`snapshot ${name}: no recorded pass wrote what it holds`);
            else if (!keys.has(key)) findings.push(`snapshot ${name}: its pass ${key} has no case`);
            else if (row && !row.changed) findings.push(`snapshot ${name}: no case of ${key} changes ${output}`);
        }
    }
    return findings;
}
