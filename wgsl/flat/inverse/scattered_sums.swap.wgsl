// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: inverse/scattered_sums, permutation swap (RGB SWAP)
// summary: Adds what inverse/scatter_steps has scattered to what is collected, and leaves zeros.
// source: none; fixed point as floats.
// note: Dispatch over the voxels, with RGB and SWAP as inverse/scatter_steps has them.
// definition RGB: three channels, each by itself; else one.
// definition SWAP: sums are floats in single words.
// binding view: the view.
// binding grid: the voxels.
// binding words: in and out, sums and then zeros.
// binding solved: 0 where a voxel is not solved for: it stays as it is. A number a voxel, x fastest.
// binding collected: in and out, a number a voxel; four with RGB, of which the last stays as it is.

// ---- airlight::inverse::slice_steps ----
// summary: View rays in steps from slice to slice of a volume's box; a picture and its back-projection take the same.
// source: thesis 7.4.1 and Listing 7.1; slices along the main axis after Joseph (1982).

/// A view of the volume: rays are affine in the pixel. 208 bytes.
struct SliceView {
    /// Where the ray through the corner of the picture begins.
    origin: vec3<f32>,
    /// How many slices, 1..MOST_SLICES.
    slices: u32,
    /// Direction of that ray, of any length.
    direction: vec3<f32>,
    reserved_a: u32,
    /// What a pixel to the right adds to the origin.
    origin_right: vec3<f32>,
    /// Of the picture, pixels.
    width: u32,
    /// What a pixel to the right adds to the direction.
    direction_right: vec3<f32>,
    /// Of the picture, pixels.
    height: u32,
    /// What a pixel down adds to the origin.
    origin_down: vec3<f32>,
    reserved_b: u32,
    /// What a pixel down adds to the direction.
    direction_down: vec3<f32>,
    reserved_c: u32,
    /// Unit vector across slices: an axis of the box.
    axis: vec3<f32>,
    /// How far from faces across the slices samples may lie of rays that do not cross their slice whole, of the box: anywhere from 1 on.
    margin: f32,
    /// Homogeneous column, in pixels, of a point (x, y, z, 1).
    column_of: vec4<f32>,
    /// Homogeneous row.
    row_of: vec4<f32>,
    /// What both are divided by.
    divisor_of: vec4<f32>,
    /// Edge of the box along x, in the world, metres.
    edge_x: vec3<f32>,
    reserved_e: u32,
    /// Edge along y.
    edge_y: vec3<f32>,
    reserved_f: u32,
    /// Edge along z.
    edge_z: vec3<f32>,
    reserved_g: u32,
}

/// Voxels of what is solved for. 16 bytes.
struct VoxelGrid {
    /// Along x, y and z, each from 1 up.
    size: vec3<u32>,
    reserved_a: u32,
}

// ---- inverse/scattered_sums ----

@group(0) @binding(0) var<uniform> view: SliceView;
@group(0) @binding(1) var<uniform> grid: VoxelGrid;
@group(0) @binding(3) var<storage, read_write> words: array<u32>;
@group(0) @binding(4) var<storage, read> solved: array<f32>;
@group(0) @binding(5) var<storage, read_write> collected: array<f32>;

/// Takes a number out of the words. `channel`: of it, 0 to 2.
fn taken(number: u32, channel: u32) -> f32 {
    let place = min(number, arrayLength(&words) - 1u);
    let sum = bitcast<f32>(words[place]);
    words[place] = 0u;
    return sum;
}

@compute @workgroup_size(8, 4, 4)
fn scattered_sums(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id >= grid.size) {
        return;
    }
    let index = (id.z * grid.size.y + id.y) * grid.size.x + id.x;
    let wanted = solved[min(index, arrayLength(&solved) - 1u)] != 0.0;
    for (var channel = 0u; channel < 3u; channel++) {
        let sum = taken(3u * index + channel, channel);
        let place = min(4u * index + channel, arrayLength(&collected) - 1u);
        collected[place] += select(0.0, sum, wanted);
    }
}
