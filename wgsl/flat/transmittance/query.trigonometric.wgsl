// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: transmittance/query, permutation trigonometric (COEFFICIENTS=8 TRIGONOMETRIC)
// summary: Transmittance from the light to each of a list of points in the world, by any form of map.
// source: Gautron et al., "Extinction transmittance maps" (2011), Eq. 3.
// note: What a renderer does for each particle or sample; here for curves along a light ray, and for tests.
// note: Points that are not finite have transmittance 1.
// definition COEFFICIENTS: numbers a texel, four a layer: 4, 8 or 16, of the moments 8; 4 where it is not given.
// definition TRIGONOMETRIC: two trigonometric moments.
// binding coefficients: the layers of the map, rgba32float or rgba16float.
// binding light: the directional light of the map.
// binding points: points in the world, metres; the fourth number is not used.
// binding transmittances: out, 0..1, one a point.

// ---- airlight::core::arc_cosine ----
// summary: The angle whose cosine is given, as exact as its cosine.
// source: acos(x) = atan2(sqrt(1 - x^2), x), by which the WGSL specification bounds the error of acos.

/// Radians 0..pi; a cosine outside -1..1 counts as the nearer end.
fn arc_cosine(cosine: f32) -> f32 {
    let held = clamp(cosine, -1.0, 1.0);
    return atan2(sqrt((1.0 - held) * (1.0 + held)), held);
}

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

// ---- airlight::transmittance::transmittance_moments ----
// summary: Transmittance from moments of optical depth along a light ray: six of powers, or two complex trigonometric ones.
// source: Muenstermann, Krumpen, Klein, Peters, "Moment-based order-independent transparency" (PACMCGIT 1(1), 2018).

/// Part of the optical depth right at a depth that counts as before it.
const OVERESTIMATION: f32 = 0.25;
/// Arc of the circle that no depth maps to, radians.
const GAP: f32 = 0.3141592653589793;
/// Part of an even density over the circle that is mixed in.
const TRIGONOMETRIC_BIAS: f32 = 1e-5;
/// Least optical depth that has a distribution.
const LEAST_DEPTH: f32 = 1e-20;

/// The product of complex numbers.
fn complex_product(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    return vec2<f32>(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x);
}

/// The conjugate of `a`.
fn conjugate(a: vec2<f32>) -> vec2<f32> {
    return vec2<f32>(a.x, -a.y);
}

/// C = L D L* of trigonometric moments.
struct CircleFactors {
    /// Entries of L in the first column: the moments.
    once: vec2<f32>,
    /// Of row 2.
    twice: vec2<f32>,
    /// The entry of row 2 at column 1.
    lower: vec2<f32>,
    /// D_1 and D_2; D_0 is 1.
    pivots: vec2<f32>,
}

/// Factors of the matrix of biased moments, complex numbers with an absolute value up to 1.
fn circle_factors(once: vec2<f32>, twice: vec2<f32>) -> CircleFactors {
    let keep = 1.0 - TRIGONOMETRIC_BIAS;
    let a = keep * once / max(1.0, length(once));
    let b = keep * twice / max(1.0, length(twice));
    let first = max(1.0 - dot(a, a), TRIGONOMETRIC_BIAS);
    let lower = (a - complex_product(b, conjugate(a))) / first;
    let second = max(1.0 - dot(b, b) - dot(lower, lower) * first, 0.1 * TRIGONOMETRIC_BIAS);
    return CircleFactors(a, b, lower, vec2<f32>(first, second));
}

/// L^-1 e at the angle of which `unit` is (cosine, sine); the first entry is 1. Two complex numbers.
fn circle_polynomials(factors: CircleFactors, unit: vec2<f32>) -> vec4<f32> {
    let first = unit - factors.once;
    let second = complex_product(unit, unit) - factors.twice - complex_product(factors.lower, first);
    return vec4<f32>(first, second);
}

/// The most that can lie where `polynomials` are: 1 / K, 0..1.
fn circle_weight(factors: CircleFactors, polynomials: vec4<f32>) -> f32 {
    let first = dot(polynomials.xy, polynomials.xy) / factors.pivots.x;
    return 1.0 / (1.0 + first + dot(polynomials.zw, polynomials.zw) / factors.pivots.y);
}

/// How much of what lies at the angle `node` is before `phase`, 0..2 pi - GAP: 0..1.
fn before_phase(node: f32, phase: f32) -> f32 {
    let around = node - 2.0 * PI * floor(node / (2.0 * PI));
    let last = 2.0 * PI - GAP;
    return select(select(0.0, 1.0, around < phase), clamp((around - last) / GAP, 0.0, 1.0), around > last);
}

/// Transmittance 0..1 from the near side to `depth` 0..1. `first`, `second`: the layers.
fn trigonometric_transmittance(first: vec4<f32>, second: vec4<f32>, depth: f32) -> f32 {
    let total = max(first.x, 0.0);
    let scale = 1.0 / max(total, LEAST_DEPTH);
    let factors = circle_factors(first.yz * scale, vec2<f32>(first.w, second.x) * scale);
    let phase = (2.0 * PI - GAP) * clamp(depth, 0.0, 1.0);
    let here = circle_polynomials(factors, vec2<f32>(cos(phase), sin(phase)));
    let own = circle_weight(factors, here);
    // q = C^-1 e times D_2, of which the greatest entry may else overflow; K has the entries of q as coefficients.
    let last = here.zw;
    let ratio = factors.pivots.y / factors.pivots.x;
    let middle = here.xy * ratio - complex_product(conjugate(factors.lower), last);
    let start = vec2<f32>(factors.pivots.y, 0.0) - complex_product(conjugate(factors.once), middle)
        - complex_product(conjugate(factors.twice), last);
    // Roots of start w^2 + middle w + last, both on the circle: w = exp(i (turn / 2 +- arc)).
    let product = complex_product(last, conjugate(start));
    let turn = atan2(product.y, product.x);
    let across = complex_product(middle, conjugate(start));
    let real = dot(across, vec2<f32>(cos(0.5 * turn), sin(0.5 * turn)));
    let arc = arc_cosine(-0.5 * real / max(dot(start, start), 1e-30));
    var before = OVERESTIMATION * own;
    var left = 1.0 - own;
    for (var root = 0u; root < 2u; root++) {
        let node = 0.5 * turn + select(arc, -arc, root == 1u);
        let weight = min(circle_weight(factors, circle_polynomials(factors, vec2<f32>(cos(node), sin(node)))), left);
        before += weight * before_phase(node, phase);
        left -= weight;
    }
    return exp(-total * clamp(before, 0.0, 1.0));
}

// ---- airlight::transmittance::transmittance_map ----
// summary: Callback: transmittance from a directional light to a place in its map, by whichever form the pass was built for.
// source: Gautron et al. (2011), Jansen and Bavoil (2010), Delalandre et al. (2011), Muenstermann et al. (2018).

@group(0) @binding(0) var coefficients: texture_2d_array<f32>;

/// Columns and rows of the map.
fn transmittance_map_size() -> vec2<u32> {
    return textureDimensions(coefficients);
}

/// Transmittance of a footprint at `depth`, 0..1.
fn footprint_transmittance(at: Footprint, depth: f32) -> f32 {
    return trigonometric_transmittance(mixed_texel(coefficients, at, 0u), mixed_texel(coefficients, at, 1u), depth);
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
