// SPDX-License-Identifier: MIT OR Apache-2.0
// The page of the book that says what differs between implementations.

import { execFileSync } from "node:child_process";
import { readFile } from "node:fs/promises";
import { join } from "node:path";
import { DEFAULTS } from "./tolerances.js";

const table = (head, rows) => [head, head.map(() => "---"), ...rows].map((row) => `| ${row.join(" | ")} |`).join("\n");
const code = (text) => `\`${text}\``;

function number(value) {
    if (value === 0) return "0";
    if (!Number.isFinite(value)) return "∞";
    return value >= 0.01 && value < 1e5 ? String(Number(value.toPrecision(2))) : value.toExponential(1);
}

const percent = (share) => (share === 0 ? "0" : `${Number((100 * share).toPrecision(2))} %`);

/** The pass, its permutation and the entry points, out of a key. */
function parts(key) {
    const split = key.split(" + ").map((one) => /^([^:[]+)(?::(\S+)|\[(.*?)\]) (.+)$/.exec(one).slice(1));
    const column = (take) => split.map(take).filter((text, k, all) => all.indexOf(text) === k).join(", ");
    return {
        pass: column(([pass]) => code(pass)),
        permutation: column(([, permutation, definitions]) => permutation ?? code(definitions)),
        entryPoints: column(([, , , entryPoints]) => code(entryPoints)),
    };
}

function passes(rows) {
    const head = ["pass", "permutation", "entry points", "output", "compared", "worst", "beyond", "allowed", "tolerance of", "verdict"];
    return table(head, rows.map((row) => {
        const { pass, permutation, entryPoints } = parts(row.key);
        const { tolerance } = row;
        const source = tolerance.source === "default" ? "default" : code(tolerance.source);
        const verdict = row.verdict === "expected" ? "expected failure" : row.verdict;
        return [
            pass, permutation, entryPoints, row.output === "*" ? "all" : code(row.output), row.compared, number(row.worst),
            percent(row.share), percent(tolerance.outliers), source, verdict,
        ];
    }));
}

function version(program) {
    try {
        const text = execFileSync(program, ["--version"], { encoding: "utf8", stdio: ["ignore", "pipe", "ignore"] });
        return /\d+[.:]\d[\w.:]*/.exec(text)?.[0] ?? "";
    } catch (error) {
        return error.code === "ENOENT" ? null : "";
    }
}

/** A table of the compilers of naga's outputs, and what `validate/expected_failures` says of them. */
export async function backEnds(root) {
    const compilers = [
        ["SPIR-V 1.3", "`spirv-val`", version("spirv-val")],
        ["GLSL 4.50", "`glslangValidator`", version("glslangValidator")],
        ["HLSL, shader model 6.0", "`dxc`, by `scripts/dxc.sh` on Linux", "library of compushady 0.17.5"],
        ["MSL 2.4", "none: Apple's compiler is there on macOS only", ""],
        ["WGSL", "`tint`, and Chromium's as below", version("tint")],
    ];
    const list = (await readFile(join(root, "validate/expected_failures"), "utf8")).split("\n");
    const known = list.filter((line) => line && !line.startsWith("#")).map((line) => {
        const [, what, backEnd, reason] = /^(\S+) (\S+) (.+)$/.exec(line);
        return [code(what), backEnd, reason];
    });
    const rows = compilers.map(([language, by, found]) => [language, by, found ?? "not on the PATH when this page was made"]);
    return `${table(["written by naga", "compiled or validated by", "version"], rows)}

Expected failures, which are findings once they pass:

${table(["pass", "language", "why"], known)}`;
}

/** The page. */
export function report(about, rows, backEndText) {
    const known = rows.filter((row) => row.verdict === "expected");
    const count = (verdict) => rows.filter((row) => row.verdict === verdict).length;
    const { vendor, architecture, device, description } = about.info;
    const adapter = [vendor, architecture, device, description].filter(Boolean).join(", ");
    const { f16, f32, unorm, outliers } = DEFAULTS;
    const reasons = known.length === 0
        ? "There are none."
        : table(["pass", "output", "why", "found", "at most"], known.map((row) => [code(row.key), code(row.output), row.reason, row.fault, row.limit]));
    return `# Portability

<!-- Written by \`make portability\`; do not edit. -->

Every pass that a snapshot test runs, run a second time from its stand-alone file by another implementation: Tint compiles it, Dawn
runs it on SwiftShader, in headless Chromium. Inputs are the bytes that the pass was given on the first adapter, results are
compared with the bytes that it wrote there. See [Testing](testing.md#a-second-implementation) for how.

${table(["", ""], [
    ["first", about.devices.join(", ")],
    ["second", `${about.browser}, adapter ${adapter}`],
    ["cases", `${about.cases}, of ${new Set(rows.map((row) => row.key)).size} passes and permutations, for ${about.snapshots} snapshots`],
    ["shaders", `${about.flat} flat files, ${about.composed} composed with definitions that no shipped permutation has`],
    ["outputs", `${rows.length}: ${count("passed")} within tolerance, ${known.length} expected failures, ${count("failed")} failures`],
])}

A tolerance is that of the snapshot that holds the output, the strictest where several do, and the share of elements that may be
beyond it is the one that the snapshot allows another adapter. Outputs between snapshots have these, of absolute difference and
share of the value: half floats ${f16.join(" and ")}, floats ${f32.join(" and ")}, 8 bits ${unorm[0]}, integers none; beyond it
${percent(outliers)} of the elements of a case. An element is a texel, an element of an array in a buffer, or a number before it.
\`worst\` is the greatest difference in units of the tolerance, \`beyond\` the greatest share in one case.

## Expected failures

${reasons}

## Passes

${passes(rows)}

## Back ends

\`make check\` gives every entry point of every permutation to these, where they can be had.

${backEndText}
`;
}
