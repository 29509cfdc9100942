// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::splatting::splat
// summary: Splats: voxels above a threshold, where they lie, and the quad that covers one in a picture.
// source: Zhang and Crawfis, 2.1 and 4.1, steps 3 and 12 to 14.
// note: Voxel space has the middle of voxel (i, j, k) at (i, j, k). Kernels are round there, and ellipsoids in the world, so that
// note: volumes of unequal, turned or skewed voxels need nothing else.
// equation: voxel (i, j, k) = (index mod w, (index / w) mod h, index / (w h));  reach along d = radius |Mᵀ d|, M: voxels to metres
// error: footprints of a constant volume add up to a constant within 1 %;
// error: test splatting/pictures::footprints_of_a_constant_volume_add_up_to_a_constant.
// parameter index: number of the voxel, x fastest.
// parameter matrix: affine.
// parameter direction: unit vector in the world.
// parameter middle: metres in the world.
// parameter radius: voxels, above 0.
// parameter vertex: 0..5.

#import airlight::core::camera::{Camera, ORTHOGRAPHIC, towards_viewer, matrix_row}

/// A voxel that is drawn. 8 bytes.
struct Splat {
    /// Number of the voxel, x fastest, then y.
    voxel: u32,
    /// Its value.
    value: f32,
}

/// A volume of splats. 144 bytes.
struct SplatVolume {
    /// Voxel space to the world, metres; affine.
    world_from_voxel: mat4x4<f32>,
    /// Its inverse.
    voxel_from_world: mat4x4<f32>,
    /// Voxels along x, y and z.
    size: vec3<u32>,
    /// Voxels of no greater value are left out.
    threshold: f32,
}

/// Voxels or splats that are looked at together. 16 bytes.
struct SplatBatch {
    /// Number of the first.
    first: u32,
    /// How many.
    count: u32,
    reserved_a: u32,
    reserved_b: u32,
}

/// Where voxel `index` lies in voxel space.
fn voxel_place(volume: SplatVolume, index: u32) -> vec3<f32> {
    let width = max(volume.size.x, 1u);
    let height = max(volume.size.y, 1u);
    let row = index / width;
    return vec3<f32>(f32(index - row * width), f32(row % height), f32(row / height));
}

/// The linear part of an affine matrix.
fn linear_part(matrix: mat4x4<f32>) -> mat3x3<f32> {
    return mat3x3<f32>(matrix[0].xyz, matrix[1].xyz, matrix[2].xyz);
}

/// How far a splat of `radius` voxels reaches along a unit vector of the world, metres.
fn reach_along(volume: SplatVolume, direction: vec3<f32>, radius: f32) -> f32 {
    return radius * length(direction * linear_part(volume.world_from_voxel));
}

/// A corner of the quad that covers a splat: a point of the world, metres, in the plane through its `middle` that faces the eye.
struct QuadCorner {
    /// The point.
    point: vec3<f32>,
    /// Whether the quad is to be drawn: not where the eye is in the splat, or before it.
    visible: bool,
}

/// Corner of vertex 0..5 of the two triangles of the quad around a splat of `radius` voxels.
fn quad_around(camera: Camera, volume: SplatVolume, middle: vec3<f32>, radius: f32, vertex: u32) -> QuadCorner {
    let index = select(vertex - 2u, vertex, vertex < 3u);
    let to_viewer = towards_viewer(camera, middle);
    let distance = max(length(to_viewer), 1e-20);
    let axis = to_viewer / distance;
    // Any two directions across the axis; those of the picture keep quads tight.
    let up = matrix_row(camera.clip_from_world, 1u).xyz;
    let across = cross(up, axis);
    let right = across * inverseSqrt(max(dot(across, across), 1e-30));
    let top = cross(axis, right);
    let near = reach_along(volume, axis, radius);
    let parallel = camera.projection == ORTHOGRAPHIC;
    let before = parallel || distance > 1.25 * near;
    // What lies before the plane is seen larger.
    let larger = select(distance / max(distance - near, 0.2 * distance), 1.0, parallel);
    let sides = vec2<f32>(reach_along(volume, right, radius), reach_along(volume, top, radius)) * larger;
    let corner = vec2<f32>(f32(index & 1u), f32(index >> 1u)) * 2.0 - 1.0;
    return QuadCorner(middle + right * (sides.x * corner.x) + top * (sides.y * corner.y), before);
}
