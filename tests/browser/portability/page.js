// SPDX-License-Identifier: MIT OR Apache-2.0
// Runs in a page: repeats cases one after the other and compares what they write.

import { compare } from "./compare.js";
import { open, repeat } from "./device.js";

const blobs = new Map();

async function fetched(url, read) {
    if (!blobs.has(url)) {
        const response = await fetch(url);
        if (!response.ok) throw new Error(`${url}: ${response.status}`);
        blobs.set(url, read(response));
    }
    return blobs.get(url);
}

const bytesOf = (url) => fetched(url, async (response) => new Uint8Array(await response.arrayBuffer()));
const textOf = (url) => fetched(url, (response) => response.text());

let opened;

/** What the adapter says of itself. */
export async function adapter() {
    opened ??= await open();
    return opened.info;
}

/**
 * Repeats cases. Each is `{url, blobs, shaders, tolerances}`: addresses of its description, of the folder of blobs and of the text
 * of each of its shaders; a tolerance for each output.
 */
export async function run(cases) {
    const results = [];
    for (const one of cases) {
        const recorded = await (await fetch(one.url)).json();
        const blob = (name) => bytesOf(one.blobs + name);
        try {
            opened ??= await open();
            const written = await repeat(opened.device, recorded, blob, (shader) => textOf(one.shaders[shader]));
            const outputs = [];
            for (const [k, { name, resource }] of recorded.outputs.entries()) {
                const about = recorded.resources[resource];
                const [before, after] = [await blob(about.before), await blob(about.after)];
                const changed = about.before !== about.after;
                const compared = compare(about, written.get(resource), after, one.tolerances[k]);
                outputs.push({ name, changed, ...compared, bytes: before.length });
            }
            results.push({ outputs });
        } catch (error) {
            results.push({ error: error.message });
        }
    }
    return results;
}
