// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: inverse/pack_volume, permutation default (RGB)
// summary: Puts a vector of the solver into a texture, from which rays read faster.
// source: none; a copy whose rows need no padding.
// note: Dispatch over the voxels. What is not finite becomes 0.
// definition RGB: three channels, four numbers a voxel; else one.
// binding grid: the voxels.
// binding vector: numbers a voxel, x fastest.
// binding volume: out, r32float, rgba32float with RGB.

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

// ---- airlight::inverse::slice_steps ----
// summary: View rays in steps from slice to slice of a volume's box; a picture and its back-projection take the same.
// source: thesis 7.4.1 and Listing 7.1; slices along the main axis after Joseph (1982).

/// Voxels of what is solved for. 16 bytes.
struct VoxelGrid {
    /// Along x, y and z, each from 1 up.
    size: vec3<u32>,
    reserved_a: u32,
}

// ---- inverse/pack_volume ----

@group(0) @binding(0) var<uniform> grid: VoxelGrid;
@group(0) @binding(1) var<storage, read> vector: array<f32>;
@group(0) @binding(2) var volume: texture_storage_3d<rgba32float, write>;

/// A number of the vector.
fn number_at(place: u32) -> f32 {
    return finite_or(vector[min(place, arrayLength(&vector) - 1u)], 0.0);
}

@compute @workgroup_size(8, 4, 4)
fn pack_volume(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id >= grid.size) {
        return;
    }
    let index = (id.z * grid.size.y + id.y) * grid.size.x + id.x;
    let value = vec4<f32>(number_at(4u * index), number_at(4u * index + 1u), number_at(4u * index + 2u), 0.0);
    textureStore(volume, id, value);
}
