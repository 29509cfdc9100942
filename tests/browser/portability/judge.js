// SPDX-License-Identifier: MIT OR Apache-2.0
// Verdicts on what a browser computed, and the list of failures that are known.

/**
 * Reads `key | output | limit | reason` lines; `*` is any output. A limit is `3 times` (within three times the tolerance the output
 * does not fail) or `3 %` (no case has more beyond the tolerance).
 */
export function parseExpected(text) {
    const expected = [];
    for (const [index, line] of text.split("\n").entries()) {
        const content = line.trim();
        if (!content || content.startsWith("#")) continue;
        const parts = content.split(" | ").map((part) => part.trim());
        if (parts.length !== 4 || parts.some((part) => !part)) {
            throw new Error(`expected_failures, line ${index + 1}: write \`pass:permutation entry points | output | limit | reason\``);
        }
        const [key, output, limit, reason] = parts;
        const [, number, unit] = /^([\d.]+) (times|%)$/.exec(limit) ?? [];
        if (!number) throw new Error(`expected_failures, line ${index + 1}: a limit is \`3 times\` or \`3 %\`, not \`${limit}\``);
        const bound = unit === "%" ? { share: Number(number) / 100 } : { times: Number(number) };
        expected.push({ key, output, limit, ...bound, reason, line: index + 1 });
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
            const fresh = { key, output: output.name, cases: 0, compared: 0, off: 0, worst: 0, share: 0, wide: 0, changed: false, errors: [] };
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
            row.wide = Math.max(row.wide, output.compared ? output.offWide / output.compared : 0);
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

/** Whether a row fails by no more than is expected. */
function isWithin(row, known) {
    if (row.errors.length > 0) return false;
    return known.times ? row.wide <= row.tolerance.outliers : row.share <= known.share;
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
        row.verdict = known && isWithin(row, known) ? "expected" : "failed";
        Object.assign(row, { reason: known?.reason, limit: known?.limit });
        if (known) used.add(known);
        const limit = known ? `, more than the expected failure's ${known.limit}` : "";
        if (row.verdict === "failed") findings.push(`${row.key}, ${row.output}: ${row.fault}${limit}`);
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
