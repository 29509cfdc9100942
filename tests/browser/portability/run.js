// SPDX-License-Identifier: MIT OR Apache-2.0
// node run.js: repeats in headless Chromium every pass that was recorded in `target/portability`, from its flat file, holds what
// it writes to the tolerances of the snapshots, and writes `docs/src/portability.md`. Exits with 1 where something is wrong.

import { existsSync } from "node:fs";
import { readdir, readFile, writeFile } from "node:fs/promises";
import { join, resolve } from "node:path";
import { chromiumPath, withPage } from "../chromium.js";
import { judge, parseExpected, summarise } from "./judge.js";
import { backEnds, report } from "./report.js";
import { measureOf } from "./measures.js";
import { readSnapshots, toleranceOf } from "./tolerances.js";

const ROOT = resolve(import.meta.dirname, "../../..");
const RECORDED = "target/portability";
/** Cases that a page is given at a time. */
const CHUNK = 25;

const json = async (path) => JSON.parse(await readFile(join(ROOT, path), "utf8"));

/** The file that an engine copies, or what the recorder wrote of definitions that are not shipped. */
async function shaderFile(folder, number) {
    const { pass, permutation } = await json(`${folder}/shaders/${number}.json`);
    if (!permutation) return { file: `${folder}/shaders/${number}.wgsl`, flat: false };
    const file = `wgsl/flat/${pass}${permutation === "default" ? "" : `.${permutation}`}.wgsl`;
    if (!existsSync(join(ROOT, file))) throw new Error(`${file} is missing: run airlight-validate flatten`);
    return { file, flat: true };
}

/** Everything that was recorded. */
async function readRecorded() {
    const folders = existsSync(join(ROOT, RECORDED)) ? await readdir(join(ROOT, RECORDED), { withFileTypes: true }) : [];
    const recorded = { cases: [], taken: [], devices: new Set(), flat: new Set(), composed: new Set() };
    for (const entry of folders.filter((folder) => folder.isDirectory())) {
        const folder = `${RECORDED}/${entry.name}`;
        recorded.devices.add((await json(`${folder}/device.json`)).adapter);
        const lines = (await readFile(join(ROOT, folder, "snapshots.jsonl"), "utf8")).trim().split("\n");
        recorded.taken.push(...lines.map((line) => JSON.parse(line)));
        const files = await readdir(join(ROOT, folder, "cases"));
        for (const file of files.sort((a, b) => parseInt(a) - parseInt(b))) {
            const { key, scene, shaders, outputs } = await json(`${folder}/cases/${file}`);
            const texts = await Promise.all(shaders.map((number) => shaderFile(folder, number)));
            texts.forEach(({ file: path, flat }) => recorded[flat ? "flat" : "composed"].add(path));
            const paths = texts.map(({ file: path }) => path);
            recorded.cases.push({ key, scene, outputs, url: `${folder}/cases/${file}`, blobs: `${folder}/blobs/`, shaders: paths });
        }
    }
    if (recorded.cases.length === 0) throw new Error(`nothing is recorded in ${RECORDED}: run make portability`);
    return recorded;
}

async function repeatAll(cases, tolerances) {
    return withPage(ROOT, async (page, url) => {
        await page.goto(url);
        const at = (path) => url + path;
        const module = at("tests/browser/portability/page.js");
        const info = await page.evaluate(async (path) => (await import(path)).adapter(), module);
        const results = [];
        for (let first = 0; first < cases.length; first += CHUNK) {
            const given = cases.slice(first, first + CHUNK).map((one) => ({
                url: at(one.url),
                blobs: at(one.blobs),
                shaders: one.shaders.map(at),
                tolerances: one.outputs.map(({ name }) => tolerances(one.key, name)),
            }));
            const run = async ([path, chunk]) => (await import(path)).run(chunk);
            results.push(...(await page.evaluate(run, [module, given])));
        }
        const browser = `Chromium ${page.context().browser().version()}`;
        return { info, browser, results };
    });
}

async function main() {
    chromiumPath();
    const start = Date.now();
    const recorded = await readRecorded();
    const snapshots = await readSnapshots(join(ROOT, "tests/tests/snapshots"));
    // Drawn by a program without the host, which records nothing; its page is tested in the browser by itself.
    snapshots.delete("example_wgpu");
    const expected = parseExpected(await readFile(join(import.meta.dirname, "expected_failures"), "utf8"));
    const tolerances = (key, output) => ({
        ...toleranceOf(key, output, recorded.taken, snapshots),
        measure: measureOf(key, output),
        times: expected.find((entry) => entry.key === key && entry.output === output)?.times,
    });
    const { info, browser, results } = await repeatAll(recorded.cases, tolerances);
    const cases = recorded.cases.map(({ key, scene }, k) => ({ key, scene, ...results[k] }));
    const rows = summarise(cases, tolerances);
    const findings = judge(rows, expected, recorded.taken, snapshots);
    const about = { browser, info, devices: [...recorded.devices], cases: cases.length, snapshots: snapshots.size };
    const files = { flat: recorded.flat.size, composed: recorded.composed.size };
    await writeFile(join(ROOT, RECORDED, "results.json"), JSON.stringify({ about, files, rows }, null, 1));
    await writeFile(join(ROOT, "docs/src/portability.md"), report({ ...about, ...files }, rows, await backEnds(ROOT)));
    const seconds = ((Date.now() - start) / 1000).toFixed(0);
    const passed = rows.filter((row) => row.verdict === "passed").length;
    const known = rows.filter((row) => row.verdict === "expected").length;
    console.log(`${cases.length} cases of ${new Set(rows.map((row) => row.key)).size} passes in ${seconds} s, ${browser}`);
    console.log(`${passed} outputs within tolerance, ${known} expected failures, ${findings.length} findings`);
    findings.forEach((finding) => console.error(`portability: ${finding.split("\n")[0]}`));
    process.exitCode = findings.length > 0 ? 1 : 0;
}

try {
    await main();
} catch (error) {
    console.error(`portability: ${error.message}`);
    process.exitCode = 1;
}
