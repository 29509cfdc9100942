// SPDX-License-Identifier: MIT OR Apache-2.0
//! What no compiler says, or says too late.

use super::{Lint, Severity};

pub(super) const LINTS: &[Lint] = &[
    Lint {
        name: "condition",
        severity: Severity::Error,
        what: "`&&`, `||` or more than one clause in `#if`, `#ifdef` or `#ifndef`",
        why: "naga_oil tests the first clause and ignores the rest of the line without a word.",
        mend: "Nest the conditions.",
        example: "#if BASES == 32 && HALF == 1   // taken whenever BASES is 32",
    },
    Lint {
        name: "layout-attribute",
        severity: Severity::Error,
        what: "`@align` or `@size` in a struct of a module",
        why: "The attributes are dropped on import, so that the importer reads other bytes than the host wrote.",
        mend: "Use padding members.",
        example: "#define_import_path a\nstruct S { @align(16) a: f32, @align(16) b: f32 }",
    },
    Lint {
        name: "renamed-name",
        severity: Severity::Warning,
        what: "a member, local, entry point or item that ends in a digit or holds `__`",
        why: "naga appends `_` to such a name whenever a module is written out for an importer, and folds `__`: the \
              name that a host or importer looks for is gone. For a module's items and members it is an error.",
        mend: "End the name in a letter.",
        example: "struct Vertex { uv1: vec2<f32> }   // becomes uv1_",
    },
    Lint {
        name: "unused-import",
        severity: Severity::Warning,
        what: "an import that the file does not use",
        why: "It composes even if the item is misspelt or the module is broken.",
        mend: "Remove the import.",
        example: "#import noise::{perlin, perlln}\nfn f(x: f32) -> f32 { return perlin(x); }",
    },
    Lint {
        name: "imported-override",
        severity: Severity::Error,
        what: "a pipeline `override` of another module, used by name",
        why: "The composer has no names for overrides of modules; the error that follows speaks of something else.",
        mend: "Declare the override in the shader, or use `#{NAME}` and a definition.",
        example: "#define_import_path a          #import a\noverride SIZE: u32 = 8;        fn f() -> u32 { return a::SIZE; }",
    },
    Lint {
        name: "abstract-const",
        severity: Severity::Warning,
        what: "a constant of a module without a concrete type",
        why: "A value without a type is folded away inside the module, so that an importer does not find it.",
        mend: "Write the type: `const X: f32 = 0.5`.",
        example: "#define_import_path a\nconst X = 0.5;",
    },
    Lint {
        name: "precedence",
        severity: Severity::Error,
        what: "operators that WGSL has no order for, without parentheses",
        why: "naga reads them as C does; browsers reject the file.",
        mend: "Write the parentheses.",
        example: "let a = i << 1u + i;\nlet b = x || y && z;",
    },
    Lint {
        name: "endless-loop",
        severity: Severity::Error,
        what: "`loop` or `for (;;)` without `break` or `return`",
        why: "naga takes it; browsers reject the file, and a device that runs it is lost.",
        mend: "Give the loop an exit.",
        example: "loop { i += 1u; }",
    },
    Lint {
        name: "select-index",
        severity: Severity::Warning,
        what: "index arithmetic inside `select` that nothing holds in range",
        why: "`select` evaluates both values before it takes one, so that the index leaves the array exactly where the \
              condition was to prevent it; what comes back then differs from device to device.",
        mend: "Clamp the index, or use `if`.",
        example: "let a = select(values[i - 1u], 0.0, i == 0u);",
    },
    Lint {
        name: "formats",
        severity: Severity::Error,
        what: "a storage format, an access or a resource that core WebGPU does not have",
        why: "Shader compilers accept it; the error comes when a pipeline is made, and on some devices only. Core \
              `read_write` is r32float, r32uint and r32sint alone.",
        mend: "Use a core format; read through one binding and write through another.",
        example: "@group(0) @binding(0) var t: texture_storage_2d<rgba16float, read_write>;",
    },
    Lint {
        name: "limits",
        severity: Severity::Error,
        what: "more of something than WebGPU grants by default",
        why: "The developer's device has more, a user's may not: 8 storage buffers and 4 storage textures a stage, 256 \
              invocations and 16 KiB of memory a workgroup, 4 bind groups. In a named permutation it is a warning.",
        mend: "Use less, or ask for the limit and name the permutation.",
        example: "@compute @workgroup_size(32, 32) fn main() {}",
    },
    Lint {
        name: "padding",
        severity: Severity::Error,
        what: "a hole in a uniform struct of Airlight's own layout",
        why: "A host that writes the struct field by field puts what follows in the wrong place.",
        mend: "Spell the padding out as a member.",
        example: "struct S { a: f32, b: vec3<f32> }",
    },
];
