// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: transmittance/check_particles, permutation default
// summary: Counts the particles that the splatting passes keep and drop.
// source: none; bad input is dropped, and that is reported.
// binding light: the directional light of the map.
// binding splat: size of the map, number of particles.
// binding particles: the particles.
// binding counts: out, how many are kept, not finite, of an impossible radius, of negative extinction, outside of the map; zeros before.

// ---- airlight::core::finite ----
// summary: Replaces NaN and infinities in data that comes from outside.
// source: IEEE 754 binary32: all exponent bits set means NaN or infinity.

/// True if `x` is neither NaN nor infinite.
fn is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u;
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

// ---- transmittance/check_particles ----

@group(0) @binding(0) var<uniform> light: Light;
@group(0) @binding(1) var<uniform> splat: SplatTarget;
@group(0) @binding(2) var<storage, read> particles: array<Particle>;
@group(0) @binding(3) var<storage, read_write> counts: array<atomic<u32>>;

@compute @workgroup_size(64)
fn count_particles(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let index = id.x + id.y * groups.x * 64u;
    if index >= min(splat.count, arrayLength(&particles)) {
        return;
    }
    let particle = particles[index];
    let defect = particle_defect(particle, ball_in_map(particle, light, splat.size), splat.size);
    atomicAdd(&counts[min(defect, arrayLength(&counts) - 1u)], 1u);
}
