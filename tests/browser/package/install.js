// SPDX-License-Identifier: MIT OR Apache-2.0
// Packs the npm package and installs it as a stranger would, into an empty folder and without a network.

import { execFileSync } from "node:child_process";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { fileURLToPath } from "node:url";

/** The folder `wgsl/` of this repository. */
export const WGSL = fileURLToPath(new URL("../../../wgsl/", import.meta.url));

/** A folder with the package in its `node_modules`; the names of the packed files; and what removes the folder. */
export function installed() {
    const folder = mkdtempSync(join(tmpdir(), "airlight-npm-"));
    const npm = (args, cwd) => execFileSync("npm", args, { cwd, encoding: "utf8", stdio: ["ignore", "pipe", "inherit"] });
    const remove = () => rmSync(folder, { recursive: true, force: true });
    try {
        // `prepack` may print as well; the list comes last.
        const printed = npm(["pack", "--json", "--loglevel=error", "--pack-destination", folder], WGSL);
        const [packed] = JSON.parse(printed.slice(printed.indexOf("[")));
        writeFileSync(join(folder, "package.json"), '{ "private": true, "type": "module" }\n');
        npm(["install", "--offline", "--no-audit", "--no-fund", "--loglevel=error", `./${packed.filename}`], folder);
        return { folder, files: packed.files.map(({ path }) => path), remove };
    } catch (error) {
        remove();
        throw error;
    }
}
