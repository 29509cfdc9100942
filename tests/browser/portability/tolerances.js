// SPDX-License-Identifier: MIT OR Apache-2.0
// How much an output may differ: as much as the snapshots that hold it allow another adapter, or else a default of its format.

import { readdir, readFile } from "node:fs/promises";
import { join } from "node:path";

/** `[absolute, relative]` of each kind of number, and the share of elements that may be further off, where no snapshot says it. */
export const DEFAULTS = {
    f16: [2e-3, 5e-3],
    f32: [1e-4, 1e-3],
    i32: [0, 0],
    u32: [0, 0],
    unorm: [4e-3, 0],
    outliers: 0.02,
};

/** Of each snapshot, by its name: the numbers of its header, or null for a picture. */
export async function readSnapshots(folder) {
    const files = (await readdir(folder)).filter((file) => file.endsWith(".snap"));
    const read = async (file) => {
        const text = await readFile(join(folder, file), "utf8");
        const line = /^tolerance: (\S+) \+ (\S+) of the value; outliers on another adapter: (\S+)$/m.exec(text);
        return [file.slice(0, -".snap".length), line ? line.slice(1).map(Number) : null];
    };
    return new Map(await Promise.all(files.map(read)));
}

/** The tolerance of an output of a pass (`key`), by the snapshots that were taken of it: the strictest one. */
export function toleranceOf(key, output, taken, snapshots) {
    const named = taken.filter((entry) => entry.key === key && entry.output === output);
    const stated = named.filter((entry) => snapshots.get(entry.snapshot));
    if (stated.length === 0) return { ...DEFAULTS, source: "default" };
    const strictness = ([absolute, relative, outliers]) => absolute + relative + outliers;
    const numbers = (entry) => snapshots.get(entry.snapshot);
    const [first] = stated.sort((a, b) => strictness(numbers(a)) - strictness(numbers(b)));
    const [absolute, relative, outliers] = numbers(first);
    const [float, whole] = [[absolute, relative], [absolute, 0]];
    return { f16: float, f32: float, i32: whole, u32: whole, unorm: float, outliers, source: first.snapshot };
}
