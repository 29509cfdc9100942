// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: scattering/march, permutation average (AVERAGE)
// summary: In-scattered radiance of every pixel by marching: along rows of the rectified map, or through the standard shadow map.
// source: thesis 4.2.1 and 4.3.1, Eq. 4.4 and 4.8.
// note: Rows: the nearest row, one texture load a step; one step a texel, or with STEPS `steps` equal steps a ray.
// definition AVERAGE: average visibility instead of visibility weighted by transmittance.
// binding camera: the camera, perspective (epipolar rows) or any.
// binding light: the directional light.
// binding medium: the medium.
// binding frame: the frame of the slices; epipolar rows only.
// binding slices: their bounds, rgba32float; epipolar rows only.
// binding depth: depth buffer of the picture, a depth format or r32float; non-finite values count as far.
// binding rectified: the rectified map; rows only.
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

/// Normalised device coordinates of a position in pixels: (0, 0) is the top left corner of the picture.
fn ndc_from_pixel(camera: Camera, pixel: vec2<f32>) -> vec2<f32> {
    return vec2<f32>(2.0, -2.0) * pixel / camera.viewport + vec2<f32>(-1.0, 1.0);
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

/// Mean visibility over the first `texels` texels of a row of a rectified map, weighted by
/// transmittance. `depth`: of the ray, 0..1; `texels`: fractional, clamped to the width of the map;
/// `optical_step`: optical depth of the ray over one texel, zero for the plain mean.
fn march_row(map: texture_2d<f32>, row: u32, depth: f32, texels: f32, optical_step: f32) -> f32 {
    let size = textureDimensions(map);
    let covered = clamp(texels, 1e-3, f32(size.x));
    let whole = min(u32(covered), size.x - 1u);
    let part = covered - f32(whole);
    let ratio = exp(-optical_step);
    // Weights in units of the first texel's: 1, q, q^2 ...; the last texel counts in part.
    let scale = one_minus_exp(optical_step);
    let last = select(part, one_minus_exp(optical_step * part) / scale, scale > 1e-6);
    var sum = 0.0;
    if textureLoad(map, vec2<u32>(whole, row), 0).x >= depth {
        sum = last;
    }
    for (var left = whole; left > 0u; left--) {
        let lit = textureLoad(map, vec2<u32>(left - 1u, row), 0).x >= depth;
        sum = sum * ratio + select(0.0, 1.0, lit);
    }
    return clamp(sum / prefix_weight(optical_step, covered), 0.0, 1.0);
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

// ---- scattering/march ----

struct MarchParameters {
    /// Steps a ray, 1..65536.
    steps: u32,
    /// Where in each step the sample lies, 0..1; unused with jitter.
    offset: f32,
    /// Number of the frame, for jitter; 0 is the static pattern.
    frame: u32,
    reserved: u32,
}

@group(0) @binding(0) var<uniform> camera: Camera;
@group(0) @binding(1) var<uniform> light: Light;
@group(0) @binding(2) var<uniform> medium: Medium;
@group(0) @binding(3) var<uniform> frame: Frame;
@group(0) @binding(4) var slices: texture_2d<f32>;
@group(0) @binding(6) var rectified: texture_2d<f32>;
@group(0) @binding(5) var depth: texture_2d<f32>;
@group(0) @binding(9) var scattered: texture_storage_2d<rgba16float, write>;

/// Where in each step the samples of a pixel lie, 0..1.
fn step_offset(pixel: vec2<u32>, march: MarchParameters) -> f32 {
    return march.offset;
}

/// Radiance, and mean visibility in alpha, of a pixel.
fn pixel_light(pixel: vec2<u32>) -> vec4<f32> {
    let ndc = ndc_from_pixel(camera, vec2<f32>(pixel) + 0.5);
    let surface = clamp(finite_or(textureLoad(depth, pixel, 0).x, camera.far_depth), 0.0, 1.0);
    let ray = epipolar_ray(frame, ndc, surface, medium.distance_limit);
    let distance = ray.distance;
    let cosine = ray.cosine;
    let extinction = 0.0;

    let row = nearest_row(frame, ray.row);
    let slice = slice_from_texel(textureLoad(slices, vec2<u32>(row, 0u), 0));
    let width = f32(textureDimensions(rectified).x);
    let radius = distance * ray.sine;
    // A texel of a ray that barely leaves the light's direction is longer than any ray: the clamp keeps it finite.
    let optical_step = extinction * slice.radius_max / (width * max(ray.sine, 1e-6));
    let texels = width * radius / slice.radius_max;
    let visibility = march_row(rectified, row, depth_from_ray(slice, ray), texels, optical_step);
    let radiance = in_scattered(medium, light.radiance, cosine, distance, visibility);
    return vec4<f32>(min(radiance, vec3<f32>(65504.0)), visibility);
}

@compute @workgroup_size(16, 8)
fn march(@builtin(global_invocation_id) id: vec3<u32>) {
    if all(id.xy < textureDimensions(scattered)) {
        textureStore(scattered, id.xy, pixel_light(id.xy));
    }
}

@vertex
fn vertex_picture(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return picture_corner(index);
}

@fragment
fn fragment_march(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return pixel_light(vec2<u32>(position.xy));
}
