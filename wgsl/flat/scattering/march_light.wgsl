// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: scattering/march_light, permutation default
// summary: In-scattered radiance of every pixel by marching the shadow maps of any light: spot, point, cascades, light texture.
// source: thesis 2.4.4, Eq. 2.20; 4.2.1; C. Kulla and M. Fajardo, "Importance sampling techniques for path tracing in participating media" (2012).
// note: The naive form for every light; `march` is the fastest one for a directional light with one shadow map.
// note: Around a light at a point steps are equal angles at the light, which the fall-off with distance makes alike.
// binding camera: the camera, any.
// binding light: the light, directional without LOCAL.
// binding medium: the medium.
// binding depth: depth buffer of the picture, a depth format or r32float; non-finite values count as far.
// binding shadow_map: depth of the standard shadow map; without SHADOW_ARRAY.
// binding parameters: number of steps.
// binding scattered: out of the compute entry point (the fragment entry point returns it), rgba16float: linear RGB radiance, and in alpha the mean visibility times fall-off 0..1.

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

/// Visibility, 0 or 1, times fall-off and light texture at a point in the world, metres.
fn lit_at(light: Light, point: vec3<f32>) -> vec3<f32> {
    let visibility = lit_by_shadow(shadow_in_map(shadow_map, light, point), light.far_depth);
    let lit = vec3<f32>(visibility * angular_falloff(light, direction_to_light(light, point)));
    return lit;
}

/// Mean of `lit_at` over a view ray between two distances in metres, by equal steps, weighted by transmittance.
/// `extinction` in 1/m, 0 for the plain mean; `offset`: 0..1, where in each step the sample lies.
fn marched_light(
    light: Light, origin: vec3<f32>, direction: vec3<f32>, span: vec2<f32>, extinction: f32, steps: u32, offset: f32
) -> vec3<f32> {
    let taken = min(steps, MOST_MARCH_STEPS);
    let stride = (span.y - span.x) / f32(max(taken, 1u));
    var sum = vec3<f32>(0.0);
    var total = 0.0;
    for (var done = 0u; done < taken; done++) {
        let along = stride * (f32(done) + offset);
        let weight = exp(-min(extinction * stride * f32(done), 80.0));
        sum += weight * lit_at(light, origin + (span.x + along) * direction);
        total += weight;
    }
    return sum / max(total, 1.0);
}

// ---- scattering/march_light ----

struct MarchParameters {
    /// Steps a ray, 1..65536.
    steps: u32,
    /// Where in each step the sample lies, 0..1.
    offset: f32,
    /// Unused here.
    frame: u32,
    reserved: u32,
}

@group(0) @binding(0) var<uniform> camera: Camera;
@group(0) @binding(1) var<uniform> light: Light;
@group(0) @binding(2) var<uniform> medium: Medium;
@group(0) @binding(5) var depth: texture_2d<f32>;
@group(0) @binding(8) var<uniform> parameters: MarchParameters;
@group(0) @binding(9) var scattered: texture_storage_2d<rgba16float, write>;
/// Radiance, and mean visibility times fall-off in alpha, of a pixel.
fn pixel_light(pixel: vec2<u32>) -> vec4<f32> {
    let ndc = ndc_from_pixel(camera, vec2<f32>(pixel) + 0.5);
    let surface = clamp(finite_or(textureLoad(depth, pixel, 0).x, camera.far_depth), 0.0, 1.0);
    let ray = view_ray(camera, ndc);
    let distance = distance_from_depth(camera, ray, ndc, surface, medium.distance_limit);
    let span = vec2<f32>(0.0, distance);
    let steps = max(parameters.steps, 1u);
    let extinction = medium.extinction;
    let lit = marched_light(light, ray.origin, ray.direction, span, extinction, steps, parameters.offset);
    let cosine = dot(ray.direction, light.direction);
    let radiance = lit * in_scattered(medium, light.radiance, cosine, distance, 1.0);
    return vec4<f32>(min(radiance, vec3<f32>(65504.0)), dot(lit, vec3<f32>(1.0 / 3.0)));
}

@compute @workgroup_size(16, 8)
fn march_light(@builtin(global_invocation_id) id: vec3<u32>) {
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
