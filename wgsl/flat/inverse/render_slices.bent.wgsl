// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: inverse/render_slices, permutation bent (ALBEDO BENT EMISSION RGB)
// summary: A picture of a volume, linear in what is solved for: the product with W.
// source: thesis 7.3.2, Eq. 7.4, 7.6, 7.8 and 7.13, Listing 7.1.
// note: Dispatch over the picture of a view.
// note: A step of length d through extinction s behind a transmittance T weighs T (1 - exp(-s d)) for emission, and that times scattered light
// note: for albedo. For extinction it weighs d: the picture is the optical depth, the thesis's o with the other sign.
// definition EMISSION: emission is solved for; with ALBEDO both are. Without PATHS.
// definition ALBEDO: albedo is solved for. Without PATHS.
// definition RGB: three channels, each by itself; else one.
// definition BENT: rays are bent by an index of refraction, and their steps are of one length.
// binding view: the view.
// binding spans: which part of each ray lies in the volume, rg32float; of inverse/ray_spans, with BENT if this has it.
// binding rendered: out, radiance of the volume, with PATHS its optical depth; r32float, rgba32float with RGB.
// binding extinction: of the medium, 1/m; with PATHS what is solved for.
// binding emission: radiance of a medium so thick that nothing shines through; with EMISSION.
// binding albedo: of the medium, 0..1; with ALBEDO.
// binding scattered: radiance that an albedo of 1 scatters towards the eye; with ALBEDO.
// binding steps: of the view's rays; with BENT.
// binding refraction: index of refraction; with BENT.
// binding through: out, transmittance to what lies behind, like `rendered`; without PATHS.

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

/// Most steps of any bent ray.
const MOST_RAY_STEPS: u32 = 65536u;

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

/// Steps of rays. 16 bytes.
struct RaySteps {
    /// Length of a step of a bent ray, metres, above 0.
    metres: f32,
    /// Most steps of a bent ray, 0..MOST_RAY_STEPS.
    most: u32,
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

// ---- airlight::inverse::bent_rays ----
// summary: View rays that an index of refraction bends inside the box, in steps of one length; a picture and its back-projection take the same.
// source: Ihrke et al., "Eikonal rendering" (2007); thesis 7.3.

/// Gradients of the three coordinates of the box in the world, 1/m.
struct BoxSlopes {
    /// Of the first coordinate.
    along_x: vec3<f32>,
    /// Of the second.
    along_y: vec3<f32>,
    /// Of the third.
    along_z: vec3<f32>,
}

/// A bent ray before a step.
struct BentRay {
    /// Where it is, in unit space.
    place: vec3<f32>,
    /// Unit vector in the world.
    direction: vec3<f32>,
    /// Index of refraction where it is.
    index: f32,
    /// Metres from where it entered the box to where it ends at the latest.
    reach: f32,
    /// Whole steps that it has taken.
    taken: u32,
}

/// Gradients of the coordinates of a view's box.
fn box_slopes(view: SliceView) -> BoxSlopes {
    let size = max(max(length(view.edge_x), length(view.edge_y)), max(length(view.edge_z), 1e-30));
    // Of edges of about a metre, so that no product is too great or too small.
    let edge_x = view.edge_x / size;
    let edge_y = view.edge_y / size;
    let edge_z = view.edge_z / size;
    let across = cross(edge_y, edge_z);
    let volume = dot(edge_x, across);
    let scale = 1.0 / (size * select(volume, 1e-30, abs(volume) < 1e-30));
    return BoxSlopes(across * scale, cross(edge_z, edge_x) * scale, cross(edge_x, edge_y) * scale);
}

/// A direction of the world in unit space, per metre.
fn unit_direction(slopes: BoxSlopes, world: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(dot(slopes.along_x, world), dot(slopes.along_y, world), dot(slopes.along_z, world));
}

/// The index of refraction at a place.
fn index_at(refraction: texture_3d<f32>, unit: vec3<f32>) -> f32 {
    return clamp(finite_or(triangle_field(refraction, unit).x, 1.0), 0.01, 100.0);
}

/// Gradient of the index in the world, 1/m.
fn index_slope(refraction: texture_3d<f32>, slopes: BoxSlopes, unit: vec3<f32>) -> vec3<f32> {
    let size = vec3<f32>(textureDimensions(refraction));
    let aside = 0.5 / size;
    let x = index_at(refraction, unit + vec3<f32>(aside.x, 0.0, 0.0)) - index_at(refraction, unit - vec3<f32>(aside.x, 0.0, 0.0));
    let y = index_at(refraction, unit + vec3<f32>(0.0, aside.y, 0.0)) - index_at(refraction, unit - vec3<f32>(0.0, aside.y, 0.0));
    let z = index_at(refraction, unit + vec3<f32>(0.0, 0.0, aside.z)) - index_at(refraction, unit - vec3<f32>(0.0, 0.0, aside.z));
    return slopes.along_x * (x * size.x) + slopes.along_y * (y * size.y) + slopes.along_z * (z * size.z);
}

/// A ray where it enters the box. `span`: of inverse/ray_spans with BENT.
fn bent_ray(refraction: texture_3d<f32>, view: SliceView, ray: SliceRay, span: vec2<f32>) -> BentRay {
    let metres = ray.direction.x * view.edge_x + ray.direction.y * view.edge_y + ray.direction.z * view.edge_z;
    let place = ray.origin + ray.direction * span.x;
    let inside = span.y > span.x;
    return BentRay(
        select(vec3<f32>(0.5), place, inside),
        metres / max(ray.metres, 1e-30),
        index_at(refraction, place),
        select(0.0, min((span.y - span.x) * ray.metres, 1e30), inside),
        0u
    );
}

/// Metres to where a ray leaves the box; not above 0 for one on a face, on its way out.
fn way_out(place: vec3<f32>, along: vec3<f32>) -> f32 {
    let still = abs(along) < vec3<f32>(1e-20);
    let safe = select(along, vec3<f32>(1.0), still);
    let ways = (select(vec3<f32>(0.0), vec3<f32>(1.0), along > vec3<f32>(0.0)) - place) / safe;
    let way = select(ways, vec3<f32>(3e38), still);
    return min(min(way.x, way.y), way.z);
}

/// What is next of a ray; 0 metres of one that has ended.
fn part_ahead(slopes: BoxSlopes, ray: BentRay, step: f32) -> SlicePart {
    let along = unit_direction(slopes, ray.direction);
    let left = ray.reach - f32(ray.taken) * step;
    let metres = max(min(step, min(left, way_out(ray.place, along))), 0.0);
    return SlicePart(ray.place + along * (0.5 * metres), metres);
}

/// The ray after a part.
fn after_part(refraction: texture_3d<f32>, slopes: BoxSlopes, ray: BentRay, part: SlicePart, step: f32) -> BentRay {
    let place = ray.place + unit_direction(slopes, ray.direction) * step;
    let turned = ray.direction * ray.index + index_slope(refraction, slopes, ray.place) * step;
    let size = length(turned);
    // A force that takes all its way away leaves a ray as it is.
    let direction = select(ray.direction, turned / max(size, 1e-20), size > 1e-20);
    let ended = part.metres < step;
    return BentRay(
        select(place, ray.place, ended),
        direction,
        index_at(refraction, place),
        select(ray.reach, 0.0, ended),
        ray.taken + 1u
    );
}

/// What is next of a ray, which goes on behind it; 0 metres of one that has ended.
fn next_part(refraction: texture_3d<f32>, slopes: BoxSlopes, ray: ptr<function, BentRay>, step: f32) -> SlicePart {
    let part = part_ahead(slopes, *ray, step);
    *ray = after_part(refraction, slopes, *ray, part, step);
    return part;
}

// ---- inverse/render_slices ----

@group(0) @binding(0) var<uniform> view: SliceView;
@group(0) @binding(1) var spans: texture_2d<f32>;
@group(0) @binding(2) var rendered: texture_storage_2d<rgba32float, write>;
@group(0) @binding(3) var extinction: texture_3d<f32>;
@group(0) @binding(4) var emission: texture_3d<f32>;
@group(0) @binding(5) var albedo: texture_3d<f32>;
@group(0) @binding(6) var scattered: texture_3d<f32>;
@group(0) @binding(7) var through: texture_storage_2d<rgba32float, write>;
@group(0) @binding(8) var<uniform> steps: RaySteps;
@group(0) @binding(9) var refraction: texture_3d<f32>;

/// What is solved for, at a place.
fn solved(field: texture_3d<f32>, place: vec3<f32>) -> vec4<f32> {
    return triangle_field(field, place);
}

@compute @workgroup_size(16, 8)
fn render_slices(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= vec2<u32>(view.width, view.height)) {
        return;
    }
    let ray = slice_ray(view, vec2<f32>(id.xy) + 0.5);
    let span = textureLoad(spans, min(id.xy, textureDimensions(spans) - 1u), 0).xy;
    let slopes = box_slopes(view);
    var bent = bent_ray(refraction, view, ray, span);
    let first = 0u;
    let end = min(steps.most, MOST_RAY_STEPS);
    var sum = all_channels(0.0);
    var depth = all_channels(0.0);
    for (var step = first; step < end; step++) {
        let part = next_part(refraction, slopes, &bent, steps.metres);
        if part.metres <= 0.0 {
            break;
        }
        let weight = step_weight(&depth, channels_of(triangle_field(extinction, part.place)), part.metres);
        var radiance = all_channels(0.0);
        radiance += channels_of(solved(emission, part.place));
        radiance += channels_of(solved(albedo, part.place)) * channels_of(triangle_field(scattered, part.place));
        sum += weight * radiance;
    }
    textureStore(rendered, id.xy, texel_of(sum));
    textureStore(through, id.xy, texel_of(exp(-depth)));
}
