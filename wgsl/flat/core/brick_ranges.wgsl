// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: core/brick_ranges, permutation default
// summary: Least and greatest value of each brick of a volume.
// source: Levoy, "Efficient ray tracing of volume data" (1990).
// note: Values that are not finite count as 0. What makes a brick occupied is asked later, so that a change of it leaves these be.
// binding volume: the volume, any float format.
// binding ranges: out, least and greatest value of each brick and one voxel around it, a texel a brick.

// ---- airlight::core::bricks ----
// summary: Bricks of voxels over a volume, by which a march passes over empty space without a change of what it meets.
// source: Levoy, "Efficient ray tracing of volume data" (1990); distances after Cohen and Sheffer, "Proximity clouds" (1994).

/// Voxels along a brick.
const BRICK: u32 = 8u;

/// Bricks along each axis of a volume of `size` voxels.
fn brick_count(size: vec3<u32>) -> vec3<u32> {
    return (size + vec3<u32>(BRICK - 1u)) / BRICK;
}

// ---- airlight::core::finite ----
// summary: Replaces NaN and infinities in data that comes from outside.
// source: IEEE 754 binary32: all exponent bits set means NaN or infinity.

/// True if `x` is neither NaN nor infinite.
fn is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u;
}

/// `x` where it is finite, `fallback` elsewhere.
fn finite_or(x: f32, fallback: f32) -> f32 {
    return select(fallback, x, is_finite(x));
}

// ---- core/brick_ranges ----

@group(0) @binding(0) var volume: texture_3d<f32>;
@group(0) @binding(1) var ranges: texture_storage_3d<rg32float, write>;

@compute @workgroup_size(8, 4, 2)
fn brick_ranges(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = textureDimensions(volume);
    if any(id >= min(brick_count(size), textureDimensions(ranges))) {
        return;
    }
    let begin = max(id * BRICK, vec3<u32>(1u)) - 1u;
    let end = min((id + 1u) * BRICK + 1u, size);
    var least = 3.4e38;
    var greatest = -3.4e38;
    for (var z = begin.z; z < end.z; z++) {
        for (var y = begin.y; y < end.y; y++) {
            for (var x = begin.x; x < end.x; x++) {
                let value = finite_or(textureLoad(volume, vec3<u32>(x, y, z), 0).x, 0.0);
                least = min(least, value);
                greatest = max(greatest, value);
            }
        }
    }
    textureStore(ranges, id, vec4<f32>(least, greatest, 0.0, 0.0));
}
