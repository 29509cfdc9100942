// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: inverse/scatter_steps, permutation default (RGB)
// summary: Projects a picture back into the volume: the product with the transpose of W, in which each ray scatters.
// source: thesis 7.4.1; see inverse/render_slices, whose steps and weights these are.
// note: Dispatch over the picture of a view, into zeros; then inverse/scattered_sums. Additions are of whole numbers, 64 bits each: results are
// note: the same bits in every run, although no one knows the order. See inverse/fixed_point for why they do not overflow.
// note: Where each voxel collects, inverse/cg_backproject, the products are the same; here rays may be bent, and no volume of weighed steps is needed.
// definition RGB: three channels, each by itself; else one.
// binding view: the view.
// binding spans: which part of each ray lies in the volume, rg32float; of inverse/ray_spans, with BENT if this has it.
// binding grid: the voxels.
// binding picture: what is projected back.
// binding extinction: of the medium, 1/m; without PATHS.
// binding greatest: of inverse/greatest_values; without SWAP.
// binding words: in and out, channel by channel and x fastest, two words a number, the lower first; with SWAP one.

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

/// A voxel and its basis function at some place.
struct Corner {
    /// The voxel.
    voxel: vec3<u32>,
    /// Its basis function there, 0..1.
    weight: f32,
}

/// One of the eight voxels about a place, and its triangle function there; the eight weights add up to 1. `corner`: 0 to 7, a bit an axis.
fn triangle_corner(unit: vec3<f32>, size: vec3<u32>, corner: u32) -> Corner {
    let last = vec3<f32>(size - vec3<u32>(1u));
    let place = clamp(unit * vec3<f32>(size) - 0.5, vec3<f32>(0.0), last);
    let low = floor(place);
    let part = place - low;
    let upper = (vec3<u32>(corner, corner >> 1u, corner >> 2u) & vec3<u32>(1u)) == vec3<u32>(1u);
    let weights = select(vec3<f32>(1.0) - part, part, upper);
    // Upper ones that there are not have no weight.
    return Corner(vec3<u32>(select(low, min(low + 1.0, last), upper)), weights.x * weights.y * weights.z);
}

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

/// A number in fixed point, cut off towards 0. `exponent`: e, `pixels`: b of the note.
fn fixed_words(value: f32, exponent: i32, pixels: i32) -> vec2<u32> {
    let share = clamp(value * power_of_two(-exponent), -1.0, 1.0);
    let upper = abs(share) * power_of_two(29 - pixels);
    let whole = floor(upper);
    let words = vec2<u32>(u32((upper - whole) * 4294967296.0), u32(whole));
    return select(words, negative_words(words), share < 0.0);
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

/// Voxels of what is solved for. 16 bytes.
struct VoxelGrid {
    /// Along x, y and z, each from 1 up.
    size: vec3<u32>,
    reserved_a: u32,
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

// ---- inverse/scatter_steps ----

@group(0) @binding(0) var<uniform> view: SliceView;
@group(0) @binding(1) var spans: texture_2d<f32>;
@group(0) @binding(3) var<uniform> grid: VoxelGrid;
@group(0) @binding(4) var picture: texture_2d<f32>;
@group(0) @binding(5) var extinction: texture_3d<f32>;
@group(0) @binding(8) var<storage, read> greatest: array<u32>;
@group(0) @binding(9) var<storage, read_write> words: array<atomic<u32>>;

/// Adds to a number. Each time the lower word runs over, who sees it carries.
fn add(number: u32, value: f32, exponent: i32, pixels: i32) {
    let place = min(2u * number, max(arrayLength(&words), 2u) - 2u);
    let added = fixed_words(value, exponent, pixels);
    let old = atomicAdd(&words[place], added.x);
    let carried = select(0u, 1u, old > 0xffffffffu - added.x);
    atomicAdd(&words[min(place + 1u, arrayLength(&words) - 1u)], added.y + carried);
}

/// Adds channels to a voxel's sums.
fn add_channels(voxel: vec3<u32>, value: vec3<f32>, exponents: vec3<i32>, pixels: i32) {
    let index = (voxel.z * grid.size.y + voxel.y) * grid.size.x + voxel.x;
    for (var channel = 0u; channel < 3u; channel++) {
        add(3u * index + channel, value[channel], exponents[channel], pixels);
    }
}

/// Exponents of fixed point, by channel.
fn exponents_of_channels() -> vec3<i32> {
    var exponents = vec3<i32>(0);
    for (var channel = 0u; channel < 3u; channel++) {
        let most = arrayLength(&greatest) - 1u;
        exponents[channel] = fixed_exponent(greatest[min(channel, most)], greatest[min(4u + channel, most)]);
    }
    return exponents;
}

@compute @workgroup_size(16, 8)
fn scatter_steps(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= vec2<u32>(view.width, view.height)) {
        return;
    }
    let ray = slice_ray(view, vec2<f32>(id.xy) + 0.5);
    let span = textureLoad(spans, min(id.xy, textureDimensions(spans) - 1u), 0).xy;
    let texel = textureLoad(picture, min(id.xy, textureDimensions(picture) - 1u), 0);
    let value = channels_of(vec4<f32>(finite_or(texel.x, 0.0), finite_or(texel.y, 0.0), finite_or(texel.z, 0.0), 0.0));
    let exponents = exponents_of_channels();
    let pixels = pixel_exponent(view.width * view.height);
    let walk = slice_walk(view, ray, span);
    let first = walk.first;
    let end = walk.end;
    var depth = all_channels(0.0);
    for (var step = first; step < end; step++) {
        let part = slice_part(view, ray, span, slice_of_step(walk, step));
        var weight = step_weight(&depth, channels_of(triangle_field(extinction, part.place)), part.metres);
        let sent = value * weight;
        if part.metres > 0.0 {
            for (var corner = 0u; corner < 8u; corner++) {
                let reached = triangle_corner(part.place, grid.size, corner);
                add_channels(reached.voxel, reached.weight * sent, exponents, pixels);
            }
        }
    }
}
