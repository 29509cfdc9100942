// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: transmittance/query, permutation power (COEFFICIENTS=8 POWER)
// summary: Transmittance from the light to each of a list of points in the world, by any form of map.
// source: Gautron et al., "Extinction transmittance maps" (2011), Eq. 3.
// note: What a renderer does for each particle or sample; here for curves along a light ray, and for tests.
// note: Points that are not finite have transmittance 1.
// definition COEFFICIENTS: numbers a texel, four a layer: 4, 8 or 16, of the moments 8; 4 where it is not given.
// definition POWER: six power moments.
// binding coefficients: the layers of the map, rgba32float or rgba16float.
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

// ---- airlight::core::moment_bounds ----
// summary: Six moments of a distribution on -1..1, and the bounds that they give of its share beyond a place.
// source: Algorithm 1 of Peters et al., "Improved moment shadow maps for translucent occluders, soft shadows and single scattering" (2017).

/// Share of the density 1 / (pi sqrt(1 - z^2)) that is mixed in.
const MOMENT_BIAS: f32 = 1e-5;
/// Values below this break the factorisation off; the bias keeps those of real moments above it.
const LEAST_PIVOT: f32 = 0.1 * MOMENT_BIAS;
/// Roots farther away than this carry less than 1e-5.
const FARTHEST_ROOT: f32 = 8.0;

/// Means of the Chebyshev polynomials T_1 to T_6.
struct Moments {
    /// Of degree 1, 2 and 3, -1..1.
    low: vec3<f32>,
    /// Of degree 4, 5 and 6, -1..1.
    high: vec3<f32>,
}

/// G = L D L' and the first row of G.
struct Factors {
    /// Means of T_1, T_2, T_3, which is the first column of L.
    mean: vec3<f32>,
    /// The other entries of L: of rows 2 and 3 at column 1, and of row 3 at column 2.
    lower: vec3<f32>,
    /// 1 / D_1, 1 / D_2, 1 / D_3; D_0 is 1. Zero from where the factorisation breaks off.
    inverse: vec3<f32>,
}

/// T_1, T_2, T_3 at `z`.
fn chebyshev(z: f32) -> vec3<f32> {
    return vec3<f32>(z, 2.0 * z * z - 1.0, z * (4.0 * z * z - 3.0));
}

/// Factors of the matrix G of biased moments.
fn moment_factors(moments: Moments) -> Factors {
    let keep = 1.0 - MOMENT_BIAS;
    let low = keep * clamp(moments.low, vec3<f32>(-1.0), vec3<f32>(1.0));
    let high = keep * clamp(moments.high, vec3<f32>(-1.0), vec3<f32>(1.0));
    // Entries of G, less what the first column takes: rows and columns 1 to 3.
    let diagonal = 0.5 + 0.5 * vec3<f32>(low.y, high.x, high.z) - low * low;
    let side = 0.5 * vec3<f32>(low.x + low.z, low.y + high.x, low.x + high.y) - low.xxy * low.yzz;
    let inverse_a = select(0.0, 1.0 / max(diagonal.x, LEAST_PIVOT), diagonal.x > LEAST_PIVOT);
    let row_b = side.x * inverse_a;
    let row_c = side.y * inverse_a;
    let pivot_b = diagonal.y - row_b * side.x;
    let inverse_b = select(0.0, 1.0 / max(pivot_b, LEAST_PIVOT), pivot_b > LEAST_PIVOT && inverse_a > 0.0);
    let rest = side.z - row_b * side.y;
    let row_d = rest * inverse_b;
    let pivot_c = diagonal.z - row_c * side.y - row_d * rest;
    let inverse_c = select(0.0, 1.0 / max(pivot_c, LEAST_PIVOT), pivot_c > LEAST_PIVOT && inverse_b > 0.0);
    return Factors(low, vec3<f32>(row_b, row_c, row_d), vec3<f32>(inverse_a, inverse_b, inverse_c));
}

/// The orthogonal polynomials of degree 1, 2 and 3 at `z`; that of degree 0 is 1.
fn orthogonal_polynomials(factors: Factors, z: f32) -> vec3<f32> {
    let centred = chebyshev(z) - factors.mean;
    let second = centred.y - factors.lower.x * centred.x;
    let third = centred.z - factors.lower.y * centred.x - factors.lower.z * second;
    return vec3<f32>(centred.x, second, third);
}

/// The most that can lie where the orthogonal polynomials have these values: 1 / K, 0..1.
fn greatest_weight(factors: Factors, polynomials: vec3<f32>) -> f32 {
    return 1.0 / (1.0 + dot(polynomials * polynomials, factors.inverse));
}

/// cos(acos(x) / 3) for x from -1 to 1, and at most 3e-6 more: a polynomial in cos(acos(x) / 2).
fn cosine_of_third(x: f32) -> f32 {
    let half = sqrt(0.5 * x + 0.5);
    let last = 0.04763451 + half * (half * 0.00412080 - 0.01912183);
    return 0.5000028 + half * (0.57725041 + half * (half * last - 0.10988446));
}

/// One step of Newton's method from `root` towards a root of t^3 + a t^2 + b t + c, `coefficients` a, b, c.
fn newton_step(coefficients: vec3<f32>, root: f32) -> f32 {
    let slope = (3.0 * root + 2.0 * coefficients.x) * root + coefficients.y;
    let value = ((root + coefficients.x) * root + coefficients.y) * root + coefficients.z;
    return root - select(0.0, value / max(slope, 1e-30), slope > 1e-30);
}

/// The greatest root of t^3 + a t^2 + b t + c, `coefficients` a, b, c, of which all roots are real.
fn greatest_cubic_root(coefficients: vec3<f32>) -> f32 {
    let a = coefficients.x;
    let b = coefficients.y;
    let c = coefficients.z;
    // Roots -a/3 + 2 sqrt(p) cos: those of the cubic moved to have no square.
    let p = max(a * a - 3.0 * b, 0.0) / 9.0;
    let half_width = sqrt(p);
    let r = (a * (2.0 * a * a - 9.0 * b) + 27.0 * c) / 54.0;
    let cosine = cosine_of_third(clamp(-r / max(p * half_width, 1e-30), -1.0, 1.0));
    // From above, Newton's steps come nearer without passing it. They recover a root that is small next to the others.
    return newton_step(coefficients, newton_step(coefficients, 2.0 * half_width * cosine - a / 3.0));
}

/// Least and greatest share, 0..1, at or beyond `z`, -1..1, that are possible with these moments. Their difference is the
/// most that can lie at `z` itself.
fn share_bounds(moments: Moments, z: f32) -> vec2<f32> {
    let factors = moment_factors(moments);
    let at_ray = orthogonal_polynomials(factors, z);
    let own = greatest_weight(factors, at_ray);
    let changes = select(vec3<u32>(0u), vec3<u32>(1u), at_ray * vec3<f32>(1.0, at_ray.xy) < vec3<f32>(0.0));
    let above = changes.x + changes.y + changes.z;
    // G^-1 T(z): K(x, z) as a sum of T_0..T_3 at x, then its derivatives at x = z over K(z, z).
    let scaled = at_ray * factors.inverse;
    let third = scaled.z;
    let second = scaled.y - factors.lower.z * third;
    let first = scaled.x - factors.lower.x * second - factors.lower.y * third;
    let slope = first - 3.0 * third + z * (4.0 * second + 12.0 * z * third);
    let cubic = own * vec3<f32>(slope, 2.0 * second + 12.0 * z * third, 4.0 * third);
    // The root that lies alone on its side is the greatest in t, or the least, which is the greatest of the mirrored cubic.
    // Where all lie on the other side that root is negative, and no weight is alone.
    let side = select(-1.0, 1.0, above < 2u);
    let root = greatest_cubic_root(cubic * vec3<f32>(side, 1.0, side));
    let nearest = z + side / max(root, 1.0 / FARTHEST_ROOT);
    let weight = min(greatest_weight(factors, orthogonal_polynomials(factors, nearest)), 1.0 - own);
    let alone = select(0.0, weight, root > 1.0 / FARTHEST_ROOT);
    let upper = select(1.0 - alone, own + alone, above < 2u);
    return vec2<f32>(max(upper - own, 0.0), min(upper, 1.0));
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
/// Least optical depth that has a distribution.
const LEAST_DEPTH: f32 = 1e-20;

/// Transmittance 0..1 from the near side to `depth` 0..1. `first`, `second`: the layers.
fn power_transmittance(first: vec4<f32>, second: vec4<f32>, depth: f32) -> f32 {
    let total = max(first.x, 0.0);
    let scale = 1.0 / max(total, LEAST_DEPTH);
    let moments = Moments(first.yzw * scale, second.xyz * scale);
    let beyond = share_bounds(moments, clamp(2.0 * depth - 1.0, -1.0, 1.0));
    let before = 1.0 - beyond.y + OVERESTIMATION * (beyond.y - beyond.x);
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
    return power_transmittance(mixed_texel(coefficients, at, 0u), mixed_texel(coefficients, at, 1u), depth);
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
