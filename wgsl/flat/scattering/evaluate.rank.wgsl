// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: scattering/evaluate, permutation rank (EPIPOLE_MARCH RANK=12)
// summary: In-scattered radiance of every pixel from the filtered bases: a dot product, whatever the scene.
// source: thesis 4.3.1 and 4.3.3, Eq. 4.6 and 4.9, Listing 4.4.
// definition RANK: exact visibility by rank queries, bits of a depth as in `rank`. Not with REGIONS.
// definition EPIPOLE_MARCH: march where a ray covers fewer than 8 texels; blends until 16.
// binding camera: the camera, perspective.
// binding light: the directional light and its shadow map's clip space.
// binding medium: the medium.
// binding frame: the frame of the slices.
// binding slices: their bounds, rgba32float, one texel a slice.
// binding depth: depth buffer of the picture, a depth format or r32float; non-finite values count as far.
// binding shadow_map: depth of the standard shadow map; only with EPIPOLE_MARCH, without SHADOW_ARRAY.
// binding rank_cells: what `rank` makes, rg32uint, or with COLORS `rank_weights`, rgba32uint; with RANK only, without WAVELET; so the next two.
// binding rank_starts: the same, r32uint.
// binding rank_planes: the same, rgba32uint.
// binding rectified: the rectified map, of which only the size is read; with RANK only.
// binding scattered: out of the compute entry point (the fragment entry point returns it), rgba16float: linear RGB radiance, and in alpha the mean visibility 0..1.

// ---- airlight::core::camera ----
// summary: View rays, distances and frustum planes from a camera's matrices, for any depth convention.
// source: homogeneous unprojection; planes after Gribb and Hartmann, "Fast extraction of viewing frustum planes" (2001).

/// A camera, as an engine hands it over. 160 bytes.
struct Camera {
    /// View-projection matrix, world to clip.
    clip_from_world: mat4x4<f32>,
    /// Its inverse, clip to world.
    world_from_clip: mat4x4<f32>,
    /// Position of the eye in the world, metres; unused by an orthographic camera.
    eye: vec3<f32>,
    /// Clip depth of the near plane: 0 forward, 1 reversed.
    near_depth: f32,
    /// Width and height of the picture in pixels.
    viewport: vec2<f32>,
    /// Clip depth of the far plane: 1 forward, 0 reversed.
    far_depth: f32,
    /// PERSPECTIVE or ORTHOGRAPHIC.
    projection: u32,
}

/// A view ray: world-space origin in metres, unit direction.
struct Ray {
    /// Where it starts in the world, metres.
    origin: vec3<f32>,
    /// Unit vector, away from the eye.
    direction: vec3<f32>,
}

/// Normalised device coordinates of a position in pixels: (0, 0) is the top left corner of the picture.
fn ndc_from_pixel(camera: Camera, pixel: vec2<f32>) -> vec2<f32> {
    return vec2<f32>(2.0, -2.0) * pixel / camera.viewport + vec2<f32>(-1.0, 1.0);
}

/// The view ray through `ndc` of a perspective camera.
fn perspective_ray(camera: Camera, ndc: vec2<f32>) -> Ray {
    let far = camera.world_from_clip * vec4<f32>(ndc, camera.far_depth, 1.0);
    // With w = 0 (infinite far plane) far.xyz is the direction itself.
    return Ray(camera.eye, normalize(far.xyz - camera.eye * far.w));
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

/// Part of the depth range at either end that is kept free of view rays.
const GUARD: f32 = 0.05;

/// Depth in the guarded range. `unit`: depth over the bounds of the view rays, where rays lie in
/// 0..1 and blockers may lie outside; the result is clamped to 0..1.
fn guarded(unit: f32) -> f32 {
    return clamp(GUARD + (1.0 - 2.0 * GUARD) * unit, 0.0, 1.0);
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

// ---- airlight::core::phase ----
// summary: Phase functions, normalised to one over the sphere.
// source: thesis 2.4, Eq. 2.11 (Henyey and Greenstein 1941).

/// 1 / (4 pi), the value of the isotropic phase function, 1/sr.
const ISOTROPIC: f32 = 0.07957747154594767;

/// The Henyey-Greenstein phase function, 1/sr. `cosine`: of the scattering angle, -1..1;
/// `g`: mean cosine, clamped to -0.999..0.999, zero is isotropic.
fn henyey_greenstein(cosine: f32, g: f32) -> f32 {
    let mean = clamp(g, -0.999, 0.999);
    // (1 - g)^2 + 2 g (1 - cos) is 1 + g^2 - 2 g cos without the cancellation near the peak.
    let near = (1.0 - abs(mean)) * (1.0 - abs(mean));
    let turn = 1.0 - clamp(select(-cosine, cosine, mean >= 0.0), -1.0, 1.0);
    let inverse = inverseSqrt(near + 2.0 * abs(mean) * turn);
    return ISOTROPIC * (1.0 - mean * mean) * (inverse * inverse * inverse);
}

// ---- airlight::core::picture ----
// summary: One triangle over the whole picture, for passes in fragment form.
// source: the usual full-screen triangle.

/// Clip-space position of corner `index`, 0..2, of a triangle that covers the picture.
fn picture_corner(index: u32) -> vec4<f32> {
    return vec4<f32>(vec2<f32>(f32(index & 1u), f32(index >> 1u)) * 4.0 - 1.0, 0.0, 1.0);
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

// ---- airlight::scattering::march ----
// summary: Visibility along a view ray step by step: the naive form, as fallback and as baseline.
// source: thesis 4.2.1 and 4.3.1, Eq. 4.4 and 4.8.

/// Most steps of a march by equal steps.
const MOST_MARCH_STEPS: u32 = 65536u;

/// Mean visibility of a view ray over `steps` equal steps through a standard shadow map, weighted by
/// transmittance. `origin`, `direction`: of the ray in the world; `distance`: its length in metres;
/// `extinction` in 1/m, zero for the plain mean; `offset`: 0..1, where in each step the sample lies.
/// Outside the map everything is lit.
fn march_shadow_map(
    map: texture_2d<f32>, light: Light, origin: vec3<f32>, direction: vec3<f32>,
    distance: f32, extinction: f32, steps: u32, offset: f32
) -> f32 {
    let size = vec2<f32>(textureDimensions(map));
    // A directional light's matrix is affine: the ray is a straight line in texels and depth.
    let first = shadow_position(light, size, origin);
    let last = shadow_position(light, size, origin + direction * distance);
    let taken = min(steps, MOST_MARCH_STEPS);
    let stride = (last - first) / f32(max(taken, 1u));
    // Depth must grow away from the light for the comparison.
    let facing = select(-1.0, 1.0, light.far_depth > 0.5);
    let ratio = exp(-extinction * distance / f32(max(taken, 1u)));
    var sum = 0.0;
    var total = 0.0;
    for (var left = taken; left > 0u; left--) {
        let at = first + stride * (f32(left) - 1.0 + offset);
        let inside = all(at.xy >= vec2<f32>(0.0)) && all(at.xy < size);
        let texel = vec2<u32>(clamp(at.xy, vec2<f32>(0.0), size - 1.0));
        let stored = finite_or(textureLoad(map, texel, 0).x, light.far_depth);
        let lit = !inside || stored == light.far_depth || at.z * facing <= stored * facing;
        sum = sum * ratio + select(0.0, 1.0, lit);
        total = total * ratio + 1.0;
    }
    return sum / max(total, 1.0);
}

// ---- airlight::scattering::rectify ----
// summary: Epipolar coordinates around a directional light: rows are slices, columns radii, depth the angle to the light.
// source: thesis 4.4.1, after Baran et al., "A hierarchical volumetric shadow algorithm" (2010); Eq. 4.12.

const PI: f32 = 3.141592653589793;

/// Slices are at least this wide in theta, radians.
const LEAST_WIDTH: f32 = 1e-3;

/// Axes around the light, the range of the slices, and the view rays in these axes. 128 bytes.
struct Frame {
    /// Unit vector TOWARDS the light.
    light: vec3<f32>,
    /// Azimuth of row 0, radians.
    azimuth_min: f32,
    /// Unit vector of azimuth 0.
    axis_a: vec3<f32>,
    /// Rows per radian of azimuth.
    rows_per_radian: f32,
    /// Unit vector of azimuth pi / 2.
    axis_b: vec3<f32>,
    /// Number of rows.
    rows: f32,
    /// Position of the eye, where all slices meet.
    eye: vec3<f32>,
    /// 1 where the rows go round the full circle and wrap, 0 elsewhere.
    wraps: f32,
    /// The view ray through ndc, times (x, y, 1): its part towards the light. Any length, the same for all four.
    ray_light: vec3<f32>,
    reserved_a: f32,
    /// Its part along axis_a.
    ray_a: vec3<f32>,
    reserved_b: f32,
    /// Its part along axis_b.
    ray_b: vec3<f32>,
    reserved_c: f32,
    /// Times (x, y, depth, 1): what its length is divided by for the distance of the surface at that depth.
    ray_scale: vec4<f32>,
}

/// Bounds of one slice.
struct Slice {
    /// Least angle to the light of its view rays, radians.
    angle_min: f32,
    /// Greatest angle to the light of its view rays, radians.
    angle_max: f32,
    /// Radius in metres at the right end of its row.
    radius_max: f32,
    /// k of the reference ray, the bisectrix: sine of its angle to the light.
    reference: f32,
}

/// A view ray in epipolar coordinates.
struct EpipolarRay {
    /// Angle to the light, 0..pi, constant along the ray.
    angle: f32,
    /// Its sine: metres of radius per metre of distance.
    sine: f32,
    /// Its cosine.
    cosine: f32,
    /// Row, fractional; row j is at the value j.
    row: f32,
    /// Length of the ray in metres, up to the surface or the limit.
    distance: f32,
}

/// Greatest sine of an angle to the light between the bounds of a slice, within 2 %.
fn greatest_sine(slice: Slice) -> f32 {
    let off = max(max(slice.angle_min - 0.5 * PI, 0.5 * PI - slice.angle_max), 0.0);
    let square = min(off * off, 0.25 * PI * PI);
    return 1.0 - square * (0.5 - square / 24.0);
}

/// What `slice_texel` did, undone.
fn slice_from_texel(texel: vec4<f32>) -> Slice {
    return Slice(texel.x, texel.y, texel.z, texel.w);
}

/// The view ray through `ndc`, up to the surface with the depth-buffer value `depth` and at most `limit` metres long.
fn epipolar_ray(frame: Frame, ndc: vec2<f32>, depth: f32, limit: f32) -> EpipolarRay {
    let at = vec3<f32>(ndc, 1.0);
    let towards = dot(frame.ray_light, at);
    let a = dot(frame.ray_a, at);
    let b = dot(frame.ray_b, at);
    let radial = sqrt(a * a + b * b);
    let along = sqrt(radial * radial + towards * towards);
    let inverse = 1.0 / max(along, 1e-30);
    // At the light itself the azimuth is free; atan2(0, 0) is not.
    let azimuth = select(atan2(b, a), 0.0, radial < 1e-12 * along);
    let row = (azimuth - frame.azimuth_min) * frame.rows_per_radian;
    // A wrapping row may lie at `rows` itself: the sampler repeats.
    let last = select(frame.rows - 1.0, frame.rows, frame.wraps > 0.0);
    // along / scale, without dividing by a scale that is zero or has rounded below it.
    let scale = dot(frame.ray_scale, vec4<f32>(ndc, depth, 1.0));
    let beyond = along >= limit * scale;
    let distance = select(along / select(scale, 1.0, beyond), limit, beyond);
    return EpipolarRay(
        atan2(radial, towards), radial * inverse, towards * inverse, clamp(row, 0.0, last), distance
    );
}

/// The row nearest to a fractional `row`, always inside the map.
fn nearest_row(frame: Frame, row: f32) -> u32 {
    let rows = u32(frame.rows);
    let nearest = u32(max(row, 0.0) + 0.5);
    // Half a row beyond the last is the first, where rows wrap.
    return select(min(nearest, rows - 1u), 0u, nearest >= rows && frame.wraps > 0.0);
}

/// Depth 0..1 in the rectified map of an angle to the light: view rays of the slice lie in
/// GUARD .. 1 - GUARD, blockers beyond its bounds are clamped into the guard.
fn depth_from_angle(slice: Slice, angle: f32) -> f32 {
    return guarded((angle - slice.angle_min) / max(slice.angle_max - slice.angle_min, 0.1 * LEAST_WIDTH));
}

/// Depth in the rectified map of a view ray: kept out of the guard, into which a ray beside the
/// middle of its slice may fall.
fn depth_from_ray(slice: Slice, ray: EpipolarRay) -> f32 {
    return clamp(depth_from_angle(slice, ray.angle), GUARD, 1.0 - GUARD);
}

// ---- airlight::scattering::rows ----
// summary: Where a view ray lies in a rectified map, and how the means of a row's regions are put together.
// source: thesis 4.3.3 (regions), 4.4.2 (near plane).

/// A view ray in a rectified map.
struct RowRay {
    /// Row, fractional; row j is at the value j.
    row: f32,
    /// Texels before the ray begins, fractional.
    begin: f32,
    /// Texels before the ray ends, fractional.
    end: f32,
    /// Depth of the ray, 0..1.
    depth: f32,
}

// ---- airlight::scattering::scattered_ray ----
// summary: What evaluating a pixel's view ray gives, and the texel that is kept of it.
// source: thesis 4.3.3, Listing 4.4.

/// What stands for infinity, metres.
const FARTHEST: f32 = 1e15;

/// A view ray and the light that the air scatters into it.
struct ScatteredRay {
    /// Linear RGB radiance at the eye, at most 65504.
    radiance: vec3<f32>,
    /// Mean visibility of the light along it, 0..1; where columns have a fall-off, the mean of that times visibility over the
    /// colours.
    visibility: f32,
    /// Where it passes through the picture.
    ndc: vec2<f32>,
    /// Its length in metres up to the surface, from the eye or the near plane of an orthographic camera, at most FARTHEST;
    /// the medium may end before.
    distance: f32,
    /// View direction times the unit vector at its origin towards the light, -1..1.
    cosine: f32,
}

/// What passes write of it: radiance, and in alpha the mean visibility.
fn scattered_texel(ray: ScatteredRay) -> vec4<f32> {
    return vec4<f32>(ray.radiance, ray.visibility);
}

// ---- airlight::scattering::single_scatter ----
// summary: Single scattering of a directional light in a homogeneous medium, given the visibility along a ray.
// source: thesis 4.2.1, Eq. 4.1 and 4.2; 4.3.2, Eq. 4.8 and 4.9; Listing 4.4.

/// A homogeneous medium. 32 bytes.
struct Medium {
    /// Single-scattering albedo, 0..1 for each colour.
    albedo: vec3<f32>,
    /// Extinction coefficient in 1/m, not negative; zero is a clear picture.
    extinction: f32,
    /// Mean cosine of the Henyey-Greenstein phase function, -0.999..0.999.
    g: f32,
    /// Rays end here if they meet nothing nearer, metres, positive.
    distance_limit: f32,
    reserved_a: f32,
    reserved_b: f32,
}

/// Radiance scattered into a view ray. `visibility`: mean over the ray, weighted by transmittance or
/// plain, 0..1; `distance`: length of the ray in metres; `cosine`: view direction times direction
/// towards the light.
fn in_scattered(medium: Medium, light_radiance: vec3<f32>, cosine: f32, distance: f32, visibility: f32) -> vec3<f32> {
    let phase = henyey_greenstein(cosine, medium.g);
    return medium.albedo * light_radiance * (phase * one_minus_exp(medium.extinction * distance) * visibility);
}

// ---- airlight::scattering::lit ----
// summary: Callback: the light that reaches a point, and its mean over a view ray by marching, from a pass' bindings.
// source: thesis 2.4.4, Eq. 2.20; 4.2.1; C. Kulla and M. Fajardo, "Importance sampling techniques for path tracing in participating media" (2012).

@group(0) @binding(6) var shadow_map: texture_2d<f32>;

/// Mean visibility of a view ray of `distance` metres by marching one shadow map; faster than `marched_light`.
fn marched_visibility(
    light: Light, origin: vec3<f32>, direction: vec3<f32>, distance: f32, extinction: f32, steps: u32, offset: f32
) -> f32 {
    return march_shadow_map(shadow_map, light, origin, direction, distance, extinction, steps, offset);
}

// ---- airlight::scattering::visibility_rank ----
// summary: Exact mean visibility of a view ray: how many of the first texels of a row lie behind it, by one rank query.
// source: none; a rank structure over a permutation, cut into words: docs/src/rank.md explains it with a drawing.

/// Least stretch that is asked for, texels: shorter ones see their texel.
const LEAST_TEXELS: f32 = 1e-3;

/// A depth, clamped to 0..1, as a whole number of `bits` bits.
fn rank_value(depth: f32, bits: u32) -> u32 {
    return u32(clamp(depth, 0.0, 1.0) * f32((1u << bits) - 1u) + 0.5);
}

/// The lowest `count` bits, 0..32.
fn low_bits(count: u32) -> u32 {
    return select((1u << (count & 31u)) - 1u, 0xffffffffu, count >= 32u);
}

/// Four bit planes more of the comparison `value < limit` of 32 values at once, from the lowest plane up. `limit`: its
/// four bits lowest.
fn less_by_planes(less: u32, planes: vec4<u32>, limit: u32) -> u32 {
    var result = less;
    result = select(result & ~planes.x, result | ~planes.x, (limit & 1u) != 0u);
    result = select(result & ~planes.y, result | ~planes.y, (limit & 2u) != 0u);
    result = select(result & ~planes.z, result | ~planes.z, (limit & 4u) != 0u);
    return select(result & ~planes.w, result | ~planes.w, (limit & 8u) != 0u);
}

/// Where a query lies in the structure.
struct RankPlace {
    /// Texels that the ray covers, at least LEAST_TEXELS.
    covered: f32,
    /// Of the last of these, in which the ray ends.
    column: u32,
    /// What of it is covered, 0..1.
    part: f32,
    /// The cell: chunk times the number of blocks plus block.
    cell: u32,
    /// Ranks of the chunk that are below the ray, 0..32.
    ranks: u32,
    /// The columns of the block with a value below that of the ray, a bit each.
    less: u32,
}

/// The place of a query. `starts`: how many texels of a row have a smaller value, two values of 16 bits a texel;
/// `planes`: bit planes, four a layer, one texel a block; `columns` of the map; `texels`: fractional.
fn rank_place(
    starts: texture_2d<u32>, planes: texture_2d_array<u32>, bits: u32, columns: u32, row: u32, texels: f32, depth: f32
) -> RankPlace {
    let covered = clamp(texels, LEAST_TEXELS, f32(columns));
    let column = min(u32(covered), columns - 1u);
    let block = column / 32u;
    let value = rank_value(depth, bits);
    let pair = textureLoad(starts, vec2<u32>(value / 2u, row), 0).x;
    let start = (pair >> (16u * (value & 1u))) & 0xffffu;
    let blocks = (columns + 31u) / 32u;
    let chunk = min(start / 32u, blocks - 1u);
    var less = 0u;
    for (var layer = 0u; layer < (bits + 3u) / 4u; layer++) {
        less = less_by_planes(less, textureLoad(planes, vec2<u32>(block, row), layer, 0), value >> (4u * layer));
    }
    return RankPlace(
        covered, column, covered - f32(column), chunk * blocks + block, start - 32u * chunk, less
    );
}

/// Like `rank_visibility`, weighted by transmittance. Optical depths of one texel, `optical_step`: of the ray;
/// `least_step`: that by which the structure was built, and twice of which.
fn rank_visibility_weighted(
    cells: texture_2d<u32>, starts: texture_2d<u32>, planes: texture_2d_array<u32>, bits: u32, columns: u32,
    row: u32, texels: f32, depth: f32, optical_step: f32, least_step: f32
) -> f32 {
    let at = rank_place(starts, planes, bits, columns, row, texels, depth);
    let blocks = (columns + 31u) / 32u;
    let cell = textureLoad(cells, vec2<u32>(at.cell, row), 0).xy;
    let block_begin = f32(at.column & ~31u);
    // Where the ray lies between the two steps; beyond both where it is thin or oblique, but there rows are short.
    let least = max(least_step, 1e-30);
    let between = min((optical_step - least) / least, 64.0);
    let stored = unpack2x16unorm(cell.y);
    let base = mix(stored.x, stored.y, between);
    // Where the next chunk begins, all ranks of this one are counted; after the last chunk all ranks are.
    let next = at.cell + blocks;
    let after = unpack2x16unorm(textureLoad(cells, vec2<u32>(min(next, blocks * blocks - 1u), row), 0).y);
    let chunk = max(select(1.0, mix(after.x, after.y, between), next < blocks * blocks) - base, 0.0);
    let meant = f32(countOneBits(cell.x & low_bits(at.ranks)));
    let share = base + chunk * meant / max(f32(countOneBits(cell.x)), 1.0);
    // Weights are in units of the integral of transmittance over 1 / extinction, so that none is divided.
    let thickness = max(optical_step, 1e-30);
    let texel = one_minus_exp(thickness);
    let left = one_minus_exp(thickness * block_begin);
    let whole = one_minus_exp(thickness * f32(at.column));
    let covered = one_minus_exp(thickness * at.covered);
    // Eight columns at a time share a weight.
    let inside = at.column & 31u;
    let dark = at.less & low_bits(inside);
    let through = 1.0 - texel;
    let square = through * through;
    let eighth = square * square * square * square;
    var columns_dark = f32(countOneBits(dark >> 24u));
    columns_dark = columns_dark * eighth + f32(countOneBits(dark & 0xff0000u));
    columns_dark = columns_dark * eighth + f32(countOneBits(dark & 0xff00u));
    columns_dark = columns_dark * eighth + f32(countOneBits(dark & 0xffu));
    let block = (1.0 - left) * texel * columns_dark * square * through * sqrt(through);
    let last = select(0.0, max(covered - whole, 0.0), ((at.less >> inside) & 1u) != 0u);
    return clamp(1.0 - (clamp(share, 0.0, 1.0) * left + block + last) / covered, 0.0, 1.0);
}

// ---- airlight::scattering::prefiltered ----
// summary: Callback: mean visibility of a stretch of a row, by whichever method the pass was built for.
// source: thesis 4.3.1 and 4.3.3, Eq. 4.6 and 4.9, Listing 4.4; visibility_rank and visibility_moments for the others.

@group(0) @binding(7) var rank_cells: texture_2d<u32>;
@group(0) @binding(8) var rank_starts: texture_2d<u32>;
@group(0) @binding(13) var rank_planes: texture_2d_array<u32>;
@group(0) @binding(14) var rectified: texture_2d<f32>;
const RANK_BITS: u32 = u32(12);

/// The stretch of a row from the texel at which a region begins.
struct Prefix {
    /// Row, fractional; row j is at the value j.
    row: f32,
    /// 1 where the row after the last is the first, else 0.
    wraps: f32,
    /// First texel of the region.
    first: f32,
    /// Where the stretch ends, texels from the start of the row, fractional.
    texels: f32,
    /// Optical depth of a texel of the ray; 0 for plain means.
    optical_step: f32,
    /// By which what was stored is weighted: that of the reference ray, with RANK the least of the row.
    stored_step: f32,
}

/// Columns and rows of the rectified map.
fn map_size() -> vec2<u32> {
    return textureDimensions(rectified);
}

/// What the stretch in a whole `row` gives, 0..1: the mean visibility, or with COLORS that times fall-off, for each colour.
fn row_means(at: Prefix, row: u32, depth: f32) -> vec3<f32> {
    let columns = map_size().x;
    return vec3<f32>(rank_visibility_weighted(
        rank_cells, rank_starts, rank_planes, RANK_BITS, columns, row, at.texels, depth, at.optical_step,
        at.stored_step
    ));
}

/// The means of the nearest row, or of the two about the stretch.
fn mixed_means(at: Prefix, depth: f32) -> vec3<f32> {
    let rows = map_size().y;
    let whole = min(u32(max(at.row, 0.0)), rows - 1u);
    let next = select(min(whole + 1u, rows - 1u), 0u, whole + 1u >= rows && at.wraps > 0.0);
    let share = clamp(at.row - f32(whole), 0.0, 1.0);
    return mix(row_means(at, whole, depth), row_means(at, next, depth), share);
}

/// Mean visibility of a stretch at the depth of a ray, 0..1.
fn prefix_visibility(at: Prefix, depth: f32) -> f32 {
    return mixed_means(at, depth).x;
}

// ---- airlight::scattering::evaluated ----
// summary: Callback: what the air scatters into a pixel's view ray, from filtered bases, moments or rank queries over epipolar rows.
// source: thesis 4.3.1 and 4.3.3, Eq. 4.6 and 4.9, Listing 4.4.

@group(0) @binding(0) var<uniform> camera: Camera;
@group(0) @binding(1) var<uniform> light: Light;
@group(0) @binding(2) var<uniform> medium: Medium;
@group(0) @binding(3) var<uniform> frame: Frame;
@group(0) @binding(4) var slices: texture_2d<f32>;
@group(0) @binding(5) var depth: texture_2d<f32>;

/// Rays that cover fewer texels are marched.
const EPIPOLE_TEXELS: f32 = 8.0;
/// Steps of that march.
const EPIPOLE_STEPS: u32 = 96u;

/// Optical depths of a texel.
struct Steps {
    /// Of the ray itself.
    ray: f32,
    /// By which what was stored is weighted.
    stored: f32,
}

/// The stretch of a ray up to `texels` in the region of its row that begins at texel `first`.
fn prefix(ray: RowRay, first: f32, texels: f32, steps: Steps) -> Prefix {
    return Prefix(ray.row, frame.wraps, first, texels, steps.ray, steps.stored);
}

/// What is scattered into the view ray of `pixel`.
fn scattered_ray(pixel: vec2<u32>) -> ScatteredRay {
    let ndc = ndc_from_pixel(camera, vec2<f32>(pixel) + 0.5);
    let surface = clamp(finite_or(textureLoad(depth, pixel, 0).x, camera.far_depth), 0.0, 1.0);
    let ray = epipolar_ray(frame, ndc, surface, medium.distance_limit);
    // The bounds of the nearest slice: those of the next one differ by far less than the series resolves.
    let slice = slice_from_texel(textureLoad(slices, vec2<u32>(nearest_row(frame, ray.row), 0u), 0));
    let width = f32(map_size().x);
    let texels = clamp(width * ray.distance * ray.sine / slice.radius_max, 0.0, width);
    var row_ray = RowRay(ray.row, 0.0, texels, depth_from_ray(slice, ray));
    let near = 0.0;
    let extinction = medium.extinction;
    // Optical depth of a texel of a ray at right angles to the light.
    let across = extinction * slice.radius_max / width;
    let steps = Steps(across / max(ray.sine, 1e-6), across / greatest_sine(slice));
    var visibility = prefix_visibility(prefix(row_ray, 0.0, texels, steps), row_ray.depth);
    visibility = clamp(visibility, 0.0, 1.0);

    let near_epipole = 1.0 - smoothstep(EPIPOLE_TEXELS, 2.0 * EPIPOLE_TEXELS, texels);
    let samples = select(0u, EPIPOLE_STEPS, near_epipole > 0.0);
    let direction = perspective_ray(camera, ndc).direction;
    let marched = vec3<f32>(marched_visibility(
        light, camera.eye + near * direction, direction, ray.distance - near, extinction, samples, 0.5
    ));
    visibility = mix(visibility, marched.x, near_epipole);

    let radiance = in_scattered(medium, light.radiance, ray.cosine, ray.distance - near, visibility);
    let mean = visibility;
    let distance = epipolar_ray(frame, ndc, surface, FARTHEST).distance;
    return ScatteredRay(min(radiance, vec3<f32>(65504.0)), mean, ndc, distance, ray.cosine);
}

// ---- scattering/evaluate ----

@group(0) @binding(9) var scattered: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(16, 8)
fn evaluate(@builtin(global_invocation_id) id: vec3<u32>) {
    if all(id.xy < textureDimensions(scattered)) {
        textureStore(scattered, id.xy, scattered_texel(scattered_ray(id.xy)));
    }
}

@vertex
fn vertex_picture(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return picture_corner(index);
}

@fragment
fn fragment_evaluate(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return scattered_texel(scattered_ray(vec2<u32>(position.xy)));
}
