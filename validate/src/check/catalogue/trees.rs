// SPDX-License-Identifier: MIT OR Apache-2.0
//! What is found while a tree is read.

use super::{Lint, Severity};

pub(super) const LINTS: &[Lint] = &[
    Lint {
        name: "unreadable",
        severity: Severity::Error,
        what: "a file or folder that cannot be read, is not UTF-8, or is larger than 1 MiB",
        why: "WGSL is UTF-8, and the composer has 21 bits for a position in a file.",
        mend: "Save the file as UTF-8; split a file that is larger.",
        example: "shaders/sky.wgsl:3:12: error: [unreadable] is not UTF-8 from here on",
    },
    Lint {
        name: "nesting",
        severity: Severity::Error,
        what: "brackets or operators nested more than 2000 deep",
        why: "Compilers recurse with what a text nests and run out of stack, which ends the whole program.",
        mend: "Break the expression into several statements.",
        example: "let a = ((((((…))))));",
    },
    Lint {
        name: "unresolved-import",
        severity: Severity::Error,
        what: "an import of a path that no file has",
        why: "The composer drops an import that nothing names, and with it the error; one that is named stops the \
              first shader that needs it. Files that depend on the importer are listed as not checked.",
        mend: "Correct the path, or add the folder of the module by `--module-dir`.",
        example: "#import bevy_pbr::mesh_view_bindings::view   // without --module-dir path/to/bevy_pbr",
    },
    Lint {
        name: "import-cycle",
        severity: Severity::Error,
        what: "modules that import each other in a circle",
        why: "There is no order in which a composer can take them.",
        mend: "Move what both need into a third module.",
        example: "#define_import_path a        #define_import_path b\n#import b                    #import a",
    },
    Lint {
        name: "duplicate-module",
        severity: Severity::Error,
        what: "two files with the same `#define_import_path`",
        why: "A composer keeps the one that it is given last and says nothing.",
        mend: "Give each file a path of its own.",
        example: "#define_import_path noise   // in noise.wgsl and in old/noise.wgsl",
    },
    Lint {
        name: "permutations",
        severity: Severity::Error,
        what: "a permutations file that is malformed or does not fit the shaders",
        why: "A shader or definition that is misspelt there is never checked the way it ships.",
        mend: "List existing passes, files or import paths, and definitions that they read.",
        example: "scattering/filter.wgsl\n+ default: BASES=32\n+ half: BASES=32 HALF",
    },
    Lint {
        name: "library",
        severity: Severity::Error,
        what: "a folder in Airlight's own layout that cannot be read as one",
        why: "Nothing in it is checked then.",
        mend: "Mend the file that the finding names.",
        example: "wgsl/core/noise.wgsl:1: error: [library] a module needs `#define_import_path airlight::core::noise`",
    },
    Lint {
        name: "import-path",
        severity: Severity::Error,
        what: "a module in Airlight's own layout whose path is not that of its file",
        why: "Who looks for a module by its path does not find it.",
        mend: "Name the path after the file: `airlight::<system>::<module>`.",
        example: "#define_import_path airlight::core::nois   // in core/noise.wgsl",
    },
    Lint {
        name: "unset-definition",
        severity: Severity::Warning,
        what: "a definition in Airlight's own layout that no permutation sets",
        why: "Its branch is compiled by nobody before a user sets it.",
        mend: "List a permutation that sets it, or take the branch out.",
        example: "#ifdef HALF   // and no permutation with HALF",
    },
];
