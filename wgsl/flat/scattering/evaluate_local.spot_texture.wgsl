// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: scattering/evaluate_local, permutation spot_texture (BASES=32 COLORS=3 EPIPOLE_MARCH LANCZOS LIGHT_TEXTURE)
// summary: In-scattered radiance of every pixel around a spot or point light, from filtered bases, moments or rank queries.
// source: thesis 4.3.1 to 4.3.3, Eq. 4.6 and 4.9; V. Pegoraro and S. Parker, "An analytical solution to single scattering in homogeneous participating media" (2009).
// definition BASES: number M of bases, as in the filter; without RANK and MOMENTS.
// definition COLORS: 1 for the fall-off of a spot, 3 with LIGHT_TEXTURE, as in the filter.
// definition LIGHT_TEXTURE: a texture colours the light; with COLORS=3.
// definition LANCZOS: window the coefficients against ringing; for M of 8 and more.
// definition EPIPOLE_MARCH: march where a ray covers fewer than 8 texels; blends until 16.
// binding camera: the camera, perspective.
// binding light: the spot or point light and its shadow map's clip space.
// binding medium: the medium.
// binding frame: the frame of the slices.
// binding slices: their bounds, rgba32float, one texel a slice.
// binding depth: depth buffer of the picture, a depth format or r32float; non-finite values count as far.
// binding shadow_map: depth of the standard shadow map; only with EPIPOLE_MARCH, without SHADOW_ARRAY.
// binding light_texture: linear RGB 0..1 over the whole shadow map; only with EPIPOLE_MARCH and LIGHT_TEXTURE.
// binding light_sampler: linear, clamped to the edge; only with EPIPOLE_MARCH and LIGHT_TEXTURE.
// binding bases: filtered bases, M/4 layers, or what the filter makes with COLORS, rgba8unorm or rgba16float; without RANK and MOMENTS.
// binding bases_sampler: linear; clamp to edge in u, repeat in v; absent with NEAREST, RANK and MOMENTS.
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

/// Like `finite_or`, each component by itself.
fn finite_or_rgb(x: vec3<f32>, fallback: f32) -> vec3<f32> {
    return vec3<f32>(finite_or(x.x, fallback), finite_or(x.y, fallback), finite_or(x.z, fallback));
}

// ---- airlight::core::fourier_basis ----
// summary: Visibility as a Fourier series of the depth difference, four bases at a time.
// source: thesis 4.3.1, Eq. 4.7, after Annen et al., "Convolution shadow maps" (2007).

const fourier_basis_PI: f32 = 3.141592653589793;

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
    let first = vec2<f32>(sin(fourier_basis_PI * z), cos(fourier_basis_PI * z));
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
    return (2.0 / fourier_basis_PI) / vec2<f32>(n + 1.0, n + 3.0);
}

/// What `stored_from_basis` did, undone.
fn basis_from_stored(stored: vec4<f32>) -> vec4<f32> {
    return 2.0 * stored - 1.0;
}

// ---- airlight::core::light ----
// summary: A light, its fall-off and texture, and the clip space of its standard shadow map.
// source: thesis 4.2.1; a point source seen through a cone and softened by its radius.

/// A light at infinity: all light rays are parallel.
const DIRECTIONAL: u32 = 0u;
/// A light at a point that shines into a cone.
const SPOT: u32 = 1u;

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

/// Unit vector from `point`, metres in the world, TOWARDS the light; zero where a light at a point is right there.
fn direction_to_light(light: Light, point: vec3<f32>) -> vec3<f32> {
    let between = light.position - point;
    let local = between * inverseSqrt(max(dot(between, between), 1e-30));
    return select(local, light.direction, light.kind == DIRECTIONAL);
}

/// Angular fall-off, 0..1, along the light ray with the unit vector `towards` TOWARDS the light: of a spot 1 inside
/// the inner cone, 0 outside the outer one, smooth between; of every other light 1.
fn angular_falloff(light: Light, towards: vec3<f32>) -> f32 {
    // Not smoothstep: WGSL leaves it open what that is between two equal edges.
    let above = dot(towards, light.direction) - light.spot_cosines.y;
    let unit = clamp(above / max(light.spot_cosines.x - light.spot_cosines.y, 1e-6), 0.0, 1.0);
    return select(1.0, unit * unit * (3.0 - 2.0 * unit), light.kind == SPOT);
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

/// What a light texture (gobo) lets through, linear RGB 0..1, towards `point`, metres in the world. `map`: any float
/// format that filters, stretched over the whole shadow map; `map_sampler`: linear, clamped to the edge. Outside it a
/// directional light goes by unhindered and a spot is dark. Non-finite texels are dark.
fn light_texture_color(
    light: Light, map: texture_2d<f32>, map_sampler: sampler, point: vec3<f32>
) -> vec3<f32> {
    let uv = shadow_position(light, vec2<f32>(1.0), point).xy;
    let inside = all(uv >= vec2<f32>(0.0)) && all(uv <= vec2<f32>(1.0));
    let outside = select(0.0, 1.0, light.kind == DIRECTIONAL);
    let color = finite_or_rgb(textureSampleLevel(map, map_sampler, uv, 0.0).rgb, 0.0);
    return select(vec3<f32>(outside), clamp(color, vec3<f32>(0.0), vec3<f32>(1.0)), inside);
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

// ---- airlight::scattering::march ----
// summary: Visibility along a view ray step by step: the naive form, as fallback and as baseline.
// source: thesis 4.2.1 and 4.3.1, Eq. 4.4 and 4.8.

/// Most steps of a march by equal steps.
const MOST_MARCH_STEPS: u32 = 65536u;

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

// ---- airlight::scattering::shadow_lookup ----
// summary: Blocker and visibility of a single light ray, in one shadow map or in an array of views, of any light.
// source: L. Williams, "Casting curved shadows on curved surfaces" (1978).

/// A texel of a shadow map, on the way from a point in the world.
struct Shadow {
    /// Depth of the point itself.
    depth: f32,
    /// Depth of the blocker, 0..1; that of an empty texel where there is none.
    stored: f32,
    /// 1 where there is a blocker on this light ray, nearer to the light or not, else 0.
    blocked: u32,
}

/// The shadow map's texel on the light ray through `point`, metres in the world. `map`: a depth format or r32float.
fn shadow_in_map(map: texture_2d<f32>, light: Light, point: vec3<f32>) -> Shadow {
    let size = vec2<f32>(textureDimensions(map));
    let at = shadow_position(light, size, point);
    let inside = all(at.xy >= vec2<f32>(0.0)) && all(at.xy < size);
    let texel = vec2<u32>(clamp(at.xy, vec2<f32>(0.0), size - 1.0));
    let stored = clamp(finite_or(textureLoad(map, texel, 0).x, light.far_depth), 0.0, 1.0);
    return Shadow(at.z, stored, select(0u, 1u, inside && stored != light.far_depth));
}

/// 1 where the point is lit, else 0. `far_depth`: of an empty texel, 1 forward, 0 reversed.
fn lit_by_shadow(shadow: Shadow, far_depth: f32) -> f32 {
    // Depth must grow away from the light for the comparison.
    let facing = select(-1.0, 1.0, far_depth > 0.5);
    return select(0.0, 1.0, shadow.blocked == 0u || shadow.depth * facing <= shadow.stored * facing);
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

// ---- airlight::scattering::local_light ----
// summary: Epipolar rows around a light at a point, spot or point light, and the light that air scatters along a view ray.
// source: thesis 4.3.2 ("other light sources") and 4.4.1; W. Pegoraro and S. Parker, "An analytical solution to single scattering in homogeneous participating media" (2009); C. Kulla and M. Fajardo (2012) for equal angles.

const local_light_PI: f32 = 3.141592653589793;

/// An eye nearer to the light than this, metres, has no direction to it.
const LEAST_DISTANCE: f32 = 1e-4;
/// Slices span at least this much at the light, radians.
const LEAST_SPAN: f32 = 1e-4;
/// Optical depth after which the airlight integral stops.
const DEEPEST: f32 = 10.0;
/// Nodes and weights of the Gauss-Legendre rule of 8 points, the positive half.
const NODES: vec4<f32> = vec4<f32>(0.1834346424956498, 0.525532409916329, 0.7966664774136267, 0.9602898564975363);
const WEIGHTS: vec4<f32> = vec4<f32>(0.362683783378362, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763);

/// Bounds of one slice around a light at a point.
struct LocalSlice {
    /// Least angle to the light of its view rays, radians.
    angle_min: f32,
    /// Greatest angle to the light of its view rays, radians.
    angle_max: f32,
    /// Light angle at the left end of its row, radians.
    light_angle_min: f32,
    /// Light angle at the right end of its row, radians.
    light_angle_max: f32,
}

/// The line of a view ray, as the light sees it.
struct LocalRay {
    /// Where along the ray it passes closest to the light, metres from the eye; negative where that lies behind.
    closest: f32,
    /// How close, metres.
    passing: f32,
    /// How close, softened by the radius of the light, metres, positive.
    softened: f32,
}

/// Distance in metres of a light at `position` from the eye of `frame`, which looks towards it.
fn distance_to_light(frame: Frame, position: vec3<f32>) -> f32 {
    return max(dot(position - frame.eye, frame.light), LEAST_DISTANCE);
}

/// Light angle, 0..pi, of the point `along` metres along a view ray. `away`: of the light from the eye, metres;
/// `cosine`, `sine`: of the ray's angle to the light.
fn light_angle(away: f32, cosine: f32, sine: f32, along: f32) -> f32 {
    // At the light itself the angle is free; atan2(0, 0) is not.
    return atan2(max(along * sine, 1e-30), away - along * cosine);
}

/// Distance in metres along the view ray at `angle` to the light, of the point with the light angle `at_light`, both in
/// 0..pi; at most `limit`, which also stands for light rays that never meet it. `away`: of the light, metres.
fn distance_from_light_angle(away: f32, angle: f32, at_light: f32, limit: f32) -> f32 {
    let between = sin(angle + at_light);
    let along = away * sin(at_light);
    if angle + at_light >= local_light_PI || along > limit * between {
        return limit;
    }
    return along / max(between, 1e-30);
}

/// What `local_slice_texel` did, undone.
fn local_slice_from_texel(texel: vec4<f32>) -> LocalSlice {
    return LocalSlice(texel.x, texel.y, texel.z, texel.w);
}

/// The bounds of the view rays alone, for `depth_from_angle` and `depth_from_ray`.
fn ray_bounds(slice: LocalSlice) -> Slice {
    return Slice(slice.angle_min, slice.angle_max, 1.0, 1.0);
}

/// Part of the row, 0..1, that a view ray covers which ends at the light angle `at_light`.
fn columns_covered(slice: LocalSlice, at_light: f32) -> f32 {
    let span = max(slice.light_angle_max - slice.light_angle_min, 0.1 * LEAST_SPAN);
    return clamp((at_light - slice.light_angle_min) / span, 0.0, 1.0);
}

/// The line of a view ray as the light sees it. `away`: of the light from the eye, metres; `cosine`, `sine`: of the ray's
/// angle to the light; `radius`: of the light, metres.
fn local_ray(away: f32, cosine: f32, sine: f32, radius: f32) -> LocalRay {
    let passing = away * sine;
    // Somewhat above zero, for a ray through a light without radius.
    return LocalRay(away * cosine, passing, max(length(vec2<f32>(passing, radius)), 1e-6 * away));
}

/// Angle, -pi/2..pi/2, that grows along a view ray so that equal steps of it receive alike from the light in clear air.
/// `along`: metres along the ray.
fn equal_angle(ray: LocalRay, along: f32) -> f32 {
    return atan2(along - ray.closest, ray.softened);
}

/// Metres along the ray, not negative, of an `equal_angle`.
fn along_from_equal_angle(ray: LocalRay, angle: f32) -> f32 {
    return clamp(ray.closest + ray.softened * tan(angle), 0.0, 1e15);
}

/// Metres of air that light passes from the light to the point `along` metres along the ray, and from there to the eye.
fn path_through_air(ray: LocalRay, along: f32) -> f32 {
    return along + length(vec2<f32>(ray.passing, along - ray.closest));
}

/// Cosine of the scattering angle at the point `along` metres along the ray: the view direction times the direction
/// from there TOWARDS the light.
fn cosine_to_light(ray: LocalRay, along: f32) -> f32 {
    let left = ray.closest - along;
    return left / max(length(vec2<f32>(ray.passing, left)), 1e-12);
}

/// asinh of x >= 0, with a small relative error for small x, which the built-in function lacks.
fn area_sine(x: f32) -> f32 {
    let square = x * x;
    let series = x * (1.0 - square * (0.16666667 - square * (0.075 - square * 0.04464286)));
    return select(log(x + sqrt(square + 1.0)), series, x < 0.3);
}

/// What `area_sine` did, undone.
fn sine_of_area(x: f32) -> f32 {
    let square = x * x;
    let series = x * (1.0 + square * (0.16666667 + square * (0.008333333 + square * 0.00019841270)));
    return select(0.5 * (exp(x) - exp(-x)), series, x < 0.7);
}

/// The airlight integral on one side of the closest point. `side`: -1 before it, 1 beyond; `from_along`, `to_along`: metres from
/// the closest point, not negative, the first not greater than the second; `stretch`: the scale within which the integrand changes fast near zero.
fn airlight_side(
    ray: LocalRay, side: f32, from_along: f32, to_along: f32, stretch: f32, extinction: f32, g: f32
) -> f32 {
    let h = ray.softened;
    // What `equal_angle` lacks to pi/2 on that side; the span by itself, for a difference would lose its figures.
    let a = atan2(h, to_along) / stretch;
    let b = atan2(h, from_along) / stretch;
    let span = atan2(h * (to_along - from_along), h * h + from_along * to_along) / stretch;
    let first = area_sine(a);
    let half = 0.5 * area_sine(span * (a + b) / (b * sqrt(1.0 + a * a) + a * sqrt(1.0 + b * b)));
    let middle = first + half;
    var sum = 0.0;
    for (var pair = 0u; pair < 8u; pair++) {
        // An index into a constant vector would be a table in memory.
        let picked = select(vec4<f32>(0.0), vec4<f32>(1.0), vec4<u32>(0u, 1u, 2u, 3u) == vec4<u32>(pair >> 1u));
        let node = dot(NODES, picked);
        let at = middle + half * select(node, -node, (pair & 1u) == 0u);
        let growth = exp(at);
        let angle = max(stretch * sine_of_area(at), 1e-12);
        let along = clamp(ray.closest + side * h * cos(angle) / sin(angle), 0.0, 1e15);
        let phase = henyey_greenstein(cosine_to_light(ray, along), g);
        let air = exp(-min(extinction * path_through_air(ray, along), 200.0));
        sum += dot(WEIGHTS, picked) * phase * air * 0.5 * (growth + 1.0 / growth);
    }
    return sum * half * stretch;
}

/// The airlight integral: int p(cos) exp(-extinction (t + d)) / (d^2 + radius^2) dt from `from_along` to `to_along`
/// metres along a view ray, in 1/(m sr), with d the distance to the light. `extinction` in 1/m, not negative; `g`: mean cosine.
/// A fixed rule of 16 points: within 1e-3 for g from -0.75 to 0.9 on rays that pass the light at twice its radius or farther;
/// nearer, where the softening is a matter of taste, within 5e-2. Stretches below a thousandth of the distance to the
/// light lose figures in proportion.
fn airlight(ray: LocalRay, extinction: f32, g: f32, from_along: f32, to_along: f32) -> f32 {
    let start = from_along - ray.closest;
    let start_away = length(vec2<f32>(ray.passing, start));
    // Path at the start less that at the eye; the second form does not cancel before the closest point.
    let before = ray.passing * ray.passing / max(start_away - start, 1e-30);
    let path = select(before, start + start_away, start > 0.0) + DEEPEST / max(extinction, 1e-20);
    let deepest = 0.5 * (path - ray.passing * ray.passing / path);
    let end = max(min(to_along - ray.closest, deepest), start);

    let peak = clamp((1.0 - abs(g)) / sqrt(max(abs(g), 0.01)), 1e-3, 10.0);
    // Both sides always, an empty one for nothing: a branch here, or a loop of varying length, ends lavapipe of Mesa 22.3.
    let before_light = airlight_side(
        ray, -1.0, max(-end, 0.0), max(-start, 0.0), select(10.0, peak, g > 0.0), extinction, g
    );
    // Beyond the light the air dims over angles of about the optical depth of the closest distance.
    let stretch = min(max(extinction * ray.softened, 0.01), select(10.0, peak, g < 0.0));
    let beyond_light = airlight_side(ray, 1.0, max(start, 0.0), max(end, 0.0), stretch, extinction, g);
    return (before_light + beyond_light) / ray.softened;
}

/// Radiance scattered into a view ray. `intensity`: linear RGB radiant intensity of the light; `lit`: mean of visibility times
/// fall-off over the light angles of the stretch that `integral` was taken over, for each colour, 0..1.
fn local_in_scattered(medium: Medium, intensity: vec3<f32>, integral: f32, lit: vec3<f32>) -> vec3<f32> {
    return medium.albedo * intensity * lit * (medium.extinction * integral);
}

// ---- airlight::scattering::lit ----
// summary: Callback: the light that reaches a point, and its mean over a view ray by marching, from a pass' bindings.
// source: thesis 2.4.4, Eq. 2.20; 4.2.1; C. Kulla and M. Fajardo, "Importance sampling techniques for path tracing in participating media" (2012).

@group(0) @binding(6) var shadow_map: texture_2d<f32>;
@group(0) @binding(11) var light_texture: texture_2d<f32>;
@group(0) @binding(12) var light_sampler: sampler;

/// Visibility, 0 or 1, times fall-off and light texture at a point in the world, metres.
fn lit_at(light: Light, point: vec3<f32>) -> vec3<f32> {
    let visibility = lit_by_shadow(shadow_in_map(shadow_map, light, point), light.far_depth);
    let lit = vec3<f32>(visibility * angular_falloff(light, direction_to_light(light, point)));
    return lit * light_texture_color(light, light_texture, light_sampler, point);
}

/// Like `marched_light` for a light at a point, by steps of equal angle at the light, which the fall-off with distance
/// makes alike; weighted by the phase function of mean cosine `g` and by transmittance, unless `extinction` is zero.
/// `away`: metres from origin to light; `cosine`, `sine`: of the ray's angle to the light.
fn marched_local_light(
    light: Light, g: f32, origin: vec3<f32>, direction: vec3<f32>, away: f32, cosine: f32, sine: f32, span: vec2<f32>,
    extinction: f32, steps: u32, offset: f32
) -> vec3<f32> {
    let ray = local_ray(away, cosine, sine, light.radius);
    let taken = min(steps, MOST_MARCH_STEPS);
    let from_angle = equal_angle(ray, span.x);
    let stride = (equal_angle(ray, max(span.y, span.x)) - from_angle) / f32(max(taken, 1u));
    // Weights in units of the first step's: finite however deep the stretch lies.
    let first = path_through_air(ray, along_from_equal_angle(ray, from_angle + stride * offset));
    var sum = vec3<f32>(0.0);
    var total = 0.0;
    for (var done = 0u; done < taken; done++) {
        let along = along_from_equal_angle(ray, from_angle + stride * (f32(done) + offset));
        let phase = henyey_greenstein(cosine_to_light(ray, along), g);
        let air = exp(-clamp(extinction * (path_through_air(ray, along) - first), 0.0, 80.0));
        let weight = select(1.0, phase * air, extinction > 0.0);
        sum += weight * lit_at(light, origin + along * direction);
        total += weight;
    }
    return sum / max(total, 1e-30);
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

/// Mean of visibility times fall-off by bilinear reads, 0 up to the mean fall-off. `colors`: 1, the same fall-off for
/// all, or 3, red, green and blue.
fn fourier_colors(
    bases: texture_2d_array<f32>, bases_sampler: sampler, place: vec2<f32>, depth: f32, layers: u32, colors: u32,
    windowed: bool
) -> vec3<f32> {
    let falloff = textureSampleLevel(bases, bases_sampler, place, colors * layers, 0.0).rgb;
    var lit = 0.5 * falloff;
    var ray = fourier_ray(depth, layers);
    for (var layer = 0u; layer < layers; layer++) {
        let factors = fourier_factors(ray, layer, layers, windowed);
        let red = dot(factors, basis_from_stored(textureSampleLevel(bases, bases_sampler, place, layer, 0.0)));
        var both = vec2<f32>(red);
        if colors == 3u {
            let green = textureSampleLevel(bases, bases_sampler, place, layers + layer, 0.0);
            let blue = textureSampleLevel(bases, bases_sampler, place, 2u * layers + layer, 0.0);
            both = vec2<f32>(dot(factors, basis_from_stored(green)), dot(factors, basis_from_stored(blue)));
        }
        lit += vec3<f32>(red, both);
        ray = fourier_next(ray);
    }
    return clamp(lit, vec3<f32>(0.0), falloff);
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

/// Mean of visibility times fall-off of a stretch at the depth of a ray, for each colour.
fn prefix_colors(at: Prefix, depth: f32) -> vec3<f32> {
    let column = prefix_column(at.texels, at.first);
    let place = vec2<f32>(column, at.row + 0.5) / vec2<f32>(map_size());
    return fourier_colors(bases, bases_sampler, place, depth, LAYERS, u32(3), WINDOWED);
}

// ---- airlight::scattering::evaluated_local ----
// summary: Callback: what the air scatters into a pixel's view ray around a spot or point light.
// source: thesis 4.3.1 to 4.3.3, Eq. 4.6 and 4.9; V. Pegoraro and S. Parker, "An analytical solution to single scattering in homogeneous participating media" (2009).

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

/// What is scattered into the view ray of `pixel`.
fn scattered_ray(pixel: vec2<u32>) -> ScatteredRay {
    let ndc = ndc_from_pixel(camera, vec2<f32>(pixel) + 0.5);
    let surface = clamp(finite_or(textureLoad(depth, pixel, 0).x, camera.far_depth), 0.0, 1.0);
    let ray = epipolar_ray(frame, ndc, surface, medium.distance_limit);
    let slice = local_slice_from_texel(textureLoad(slices, vec2<u32>(nearest_row(frame, ray.row), 0u), 0));
    let width = f32(map_size().x);
    let away = distance_to_light(frame, light.position);
    let texels = width * columns_covered(slice, light_angle(away, ray.cosine, ray.sine, ray.distance));
    var row_ray = RowRay(ray.row, 0.0, texels, depth_from_ray(ray_bounds(slice), ray));
    let prefix = Prefix(ray.row, frame.wraps, 0.0, texels, 0.0, 0.0);
    var lit = prefix_colors(prefix, row_ray.depth);
    // The stretch of the ray between the least and the greatest light angle of the slice.
    let span = vec2<f32>(
        distance_from_light_angle(away, ray.angle, slice.light_angle_min, ray.distance),
        distance_from_light_angle(away, ray.angle, slice.light_angle_max, ray.distance)
    );
    let extinction = medium.extinction;
    let near_epipole = 1.0 - smoothstep(EPIPOLE_TEXELS, 2.0 * EPIPOLE_TEXELS, texels);
    // A ray that ends before it comes into the light has nothing to march.
    let steps = select(0u, EPIPOLE_STEPS, near_epipole > 0.0 && span.y > span.x);
    let direction = perspective_ray(camera, ndc).direction;
    let marched = marched_local_light(
        light, medium.g, camera.eye, direction, away, ray.cosine, ray.sine, span, extinction, steps, 0.5
    );
    lit = mix(lit, marched, near_epipole);
    let integral = airlight(
        local_ray(away, ray.cosine, ray.sine, light.radius), medium.extinction, medium.g, span.x, span.y
    );
    let radiance = local_in_scattered(medium, light.radiance, integral, lit);
    let mean = dot(lit, vec3<f32>(1.0 / 3.0));
    let distance = epipolar_ray(frame, ndc, surface, FARTHEST).distance;
    return ScatteredRay(min(radiance, vec3<f32>(65504.0)), mean, ndc, distance, ray.cosine);
}

// ---- scattering/evaluate_local ----

@group(0) @binding(9) var scattered: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(16, 8)
fn evaluate_local(@builtin(global_invocation_id) id: vec3<u32>) {
    if all(id.xy < textureDimensions(scattered)) {
        textureStore(scattered, id.xy, scattered_texel(scattered_ray(id.xy)));
    }
}

@vertex
fn vertex_picture(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return picture_corner(index);
}

@fragment
fn fragment_evaluate_local(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return scattered_texel(scattered_ray(vec2<u32>(position.xy)));
}
