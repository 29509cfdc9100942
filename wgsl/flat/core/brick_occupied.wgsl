// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: core/brick_occupied, permutation default
// summary: Which bricks hold values above a threshold, as distances before they are spread.
// source: Levoy, "Efficient ray tracing of volume data" (1990).
// note: What systems with another question replace: it writes 0 for an occupied brick, NOTHING_NEAR for an empty one.
// binding threshold: the threshold.
// binding ranges: least and greatest value of each brick, of brick_ranges.
// binding distances: out, r32uint, a texel a brick.

// ---- airlight::core::bricks ----
// summary: Bricks of voxels over a volume, by which a march passes over empty space without a change of what it meets.
// source: Levoy, "Efficient ray tracing of volume data" (1990); distances after Cohen and Sheffer, "Proximity clouds" (1994).

/// The distance where no brick is occupied.
const NOTHING_NEAR: u32 = 4096u;

// ---- core/brick_occupied ----

struct BrickThreshold {
    /// A brick is occupied if its greatest value exceeds this.
    value: f32,
    reserved_a: f32,
    reserved_b: f32,
    reserved_c: f32,
}

@group(0) @binding(0) var<uniform> threshold: BrickThreshold;
@group(0) @binding(1) var ranges: texture_3d<f32>;
@group(0) @binding(2) var distances: texture_storage_3d<r32uint, write>;

@compute @workgroup_size(8, 4, 2)
fn brick_occupied(@builtin(global_invocation_id) id: vec3<u32>) {
    if all(id < textureDimensions(distances)) {
        let empty = textureLoad(ranges, id, 0).y <= threshold.value;
        textureStore(distances, id, vec4<u32>(select(0u, NOTHING_NEAR, empty)));
    }
}
