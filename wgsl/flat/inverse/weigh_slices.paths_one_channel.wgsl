// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: inverse/weigh_slices, permutation paths_one_channel (PATHS)
// summary: What each step of a ray sends back into the volume: a pixel's value times the step's weight.
// source: thesis 7.4.1; see inverse/render_slices, whose weights these are.
// note: Dispatch over some rows of the picture of a view, then inverse/cg_backproject with the same rows. For extinction, where a step weighs its
// note: length, one slice stands for all: `weighed` has what a step sends back that crosses its slice whole.
// definition PATHS: weights of extinction, the lengths of steps.
// binding view: the view.
// binding rows: which rows of the picture.
// binding picture: what is projected back.
// binding weighed: out, columns, rows of the picture from the first on, slices; r32float, rgba32float with RGB. One
// binding weighed: slice with PATHS.

// ---- airlight::inverse::channels ----
// summary: One number or three a voxel and a pixel.
// source: none; arithmetic of one and of three is the same.

/// The channel of a texel.
fn channels_of(texel: vec4<f32>) -> f32 {
    return texel.x;
}

/// The texel of a channel.
fn texel_of(value: f32) -> vec4<f32> {
    return vec4<f32>(value, 0.0, 0.0, 1.0);
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

/// Rows of a picture. 16 bytes.
struct PictureRows {
    /// From 0 at the top.
    first: u32,
    /// How many.
    count: u32,
    reserved_a: u32,
    reserved_b: u32,
}

/// A view ray.
struct SliceRay {
    /// Where it begins.
    origin: vec3<f32>,
    /// Of any length.
    direction: vec3<f32>,
    /// Metres that one length of `direction` is.
    metres: f32,
}

/// The ray through a position in pixels; (0.5, 0.5) is the middle of the first.
fn slice_ray(view: SliceView, pixel: vec2<f32>) -> SliceRay {
    let origin = view.origin + pixel.x * view.origin_right + pixel.y * view.origin_down;
    let direction = view.direction + pixel.x * view.direction_right + pixel.y * view.direction_down;
    let metres = direction.x * view.edge_x + direction.y * view.edge_y + direction.z * view.edge_z;
    return SliceRay(origin, direction, length(metres));
}

/// Metres that a ray has of a slice that it crosses whole within the box.
fn whole_slice_metres(view: SliceView, ray: SliceRay) -> f32 {
    let speed = abs(dot(ray.direction, view.axis)) * f32(view.slices);
    return select(ray.metres / max(speed, 1e-30), 0.0, speed == 0.0);
}

// ---- inverse/weigh_slices ----

@group(0) @binding(0) var<uniform> view: SliceView;
@group(0) @binding(2) var<uniform> rows: PictureRows;
@group(0) @binding(3) var picture: texture_2d<f32>;
@group(0) @binding(6) var weighed: texture_storage_3d<r32float, write>;

@compute @workgroup_size(16, 8)
fn weigh_slices(@builtin(global_invocation_id) id: vec3<u32>) {
    let pixel = vec2<u32>(id.x, id.y + rows.first);
    if id.y >= rows.count || any(pixel >= vec2<u32>(view.width, view.height)) {
        return;
    }
    let ray = slice_ray(view, vec2<f32>(pixel) + 0.5);
    let value = channels_of(textureLoad(picture, min(pixel, textureDimensions(picture) - 1u), 0));
    textureStore(weighed, vec3<u32>(id.xy, 0u), texel_of(value * whole_slice_metres(view, ray)));
}
