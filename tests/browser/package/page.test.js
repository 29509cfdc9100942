// SPDX-License-Identifier: MIT OR Apache-2.0
// The npm package in a page: Chromium's compiler, Tint, takes every flat file, and a page fetches no more than it uses.

import assert from "node:assert/strict";
import { cpSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { withPage } from "../chromium.js";
import { installed } from "./install.js";

let package_;

before(() => {
    package_ = installed();
    // A page has no `node_modules`; without a bundler it imports the folder.
    cpSync(join(package_.folder, "node_modules/airlight-wgsl"), join(package_.folder, "airlight-wgsl"), { recursive: true });
});
after(() => package_?.remove());

/** In the page: messages of the compiler about each permutation, and about one text that is broken. */
async function compileAll() {
    const airlight = await import("/airlight-wgsl/index.js");
    const { passes } = await airlight.manifest();
    const adapter = await navigator.gpu.requestAdapter();
    // What is default needs nothing; others may use all that there is.
    const core = await adapter.requestDevice();
    const rich = await (await navigator.gpu.requestAdapter()).requestDevice({ requiredFeatures: [...adapter.features] });
    const errors = async (code, device) => {
        device.pushErrorScope("validation");
        const info = await device.createShaderModule({ code }).getCompilationInfo();
        const error = await device.popErrorScope();
        const messages = info.messages.filter(({ type }) => type === "error");
        return messages.map(({ lineNum, message }) => `${lineNum}: ${message}`).concat(error ? [error.message] : []);
    };
    const wrong = [];
    let compiled = 0;
    for (const { name, permutations } of passes) {
        for (const permutation of permutations) {
            const code = await airlight.flat(name, permutation.name);
            const found = await errors(code, permutation.name === "default" ? core : rich);
            if (found.length > 0) wrong.push(`${name}:${permutation.name}: ${found.join("; ")}`);
            compiled += 1;
        }
    }
    const broken = await errors((await airlight.flat(passes[0].name)) + "\nfn broken() -> u32 { return 1.5; }\n", core);
    return { compiled, wrong, broken };
}

test("Tint compiles every flat file without an error", async () => {
    const { compiled, wrong, broken } = await withPage(package_.folder, async (page, url) => {
        await page.goto(url);
        return page.evaluate(compileAll);
    });
    assert.deepEqual(wrong, []);
    assert.ok(compiled > 300, `${compiled} are too few to be the library`);
    assert.ok(broken.length > 0, "a broken shader has no message, so that silence means nothing");
});

test("a page fetches the flat files that it asks for and no sources", async () => {
    const fetched = await withPage(package_.folder, async (page, url) => {
        await page.goto(url);
        const paths = [];
        page.on("request", (request) => paths.push(new URL(request.url()).pathname));
        const text = await page.evaluate(async () => (await import("/airlight-wgsl/flat.js")).flat("scattering/filter"));
        assert.match(text, /@compute/);
        return paths;
    });
    const folder = "/airlight-wgsl";
    const expected = [`${folder}/flat.js`, `${folder}/npm/flat.js`, `${folder}/npm/flat/scattering/filter.wgsl.js`];
    assert.deepEqual(fetched.filter((path) => path.startsWith(folder)).sort(), expected.sort());
});
