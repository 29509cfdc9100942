// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: scattering/march, permutation projective (PROJECTIVE)
// summary: In-scattered radiance of every pixel by marching: along rows of the rectified map, or through the standard shadow map.
// source: thesis 4.2.1 and 4.3.1, Eq. 4.4 and 4.8.
// note: Rows: the nearest row, one texture load a step; one step a texel, or with STEPS `steps` equal steps a ray.
// definition PROJECTIVE: rows of a projective map, the exact sum over its texels; without STEPS and SHADOW_MAP.
// binding camera: the camera, perspective (epipolar rows) or any.
// binding light: the directional light.
// binding medium: the medium.
// binding rows: the projective rows; with PROJECTIVE only.
// binding depth: depth buffer of the picture, a depth format or r32float; non-finite values count as far.
// binding rectified: the rectified map; rows only.
// binding scattered: out of the compute entry point (the fragment entry point returns it), rgba16float: linear RGB radiance, and in alpha the mean visibility 0..1.

// ---- airlight::core::camera ----
// summary: View rays, distances and frustum planes from a camera's matrices, for any depth convention.
// source: homogeneous unprojection; planes after Gribb and Hartmann, "Fast extraction of viewing frustum planes" (2001).

/// Orthographic projection: view rays are parallel and leave the near plane.
const ORTHOGRAPHIC: u32 = 1u;

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

/// The view ray through `ndc`, of any camera.
fn view_ray(camera: Camera, ndc: vec2<f32>) -> Ray {
    // Values, not branches: some drivers compile a shader anew for every value of a uniform that a branch depends on.
    let parallel = camera.projection == ORTHOGRAPHIC;
    let far = camera.world_from_clip * vec4<f32>(ndc, camera.far_depth, 1.0);
    let near = camera.world_from_clip * vec4<f32>(ndc, camera.near_depth, 1.0);
    let origin = select(camera.eye, near.xyz / select(1.0, near.w, parallel), parallel);
    // With w = 0 (infinite far plane) far.xyz is the direction itself.
    return Ray(origin, normalize(far.xyz - select(camera.eye * far.w, near.xyz, parallel)));
}

/// Distance in metres along `ray`, the view ray through `ndc`, of the surface with the depth-buffer
/// value `depth`; at most `limit`, which also stands for points at infinity.
fn distance_from_depth(camera: Camera, ray: Ray, ndc: vec2<f32>, depth: f32, limit: f32) -> f32 {
    let point = camera.world_from_clip * vec4<f32>(ndc, depth, 1.0);
    let along = dot(point.xyz - ray.origin * point.w, ray.direction);
    // along / w, without dividing by a w that is zero or has rounded below it.
    let beyond = along >= limit * point.w;
    return select(max(along / select(point.w, 1.0, beyond), 0.0), limit, beyond);
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

// ---- airlight::scattering::projective ----
// summary: Projective rows around a directional light: view rays run along rows at constant depth after one matrix.
// source: thesis 4.4.2; weights after 4.3.2, Eq. 4.8.

/// Perspective camera: rows and depth are slopes.
const PERSPECTIVE: u32 = 0u;

/// The rows of a camera and a light, made by the host. 96 bytes.
struct ProjectiveRows {
    /// The eye; of an orthographic camera the centre of its near plane. World, metres.
    origin: vec3<f32>,
    /// X at the left end of column 0, metres; positive in perspective.
    near: f32,
    /// Unit vector of X, at right angles to the light, along the middle of the view rays.
    along: vec3<f32>,
    /// Metres of Z that a view ray of an orthographic camera takes for one of X; 0 in perspective.
    tilt: f32,
    /// Unit vector of Y.
    across: vec3<f32>,
    /// Slope Y / X (orthographic: Y, metres) at the upper border of row 0.
    row_min: f32,
    /// Unit vector of Z, AWAY from the light.
    away: vec3<f32>,
    /// From there to the lower border of the last row, positive.
    row_span: f32,
    /// X at the right end of each split, metres, growing; the last one in use and all after it are the far end.
    bounds: vec4<f32>,
    /// Least slope Z / X (orthographic: Z - tilt X, metres) of view rays.
    depth_min: f32,
    /// Range of those, positive.
    depth_span: f32,
    /// Number of splits, 1..4.
    splits: u32,
    /// PERSPECTIVE, or 1 for orthographic.
    projection: u32,
}

/// A view ray in its row.
struct ProjectiveRay {
    /// Row, fractional; row j is at the value j.
    row: f32,
    /// Depth, GUARD .. 1 - GUARD, constant along the ray.
    depth: f32,
    /// X where the ray begins, metres; 0 in perspective.
    begin: f32,
    /// X where it ends, metres.
    end: f32,
    /// Metres along the ray for one of X.
    reach: f32,
}

/// X at the left end of `split`, metres.
fn split_begin(rows: ProjectiveRows, split: u32) -> f32 {
    return select(rows.bounds[max(split, 1u) - 1u], rows.near, split == 0u);
}

/// Column, 0..`width` and fractional, of the light rays at `x` metres; clamped to the map of `width` texels.
fn column_from_x(rows: ProjectiveRows, width: f32, x: f32) -> f32 {
    let inside = clamp(x, rows.near, rows.bounds.w);
    var split = 0u;
    for (var next = 1u; next < rows.splits; next++) {
        split = select(split, next, inside >= rows.bounds[next - 1u]);
    }
    let begin = split_begin(rows, split);
    let end = rows.bounds[split];
    let unit = (inside - begin) / (end - begin) * select(1.0, end / inside, rows.projection == PERSPECTIVE);
    return (f32(split) + clamp(unit, 0.0, 1.0)) * (width / f32(rows.splits));
}

/// X in metres of a fractional `column`, 0..`width`: what `column_from_x` did, undone.
fn x_from_column(rows: ProjectiveRows, width: f32, column: f32) -> f32 {
    let share = column * f32(rows.splits) / width;
    let split = min(u32(max(share, 0.0)), rows.splits - 1u);
    let unit = clamp(share - f32(split), 0.0, 1.0);
    let begin = split_begin(rows, split);
    let end = rows.bounds[split];
    let divided = begin * end / (end - unit * (end - begin));
    return select(begin + unit * (end - begin), divided, rows.projection == PERSPECTIVE);
}

/// X of the right edge of texel `column`, metres.
fn texel_end(rows: ProjectiveRows, width: f32, column: u32) -> f32 {
    return x_from_column(rows, width, f32(column) + 1.0);
}

/// The view ray from `start` (in perspective the eye) in the unit `direction` over `distance` metres, in a map of
/// `height` rows.
fn projective_ray(
    rows: ProjectiveRows, height: f32, start: vec3<f32>, direction: vec3<f32>, distance: f32
) -> ProjectiveRay {
    let perspective = rows.projection == PERSPECTIVE;
    // The host refuses rays at right angles to X; what is left of them here is rounding.
    let cosine = max(dot(direction, rows.along), 1e-6);
    let offset = select(start - rows.origin, direction, perspective);
    let x = dot(offset, rows.along);
    let divisor = select(1.0, cosine, perspective);
    let slope = dot(offset, rows.across) / divisor;
    let row = (slope - rows.row_min) / rows.row_span * height - 0.5;
    let unit = ((dot(offset, rows.away) - rows.tilt * x) / divisor - rows.depth_min) / rows.depth_span;
    let begin = select(x, 0.0, perspective);
    return ProjectiveRay(
        clamp(row, 0.0, height - 1.0),
        clamp(guarded(unit), GUARD, 1.0 - GUARD),
        begin,
        begin + cosine * max(distance, 0.0),
        1.0 / cosine
    );
}

/// Integral of transmittance over `metres` from where it is 1, metres: the weight of that stretch of a ray. `extinction`
/// in 1/m; 0 gives `metres`, the weight of a plain mean. Relative error below 1e-6.
fn stretch_weight(extinction: f32, metres: f32) -> f32 {
    let depth = extinction * metres;
    return select(one_minus_exp(depth) / max(extinction, 1e-30), metres * (1.0 - 0.5 * depth), depth < 1e-4);
}

/// Mean visibility of a view ray over `row` of a rectified map, weighted by transmittance: the exact sum over its
/// texels. `extinction` in 1/m, 0 for the plain mean.
fn march_projective_row(
    map: texture_2d<f32>, rows: ProjectiveRows, row: u32, ray: ProjectiveRay, extinction: f32
) -> f32 {
    let size = textureDimensions(map);
    let width = f32(size.x);
    let first = min(u32(column_from_x(rows, width, ray.begin)), size.x - 1u);
    let last = max(min(u32(column_from_x(rows, width, ray.end)), size.x - 1u), first);
    var from_x = ray.begin;
    var through = 1.0;
    var sum = 0.0;
    var total = 0.0;
    var lit = false;
    for (var column = first; column <= last; column++) {
        lit = textureLoad(map, vec2<u32>(column, row), 0).x >= ray.depth;
        let inner = clamp(texel_end(rows, width, column), from_x, max(ray.end, from_x));
        let to_x = select(inner, max(ray.end, from_x), column == last);
        let metres = (to_x - from_x) * ray.reach;
        let weight = through * stretch_weight(extinction, metres);
        sum += select(0.0, weight, lit);
        total += weight;
        through *= exp(-extinction * metres);
        from_x = to_x;
    }
    // A ray of no length sees its texel.
    return select(clamp(sum / max(total, 1e-37), 0.0, 1.0), select(0.0, 1.0, lit), total < 1e-30);
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
@group(0) @binding(10) var<uniform> rows: ProjectiveRows;
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
    let ray = view_ray(camera, ndc);
    let distance = distance_from_depth(camera, ray, ndc, surface, medium.distance_limit);
    let cosine = dot(ray.direction, light.direction);
    let extinction = medium.extinction;

    let size = textureDimensions(rectified);
    let along = projective_ray(rows, f32(size.y), ray.origin, ray.direction, distance);
    let row = min(u32(along.row + 0.5), size.y - 1u);
    let visibility = march_projective_row(rectified, rows, row, along, extinction);
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
