// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: transmittance/light_particles, permutation filtered (COEFFICIENTS=4 FILTERED)
// summary: Light at each particle through a transmittance map, and keys that sort particles back to front.
// source: Gautron et al., "Extinction transmittance maps" (2011), Eq. 3.
// note: Before `render_particles`: this pass, then `core/sort` of `keys` and `order`, 32 bits.
// note: A particle is lit as its middle is, the near half of its own extinction included. What a map does not take is dropped:
// note: it comes last, with the transmittance -1. Particles of the same depth keep their order.
// note: With REFERENCE, `light_particles` is followed by `sum_particles`: for each particle all others, whatever their number, so that
// note: its cost grows with the square of it. Balls count whole then, not widened and not cut to the range of the map.
// definition COEFFICIENTS: numbers a texel, four a layer: 4, 8 or 16, of the moments 8; 4 where it is not given.
// definition FILTERED: bilinear means are read through a sampler: for maps of rgba16float, not BOUNDED.
// binding coefficients: the layers of the map, rgba32float or rgba16float; not with REFERENCE.
// binding map_sampler: linear, clamped to the edge; with FILTERED only.
// binding camera: the camera, perspective or orthographic.
// binding light: the directional light of the map.
// binding splat: size of the map, number of particles; with REFERENCE the size that tells what lies outside.
// binding particles: the particles.
// binding keys: out, ascending from the farthest to the nearest.
// binding order: out, the number of each particle.
// binding transmittances: out, from the light to each, 0..1; -1 for what is dropped.

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

// ---- airlight::core::sort ----
// summary: Keys of a radix sort, and sixteen counters of 16 bits in eight words.
// source: D. Merrill and A. Grimshaw, "High performance and scalable radix sorting" (2011); M. Herf, "Radix tricks" (2001).

/// A key that sorts as the number does: ascending, -0 before 0. NaNs lie beyond the infinities, by their sign.
fn ascending_key(value: f32) -> u32 {
    let bits = bitcast<u32>(value);
    return bits ^ select(0x80000000u, 0xffffffffu, bits >= 0x80000000u);
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

/// The range d of the map, metres: how far apart depths 0 and 1 are.
fn map_range(light: Light) -> f32 {
    return length(light.world_from_clip[2].xyz);
}

/// Texels to the metre, across and down the map, whose sides lie across the light.
fn texels_per_metre(light: Light, size: vec2<f32>) -> vec2<f32> {
    let across = vec2<f32>(length(light.world_from_clip[0].xyz), length(light.world_from_clip[1].xyz));
    return 0.5 * size / max(across, vec2<f32>(1e-12));
}

// ---- airlight::transmittance::map_texels ----
// summary: Callback: the texels of a map around a place, and bilinear means of their layers.
// source: none; rgba32float is not filterable in core WebGPU, so that means are taken by loads but with FILTERED.

@group(0) @binding(11) var map_sampler: sampler;

/// The four texels of a bilinear read.
struct Footprint {
    /// First and second column.
    columns: vec2<u32>,
    /// First and second row.
    rows: vec2<u32>,
    /// Share of the second column and of the second row, 0..1.
    share: vec2<f32>,
    /// The place over the map, 0..1.
    uv: vec2<f32>,
}

/// The texels around `place`, texel i at i + 0.5; outside of the map of `size` texels the nearest inside.
fn footprint(size: vec2<u32>, place: vec2<f32>) -> Footprint {
    let last = size - vec2<u32>(1u);
    let at = clamp(place - 0.5, vec2<f32>(0.0), vec2<f32>(last));
    let begin = min(vec2<u32>(at), last);
    let next = min(begin + 1u, last);
    let share = at - vec2<f32>(begin);
    return Footprint(vec2<u32>(begin.x, next.x), vec2<u32>(begin.y, next.y), share, place / vec2<f32>(size));
}

/// Zeros for what is not finite.
fn finite_parts(value: vec4<f32>) -> vec4<f32> {
    return vec4<f32>(
        finite_or(value.x, 0.0), finite_or(value.y, 0.0), finite_or(value.z, 0.0), finite_or(value.w, 0.0)
    );
}

/// The bilinear mean of a layer; of one texel where the footprint has no other.
fn mixed_texel(map: texture_2d_array<f32>, at: Footprint, layer: u32) -> vec4<f32> {
    return finite_parts(textureSampleLevel(map, map_sampler, at.uv, layer, 0.0));
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

/// The map that particles are splatted into. 16 bytes.
struct SplatTarget {
    /// Columns and rows.
    size: vec2<f32>,
    /// Number of particles.
    count: u32,
    reserved: u32,
}

/// Nothing is wrong with it.
const PARTICLE_KEPT: u32 = 0u;
/// A number of it is NaN or infinite.
const PARTICLE_NOT_FINITE: u32 = 1u;
/// Its radius is not positive, or greater than the range of the map.
const PARTICLE_RADIUS: u32 = 2u;
/// Its extinction is negative.
const PARTICLE_EXTINCTION: u32 = 3u;
/// No part of it lies in the map.
const PARTICLE_OUTSIDE: u32 = 4u;
/// In texels. Every ball meets the middle of a texel; of the radii below 1.7 this one keeps the sum best.
const LEAST_RADIUS: f32 = 1.25;
/// Greatest optical depth of a stretch: a transmittance of 1e-28.
const GREATEST_DEPTH: f32 = 64.0;

/// A particle in the map.
struct Ball {
    /// Of the middle: texels across and down.
    middle: vec2<f32>,
    /// Half axes in texels.
    reach: vec2<f32>,
    /// Depth of the middle, 0..1 over the range.
    depth: f32,
    /// Radius over the range.
    radius: f32,
    /// Optical depth along a ray through the middle.
    optical_depth: f32,
}

/// The ball in a map of `size` texels.
fn ball_in_map(particle: Particle, light: Light, size: vec2<f32>) -> Ball {
    let at = map_position(light, size, particle.position);
    let own = particle.radius * texels_per_metre(light, size);
    let reach = max(own, vec2<f32>(LEAST_RADIUS));
    let thinned = (own.x / reach.x) * (own.y / reach.y);
    let optical_depth = min(2.0 * particle.radius * particle.extinction * thinned, GREATEST_DEPTH);
    return Ball(at.xy, reach, at.z, particle.radius / max(map_range(light), 1e-12), optical_depth);
}

/// Why a particle is dropped, one of PARTICLE_*. `ball`: the particle in a map of `size` texels.
fn particle_defect(particle: Particle, ball: Ball, size: vec2<f32>) -> u32 {
    let known = is_finite(particle.position.x) && is_finite(particle.position.y) && is_finite(particle.position.z)
        && is_finite(particle.radius) && is_finite(particle.extinction);
    let placed = is_finite(ball.middle.x) && is_finite(ball.middle.y) && is_finite(ball.depth);
    let beside = any(ball.middle + ball.reach < vec2<f32>(0.0)) || any(ball.middle - ball.reach > size);
    let outside = beside || ball.depth + ball.radius <= 0.0 || ball.depth - ball.radius >= 1.0;
    var defect = select(PARTICLE_KEPT, PARTICLE_OUTSIDE, outside || !placed);
    defect = select(defect, PARTICLE_EXTINCTION, particle.extinction < 0.0);
    defect = select(defect, PARTICLE_RADIUS, !(particle.radius > 0.0) || ball.radius > 1.0);
    return select(PARTICLE_NOT_FINITE, defect, known);
}

// ---- airlight::transmittance::seen_particles ----
// summary: Particles of a medium as seen from the eye: their order, outlines, and what of them a view ray passes.
// source: the balls of transmittance/particles, seen along view rays instead of light rays.

/// A number that grows with the depth of a point, metres in the world, before a camera; for a perspective one the
/// distance from the plane of the eye.
fn view_depth(camera: Camera, point: vec3<f32>) -> f32 {
    let clip = camera.clip_from_world * vec4<f32>(point, 1.0);
    return select(clip.w, clip.z * (camera.far_depth - camera.near_depth), camera.projection == ORTHOGRAPHIC);
}

// ---- airlight::transmittance::transmittance_map ----
// summary: Callback: transmittance from a directional light to a place in its map, by whichever form the pass was built for.
// source: Gautron et al. (2011), Jansen and Bavoil (2010), Delalandre et al. (2011), Muenstermann et al. (2018).

@group(0) @binding(0) var coefficients: texture_2d_array<f32>;

const LAYERS: u32 = u32(4) / 4u;
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

// ---- transmittance/light_particles ----

@group(0) @binding(2) var<uniform> camera: Camera;
@group(0) @binding(3) var<uniform> light: Light;
@group(0) @binding(4) var<uniform> splat: SplatTarget;
@group(0) @binding(5) var<storage, read> particles: array<Particle>;
@group(0) @binding(6) var<storage, read_write> keys: array<u32>;
@group(0) @binding(7) var<storage, read_write> order: array<u32>;
@group(0) @binding(8) var<storage, read_write> transmittances: array<f32>;

/// Of what is dropped.
const LAST_KEY: u32 = 0xffffffffu;

/// How many particles there are.
fn particle_count() -> u32 {
    let room = min(arrayLength(&keys), min(arrayLength(&order), arrayLength(&transmittances)));
    return min(splat.count, min(arrayLength(&particles), room));
}

@compute @workgroup_size(64)
fn light_particles(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let index = id.x + id.y * groups.x * 64u;
    if index >= particle_count() {
        return;
    }
    let particle = particles[index];
    let ball = ball_in_map(particle, light, splat.size);
    let kept = particle_defect(particle, ball, splat.size) == PARTICLE_KEPT;
    keys[index] = select(LAST_KEY, ascending_key(-view_depth(camera, particle.position)), kept);
    order[index] = index;
    let middle = select(vec2<f32>(0.0), ball.middle, kept);
    transmittances[index] = select(-1.0, transmittance(middle, select(0.0, ball.depth, kept)), kept);
}
