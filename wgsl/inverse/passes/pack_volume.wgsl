// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Puts a vector of the solver into a texture, from which rays read faster.
// source: none; a copy whose rows need no padding.
// note: Dispatch over the voxels. What is not finite becomes 0.
// definition RGB: three channels, four numbers a voxel; else one.
// binding grid: the voxels.
// binding vector: numbers a voxel, x fastest.
// binding volume: out, r32float, rgba32float with RGB.

#import airlight::core::finite::finite_or
#import airlight::inverse::slice_steps::VoxelGrid

@group(#{GROUP}) @binding(0) var<uniform> grid: VoxelGrid;
@group(#{GROUP}) @binding(1) var<storage, read> vector: array<f32>;
#ifdef RGB
@group(#{GROUP}) @binding(2) var volume: texture_storage_3d<rgba32float, write>;
#else
@group(#{GROUP}) @binding(2) var volume: texture_storage_3d<r32float, write>;
#endif

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
#ifdef RGB
    let value = vec4<f32>(number_at(4u * index), number_at(4u * index + 1u), number_at(4u * index + 2u), 0.0);
#else
    let value = vec4<f32>(number_at(index), 0.0, 0.0, 0.0);
#endif
    textureStore(volume, id, value);
}
