// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: inverse/ray_spans, permutation bent (BENT)
// summary: Which part of each view ray lies in the volume before the first surface.
// source: thesis Listing 7.1.
// note: Dispatch over the picture, once for a view. What is not finite in `depths` counts as no surface.
// definition BENT: rays are bent in the volume: they end at the surface at the latest, and where they leave the volume is not asked.
// binding view: the view.
// binding depths: of the first surface along each view ray, metres from where the ray begins, r32float; great where there is none.
// binding spans: out, from and to in lengths of the ray's direction, rg32float; to is not greater than from where a ray misses.

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

/// The part of a ray in the box up to `limit` metres from where the ray begins, in lengths of its direction; none where the second is not
/// the greater.
fn ray_span(ray: SliceRay, limit: f32) -> vec2<f32> {
    let still = abs(ray.direction) < vec3<f32>(1e-20);
    let safe = select(ray.direction, vec3<f32>(1.0), still);
    let low = -ray.origin / safe;
    let high = (vec3<f32>(1.0) - ray.origin) / safe;
    let inside = (ray.origin >= vec3<f32>(0.0)) & (ray.origin <= vec3<f32>(1.0));
    let enters = select(min(low, high), vec3<f32>(0.0), still);
    let leaves = select(max(low, high), select(vec3<f32>(-1.0), vec3<f32>(3e38), inside), still);
    let begins = max(max(enters.x, enters.y), max(enters.z, 0.0));
    let ends = min(min(leaves.x, leaves.y), leaves.z);
    return vec2<f32>(begins, min(ends, max(limit, 0.0) / max(ray.metres, 1e-30)));
}

// ---- inverse/ray_spans ----

@group(0) @binding(0) var<uniform> view: SliceView;
@group(0) @binding(1) var depths: texture_2d<f32>;
@group(0) @binding(2) var spans: texture_storage_2d<rg32float, write>;

@compute @workgroup_size(16, 8)
fn ray_spans(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= vec2<u32>(view.width, view.height)) {
        return;
    }
    let limit = finite_or(textureLoad(depths, min(id.xy, textureDimensions(depths) - 1u), 0).x, 3e38);
    let ray = slice_ray(view, vec2<f32>(id.xy) + 0.5);
    let straight = ray_span(ray, limit);
    let reach = min(max(limit, 0.0), 1e30) / max(ray.metres, 1e-6);
    let span = vec2<f32>(straight.x, select(straight.y, reach, straight.y > straight.x));
    textureStore(spans, id.xy, vec4<f32>(span, 0.0, 0.0));
}
