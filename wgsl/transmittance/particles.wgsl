// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::transmittance::particles
// summary: Particles of a medium as seen from a light: which are dropped, and the stretch of each that a light ray passes.
// source: Gautron et al., "Extinction transmittance maps" (2011), Eq. 1: depth x_i and traversal distance d_i of each.
// note: A particle is a ball of even extinction. A light ray at the distance r from its middle passes sqrt(R^2 - r^2) to both
// note: sides of the depth of the middle. Light rays go through the middles of texels. A ball with a radius of
// note: less than LEAST_RADIUS texels is widened to it, and thinned so that its extinction times volume stays: the
// note: sum over texels is then from 9 % below to 11 % above that of the ball, wherever it lies between them.
// note: What lies before or behind the range of the map is cut off. Along a ray a ball has at most GREATEST_DEPTH.
// equation: chord half = √(R² − r²);  τ = 2 R σ √(1 − r² / R²), thinned by (R / R')² where it is widened to R'
// error: balls within the budget of the map's precision; test transmittance/particles::balls_are_the_series_of_their_chords.
// error: the sum of a small ball from 10 % below to 12 % above; test transmittance/particles::small_balls_keep_their_extinction.
// parameter size: columns and rows of the map, texels.
// parameter texels: position of a light ray in the map, texel i at i + 0.5.
// parameter point: metres in the world.

#import airlight::core::finite::is_finite
#import airlight::core::light::Light
#import airlight::transmittance::light_space::{map_position, map_range, texels_per_metre}

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

/// A stretch of a light ray.
struct Stretch {
    /// Depth of its middle, 0..1 over the range.
    middle: f32,
    /// Half its length over the range.
    half: f32,
    /// Its optical depth; 0 where the ray passes by.
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

/// The stretch of the light ray at `texels` that a ball fills, cut to the range.
fn stretch_of_ball(ball: Ball, texels: vec2<f32>) -> Stretch {
    let offset = (texels - ball.middle) / ball.reach;
    let chord = sqrt(max(1.0 - dot(offset, offset), 0.0));
    let half = chord * ball.radius;
    let begins = clamp(ball.depth - half, 0.0, 1.0);
    let ends = clamp(ball.depth + half, 0.0, 1.0);
    let kept = (ends - begins) / max(2.0 * half, 1e-12);
    return Stretch(0.5 * (begins + ends), 0.5 * (ends - begins), ball.optical_depth * chord * clamp(kept, 0.0, 1.0));
}

/// Optical depth of the part of a ray from `point` on, metres in the world, that lies in the ball, without widening it.
/// `direction`: unit vector TOWARDS the light.
fn optical_depth_towards(particle: Particle, point: vec3<f32>, direction: vec3<f32>) -> f32 {
    let between = particle.position - point;
    let along = dot(between, direction);
    let off = (between - along * direction) / max(particle.radius, 1e-15);
    let half = particle.radius * sqrt(max(1.0 - dot(off, off), 0.0));
    let passed = max(along + half, 0.0) - max(along - half, 0.0);
    return min(particle.extinction * passed, GREATEST_DEPTH);
}
