// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: core/brick_distances, permutation default
// summary: Spreads distances to occupied bricks along an axis; along all three, one after the other, they are Chebyshev's.
// source: Cohen and Sheffer, "Proximity clouds" (1994); separable since max(|x|, |y|, |z|) is a maximum of maxima.
// binding from_distances: r32uint, distances so far, 0 in occupied bricks.
// binding to_distances: out, r32uint, with those along the axis.

// ---- airlight::core::bricks ----
// summary: Bricks of voxels over a volume, by which a march passes over empty space without a change of what it meets.
// source: Levoy, "Efficient ray tracing of volume data" (1990); distances after Cohen and Sheffer, "Proximity clouds" (1994).

/// The distance where no brick is occupied.
const NOTHING_NEAR: u32 = 4096u;

// ---- core/brick_distances ----

@group(0) @binding(0) var from_distances: texture_3d<u32>;
@group(0) @binding(1) var to_distances: texture_storage_3d<r32uint, write>;

fn spread(id: vec3<u32>, axis: vec3<u32>) {
    let size = textureDimensions(from_distances);
    if any(id >= min(size, textureDimensions(to_distances))) {
        return;
    }
    let before = dot(id, axis);
    let after = dot(size - 1u - id, axis);
    var nearest = textureLoad(from_distances, id, 0).x;
    for (var k = 1u; k < min(nearest, max(before, after) + 1u); k++) {
        let left = textureLoad(from_distances, id - axis * min(k, before), 0).x;
        let right = textureLoad(from_distances, id + axis * min(k, after), 0).x;
        nearest = min(nearest, max(k, min(left, right)));
    }
    textureStore(to_distances, id, vec4<u32>(min(nearest, NOTHING_NEAR)));
}

@compute @workgroup_size(8, 4, 2)
fn spread_x(@builtin(global_invocation_id) id: vec3<u32>) {
    spread(id, vec3<u32>(1u, 0u, 0u));
}

@compute @workgroup_size(8, 4, 2)
fn spread_y(@builtin(global_invocation_id) id: vec3<u32>) {
    spread(id, vec3<u32>(0u, 1u, 0u));
}

@compute @workgroup_size(8, 4, 2)
fn spread_z(@builtin(global_invocation_id) id: vec3<u32>) {
    spread(id, vec3<u32>(0u, 0u, 1u));
}
