// SPDX-License-Identifier: MIT OR Apache-2.0
// The npm package in node, and what TypeScript says of its types.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { WGSL, installed } from "./install.js";

const text = (file) => readFileSync(join(WGSL, file), "utf8");
const wgsl = (folder) =>
    readdirSync(join(WGSL, folder), { recursive: true, withFileTypes: true })
        .filter((entry) => entry.isFile() && entry.name.endsWith(".wgsl"))
        .map((entry) => join(entry.parentPath, entry.name).slice(WGSL.length));

let package_;
let airlight;

before(async () => {
    package_ = installed();
    airlight = await import(pathToFileURL(join(package_.folder, "node_modules/airlight-wgsl/index.js")));
});
after(() => package_?.remove());

test("the package holds every shader, the manifest and the licences", () => {
    const files = new Set(package_.files);
    const shaders = wgsl(".");
    assert.ok(shaders.length > 400, `${shaders.length} files are too few to be the library and its flat files`);
    const others = ["manifest.json", "README.md", "package.json", "LICENSE-MIT", "LICENSE-APACHE", "UNLICENSE"];
    for (const file of [...shaders, ...others]) assert.ok(files.has(file), file);
    for (const file of files) assert.doesNotMatch(file, /\.(rs|toml|tgz)$|prepack/, file);
});

test("modules and passes are the files, and each module follows what it imports", () => {
    const { modules, passes, systems } = airlight;
    for (const { file, source } of [...modules, ...passes]) assert.equal(source, text(file), file);
    const flat = wgsl("flat");
    const files = new Set([...modules, ...passes].map(({ file }) => file));
    assert.deepEqual([...files].sort(), wgsl(".").filter((file) => !flat.includes(file)).sort());
    const seen = new Set();
    for (const { path, imports } of modules) {
        for (const other of imports) assert.ok(seen.has(other), `${path} before ${other}`);
        seen.add(path);
    }
    for (const { name, permutations } of systems) assert.equal(permutations, text(`${name}/permutations`), name);
});

test("flat texts are the flat files, and there are no others", async () => {
    const loaded = new Set();
    for (const { name, permutations } of airlight.passes) {
        assert.deepEqual(airlight.permutations(name), permutations.map(({ name }) => name));
        for (const permutation of airlight.permutations(name)) {
            const file = permutation === "default" ? `flat/${name}.wgsl` : `flat/${name}.${permutation}.wgsl`;
            assert.equal(await airlight.flat(name, permutation), text(file), file);
            loaded.add(file);
        }
        assert.equal(await airlight.flat(name), text(`flat/${name}.wgsl`));
    }
    assert.deepEqual([...loaded].sort(), wgsl("flat").sort());
    assert.deepEqual(airlight.permutations(), airlight.passes.map(({ name }) => name));
});

test("what there is not is named, with what there is", async () => {
    await assert.rejects(airlight.flat("scattering/none"), { name: "RangeError", message: /scattering\/filter/ });
    await assert.rejects(airlight.flat("scattering/filter", "none"), { name: "RangeError", message: /it has default, / });
    assert.throws(() => airlight.permutations("none"), RangeError);
    await assert.rejects(airlight.flat("__proto__"), RangeError);
});

test("the manifest is the file", async () => {
    assert.deepEqual(await airlight.manifest(), JSON.parse(text("manifest.json")));
});

test("files can be resolved by name", () => {
    const require = createRequire(join(package_.folder, "user.js"));
    for (const file of ["core/phase.wgsl", "flat/scattering/filter.wgsl", "manifest.json"]) {
        assert.equal(readFileSync(require.resolve(`airlight-wgsl/${file}`), "utf8"), text(file), file);
    }
});

test("its version and licence texts are those of the crate", () => {
    const { version, license } = JSON.parse(text("package.json"));
    const workspace = readFileSync(join(WGSL, "../Cargo.toml"), "utf8");
    assert.equal(version, workspace.match(/\[workspace\.package\]\s+version = "([^"]+)"/)[1]);
    assert.equal(license, text("Cargo.toml").match(/^license = "([^"]+)"/m)[1]);
    for (const file of ["LICENSE-MIT", "LICENSE-APACHE", "UNLICENSE"]) {
        assert.equal(text(file), readFileSync(join(WGSL, "..", file), "utf8"), file);
    }
});

const USER = `
import { flat, manifest, modules, passes, permutations, systems } from "airlight-wgsl";
import { flat as alone } from "airlight-wgsl/flat";
import type { Manifest, Module } from "airlight-wgsl";

const code: string = await flat("scattering/filter", permutations("scattering/filter")[0]);
const same: Promise<string> = alone("scattering/filter");
const first: Module = modules[0]!;
const found: Manifest = await manifest();
const group: number = found.passes[0]!.permutations[0]!.bindings[0]!.group;
const value: boolean | number | undefined = passes[0]!.permutations[0]!.definitions["BASES"];
const names: string[] = permutations();
export { code, first, group, names, same, systems, value };
`;

test("the types are those of the code, for node and for bundlers", () => {
    const tsc = createRequire(import.meta.url).resolve("typescript/bin/tsc");
    const compile = (file, ...options) =>
        execFileSync(
            process.execPath,
            [tsc, "--noEmit", "--strict", "--noUncheckedIndexedAccess", "--target", "es2022", ...options, file],
            { cwd: package_.folder, encoding: "utf8" },
        );
    writeFileSync(join(package_.folder, "user.ts"), USER);
    for (const [module, resolution] of [["nodenext", "nodenext"], ["esnext", "bundler"]]) {
        compile("user.ts", "--module", module, "--moduleResolution", resolution);
    }
    for (const [wrong, message] of [["flat(1);", /not assignable/], ["modules[0]!.source = '';", /read-only/]]) {
        writeFileSync(join(package_.folder, "wrong.ts"), `import { flat, modules } from "airlight-wgsl";\n${wrong}\n`);
        assert.throws(
            () => compile("wrong.ts", "--module", "nodenext", "--moduleResolution", "nodenext"),
            (error) => message.test(error.stdout),
        );
    }
});
