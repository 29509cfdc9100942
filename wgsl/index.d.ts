// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense

export { flat, permutations } from "./flat.js";

/** An algorithm module or callback: functions, structs and constants that a shader imports by naga_oil's `#import`. */
export interface Module {
    /** Import path, `airlight::<system>::<module>`. */
    readonly path: string;
    /** File in this package, `<system>/<module>.wgsl`. */
    readonly file: string;
    /** WGSL text with naga_oil directives. */
    readonly source: string;
    /** Import paths of the modules that it uses, all of them earlier in `modules`. */
    readonly imports: readonly string[];
}

/** A pass: bindings in `@group(#{GROUP})`, entry points, loops over texels. */
export interface Pass {
    /** `<system>/<pass>`. */
    readonly name: string;
    /** File in this package, `<system>/passes/<pass>.wgsl`. */
    readonly file: string;
    /** WGSL text with naga_oil directives; `flat` has it without. */
    readonly source: string;
    /** Import paths of the modules that it uses. */
    readonly imports: readonly string[];
    /** What is shipped of it; the first that a shader needs is `default`. */
    readonly permutations: readonly Permutation[];
}

/** A named set of definitions. */
export interface Permutation {
    /** Its name, `default` among them. */
    readonly name: string;
    /** Definitions by name: a flag is `true`, else a number. */
    readonly definitions: Readonly<Record<string, boolean | number>>;
}

/** A folder of modules and passes. */
export interface System {
    /** Its name. */
    readonly name: string;
    /** The text of its file `permutations`. */
    readonly permutations: string;
}

/** Every module, each after those that it imports. */
export const modules: readonly Module[];

/** Every pass, in the order of their names. */
export const passes: readonly Pass[];

/** Every system. */
export const systems: readonly System[];

/** What an engine binds, of every pass and permutation: `manifest.json`. It is large, and fetched when it is asked for. */
export function manifest(): Promise<Manifest>;

/** The manifest, as far as most need it; everything else of the file is there too. */
export interface Manifest {
    /** Version of the form of this file. */
    readonly format: number;
    readonly modules: readonly Pick<Module, "path" | "file" | "imports">[];
    readonly passes: readonly ManifestPass[];
}

/** A pass in the manifest. */
export interface ManifestPass {
    /** `<system>/<pass>`. */
    readonly name: string;
    readonly file: string;
    readonly imports: readonly string[];
    readonly permutations: readonly ManifestPermutation[];
}

/** A permutation in the manifest. */
export interface ManifestPermutation {
    readonly name: string;
    readonly definitions: Readonly<Record<string, boolean | number>>;
    /** Features and limits beyond those of every WebGPU device; empty where there are none. */
    readonly needs: {
        readonly features: readonly string[];
        readonly limits: Readonly<Record<string, number>>;
    };
    readonly entry_points: readonly {
        readonly name: string;
        readonly stage: "compute" | "vertex" | "fragment";
        /** Names of the bindings that it uses. */
        readonly bindings: readonly string[];
        /** Of a compute shader. */
        readonly workgroup_size?: readonly [number, number, number];
    }[];
    readonly bindings: readonly {
        readonly group: number;
        readonly binding: number;
        readonly name: string;
        /** `uniform`, `storage`, `texture`, `storage_texture`, `sampler` and the like. */
        readonly kind: string;
        /** Names of the entry points that use it. */
        readonly entry_points: readonly string[];
        readonly [more: string]: unknown;
    }[];
    /** Layouts of the structs, in bytes. */
    readonly structs: readonly {
        readonly name: string;
        readonly size: number;
        readonly align: number;
        readonly members: readonly {
            readonly name: string;
            readonly type: string;
            readonly offset: number;
            readonly size: number;
            readonly [more: string]: unknown;
        }[];
    }[];
}
