// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: transmittance/march_volume, permutation coefficients_16 (COEFFICIENTS=16 LINEAR)
// summary: Picture of a volume lit through a transmittance map: view rays are marched from the eye.
// source: Gautron et al., "Extinction transmittance maps" (2011), Eq. 3 for the light of each step.
// note: Steps are of a voxel at most and of equal length from where the ray enters the volume to where it leaves it or meets
// note: the surface; a march ends where less than LEAST_TRANSMITTANCE is left. Alpha is the transmittance to the background.
// note: Runs of samples among empty bricks are passed over; what is found is the same without them.
// note: REFERENCE marches to the light from every step, by steps of a voxel: what maps are measured against.
// note: A depth that is not finite counts as far; extinctions that are not finite or negative as 0.
// definition COEFFICIENTS: numbers a texel, four a layer: 4, 8 or 16, of the moments 8; 4 where it is not given.
// definition LINEAR: trilinear reads of the volume; else the nearest voxel.
// binding coefficients: the layers of the map, rgba32float or rgba16float; not with REFERENCE.
// binding camera: the camera, perspective or orthographic.
// binding light: the directional light, of the map.
// binding lighting: how the medium scatters.
// binding volume: where the volume lies.
// binding extinction: the volume, any float format; with LINEAR one that filters.
// binding volume_sampler: linear, clamped to the edge; with LINEAR only.
// binding brick_distances: of core/brick_distances, for the volume; or a single 0.
// binding depth: depth buffer of the picture, a depth format or r32float.
// binding picture: out of the compute entry point (the fragment entry point returns it), rgba16float: premultiplied linear RGB radiance, and in alpha the transmittance to the background.

// ---- airlight::core::bricks ----
// summary: Bricks of voxels over a volume, by which a march passes over empty space without a change of what it meets.
// source: Levoy, "Efficient ray tracing of volume data" (1990); distances after Cohen and Sheffer, "Proximity clouds" (1994).

/// Voxels along a brick.
const BRICK: u32 = 8u;
/// What samples of a march may lie beyond the place that they are reckoned to be, in samples.
const MARGIN: f32 = 0.01;

/// Bricks along each axis of a volume of `size` voxels.
fn brick_count(size: vec3<u32>) -> vec3<u32> {
    return (size + vec3<u32>(BRICK - 1u)) / BRICK;
}

/// The brick of a place in unit space; outside of the volume the nearest inside.
fn brick_at(unit: vec3<f32>, size: vec3<u32>) -> vec3<u32> {
    let last = vec3<f32>(max(brick_count(size), vec3<u32>(1u)) - 1u);
    return vec3<u32>(clamp(floor(unit * vec3<f32>(size) / f32(BRICK)), vec3<f32>(0.0), last));
}

/// How many samples of a march, with that at `unit`, lie among bricks that are alike: in this one if it is occupied
/// (`distance` 0), else among the empty ones around it. At least 1. `step`: from sample to sample, in unit space.
fn samples_alike(unit: vec3<f32>, step: vec3<f32>, size: vec3<u32>, distance: u32) -> u32 {
    let side = f32(BRICK) / vec3<f32>(size);
    let brick = vec3<f32>(brick_at(unit, size));
    let reach = f32(max(distance, 1u));
    let wall = side * select(brick - (reach - 1.0), brick + reach, step > vec3<f32>(0.0));
    let still = abs(step) < vec3<f32>(1e-12);
    let samples = select((wall - unit) / select(step, vec3<f32>(1.0), still), vec3<f32>(8192.0), still);
    return 1u + u32(clamp(min(min(samples.x, samples.y), samples.z) - MARGIN, 0.0, 8192.0));
}

/// Samples of a march that lie among bricks that are alike.
struct Run {
    /// The first that may hold something; `end` where none does.
    begin: u32,
    /// The first of the next run.
    end: u32,
}

/// The run that begins with sample `i` of `steps`, at `unit`. `distances`: of the bricks of a volume of `size` voxels; `step`:
/// from sample to sample, in unit space.
fn run_of_samples(
    distances: texture_3d<u32>, size: vec3<u32>, unit: vec3<f32>, step: vec3<f32>, i: u32, steps: u32
) -> Run {
    let brick = min(brick_at(unit, size), textureDimensions(distances) - 1u);
    let distance = textureLoad(distances, brick, 0).x;
    let end = min(i + samples_alike(unit, step, size, distance), steps);
    return Run(select(end, i, distance == 0u), end);
}

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

const PI: f32 = 3.141592653589793;

/// (sin, cos) of pi times `half_turns`, exact reduction for large arguments.
fn sine_cosine(half_turns: f32) -> vec2<f32> {
    let angle = PI * (half_turns - 2.0 * round(0.5 * half_turns));
    return vec2<f32>(sin(angle), cos(angle));
}

/// (sin, cos) of the sum of two angles given by (sin, cos).
fn rotate(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    return vec2<f32>(a.x * b.y + a.y * b.x, a.y * b.y - a.x * b.x);
}

// ---- airlight::core::cosine_basis ----
// summary: Cosines of whole multiples of a depth, their integrals and means, four orders at a time.
// source: Gautron et al., "Extinction transmittance maps" (SIGGRAPH Asia 2011 sketches), Eq. 1 and 3.

const ROOT_OF_TWO: f32 = 1.4142135623730951;

/// Cosines and sines of four angles, and the rotation that leads to the next four.
struct Harmonics {
    /// Cosines.
    cosine: vec4<f32>,
    /// Sines.
    sine: vec4<f32>,
    /// Sine and cosine of the angle from one group to the next.
    turn: vec2<f32>,
}

/// Orders 0 to 3 of pi times `depth`.
fn harmonics_first(depth: f32) -> Harmonics {
    let one = sine_cosine(depth);
    let two = rotate(one, one);
    let three = rotate(two, one);
    return Harmonics(
        vec4<f32>(1.0, one.y, two.y, three.y), vec4<f32>(0.0, one.x, two.x, three.x), rotate(two, two)
    );
}

/// The next group.
fn harmonics_next(at: Harmonics) -> Harmonics {
    return Harmonics(
        at.cosine * at.turn.y - at.sine * at.turn.x, at.sine * at.turn.y + at.cosine * at.turn.x, at.turn
    );
}

/// Orders 4 g .. 4 g + 3 of a group.
fn cosine_orders(group: u32) -> vec4<f32> {
    return f32(4u * group) + vec4<f32>(0.0, 1.0, 2.0, 3.0);
}

/// B_j of a group, the integrals of b_j from 0 to `depth`. `at`: of the same depth.
fn cosine_integral(at: Harmonics, depth: f32, group: u32) -> vec4<f32> {
    let orders = cosine_orders(group);
    let scale = ROOT_OF_TWO / (PI * max(orders, vec4<f32>(1.0)));
    return select(scale * at.sine, vec4<f32>(depth), orders < vec4<f32>(0.5));
}

/// The Fejer window of a series of `count` coefficients: 1 - j / count. What was not negative stays so.
fn fejer_window(group: u32, count: u32) -> vec4<f32> {
    return max(1.0 - cosine_orders(group) / f32(count), vec4<f32>(0.0));
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

// ---- airlight::core::volume ----
// summary: A volume in the world: its box, voxels and how a ray passes it.
// source: none; the slab test of ray tracing.

/// A volume in the world. 144 bytes.
struct VolumeSpace {
    /// World, metres, to unit space; affine.
    unit_from_world: mat4x4<f32>,
    /// Its inverse.
    world_from_unit: mat4x4<f32>,
    /// What values of the texture are multiplied by: to give extinction in 1/m, say; from 0 up.
    value_scale: f32,
    /// Metres from one sample of a march to the next at most, positive: a voxel.
    step_length: f32,
    reserved_a: f32,
    reserved_b: f32,
}

/// Most samples of a march through one volume.
const MOST_STEPS: f32 = 8192.0;

/// The part of a segment that lies in the box: from and to, 0..1; equal where it misses. `origin`, `along`: of the
/// segment, in unit space.
fn segment_in_box(origin: vec3<f32>, along: vec3<f32>) -> vec2<f32> {
    let still = abs(along) < vec3<f32>(1e-20);
    let safe = select(along, vec3<f32>(1.0), still);
    let a = -origin / safe;
    let b = (vec3<f32>(1.0) - origin) / safe;
    let inside = (origin >= vec3<f32>(0.0)) & (origin <= vec3<f32>(1.0));
    let enters = select(min(a, b), vec3<f32>(0.0), still);
    let leaves = select(max(a, b), select(vec3<f32>(-1.0), vec3<f32>(1.0), inside), still);
    let begins = max(max(enters.x, enters.y), max(enters.z, 0.0));
    return vec2<f32>(begins, max(begins, min(min(leaves.x, leaves.y), min(leaves.z, 1.0))));
}

/// How many samples a march of `metres` takes.
fn march_steps(metres: f32, volume: VolumeSpace) -> u32 {
    // A whole number of voxels stays that number.
    return u32(clamp(ceil(metres / max(volume.step_length, 1e-6) - 1e-3), 1.0, MOST_STEPS));
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

// ---- airlight::transmittance::extinction_map ----
// summary: Extinction transmittance maps: extinction along a light ray as a cosine series, transmittance from its integral.
// source: Gautron, Delalandre, Marvie, "Extinction transmittance maps" (SIGGRAPH Asia 2011 sketches), Eq. 1 to 3.

/// Optical depth from the near side to `depth` 0..1, which ringing may make negative. `layers`: of the map, four
/// coefficients each. `monotone`: 1 for the Fejer window, 0 for the plain series.
fn extinction_optical_depth(
    map: texture_2d_array<f32>, place: Footprint, depth: f32, layers: u32, monotone: f32
) -> f32 {
    let inside = clamp(depth, 0.0, 1.0);
    var at = harmonics_first(inside);
    var sum = 0.0;
    for (var group = 0u; group < layers; group++) {
        let window = mix(vec4<f32>(1.0), fejer_window(group, 4u * layers), monotone);
        sum += dot(mixed_texel(map, place, group) * window, cosine_integral(at, inside, group));
        at = harmonics_next(at);
    }
    return sum;
}

/// Transmittance 0..1 of an optical depth; 1 where that is negative.
fn transmittance_of(optical_depth: f32) -> f32 {
    return exp(-max(optical_depth, 0.0));
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

/// More than any extinction may be, 1/m.
const GREATEST_EXTINCTION: f32 = 1e6;

/// Extinction in 1/m of a value of the volume's texture; 0 for what is not finite or negative.
fn extinction_of_value(value: f32, volume: VolumeSpace) -> f32 {
    return clamp(finite_or(value * volume.value_scale, 0.0), 0.0, GREATEST_EXTINCTION);
}

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

// ---- airlight::transmittance::transmittance_map ----
// summary: Callback: transmittance from a directional light to a place in its map, by whichever form the pass was built for.
// source: Gautron et al. (2011), Jansen and Bavoil (2010), Delalandre et al. (2011), Muenstermann et al. (2018).

@group(0) @binding(0) var coefficients: texture_2d_array<f32>;

const LAYERS: u32 = u32(16) / 4u;
const WINDOW: f32 = 0.0;

/// Columns and rows of the map.
fn transmittance_map_size() -> vec2<u32> {
    return textureDimensions(coefficients);
}

/// Transmittance of a footprint at `depth`, 0..1.
fn footprint_transmittance(at: Footprint, depth: f32) -> f32 {
    return transmittance_of(extinction_optical_depth(coefficients, at, depth, LAYERS, WINDOW));
}

/// Transmittance 0..1 from the light to a place in its map. `place`: texels, texel i at i + 0.5; `depth`: 0 on the near
/// side of the range, 1 on the far side; as light_space gives them.
fn transmittance(place: vec2<f32>, depth: f32) -> f32 {
    let size = transmittance_map_size();
    let inside = all(place >= vec2<f32>(0.0)) && all(place <= vec2<f32>(size)) && depth > 0.0;
    let at = footprint(size, place);
    return select(1.0, footprint_transmittance(at, depth), inside);
}

// ---- transmittance/march_volume ----

@group(0) @binding(2) var<uniform> camera: Camera;
@group(0) @binding(3) var<uniform> light: Light;
@group(0) @binding(4) var<uniform> lighting: MediumLighting;
@group(0) @binding(5) var<uniform> volume: VolumeSpace;
@group(0) @binding(6) var extinction: texture_3d<f32>;
@group(0) @binding(7) var volume_sampler: sampler;
@group(0) @binding(8) var depth: texture_2d<f32>;
@group(0) @binding(9) var picture: texture_storage_2d<rgba16float, write>;

@group(0) @binding(10) var brick_distances: texture_3d<u32>;

/// What lies behind so little of the ray's light is not marched.
const LEAST_TRANSMITTANCE: f32 = 1e-4;
/// Marches to the light end at this optical depth.
const DARK: f32 = 16.0;

/// Extinction at a place in unit space, 1/m.
fn extinction_at(unit: vec3<f32>) -> f32 {
    return extinction_of_value(textureSampleLevel(extinction, volume_sampler, unit, 0.0).x, volume);
}

/// Premultiplied radiance of a pixel, and transmittance to its background.
fn pixel_light(pixel: vec2<u32>) -> vec4<f32> {
    let ndc = ndc_from_pixel(camera, vec2<f32>(pixel) + 0.5);
    let ray = view_ray(camera, ndc);
    let at_depth = clamp(finite_or(textureLoad(depth, pixel, 0).x, camera.far_depth), 0.0, 1.0);
    let distance = distance_from_depth(camera, ray, ndc, at_depth, lighting.distance_limit);
    let origin = (volume.unit_from_world * vec4<f32>(ray.origin, 1.0)).xyz;
    let along = (volume.unit_from_world * vec4<f32>(distance * ray.direction, 0.0)).xyz;
    let part = segment_in_box(origin, along);
    let metres = (part.y - part.x) * distance;
    let steps = march_steps(metres, volume);
    let enters = origin + part.x * along;
    let leaves = origin + part.y * along;
    // A directional light's map is affine, so that places in it lie evenly along the ray.
    let size = vec2<f32>(transmittance_map_size());
    let map_enters = map_position(light, size, ray.origin + part.x * distance * ray.direction);
    let map_leaves = map_position(light, size, ray.origin + part.y * distance * ray.direction);
    var marched = marched_nothing();
    let step = (leaves - enters) / f32(steps);
    for (var next = 0u; next < steps && marched.transmittance > LEAST_TRANSMITTANCE;) {
        let first = mix(enters, leaves, (f32(next) + 0.5) / f32(steps));
        let run = run_of_samples(brick_distances, textureDimensions(extinction), first, step, next, steps);
        for (var i = run.begin; i < run.end && marched.transmittance > LEAST_TRANSMITTANCE; i++) {
            let share = (f32(i) + 0.5) / f32(steps);
            let unit = mix(enters, leaves, share);
            let optical_depth = extinction_at(unit) * metres / f32(steps);
            let at = mix(map_enters, map_leaves, share);
            let lit = transmittance(at.xy, at.z);
            marched = marched_on(marched, optical_depth, lit);
        }
        next = run.end;
    }
    return medium_pixel(source_radiance(lighting, light.radiance, dot(ray.direction, light.direction)), marched);
}

@compute @workgroup_size(16, 8)
fn march_volume(@builtin(global_invocation_id) id: vec3<u32>) {
    if all(id.xy < textureDimensions(picture)) {
        textureStore(picture, id.xy, pixel_light(id.xy));
    }
}

@vertex
fn vertex_picture(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return picture_corner(index);
}

@fragment
fn fragment_march_volume(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return pixel_light(vec2<u32>(position.xy));
}
