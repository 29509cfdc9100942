// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: scattering/upsample, permutation default
// summary: In-scattered radiance of every pixel from a picture that was evaluated at a half or a quarter of the resolution.
// source: joint bilateral upsampling, Kopf, Cohen, Lischinski and Uyttendaele (2007); thesis Eq. 4.2.
// note: What is interpolated is the visibility: the pixel's own distance and phase function then give its
// note: radiance, so that edges of the picture stay as sharp as its depth buffer. Rays begin at the eye: a
// note: picture that was evaluated with NEAR_PLANE needs RADIANCE.
// note: Non-finite values of the evaluated picture count as 0.
// binding camera: the camera of the full picture, any.
// binding light: the directional light; without RADIANCE only.
// binding medium: the medium.
// binding reduction: the factor, and the tolerance of distances.
// binding depth: depth buffer of the full picture, a depth format or r32float; non-finite values count as far.
// binding reduced_depth: depth of the evaluated pixels, from the pass reduce_depth.
// binding reduced: their radiance and, in alpha, visibility 0..1; rgba16float.
// binding scattered: out of the compute entry point (the fragment entry point returns it), rgba16float: linear RGB radiance, and in alpha the mean visibility 0..1.

// ---- airlight::core::camera ----
// summary: View rays, distances and frustum planes from a camera's matrices, for any depth convention.
// source: homogeneous unprojection; planes after Gribb and Hartmann, "Fast extraction of viewing frustum planes" (2001).

/// Perspective projection: all view rays leave the eye.
const PERSPECTIVE: u32 = 0u;
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

// ---- airlight::core::ray_depth ----
// summary: Distance along one view ray from depth-buffer values and back, for any camera, in a few operations each.
// source: homogeneous unprojection: on a view ray numerator and denominator of the distance are affine in the depth.

/// Distance over depth on one view ray: (along + along_slope x) / (w + w_slope x), x = depth - far_depth.
struct RayDepth {
    /// Homogeneous distance at the far plane, metres times w.
    along: f32,
    /// Its change per depth; 0 for a perspective camera.
    along_slope: f32,
    /// Homogeneous w at the far plane; 0 where that is at infinity.
    w: f32,
    /// Its change per depth; 0 for an orthographic camera.
    w_slope: f32,
    /// Clip depth of the far plane.
    far_depth: f32,
    /// Clip depth of the near plane.
    near_depth: f32,
}

/// What turns depths into distances on `ray`, the view ray through `ndc`.
fn ray_depth(camera: Camera, ray: Ray, ndc: vec2<f32>) -> RayDepth {
    let far = camera.world_from_clip * vec4<f32>(ndc, camera.far_depth, 1.0);
    let column = camera.world_from_clip[2];
    let along = dot(far.xyz - ray.origin * far.w, ray.direction);
    let slope = dot(column.xyz - ray.origin * column.w, ray.direction);
    // From the eye the product is the same at every depth: what is left of its slope is rounding.
    let perspective = camera.projection == PERSPECTIVE;
    return RayDepth(along, select(slope, 0.0, perspective), far.w, column.w, camera.far_depth, camera.near_depth);
}

/// Distance in metres along the ray at `depth`, 0..1; at most `limit`, which also stands for infinity.
fn distance_on_ray(ray: RayDepth, depth: f32, limit: f32) -> f32 {
    let beyond_far = depth - ray.far_depth;
    let along = ray.along + ray.along_slope * beyond_far;
    let w = ray.w + ray.w_slope * beyond_far;
    let beyond = along >= limit * w;
    return select(max(along / select(w, 1.0, beyond), 0.0), limit, beyond);
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

// ---- airlight::scattering::upsample ----
// summary: Scattered light at a fraction of the resolution: which pixels are evaluated, and how the others are found from them.
// source: joint bilateral upsampling, Kopf, Cohen, Lischinski and Uyttendaele (2007), with distance along the ray as guide.

/// How the picture is reduced. 16 bytes.
struct Reduction {
    /// Pixels of the full picture from one evaluated pixel to the next, in x and in y: 2 or 4.
    factor: u32,
    /// Relative difference of distance at which a neighbour counts half, positive.
    tolerance: f32,
    reserved_a: u32,
    reserved_b: u32,
}

/// Share of neighbours that bilinear weights leave out, where all others are at other distances.
const LEAST_WEIGHT: f32 = 0.01;

/// The four evaluated pixels around a pixel.
struct Neighbours {
    /// Pixel of the low resolution at or before it, in x and y.
    before: vec2<u32>,
    /// The next one in x and y; the same at the end of the picture.
    behind: vec2<u32>,
    /// Bilinear weights: before and behind in x; then both in the row behind. They add up to one.
    bilinear: vec4<f32>,
}

/// The evaluated pixels around a `pixel` of the full picture. `size`: of the low resolution, at least 1.
fn evaluated_neighbours(reduction: Reduction, pixel: vec2<u32>, size: vec2<u32>) -> Neighbours {
    let factor = max(reduction.factor, 1u);
    let last = size - 1u;
    let before = min(pixel / factor, last);
    let part = clamp(vec2<f32>(pixel - before * factor) / f32(factor), vec2<f32>(0.0), vec2<f32>(1.0));
    let rest = 1.0 - part;
    let bilinear = vec4<f32>(rest.x * rest.y, part.x * rest.y, rest.x * part.y, part.x * part.y);
    return Neighbours(before, min(before + 1u, last), bilinear);
}

/// How far neighbours with rays of the lengths `others` can stand in for a ray of the length `distance`,
/// all in metres: 1 for equal lengths, 1/2 at the relative difference `tolerance`, never 0.
fn closeness(distance: f32, others: vec4<f32>, tolerance: f32) -> vec4<f32> {
    let scale = max(distance, 1e-6) * max(tolerance, 1e-4);
    let off = min(abs(others - distance) / scale, vec4<f32>(1e15));
    return 1.0 / (1.0 + off * off);
}

/// Weights of the neighbours, adding up to one. Where those that the bilinear weights prefer are at other
/// distances, the one at the most similar distance takes over.
fn upsampling_weights(bilinear: vec4<f32>, closeness: vec4<f32>) -> vec4<f32> {
    let near = bilinear * closeness;
    let trusted = dot(near, vec4<f32>(1.0));
    let weights = near + LEAST_WEIGHT * max(1.0 - trusted, 0.0) * closeness;
    return weights / max(dot(weights, vec4<f32>(1.0)), 1e-37);
}

// ---- scattering/upsample ----

@group(0) @binding(0) var<uniform> camera: Camera;
@group(0) @binding(1) var<uniform> light: Light;
@group(0) @binding(2) var<uniform> medium: Medium;
@group(0) @binding(3) var<uniform> reduction: Reduction;
@group(0) @binding(4) var depth: texture_2d<f32>;
@group(0) @binding(5) var reduced_depth: texture_2d<f32>;
@group(0) @binding(6) var reduced: texture_2d<f32>;
@group(0) @binding(7) var scattered: texture_storage_2d<rgba16float, write>;

/// Depth 0..1 of an evaluated pixel.
fn depth_at(pixel: vec2<u32>) -> f32 {
    return clamp(finite_or(textureLoad(reduced_depth, pixel, 0).x, camera.far_depth), 0.0, 1.0);
}

/// Visibility of an evaluated pixel.
fn light_at(pixel: vec2<u32>) -> f32 {
    return finite_or(textureLoad(reduced, pixel, 0).a, 0.0);
}

/// Radiance, and mean visibility in alpha, of a pixel.
fn pixel_light(pixel: vec2<u32>) -> vec4<f32> {
    let ndc = ndc_from_pixel(camera, vec2<f32>(pixel) + 0.5);
    let view = view_ray(camera, ndc);
    let ray = ray_depth(camera, view, ndc);
    let surface = clamp(finite_or(textureLoad(depth, pixel, 0).x, camera.far_depth), 0.0, 1.0);
    let distance = distance_on_ray(ray, surface, medium.distance_limit);

    let near = evaluated_neighbours(reduction, pixel, textureDimensions(reduced));
    let right = vec2<u32>(near.behind.x, near.before.y);
    let below = vec2<u32>(near.before.x, near.behind.y);
    // Distances of the neighbours' depths on this pixel's ray: their own rays are as long to a pixel's width.
    let distances = vec4<f32>(
        distance_on_ray(ray, depth_at(near.before), medium.distance_limit),
        distance_on_ray(ray, depth_at(right), medium.distance_limit),
        distance_on_ray(ray, depth_at(below), medium.distance_limit),
        distance_on_ray(ray, depth_at(near.behind), medium.distance_limit)
    );
    let weights = upsampling_weights(near.bilinear, closeness(distance, distances, reduction.tolerance));
    let mean = light_at(near.before) * weights.x + light_at(right) * weights.y
        + light_at(below) * weights.z + light_at(near.behind) * weights.w;
    let visibility = clamp(mean, 0.0, 1.0);
    let cosine = dot(view.direction, light.direction);
    let radiance = in_scattered(medium, light.radiance, cosine, distance, visibility);
    return vec4<f32>(min(radiance, vec3<f32>(65504.0)), visibility);
}

@compute @workgroup_size(16, 8)
fn upsample(@builtin(global_invocation_id) id: vec3<u32>) {
    if all(id.xy < textureDimensions(scattered)) {
        textureStore(scattered, id.xy, pixel_light(id.xy));
    }
}

@vertex
fn vertex_picture(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return picture_corner(index);
}

@fragment
fn fragment_upsample(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return pixel_light(vec2<u32>(position.xy));
}
