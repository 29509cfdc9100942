// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: inverse/weigh_slices, permutation default (RGB)
// summary: What each step of a ray sends back into the volume: a pixel's value times the step's weight.
// source: thesis 7.4.1; see inverse/render_slices, whose weights these are.
// note: Dispatch over some rows of the picture of a view, then inverse/cg_backproject with the same rows. For extinction, where a step weighs its
// note: length, one slice stands for all: `weighed` has what a step sends back that crosses its slice whole.
// definition RGB: three channels, each by itself; else one.
// binding view: the view.
// binding spans: which part of each ray lies in the volume, rg32float; without PATHS.
// binding rows: which rows of the picture.
// binding picture: what is projected back.
// binding extinction: of the medium, 1/m; without PATHS.
// binding weighed: out, columns, rows of the picture from the first on, slices; r32float, rgba32float with RGB. One
// binding weighed: slice with PATHS.

// ---- airlight::core::prefix_sum ----
// summary: Running weighted mean along a row: the prefix sum that filters basis textures.
// source: thesis 4.3.3, Listings 4.1 and 4.2.

/// 1 - exp(-x) for x >= 0, without cancellation for small x. Relative error below 1e-6.
fn one_minus_exp(x: f32) -> f32 {
    const third: f32 = 1.0 / 3.0;
    const sixth: f32 = 1.0 / 6.0;
    let series = x * (1.0 - x * 0.5 * (1.0 - x * third * (1.0 - x * 0.25 * (1.0 - x * 0.2 * (1.0 - x * sixth)))));
    return select(1.0 - exp(-x), series, x < 0.3);
}

// ---- airlight::inverse::basis ----
// summary: Fields as sums of basis functions, one a voxel: triangle or box functions.
// source: thesis 7.3.1.

/// A field of triangle functions at a place.
fn triangle_field(field: texture_3d<f32>, unit: vec3<f32>) -> vec4<f32> {
    let size = textureDimensions(field);
    let last = vec3<f32>(size - vec3<u32>(1u));
    let place = clamp(unit * vec3<f32>(size) - 0.5, vec3<f32>(0.0), last);
    let low = floor(place);
    let part = place - low;
    let near = vec3<u32>(low);
    let far = vec3<u32>(min(low + 1.0, last));
    let a = mix(textureLoad(field, near, 0), textureLoad(field, vec3<u32>(far.x, near.yz), 0), part.x);
    let b = mix(textureLoad(field, vec3<u32>(near.x, far.y, near.z), 0), textureLoad(field, vec3<u32>(far.xy, near.z), 0), part.x);
    let c = mix(textureLoad(field, vec3<u32>(near.xy, far.z), 0), textureLoad(field, vec3<u32>(far.x, near.y, far.z), 0), part.x);
    let d = mix(textureLoad(field, vec3<u32>(near.x, far.yz), 0), textureLoad(field, far, 0), part.x);
    return mix(mix(a, b, part.y), mix(c, d, part.y), part.z);
}

// ---- airlight::inverse::channels ----
// summary: One number or three a voxel and a pixel.
// source: none; arithmetic of one and of three is the same.

/// The channels of a texel.
fn channels_of(texel: vec4<f32>) -> vec3<f32> {
    return texel.rgb;
}

/// The texel of channels.
fn texel_of(value: vec3<f32>) -> vec4<f32> {
    return vec4<f32>(value, 1.0);
}

/// The same number in all channels.
fn all_channels(value: f32) -> vec3<f32> {
    return vec3<f32>(value);
}

/// Optical depth of a step through an extinction; below 0 there is none.
fn step_depth(extinction: vec3<f32>, metres: f32) -> vec3<f32> {
    return max(extinction, vec3<f32>(0.0)) * metres;
}

/// What a step of an optical depth takes of what passes.
fn taken_of(depth: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(one_minus_exp(depth.x), one_minus_exp(depth.y), one_minus_exp(depth.z));
}

/// What a step through an extinction weighs behind an optical depth, to which it is added.
fn step_weight(depth: ptr<function, vec3<f32>>, extinction: vec3<f32>, metres: f32) -> vec3<f32> {
    let passed = step_depth(extinction, metres);
    let weight = exp(-*depth) * taken_of(passed);
    *depth += passed;
    return weight;
}

// ---- airlight::inverse::slice_steps ----
// summary: View rays in steps from slice to slice of a volume's box; a picture and its back-projection take the same.
// source: thesis 7.4.1 and Listing 7.1; slices along the main axis after Joseph (1982).

/// Most slices of a volume.
const MOST_SLICES: u32 = 4096u;

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

/// What a ray has of a slice.
struct SlicePart {
    /// Its middle, moved to the middle plane of the slice.
    place: vec3<f32>,
    /// How long it is, metres; 0 where the ray has nothing of the slice.
    metres: f32,
}

/// The ray through a position in pixels; (0.5, 0.5) is the middle of the first.
fn slice_ray(view: SliceView, pixel: vec2<f32>) -> SliceRay {
    let origin = view.origin + pixel.x * view.origin_right + pixel.y * view.origin_down;
    let direction = view.direction + pixel.x * view.direction_right + pixel.y * view.direction_down;
    let metres = direction.x * view.edge_x + direction.y * view.edge_y + direction.z * view.edge_z;
    return SliceRay(origin, direction, length(metres));
}

/// The slices of a ray, nearest first: steps count from `first` to before `end`.
struct SliceWalk {
    /// The first slice from the low side of the axis.
    first: u32,
    /// The one past the last.
    end: u32,
    /// Whether the nearest is the first.
    climbs: bool,
}

/// First slice of a ray's span and the one past the last, from the low side of the axis.
fn slices_of(view: SliceView, ray: SliceRay, span: vec2<f32>) -> vec2<u32> {
    let ends = dot(ray.origin, view.axis) + dot(ray.direction, view.axis) * span;
    let count = f32(min(view.slices, MOST_SLICES));
    // One more to each side: an end that rounding has put into the neighbour.
    let low = clamp(floor(min(ends.x, ends.y) * count - 0.01), 0.0, count);
    let high = clamp(ceil(max(ends.x, ends.y) * count + 0.01), low, count);
    return select(vec2<u32>(0u), vec2<u32>(vec2<f32>(low, high)), span.y > span.x);
}

/// The slices of a ray's span in its order.
fn slice_walk(view: SliceView, ray: SliceRay, span: vec2<f32>) -> SliceWalk {
    let slices = slices_of(view, ray, span);
    return SliceWalk(slices.x, slices.y, dot(ray.direction, view.axis) >= 0.0);
}

/// The slice of a step.
fn slice_of_step(walk: SliceWalk, step: u32) -> u32 {
    return select(walk.end - 1u - (step - walk.first), step, walk.climbs);
}

/// What a ray has of a slice within its span.
fn slice_part(view: SliceView, ray: SliceRay, span: vec2<f32>, slice: u32) -> SlicePart {
    let speed = dot(ray.direction, view.axis);
    let start = dot(ray.origin, view.axis);
    let sides = vec2<f32>(f32(slice), f32(slice + 1u)) / f32(view.slices);
    let still = abs(speed) < 1e-20;
    let crossings = (sides - start) / select(speed, 1.0, still);
    let within = start >= sides.x && start < sides.y;
    let begin = max(span.x, select(min(crossings.x, crossings.y), select(3e38, -3e38, within), still));
    let end = min(span.y, select(max(crossings.x, crossings.y), select(-3e38, 3e38, within), still));
    let part = max(end - begin, 0.0);
    let middle = ray.origin + ray.direction * (begin + 0.5 * part);
    return SlicePart(middle + view.axis * (0.5 * (sides.x + sides.y) - dot(middle, view.axis)), part * ray.metres);
}

// ---- inverse/weigh_slices ----

@group(0) @binding(0) var<uniform> view: SliceView;
@group(0) @binding(1) var spans: texture_2d<f32>;
@group(0) @binding(2) var<uniform> rows: PictureRows;
@group(0) @binding(3) var picture: texture_2d<f32>;
@group(0) @binding(4) var extinction: texture_3d<f32>;
@group(0) @binding(6) var weighed: texture_storage_3d<rgba32float, write>;

@compute @workgroup_size(16, 8)
fn weigh_slices(@builtin(global_invocation_id) id: vec3<u32>) {
    let pixel = vec2<u32>(id.x, id.y + rows.first);
    if id.y >= rows.count || any(pixel >= vec2<u32>(view.width, view.height)) {
        return;
    }
    let ray = slice_ray(view, vec2<f32>(pixel) + 0.5);
    let value = channels_of(textureLoad(picture, min(pixel, textureDimensions(picture) - 1u), 0));
    let span = textureLoad(spans, min(pixel, textureDimensions(spans) - 1u), 0).xy;
    let walk = slice_walk(view, ray, span);
    var depth = all_channels(0.0);
    for (var step = walk.first; step < walk.end; step++) {
        let slice = slice_of_step(walk, step);
        let part = slice_part(view, ray, span, slice);
        var weight = step_weight(&depth, channels_of(triangle_field(extinction, part.place)), part.metres);
        textureStore(weighed, vec3<u32>(id.xy, slice), texel_of(value * weight));
    }
}
