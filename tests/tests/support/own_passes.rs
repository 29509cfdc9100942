// SPDX-License-Identifier: MIT OR Apache-2.0
//! What the tests of `airlight run` share: passes of their own, and a camera for those of the library.
#![allow(dead_code, clippy::unwrap_used)]

use std::path::Path;

/// Passes of the tests' own, for what the library's do not have yet.
const MIXED: &str = "// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Everything that can be bound.
struct Inner { scale: vec2<f32>, count: u32 }
struct Parameters { turn: mat2x2<f32>, inner: array<Inner, 2>, shift: i32 }
@group(#{GROUP}) @binding(0) var<uniform> parameters: Parameters;
@group(#{GROUP}) @binding(1) var volume: texture_3d<f32>;
@group(#{GROUP}) @binding(2) var image: texture_2d<f32>;
@group(#{GROUP}) @binding(3) var image_sampler: sampler;
@group(#{GROUP}) @binding(4) var ids: texture_2d<u32>;
@group(#{GROUP}) @binding(5) var<storage, read_write> results: array<vec4<f32>>;
@group(#{GROUP}) @binding(6) var marks: texture_storage_2d<r32uint, read_write>;
@group(#{GROUP}) @binding(7) var<storage, read> points: array<vec3<f32>>;
@group(#{GROUP}) @binding(8) var<uniform> again: Parameters;
@compute @workgroup_size(1)
fn gather(@builtin(global_invocation_id) id: vec3<u32>) {
    let turned = parameters.turn * vec2<f32>(1.0, 10.0);
    results[4u * id.x] = vec4<f32>(turned, f32(parameters.inner[1].count), f32(parameters.shift));
    results[4u * id.x + 1u] = vec4<f32>(
        textureLoad(volume, vec3<u32>(1u, 0u, 1u), 0).x,
        textureSampleLevel(image, image_sampler, vec2<f32>(0.5, 0.25), 0.0).y,
        f32(textureLoad(ids, vec2<u32>(1u, 1u), 0).x), f32(arrayLength(&results))
    );
    results[4u * id.x + 2u] = vec4<f32>(points[1], f32(arrayLength(&points)));
    results[4u * id.x + 3u] = vec4<f32>(parameters.inner[0].scale, again.inner[0].scale);
}
@compute @workgroup_size(2, 2)
fn mark(@builtin(global_invocation_id) id: vec3<u32>) {
    let old = textureLoad(marks, id.xy).x;
    textureStore(marks, id.xy, vec4<u32>(old * 2u + id.x + u32(parameters.shift), 0u, 0u, 0u));
}
";

const DEPTHS: &str = "// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: What run cannot make.
@group(#{GROUP}) @binding(0) var depths: texture_depth_2d;
@group(#{GROUP}) @binding(1) var<storage, read_write> results: array<f32>;
@compute @workgroup_size(1)
fn depth_main() { results[0] = textureLoad(depths, vec2<u32>(0u), 0); }
@vertex
fn two_vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> { return vec4<f32>(f32(index)); }
struct Two { @location(0) a: vec4<f32>, @location(1) b: vec4<f32> }
@fragment
fn two() -> Two { return Two(vec4<f32>(1.0), vec4<f32>(2.0)); }
@fragment
fn three() -> @location(0) vec3<f32> { return vec3<f32>(1.0); }
";

const BROKEN: &str = "// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Wrong.
@compute @workgroup_size(1)
fn broken() { let x: u32 = 1.5; }
";

/// Writes them into the folder `own` of `folder`, as the system `t`.
pub fn own_shaders(folder: &Path) {
    let passes = folder.join("own/t/passes");
    std::fs::create_dir_all(&passes).unwrap();
    for (name, text) in [("mixed", MIXED), ("depths", DEPTHS), ("broken", BROKEN)] {
        std::fs::write(passes.join(format!("{name}.wgsl")), text).unwrap();
    }
    std::fs::write(
        folder.join("own/t/permutations"),
        "mixed\n+ default:\ndepths\n+ default:\nbroken\n+ default:\n",
    )
    .unwrap();
}

/// A camera as raw words, looking along -z from the origin with a field of view of 90 degrees and depths 0..1.
pub fn camera() -> Vec<f32> {
    let (near, far) = (0.1_f64, 10.0);
    let (a, b) = (far / (near - far), far * near / (near - far));
    // Columns.
    let clip_from_world =
        [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, a, -1.0], [0.0, 0.0, b, 0.0]];
    let world_from_clip =
        [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0 / b], [0.0, 0.0, -1.0, a / b]];
    let mut words: Vec<f32> =
        [clip_from_world, world_from_clip].iter().flatten().flatten().map(|word| *word as f32).collect();
    // Eye, depth of the near plane; viewport, depth of the far plane, perspective.
    words.extend([0.0, 0.0, 0.0, 0.0, 8.0, 8.0, 1.0, f32::from_bits(0)]);
    words
}
