// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: inverse/scattered_sums, permutation one_channel
// summary: Adds what inverse/scatter_steps has scattered to what is collected, and leaves zeros.
// source: none; fixed point as floats.
// note: Dispatch over the voxels, with RGB and SWAP as inverse/scatter_steps has them.
// binding view: the view.
// binding grid: the voxels.
// binding greatest: of inverse/greatest_values; without SWAP.
// binding words: in and out, sums and then zeros.
// binding solved: 0 where a voxel is not solved for: it stays as it is. A number a voxel, x fastest.
// binding collected: in and out, a number a voxel; four with RGB, of which the last stays as it is.

// ---- airlight::inverse::fixed_point ----
// summary: Sums of a back-projection in fixed point of 64 bits: no order of additions changes them.
// source: none; two's complement in two words, the lower one first.

/// A power of two. `exponent`: -126 to 127.
fn power_of_two(exponent: i32) -> f32 {
    return bitcast<f32>(u32(clamp(exponent, -126, 127) + 127) << 23u);
}

/// Exponent of a power of two that is greater than what the bits of a float say.
fn exponent_above(bits: u32) -> i32 {
    return i32((bits & 0x7fffffffu) >> 23u) - 126;
}

/// The exponent e of the note. Bits of floats: `greatest` of the picture's greatest absolute value, `bound` of the bound of row sums.
fn fixed_exponent(greatest: u32, bound: u32) -> i32 {
    return clamp(exponent_above(greatest) + exponent_above(bound), -60, 120);
}

/// The exponent b of the note.
fn pixel_exponent(pixels: u32) -> i32 {
    return 32 - i32(countLeadingZeros(pixels));
}

/// The negative of a number of two words.
fn negative_words(words: vec2<u32>) -> vec2<u32> {
    return vec2<u32>(~words.x + 1u, ~words.y + select(0u, 1u, words.x == 0u));
}

/// The float next to a number in fixed point, or next but one.
fn fixed_number(words: vec2<u32>, exponent: i32, pixels: i32) -> f32 {
    let negative = words.y >= 0x80000000u;
    let size = select(words, negative_words(words), negative);
    let unit = exponent + pixels - 61;
    let number = f32(size.y) * power_of_two(unit + 32) + f32(size.x) * power_of_two(unit);
    return select(number, -number, negative);
}

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
@group(0) @binding(2) var<storage, read> greatest: array<u32>;
@group(0) @binding(3) var<storage, read_write> words: array<u32>;
@group(0) @binding(4) var<storage, read> solved: array<f32>;
@group(0) @binding(5) var<storage, read_write> collected: array<f32>;

/// Takes a number out of the words. `channel`: of it, 0 to 2.
fn taken(number: u32, channel: u32) -> f32 {
    let place = min(2u * number, max(arrayLength(&words), 2u) - 2u);
    let both = vec2<u32>(words[place], words[min(place + 1u, arrayLength(&words) - 1u)]);
    words[place] = 0u;
    words[min(place + 1u, arrayLength(&words) - 1u)] = 0u;
    let most = arrayLength(&greatest) - 1u;
    let exponent = fixed_exponent(greatest[min(channel, most)], greatest[min(4u + channel, most)]);
    return fixed_number(both, exponent, pixel_exponent(view.width * view.height));
}

@compute @workgroup_size(8, 4, 4)
fn scattered_sums(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id >= grid.size) {
        return;
    }
    let index = (id.z * grid.size.y + id.y) * grid.size.x + id.x;
    let wanted = solved[min(index, arrayLength(&solved) - 1u)] != 0.0;
    let sum = taken(index, 0u);
    collected[min(index, arrayLength(&collected) - 1u)] += select(0.0, sum, wanted);
}
