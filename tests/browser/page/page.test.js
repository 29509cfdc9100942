// SPDX-License-Identifier: MIT OR Apache-2.0
// examples/page in headless Chromium: its picture, its sliders, its messages. `AIRLIGHT_BLESS=1` replaces the picture; look
// at it at full size.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtemp, readFile, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { withPage } from "../chromium.js";
import { brightness, similarity } from "./pictures.js";

const ROOT = fileURLToPath(new URL("../../..", import.meta.url));
const BLESSED = fileURLToPath(new URL("shafts.png", import.meta.url));
const SIZE = { width: 480, height: 270 };
// A software adapter compiles for seconds.
const TIMEOUT = 300_000;

/** Opens the example in a page of `SIZE`; `run` gets the page and what its console said of errors and warnings. */
const withExample = (run) =>
    withPage(ROOT, async (page, url) => {
        const said = [];
        page.on("console", (line) => ["error", "warning"].includes(line.type()) && said.push(line.text()));
        await page.setViewportSize(SIZE);
        return run(page, `${url}examples/page/index.html`, said);
    });

/** Waits until more than `frames` frames were drawn, or the page shows a message; returns how many there are. */
async function drawn(page, frames) {
    const count = () => page.evaluate(() => Number(document.querySelector("canvas").dataset.frames ?? 0));
    await page.waitForFunction((frames) => {
        const message = document.querySelector("#message").textContent;
        return message || Number(document.querySelector("canvas").dataset.frames ?? 0) > frames;
    }, frames, { timeout: TIMEOUT });
    assert.equal(await page.textContent("#message"), "");
    return count();
}

/** The canvas as it is presented, without the sliders. */
const photograph = (page) => page.locator("canvas").screenshot({ style: "form { visibility: hidden }", timeout: TIMEOUT });

/** Moves sliders, waits for the frame, and returns the picture. */
async function moved(page, sliders) {
    const frames = await page.evaluate((sliders) => {
        const form = document.querySelector("form");
        for (const [name, value] of Object.entries(sliders)) form.elements[name].value = value;
        const before = Number(document.querySelector("canvas").dataset.frames);
        form.dispatchEvent(new Event("input"));
        return before;
    }, sliders);
    await drawn(page, frames);
    return photograph(page);
}

test("the picture, the sliders, another size", { timeout: 4 * TIMEOUT }, () =>
    withExample(async (page, address, said) => {
        await page.goto(address);
        let frames = await drawn(page, 0);
        const picture = await photograph(page);
        if (process.env.AIRLIGHT_BLESS) await writeFile(BLESSED, picture);
        const { structure, mean } = await similarity(page, picture, await readFile(BLESSED));
        assert.ok(structure > 0.98 && mean < 1.5, `structural similarity ${structure}, mean difference ${mean}`);

        // A shaft before the dark wall beside the bunny, and the bunny's back in the sun.
        const [shaft, back] = [[0.62, 0.53, 0.72, 0.62], [0.49, 0.54, 0.53, 0.62]];
        const [before, lit] = [await brightness(page, picture, shaft), await brightness(page, picture, back)];
        const thin = await brightness(page, await moved(page, { extinction: 0.005 }), shaft);
        assert.ok(before > 1.3 * thin, `less air, darker shafts: ${before} to ${thin}`);
        const soot = await moved(page, { extinction: 0.1, albedo: 0 });
        const [dark, dim] = [await brightness(page, soot, shaft), await brightness(page, soot, back)];
        assert.ok(dark < 0.5 * before, `soot scatters nothing: ${before} to ${dark}`);
        assert.ok(dim < 0.9 * lit && dim > 0.3 * lit, `and dims what lies behind: ${lit} to ${dim}`);
        const dimmer = await brightness(page, await moved(page, { extinction: 0.2 }), back);
        assert.ok(dimmer < 0.9 * dim, `more of it more: ${dim} to ${dimmer}`);
        const again = await moved(page, { extinction: 0.05, albedo: 0.95 });
        assert.ok((await similarity(page, again, picture)).structure > 0.999, "and all the way back");

        frames = await drawn(page, 0);
        await page.setViewportSize({ width: 320, height: 320 });
        await drawn(page, frames);
        const size = await page.evaluate(() => [document.querySelector("canvas").width, document.querySelector("canvas").height]);
        assert.deepEqual(size, [640, 640]);
        assert.deepEqual(said, []);
    }));

test("the steps of the README, in a new folder", { timeout: TIMEOUT }, async () => {
    const readme = await readFile(join(ROOT, "examples/page/README.md"), "utf8");
    const [, steps] = readme.split("## From an empty folder");
    const lines = steps.split("## Sliders")[0].split("\n").filter((line) => line.startsWith("    "));
    const script = lines.filter((line) => !/AIRLIGHT=|http\.server/.test(line)).join("\n");
    assert.ok(lines.length - script.split("\n").length === 2, "the repository and the server are the test's own");
    const folder = await mkdtemp(join(tmpdir(), "shafts-"));
    try {
        execFileSync("bash", ["-ec", script], { cwd: folder, env: { ...process.env, AIRLIGHT: ROOT } });
        await withPage(join(folder, "shafts"), async (page, url) => {
            await page.setViewportSize(SIZE);
            await page.goto(`${url}index.html`);
            await drawn(page, 0);
            const { structure, mean } = await similarity(page, await photograph(page), await readFile(BLESSED));
            assert.ok(structure > 0.98 && mean < 1.5, `structural similarity ${structure}, mean difference ${mean}`);
        });
    } finally {
        await rm(folder, { recursive: true });
    }
});

test("a browser without WebGPU is told so", { timeout: TIMEOUT }, () =>
    withExample(async (page, address) => {
        await page.addInitScript(() => Object.defineProperty(Navigator.prototype, "gpu", { get: () => undefined }));
        await page.goto(address);
        await page.waitForFunction(() => document.querySelector("#message").textContent, null, { timeout: TIMEOUT });
        assert.match(await page.textContent("#message"), /no WebGPU/);
    }));
