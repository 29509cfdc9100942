// SPDX-License-Identifier: MIT OR Apache-2.0
//! What compilers and back ends say.

use super::{Lint, Severity};

pub(super) const LINTS: &[Lint] = &[
    Lint {
        name: "compose",
        severity: Severity::Error,
        what: "an error of naga_oil or naga: syntax, types, names, capabilities beyond core WebGPU",
        why: "The shader does not compile.",
        mend: "Correct the source at the place that is named.",
        example: "fn f() -> f32 { return 1u; }",
    },
    Lint {
        name: "unused-broken",
        severity: Severity::Error,
        what: "an error in a part of a module that no shader uses",
        why: "The composer drops what is not used before it is validated, so every shader composes until one uses it. \
              The check forces every item of a module into use.",
        mend: "Correct the part, or remove it.",
        example: "#define_import_path noise\nfn used() -> f32 { return 1.0; }\nfn unused() -> f32 { return 1u; }",
    },
    Lint {
        name: "tint",
        severity: Severity::Error,
        what: "an error or warning of Tint, the compiler of Chrome",
        why: "naga takes programs that WebGPU forbids, such as aliased pointer arguments, f64 and atomic floats.",
        mend: "Correct what the message names: the program does not run in a browser.",
        example: "fn f(a: ptr<function, u32>, b: ptr<function, u32>) { *a = *b; }\nf(&x, &x);",
    },
    Lint {
        name: "uniformity",
        severity: Severity::Error,
        what: "a barrier, a derivative or `textureSample` in control flow that is not uniform",
        why: "Invocations that never arrive leave the others without a partner: a hang or wrong values. naga does not \
              look; Tint does. Where Tint is absent, only what an entry point decides by its own varying arguments \
              is seen.",
        mend: "Move the call out of the branch, or use `textureSampleLevel` or `textureSampleGrad`.",
        example: "if local_index < 4u {\n    workgroupBarrier();\n}",
    },
    Lint {
        name: "flat",
        severity: Severity::Error,
        what: "a composed shader that loses something when it is written as one WGSL file",
        why: "naga's writer drops `@size` and `@align` and renames; engines without a composer use that form. In \
              trees of others it is a warning.",
        mend: "Use padding members instead of layout attributes, and names that do not end in a digit.",
        example: "struct S { @size(32) a: f32, b: f32 }",
    },
    Lint {
        name: "spirv",
        severity: Severity::Error,
        what: "what naga cannot write as SPIR-V, or `spirv-val` rejects",
        why: "The shader does not run on Vulkan.",
        mend: "Write the construct in another way; the message names the entry point.",
        example: "[spirv] `main`: spirv-val: …",
    },
    Lint {
        name: "msl",
        severity: Severity::Error,
        what: "what naga cannot write as Metal Shading Language 2.4",
        why: "The shader does not run on Metal.",
        mend: "Write the construct in another way; the message names the entry point.",
        example: "[msl] `main`: …",
    },
    Lint {
        name: "hlsl",
        severity: Severity::Error,
        what: "what naga cannot write as HLSL for shader model 6.0",
        why: "The shader does not run on Direct3D 12.",
        mend: "Write the construct in another way; the message names the entry point.",
        example: "[hlsl] `main`: …",
    },
    Lint {
        name: "glsl",
        severity: Severity::Error,
        what: "what naga cannot write as GLSL 4.50, or `glslangValidator` rejects",
        why: "The shader does not run where a host falls back to OpenGL. WebGPU never does: in trees of others it is \
              a warning.",
        mend: "Read depth textures with a sampler, and use one sampler for a texture.",
        example: "@group(0) @binding(0) var depth: texture_depth_2d;\nlet z = textureLoad(depth, p, 0);",
    },
    Lint {
        name: "expected-failures",
        severity: Severity::Error,
        what: "an entry in Airlight's list of expected failures that is malformed or passes",
        why: "A list that is longer than it must be hides the next failure.",
        mend: "Take the entry out.",
        example: "scattering/filter glsl a reason that is gone",
    },
    Lint {
        name: "internal",
        severity: Severity::Error,
        what: "a check that panicked or found no end",
        why: "A fault of a compiler in the check, not seen before; the other files are checked all the same.",
        mend: "Report it with the file; `--allow internal` goes on without.",
        example: "shaders/a.wgsl: error: [internal] gave up after 300 s",
    },
];
