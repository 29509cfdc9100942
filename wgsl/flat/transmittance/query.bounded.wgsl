// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: transmittance/query, permutation bounded (BOUNDED COEFFICIENTS=4)
// summary: Transmittance from the light to each of a list of points in the world, by any form of map.
// source: Gautron et al., "Extinction transmittance maps" (2011), Eq. 3.
// note: What a renderer does for each particle or sample; here for curves along a light ray, and for tests.
// note: Points that are not finite have transmittance 1.
// definition COEFFICIENTS: numbers a texel, four a layer: 4, 8 or 16, of the moments 8; 4 where it is not given.
// definition BOUNDED: an extinction map over the occupied interval of each texel.
// binding coefficients: the layers of the map, rgba32float or rgba16float.
// binding intervals: least and greatest occupied depth, 0..1, rg32float; with BOUNDED only.
// binding light: the directional light of the map.
// binding points: points in the world, metres; the fourth number is not used.
// binding transmittances: out, 0..1, one a point.

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

// ---- airlight::core::fourier_basis ----
// summary: Visibility as a Fourier series of the depth difference, four bases at a time.
// source: thesis 4.3.1, Eq. 4.7, after Annen et al., "Convolution shadow maps" (2007).

const PI: f32 = 3.141592653589793;

/// (sin, cos) of pi times `half_turns`, exact reduction for large arguments.
fn sine_cosine(half_turns: f32) -> vec2<f32> {
    let angle = PI * (half_turns - 2.0 * round(0.5 * half_turns));
    return vec2<f32>(sin(angle), cos(angle));
}

/// (sin, cos) of the sum of two angles given by (sin, cos).
fn rotate(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    return vec2<f32>(a.x * b.y + a.y * b.x, a.y * b.y - a.x * b.x);
}

// ---- airlight::core::cosine_basis ----
// summary: Cosines of whole multiples of a depth, their integrals and means, four orders at a time.
// source: Gautron et al., "Extinction transmittance maps" (SIGGRAPH Asia 2011 sketches), Eq. 1 and 3.

const ROOT_OF_TWO: f32 = 1.4142135623730951;

/// Cosines and sines of four angles, and the rotation that leads to the next four.
struct Harmonics {
    /// Cosines.
    cosine: vec4<f32>,
    /// Sines.
    sine: vec4<f32>,
    /// Sine and cosine of the angle from one group to the next.
    turn: vec2<f32>,
}

/// Orders 0 to 3 of pi times `depth`.
fn harmonics_first(depth: f32) -> Harmonics {
    let one = sine_cosine(depth);
    let two = rotate(one, one);
    let three = rotate(two, one);
    return Harmonics(
        vec4<f32>(1.0, one.y, two.y, three.y), vec4<f32>(0.0, one.x, two.x, three.x), rotate(two, two)
    );
}

/// The next group.
fn harmonics_next(at: Harmonics) -> Harmonics {
    return Harmonics(
        at.cosine * at.turn.y - at.sine * at.turn.x, at.sine * at.turn.y + at.cosine * at.turn.x, at.turn
    );
}

/// Orders 4 g .. 4 g + 3 of a group.
fn cosine_orders(group: u32) -> vec4<f32> {
    return f32(4u * group) + vec4<f32>(0.0, 1.0, 2.0, 3.0);
}

/// B_j of a group, the integrals of b_j from 0 to `depth`. `at`: of the same depth.
fn cosine_integral(at: Harmonics, depth: f32, group: u32) -> vec4<f32> {
    let orders = cosine_orders(group);
    let scale = ROOT_OF_TWO / (PI * max(orders, vec4<f32>(1.0)));
    return select(scale * at.sine, vec4<f32>(depth), orders < vec4<f32>(0.5));
}

/// The Fejer window of a series of `count` coefficients: 1 - j / count. What was not negative stays so.
fn fejer_window(group: u32, count: u32) -> vec4<f32> {
    return max(1.0 - cosine_orders(group) / f32(count), vec4<f32>(0.0));
}

// ---- airlight::core::light ----
// summary: A light, its fall-off and texture, and the clip space of its standard shadow map.
// source: thesis 4.2.1; a point source seen through a cone and softened by its radius.

/// A light and its standard shadow map. 192 bytes.
struct Light {
    /// World to the shadow map's clip space; affine for a directional light, unused with an array of shadow maps.
    clip_from_world: mat4x4<f32>,
    /// Its inverse.
    world_from_clip: mat4x4<f32>,
    /// Unit vector TOWARDS a directional light; of a spot, the reverse of the axis along which it shines.
    direction: vec3<f32>,
    /// Depth of an empty texel of the shadow map, farthest from the light: 1 forward, 0 reversed.
    far_depth: f32,
    /// Linear RGB: for a directional light the irradiance at normal incidence; for one at a point its radiant
    /// intensity, the irradiance at a distance of one metre.
    radiance: vec3<f32>,
    /// DIRECTIONAL, SPOT or POINT.
    kind: u32,
    /// Where a spot or point light is, metres.
    position: vec3<f32>,
    /// Radius of a spot or point light, metres, positive: nearer to it the fall-off with distance stops.
    radius: f32,
    /// Cosines of the half angles inside which a spot shines fully, and outside which not at all.
    spot_cosines: vec2<f32>,
    reserved_a: f32,
    reserved_b: f32,
}

/// Position in texels of a map, and depth, of a point in the clip space of that map; a point at or behind the light
/// (w <= 0) is carried outside the map. `size`: of the map in texels.
fn texels_from_clip(clip: vec4<f32>, size: vec2<f32>) -> vec3<f32> {
    let before = clip.w > 0.0;
    let ndc = clip.xyz / select(1.0, clip.w, before);
    return select(vec3<f32>(-size, 0.0), vec3<f32>((ndc.xy * vec2<f32>(0.5, -0.5) + 0.5) * size, ndc.z), before);
}

/// Position in texels of the shadow map, and depth, of a point in the world, metres; a point behind a spot is carried
/// outside the map. `size`: of the map in texels.
fn shadow_position(light: Light, size: vec2<f32>, point: vec3<f32>) -> vec3<f32> {
    return texels_from_clip(light.clip_from_world * vec4<f32>(point, 1.0), size);
}

// ---- airlight::transmittance::light_space ----
// summary: Places in a transmittance map: texels across the light, and the depth along it.
// source: core/light for the clip space of a directional light.

/// A depth of the light's clip space as a depth of the map or back: 0 near, 1 far.
fn forward_depth(light: Light, clip_depth: f32) -> f32 {
    return select(1.0 - clip_depth, clip_depth, light.far_depth > 0.5);
}

/// Position in texels and depth 0..1 of a point in the world, metres; outside of the map beyond these ranges.
fn map_position(light: Light, size: vec2<f32>, point: vec3<f32>) -> vec3<f32> {
    let at = shadow_position(light, size, point);
    return vec3<f32>(at.xy, forward_depth(light, at.z));
}

// ---- airlight::transmittance::map_texels ----
// summary: Callback: the texels of a map around a place, and bilinear means of their layers.
// source: none; rgba32float is not filterable in core WebGPU, so that means are taken by loads but with FILTERED.

/// The four texels of a bilinear read.
struct Footprint {
    /// First and second column.
    columns: vec2<u32>,
    /// First and second row.
    rows: vec2<u32>,
    /// Share of the second column and of the second row, 0..1.
    share: vec2<f32>,
}

/// The texels around `place`, texel i at i + 0.5; outside of the map of `size` texels the nearest inside.
fn footprint(size: vec2<u32>, place: vec2<f32>) -> Footprint {
    let last = size - vec2<u32>(1u);
    let at = clamp(place - 0.5, vec2<f32>(0.0), vec2<f32>(last));
    let begin = min(vec2<u32>(at), last);
    let next = min(begin + 1u, last);
    let share = at - vec2<f32>(begin);
    return Footprint(vec2<u32>(begin.x, next.x), vec2<u32>(begin.y, next.y), share);
}

/// One texel alone.
fn footprint_alone(size: vec2<u32>, texel: vec2<u32>) -> Footprint {
    return Footprint(texel.xx, texel.yy, vec2<f32>(0.0));
}

/// Texel `corner` 0..3 of the footprint: 0 and 1 in the first row.
fn footprint_texel(at: Footprint, corner: u32) -> vec2<u32> {
    return vec2<u32>(select(at.columns.x, at.columns.y, (corner & 1u) == 1u), select(at.rows.x, at.rows.y, corner > 1u));
}

/// Share 0..1 of texel `corner` in a bilinear mean.
fn footprint_weight(at: Footprint, corner: u32) -> f32 {
    let across = select(1.0 - at.share.x, at.share.x, (corner & 1u) == 1u);
    return across * select(1.0 - at.share.y, at.share.y, corner > 1u);
}

/// Zeros for what is not finite.
fn finite_parts(value: vec4<f32>) -> vec4<f32> {
    return vec4<f32>(
        finite_or(value.x, 0.0), finite_or(value.y, 0.0), finite_or(value.z, 0.0), finite_or(value.w, 0.0)
    );
}

/// The bilinear mean of a layer; of one texel where the footprint has no other.
fn mixed_texel(map: texture_2d_array<f32>, at: Footprint, layer: u32) -> vec4<f32> {
    let first = textureLoad(map, vec2<u32>(at.columns.x, at.rows.x), layer, 0);
    if all(at.share == vec2<f32>(0.0)) {
        return finite_parts(first);
    }
    let second = textureLoad(map, vec2<u32>(at.columns.y, at.rows.x), layer, 0);
    let third = textureLoad(map, vec2<u32>(at.columns.x, at.rows.y), layer, 0);
    let fourth = textureLoad(map, vec2<u32>(at.columns.y, at.rows.y), layer, 0);
    return finite_parts(mix(mix(first, second, at.share.x), mix(third, fourth, at.share.x), at.share.y));
}

// ---- airlight::transmittance::extinction_map ----
// summary: Extinction transmittance maps: extinction along a light ray as a cosine series, transmittance from its integral.
// source: Gautron, Delalandre, Marvie, "Extinction transmittance maps" (SIGGRAPH Asia 2011 sketches), Eq. 1 to 3.

/// Optical depth from the near side to `depth` 0..1, which ringing may make negative. `layers`: of the map, four
/// coefficients each. `monotone`: 1 for the Fejer window, 0 for the plain series.
fn extinction_optical_depth(
    map: texture_2d_array<f32>, place: Footprint, depth: f32, layers: u32, monotone: f32
) -> f32 {
    let inside = clamp(depth, 0.0, 1.0);
    var at = harmonics_first(inside);
    var sum = 0.0;
    for (var group = 0u; group < layers; group++) {
        let window = mix(vec4<f32>(1.0), fejer_window(group, 4u * layers), monotone);
        sum += dot(mixed_texel(map, place, group) * window, cosine_integral(at, inside, group));
        at = harmonics_next(at);
    }
    return sum;
}

/// Transmittance 0..1 of an optical depth; 1 where that is negative.
fn transmittance_of(optical_depth: f32) -> f32 {
    return exp(-max(optical_depth, 0.0));
}

// ---- airlight::transmittance::bounded_map ----
// summary: An extinction map whose series covers only the occupied interval of each texel's light ray.
// source: extends Gautron et al., "Extinction transmittance maps" (2011): the same series, another domain.

/// Shortest interval that is told from a point, over the range of the map.
const LEAST_INTERVAL: f32 = 1e-6;

/// A depth of the map, 0..1, as one of `interval`, its least and greatest occupied depth: 0..1, clamped.
fn depth_in_interval(interval: vec2<f32>, depth: f32) -> f32 {
    return clamp((depth - interval.x) / max(interval.y - interval.x, LEAST_INTERVAL), 0.0, 1.0);
}

/// Transmittance 0..1 from the near side to `depth` 0..1: the mean over the footprint. `intervals`: least and greatest
/// occupied depth of each texel; the other parameters as of `extinction_optical_depth`.
fn bounded_transmittance(
    map: texture_2d_array<f32>, intervals: texture_2d<f32>, place: Footprint, depth: f32, layers: u32, monotone: f32
) -> f32 {
    let alone = all(place.share == vec2<f32>(0.0));
    var sum = 0.0;
    for (var corner = 0u; corner < select(4u, 1u, alone); corner++) {
        let texel = footprint_texel(place, corner);
        let own = depth_in_interval(textureLoad(intervals, texel, 0).xy, depth);
        let single = footprint_alone(textureDimensions(map), texel);
        let optical_depth = extinction_optical_depth(map, single, own, layers, monotone);
        sum += footprint_weight(place, corner) * transmittance_of(optical_depth);
    }
    return clamp(sum, 0.0, 1.0);
}

// ---- airlight::transmittance::transmittance_map ----
// summary: Callback: transmittance from a directional light to a place in its map, by whichever form the pass was built for.
// source: Gautron et al. (2011), Jansen and Bavoil (2010), Delalandre et al. (2011), Muenstermann et al. (2018).

@group(0) @binding(0) var coefficients: texture_2d_array<f32>;
@group(0) @binding(1) var intervals: texture_2d<f32>;

const LAYERS: u32 = u32(4) / 4u;
const WINDOW: f32 = 0.0;

/// Columns and rows of the map.
fn transmittance_map_size() -> vec2<u32> {
    return textureDimensions(coefficients);
}

/// Transmittance of a footprint at `depth`, 0..1.
fn footprint_transmittance(at: Footprint, depth: f32) -> f32 {
    return bounded_transmittance(coefficients, intervals, at, depth, LAYERS, WINDOW);
}

/// Transmittance 0..1 from the light to a place in its map. `place`: texels, texel i at i + 0.5; `depth`: 0 on the near
/// side of the range, 1 on the far side; as light_space gives them.
fn transmittance(place: vec2<f32>, depth: f32) -> f32 {
    let size = transmittance_map_size();
    let inside = all(place >= vec2<f32>(0.0)) && all(place <= vec2<f32>(size)) && depth > 0.0;
    let at = footprint(size, place);
    return select(1.0, footprint_transmittance(at, depth), inside);
}

// ---- transmittance/query ----

@group(0) @binding(2) var<uniform> light: Light;
@group(0) @binding(3) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read_write> transmittances: array<f32>;

@compute @workgroup_size(64)
fn query(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let index = id.x + id.y * groups.x * 64u;
    if index >= min(arrayLength(&points), arrayLength(&transmittances)) {
        return;
    }
    let given = points[index].xyz;
    let known = is_finite(given.x) && is_finite(given.y) && is_finite(given.z);
    let point = select(vec3<f32>(0.0), given, known);
    let at = map_position(light, vec2<f32>(transmittance_map_size()), point);
    transmittances[index] = select(1.0, transmittance(at.xy, at.z), known);
}
