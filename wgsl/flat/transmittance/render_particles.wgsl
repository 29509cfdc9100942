// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: transmittance/render_particles, permutation default
// summary: Picture of particles that `light_particles` lit and `core/sort` put in order: a square each, blended back to front.
// source: Gautron et al., "Extinction transmittance maps" (2011).
// note: Six vertices an instance, an instance a particle. The target is cleared to (0, 0, 0, 1), or a picture that the medium
// note: is put over, and blended as source + source alpha * destination, alpha as source alpha * destination alpha: then it
// note: holds premultiplied radiance, and in alpha the transmittance to the background. Depth is not tested, but cuts balls.
// note: What is approximate: a particle is lit evenly, as its middle is, and balls that overlap are blended as if each lay
// note: whole before or behind the other. In half floats a particle of an optical depth below 2.4e-4 dims nothing.
// binding camera: the camera, perspective or orthographic.
// binding light: the directional light of the map.
// binding lighting: how the medium scatters.
// binding particles: the particles.
// binding order: numbers of particles, from the farthest to the nearest.
// binding transmittances: from the light to each particle, 0..1; negative for what is dropped.
// binding depth: depth buffer of the picture, a depth format or r32float; values that are not finite count as far.

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

/// Vector from `point`, metres in the world, TOWARDS the viewer, of any length: to the eye, or against the parallel
/// rays of an orthographic camera.
fn towards_viewer(camera: Camera, point: vec3<f32>) -> vec3<f32> {
    let parallel = camera.world_from_clip[2].xyz * (camera.near_depth - camera.far_depth);
    return select(camera.eye - point, parallel, camera.projection == ORTHOGRAPHIC);
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

/// Row `index` of a matrix, as a vector.
fn matrix_row(matrix: mat4x4<f32>, index: u32) -> vec4<f32> {
    return vec4<f32>(matrix[0][index], matrix[1][index], matrix[2][index], matrix[3][index]);
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

// ---- airlight::transmittance::medium ----
// summary: Single scattering of a directional light along a view ray through a medium of varying extinction.
// source: the equation of radiative transfer without multiple scattering; Gautron et al. (2011) for what lights a step.

/// How a medium scatters light. 32 bytes.
struct MediumLighting {
    /// Single-scattering albedo, 0..1 for each colour.
    albedo: vec3<f32>,
    /// Mean cosine of the Henyey-Greenstein phase function, -0.999..0.999.
    g: f32,
    /// View rays end here if they meet nothing nearer, metres, positive.
    distance_limit: f32,
    reserved_a: f32,
    reserved_b: f32,
    reserved_c: f32,
}

/// The greatest half float.
const GREATEST_RADIANCE: f32 = 65504.0;

/// What was met on a view ray from the eye up to a place.
struct Marched {
    /// Sum of T_eye (1 - exp(-tau)) T_light over the steps, 0..1: the share of `source_radiance` that reaches the eye.
    scattered: f32,
    /// Transmittance from the eye to that place, 0..1.
    transmittance: f32,
}

/// Linear RGB radiance of an opaque medium in full light. `light_radiance`: irradiance of the light at normal incidence;
/// `cosine`: view direction times direction TOWARDS the light.
fn source_radiance(lighting: MediumLighting, light_radiance: vec3<f32>, cosine: f32) -> vec3<f32> {
    return lighting.albedo * light_radiance * henyey_greenstein(cosine, lighting.g);
}

/// Nothing was met yet.
fn marched_nothing() -> Marched {
    return Marched(0.0, 1.0);
}

/// With a step of `optical_depth` more, from 0 up. `light_transmittance`: from the light to it, 0..1.
fn marched_on(before: Marched, optical_depth: f32, light_transmittance: f32) -> Marched {
    let scattered = one_minus_exp(optical_depth);
    return Marched(
        before.scattered + before.transmittance * scattered * light_transmittance,
        before.transmittance * (1.0 - scattered)
    );
}

/// A pixel: premultiplied radiance, and transmittance to the background in alpha. `source`: of `source_radiance`.
fn medium_pixel(source: vec3<f32>, marched: Marched) -> vec4<f32> {
    let radiance = clamp(source * marched.scattered, vec3<f32>(0.0), vec3<f32>(GREATEST_RADIANCE));
    return vec4<f32>(radiance, clamp(marched.transmittance, 0.0, 1.0));
}

// ---- airlight::transmittance::particles ----
// summary: Particles of a medium as seen from a light: which are dropped, and the stretch of each that a light ray passes.
// source: Gautron et al., "Extinction transmittance maps" (2011), Eq. 1: depth x_i and traversal distance d_i of each.

/// A particle. 32 bytes.
struct Particle {
    /// Of the middle, metres in the world.
    position: vec3<f32>,
    /// Metres, positive, at most the range of the map.
    radius: f32,
    /// 1/m, from 0 up.
    extinction: f32,
    reserved_a: f32,
    reserved_b: f32,
    reserved_c: f32,
}

/// In texels. Every ball meets the middle of a texel; of the radii below 1.7 this one keeps the sum best.
const LEAST_RADIUS: f32 = 1.25;
/// Greatest optical depth of a stretch: a transmittance of 1e-28.
const GREATEST_DEPTH: f32 = 64.0;

// ---- airlight::transmittance::seen_particles ----
// summary: Particles of a medium as seen from the eye: their order, outlines, and what of them a view ray passes.
// source: the balls of transmittance/particles, seen along view rays instead of light rays.

/// A particle before the eye.
struct SeenBall {
    /// Of the middle, metres in the world.
    middle: vec3<f32>,
    /// Radius of its outline, metres.
    reach: f32,
    /// Half its length along a view ray through the middle, metres.
    radius: f32,
    /// Optical depth along that ray.
    optical_depth: f32,
}

/// The particle before the camera.
fn seen_ball(camera: Camera, particle: Particle) -> SeenBall {
    let w = dot(matrix_row(camera.clip_from_world, 3u), vec4<f32>(particle.position, 1.0));
    let columns = length(matrix_row(camera.clip_from_world, 0u).xyz) * camera.viewport.x;
    let rows = length(matrix_row(camera.clip_from_world, 1u).xyz) * camera.viewport.y;
    let pixel = 2.0 * max(w, 0.0) / max(min(columns, rows), 1e-12);
    let reach = max(particle.radius, LEAST_RADIUS * pixel);
    let thinned = (particle.radius / reach) * (particle.radius / reach);
    let optical_depth = min(2.0 * particle.radius * particle.extinction * thinned, GREATEST_DEPTH);
    return SeenBall(particle.position, reach, particle.radius, optical_depth);
}

/// Clip position of a corner of a square around the outline, of no depth of its own. `side`: -1 or 1 across and up.
fn outline_corner(camera: Camera, ball: SeenBall, side: vec2<f32>) -> vec4<f32> {
    let towards = towards_viewer(camera, ball.middle);
    let parallel = camera.projection == ORTHOGRAPHIC;
    let square = dot(towards, towards);
    let own = ball.reach * ball.reach;
    // In the plane through the middle the cone of rays that touch the ball is wider than the ball.
    let wider = select(sqrt(square / max(square - own, 0.05 * own)), 1.0, parallel);
    let axis = towards * inverseSqrt(max(square, 1e-30));
    let pole = select(vec3<f32>(1.0, 0.0, 0.0), vec3<f32>(0.0, 1.0, 0.0), abs(axis.y) < 0.9);
    let across = normalize(cross(pole, axis));
    let point = ball.middle + ball.reach * wider * (side.x * across + side.y * cross(axis, across));
    let clip = camera.clip_from_world * vec4<f32>(point, 1.0);
    // From inside, and from so near that the square would be far larger than the ball: the whole picture.
    let apart = parallel || square > 1.1 * own;
    return select(vec4<f32>(side, 0.5, 1.0), vec4<f32>(clip.xy, 0.5 * clip.w, clip.w), apart);
}

/// Optical depth of the part of the ball that the view ray passes up to `distance` metres; 0 where it passes by.
fn seen_optical_depth(ball: SeenBall, ray: Ray, distance: f32) -> f32 {
    let between = ball.middle - ray.origin;
    let along = dot(between, ray.direction);
    let off = (between - along * ray.direction) / max(ball.reach, 1e-15);
    let chord = sqrt(max(1.0 - dot(off, off), 0.0));
    let whole = max(2.0 * chord * ball.radius, 1e-30);
    let before_surface = clamp(0.5 + (distance - along) / whole, 0.0, 1.0);
    let behind_eye = clamp(0.5 - along / whole, 0.0, 1.0);
    return ball.optical_depth * chord * max(before_surface - behind_eye, 0.0);
}

// ---- transmittance/render_particles ----

@group(0) @binding(0) var<uniform> camera: Camera;
@group(0) @binding(1) var<uniform> light: Light;
@group(0) @binding(2) var<uniform> lighting: MediumLighting;
@group(0) @binding(3) var<storage, read> particles: array<Particle>;
@group(0) @binding(4) var<storage, read> order: array<u32>;
@group(0) @binding(5) var<storage, read> transmittances: array<f32>;
@group(0) @binding(6) var depth: texture_2d<f32>;

struct Corner {
    @builtin(position) clip: vec4<f32>,
    @location(0) @interpolate(flat) middle_and_reach: vec4<f32>,
    @location(1) @interpolate(flat) along: vec4<f32>,
}

@vertex
fn vertex_particle(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> Corner {
    let number = min(order[min(instance, arrayLength(&order) - 1u)], arrayLength(&particles) - 1u);
    let lit = transmittances[min(number, arrayLength(&transmittances) - 1u)];
    let kept = lit >= 0.0;
    let ball = seen_ball(camera, particles[number]);
    // Corners 0 1 2 and 2 1 3 of a square.
    let corner = select(vertex, select(5u - vertex, 3u, vertex > 4u), vertex > 2u);
    let side = vec2<f32>(select(-1.0, 1.0, (corner & 1u) == 1u), select(-1.0, 1.0, corner > 1u));
    let clip = outline_corner(camera, ball, side);
    // What is dropped has no area, and lies beside the picture.
    return Corner(
        select(vec4<f32>(-2.0, -2.0, 0.5, 1.0), clip, kept),
        select(vec4<f32>(0.0, 0.0, 0.0, 1.0), vec4<f32>(ball.middle, ball.reach), kept),
        select(vec4<f32>(0.0), vec4<f32>(ball.radius, ball.optical_depth, lit, 0.0), kept)
    );
}

@fragment
fn fragment_particle(corner: Corner) -> @location(0) vec4<f32> {
    let ndc = ndc_from_pixel(camera, corner.clip.xy);
    let ray = view_ray(camera, ndc);
    let given = textureLoad(depth, vec2<u32>(corner.clip.xy), 0).x;
    let at_depth = clamp(finite_or(given, camera.far_depth), 0.0, 1.0);
    let distance = distance_from_depth(camera, ray, ndc, at_depth, lighting.distance_limit);
    let ball = SeenBall(corner.middle_and_reach.xyz, corner.middle_and_reach.w, corner.along.x, corner.along.y);
    let met = marched_on(marched_nothing(), seen_optical_depth(ball, ray, distance), corner.along.z);
    return medium_pixel(source_radiance(lighting, light.radiance, dot(ray.direction, light.direction)), met);
}
