// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: scattering/evaluate, permutation regions (BASES=32 EPIPOLE_MARCH LANCZOS REGIONS=3)
// summary: In-scattered radiance of every pixel from the filtered bases: a dot product, whatever the scene.
// source: thesis 4.3.1 and 4.3.3, Eq. 4.6 and 4.9, Listing 4.4.
// definition BASES: number M of bases, as in the filter; without RANK and MOMENTS.
// definition LANCZOS: window the coefficients against ringing; for M of 8 and more.
// definition EPIPOLE_MARCH: march where a ray covers fewer than 8 texels; blends until 16.
// definition REGIONS: regions that the rows were filtered in, as in the filter; more than one costs more reads a pixel.
// binding camera: the camera, perspective.
// binding light: the directional light and its shadow map's clip space.
// binding medium: the medium.
// binding frame: the frame of the slices.
// binding slices: their bounds, rgba32float, one texel a slice.
// binding depth: depth buffer of the picture, a depth format or r32float; non-finite values count as far.
// binding shadow_map: depth of the standard shadow map; only with EPIPOLE_MARCH, without SHADOW_ARRAY.
// binding bases: filtered bases, M/4 layers, or what the filter makes with COLORS, rgba8unorm or rgba16float.
// binding bases_sampler: linear; clamp to edge in u, repeat in v; absent with NEAREST.
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

const PI: f32 = 3.141592653589793;

/// Part of the depth range at either end that is kept free of view rays.
const GUARD: f32 = 0.05;

/// Depth in the guarded range. `unit`: depth over the bounds of the view rays, where rays lie in
/// 0..1 and blockers may lie outside; the result is clamped to 0..1.
fn guarded(unit: f32) -> f32 {
    return clamp(GUARD + (1.0 - 2.0 * GUARD) * unit, 0.0, 1.0);
}

/// Four bases and the rotation that leads to the next four.
struct Series {
    /// sin, cos of the first frequency, sin, cos of the second.
    basis: vec4<f32>,
    /// sin and cos of 4 pi z, the angle from one group to the next.
    turn: vec2<f32>,
}

/// (sin, cos) of the sum of two angles given by (sin, cos).
fn rotate(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    return vec2<f32>(a.x * b.y + a.y * b.x, a.y * b.y - a.x * b.x);
}

/// The bases of group 0 at depth `z`, 0..1: one sine and cosine instead of two, and of an angle up to
/// pi, which needs no reduction.
fn series_first(z: f32) -> Series {
    let first = vec2<f32>(sin(PI * z), cos(PI * z));
    let double = rotate(first, first);
    return Series(vec4<f32>(first, rotate(first, double)), rotate(double, double));
}

/// The next group, by a rotation instead of new sines. The error grows by about 1e-7 a step.
fn series_next(series: Series) -> Series {
    return Series(
        vec4<f32>(rotate(series.basis.xy, series.turn), rotate(series.basis.zw, series.turn)),
        series.turn
    );
}

/// Coefficients of `group` from the series of the ray's depth (Eq. 4.7), to be multiplied with the
/// filtered bases. Plain truncation: sharpest, overshoots by 9 %.
fn coefficients(ray: Series, group: u32) -> vec4<f32> {
    let scale = coefficient_scale(group);
    return vec4<f32>(ray.basis.y, -ray.basis.x, ray.basis.w, -ray.basis.z) * scale.xxyy;
}

/// Like `coefficients` with the Lanczos window, sinc(n / M): overshoot 1.2 %, an edge about 1.3
/// times as wide. `window`: the series at depth 1 / M, stepped along with `ray`.
fn coefficients_lanczos(ray: Series, window: Series, group: u32, bases: u32) -> vec4<f32> {
    let scale = coefficient_scale(group);
    // sinc(n / M) = sin(pi n / M) M / (pi n); pi n = 2 / scale.
    let sinc = window.basis.xz * scale * (0.5 * f32(bases));
    return vec4<f32>(ray.basis.y, -ray.basis.x, ray.basis.w, -ray.basis.z) * (scale * sinc).xxyy;
}

/// 2 / c of the two frequencies of `group`.
fn coefficient_scale(group: u32) -> vec2<f32> {
    let n = f32(4u * group);
    return (2.0 / PI) / vec2<f32>(n + 1.0, n + 3.0);
}

/// What `stored_from_basis` did, undone.
fn basis_from_stored(stored: vec4<f32>) -> vec4<f32> {
    return 2.0 * stored - 1.0;
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

/// Weight of the first `texels` texels of a row, fractional, in units of the first texel's. `optical_step`: optical
/// depth of one texel; zero gives the number of texels. Relative error below 2e-6.
fn prefix_weight(optical_step: f32, texels: f32) -> f32 {
    // So thin that 1 - exp(-x) is x.
    let thickness = max(optical_step, 1e-30);
    return one_minus_exp(thickness * texels) / one_minus_exp(thickness);
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

/// The region of a row of `width` texels in `regions` regions that holds the `texels`-th texel.
fn region_of(texels: f32, width: u32, regions: u32) -> u32 {
    // A ray that ends at the border of two regions needs nothing of the second.
    let last = u32(max(ceil(texels) - 1.0, 0.0));
    return min(last * regions / width, regions - 1u);
}

/// First texel of a region; of the region after the last, the width.
fn region_begin(region: u32, width: u32, regions: u32) -> u32 {
    return (region * width + regions - 1u) / regions;
}

/// Where the prefix mean over the texels before `texels` is read, in texels: texel i holds the mean over the texels
/// up to and with i, so that half a texel is taken off; at the start of the region that begins at `first` it stays inside.
fn prefix_column(texels: f32, first: f32) -> f32 {
    return max(texels - 0.5, first + 0.5);
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

// ---- airlight::scattering::visibility_fourier ----
// summary: Mean visibility of a view ray from filtered Fourier bases: one read a vector of bases, and a dot product.
// source: thesis 4.3.1 and 4.3.2, Eq. 4.6, 4.7 and 4.9; 4.3.3, Listing 4.4.

/// The series of a ray and of its window, stepped along together.
struct FourierRay {
    /// Of the ray's depth.
    series: Series,
    /// Of the window.
    window: Series,
}

/// The ray at its first four bases.
fn fourier_ray(depth: f32, layers: u32) -> FourierRay {
    return FourierRay(series_first(depth), series_first(1.0 / f32(4u * layers)));
}

/// What the bases of `layer` are multiplied with.
fn fourier_factors(ray: FourierRay, layer: u32, layers: u32, windowed: bool) -> vec4<f32> {
    if windowed {
        return coefficients_lanczos(ray.series, ray.window, layer, 4u * layers);
    }
    return coefficients(ray.series, layer);
}

/// The ray at the next four bases.
fn fourier_next(ray: FourierRay) -> FourierRay {
    return FourierRay(series_next(ray.series), series_next(ray.window));
}

/// Mean visibility by bilinear reads; not clamped: the series overshoots.
fn fourier_visibility(
    bases: texture_2d_array<f32>, bases_sampler: sampler, place: vec2<f32>, depth: f32, layers: u32, windowed: bool
) -> f32 {
    var ray = fourier_ray(depth, layers);
    var visibility = 0.5;
    for (var layer = 0u; layer < layers; layer++) {
        let stored = textureSampleLevel(bases, bases_sampler, place, layer, 0.0);
        visibility += dot(fourier_factors(ray, layer, layers, windowed), basis_from_stored(stored));
        ray = fourier_next(ray);
    }
    return visibility;
}

// ---- airlight::scattering::prefiltered ----
// summary: Callback: mean visibility of a stretch of a row, by whichever method the pass was built for.
// source: thesis 4.3.1 and 4.3.3, Eq. 4.6 and 4.9, Listing 4.4; visibility_rank and visibility_moments for the others.

@group(0) @binding(7) var bases: texture_2d_array<f32>;
@group(0) @binding(8) var bases_sampler: sampler;
const LAYERS: u32 = u32(32) / 4u;
const WINDOWED: bool = true;

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
    return textureDimensions(bases).xy;
}

/// Mean visibility of a stretch at the depth of a ray; not clamped: the series overshoots.
fn prefix_visibility(at: Prefix, depth: f32) -> f32 {
    let column = prefix_column(at.texels, at.first);
    let place = vec2<f32>(column, at.row + 0.5) / vec2<f32>(map_size());
    return fourier_visibility(bases, bases_sampler, place, depth, LAYERS, WINDOWED);
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

const ROW_REGIONS: u32 = u32(3);

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

/// Mean visibility of a ray over its stretch of the row.
fn mean_visibility(ray: RowRay, steps: Steps) -> f32 {
    // Prefix means are weighted by the reference ray; the regions are put together by the ray itself.
    let mean_step = steps.stored;
    let width = map_size().x;
    let first = region_of(ray.begin, width, ROW_REGIONS);
    let last = region_of(ray.end, width, ROW_REGIONS);
    var sum = 0.0;
    var total = 0.0;
    for (var region = first; region <= last; region++) {
        let start = f32(region_begin(region, width, ROW_REGIONS));
        let from_texel = max(ray.begin, start);
        let to_texel = min(ray.end, f32(region_begin(region + 1u, width, ROW_REGIONS)));
        var mean = prefix_visibility(prefix(ray, start, to_texel, steps), ray.depth);
        // In units of the stretch's first texel: finite however deep the stretch lies.
        let weight = exp(-steps.ray * (from_texel - ray.begin)) * prefix_weight(steps.ray, to_texel - from_texel);
        sum += mean * weight;
        total += weight;
    }
    return select(0.0, sum / total, total > 0.0);
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
    let steps = Steps(across / max(ray.sine, 1e-6), across / slice.reference);
    var visibility = mean_visibility(row_ray, steps);
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
