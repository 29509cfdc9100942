// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: transmittance/splat_fixed, permutation coefficients_8 (COEFFICIENTS=8)
// summary: Splats particles into any additive map in fixed point: the result does not depend on their order at all.
// source: Gautron et al., "Extinction transmittance maps" (2011), Eq. 1.
// note: Whole numbers add up to the same sum in any order. A workgroup takes a particle and goes over the texels it covers; then
// note: `resolve` turns sums into layers. With BOUNDED, `occupy` finds the intervals first, by maxima of bit patterns,
// note: which are ordered as the positive floats are. FIXED_STEPS to a unit: each particle is off by at most half a step, and
// note: sums overflow beyond an optical depth of 5792. Overflows are counted.
// definition COEFFICIENTS: numbers a texel, four a layer: 4, 8 or 16, of the moments 8; 4 where it is not given.
// binding light: the directional light of the map.
// binding splat: size of the map, number of particles.
// binding particles: the particles.
// binding sums: one for each coefficient of each texel, zeros before `accumulate`.
// binding counts: the sixth number counts overflows.
// binding coefficients: out, the layers of the map.

// ---- airlight::core::finite ----
// summary: Replaces NaN and infinities in data that comes from outside.
// source: IEEE 754 binary32: all exponent bits set means NaN or infinity.

/// True if `x` is neither NaN nor infinite.
fn is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u;
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

/// b_j of a group at the depth of `at`.
fn cosine_basis(at: Harmonics, group: u32) -> vec4<f32> {
    return select(ROOT_OF_TWO * at.cosine, vec4<f32>(1.0), cosine_orders(group) < vec4<f32>(0.5));
}

/// sin(angle) / angle, 0..1 for angles up to pi. `sine`: of `angle`.
fn sine_over_angle(sine: vec4<f32>, angle: vec4<f32>) -> vec4<f32> {
    const third: f32 = 1.0 / 6.0;
    let square = angle * angle;
    // Where the angle is small the quotient loses what a sine loses.
    let near = 1.0 - third * square * (1.0 - 0.05 * square * (1.0 - square / 42.0));
    let safe = select(vec4<f32>(1.0), angle, abs(angle) > vec4<f32>(0.5));
    return select(near, sine / safe, abs(angle) > vec4<f32>(0.5));
}

/// What the cosines of a group at the middle of a stretch are multiplied by to give their means over it: the stretch
/// reaches `half` to both sides. `at_half`: the harmonics of `half`.
fn cosine_spread(at_half: Harmonics, half: f32, group: u32) -> vec4<f32> {
    return sine_over_angle(at_half.sine, PI * half * cosine_orders(group));
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

// ---- airlight::transmittance::extinction_map ----
// summary: Extinction transmittance maps: extinction along a light ray as a cosine series, transmittance from its integral.
// source: Gautron, Delalandre, Marvie, "Extinction transmittance maps" (SIGGRAPH Asia 2011 sketches), Eq. 1 to 3.

/// Coefficients of a group of a stretch of optical depth 1. `middle` and `extent`: harmonics of the depth of its middle and
/// of its half length, `half`, all over the range of the map.
fn extinction_coefficients(middle: Harmonics, extent: Harmonics, half: f32, group: u32) -> vec4<f32> {
    return cosine_basis(middle, group) * cosine_spread(extent, half, group);
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

// ---- airlight::transmittance::map_form ----
// summary: Callback: what a stretch of extinction adds to the layers of a map, by whichever form the pass was built for.
// source: the algorithm modules of the forms.

/// Layers of a map.
const LAYERS: u32 = u32(8) / 4u;

/// What a stretch of optical depth 1 adds to each layer.
struct Contribution {
    /// Layer by layer.
    layers: array<vec4<f32>, LAYERS>,
}

/// What the stretch around `middle`, `half` to both sides, 0..1 over the range or the interval, adds.
fn contribution(middle: f32, half: f32) -> Contribution {
    var all: Contribution;
    var at = harmonics_first(middle);
    var extent = harmonics_first(half);
    for (var layer = 0u; layer < LAYERS; layer++) {
        all.layers[layer] = extinction_coefficients(at, extent, half, layer);
        at = harmonics_next(at);
        extent = harmonics_next(extent);
    }
    return all;
}

// ---- transmittance/splat_fixed ----

@group(0) @binding(0) var<uniform> light: Light;
@group(0) @binding(1) var<uniform> splat: SplatTarget;
@group(0) @binding(2) var<storage, read> particles: array<Particle>;
@group(0) @binding(3) var<storage, read_write> sums: array<atomic<i32>>;
@group(0) @binding(4) var<storage, read_write> counts: array<atomic<u32>>;
@group(0) @binding(5) var coefficients: texture_storage_2d_array<rgba32float, write>;

const THREADS: u32 = 32u;
/// Of fixed point to a unit of optical depth.
const FIXED_STEPS: f32 = 262144.0;
const OVERFLOWED: u32 = 5u;
const BITS_OF_ONE: u32 = 0x3f800000u;
/// Zeros may be negative.
const NO_SIGN: u32 = 0x7fffffffu;

/// A particle in the map, and the texels that it covers.
struct Cover {
    /// The particle.
    ball: Ball,
    /// First column and row.
    first: vec2<u32>,
    /// How many of both; zeros where the particle is dropped.
    size: vec2<u32>,
}

/// What the particle of a workgroup covers of a map that has `room` texels at most; nothing for a workgroup beyond the last particle.
fn covered(group: vec3<u32>, groups: vec3<u32>, room: u32) -> Cover {
    let index = group.x + group.y * groups.x;
    let count = min(splat.count, arrayLength(&particles));
    let particle = particles[min(index, arrayLength(&particles) - 1u)];
    let ball = ball_in_map(particle, light, splat.size);
    let kept = index < count && particle_defect(particle, ball, splat.size) == PARTICLE_KEPT;
    let columns = clamp(splat.size.x, 1.0, f32(room));
    let fitting = vec2<f32>(columns, clamp(splat.size.y, 0.0, f32(room / max(u32(columns), 1u))));
    let last = fitting - 1.0;
    let begin = clamp(ceil(ball.middle - ball.reach - 0.5), vec2<f32>(0.0), fitting);
    let end = clamp(floor(ball.middle + ball.reach - 0.5), vec2<f32>(-1.0), last);
    let size = select(vec2<f32>(0.0), max(end - begin + 1.0, vec2<f32>(0.0)), kept);
    return Cover(ball, vec2<u32>(begin), vec2<u32>(size));
}

@compute @workgroup_size(THREADS)
fn accumulate(
    @builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32
) {
    let cover = covered(group, groups, arrayLength(&sums) / (4u * LAYERS));
    for (var i = thread; i < cover.size.x * cover.size.y; i += THREADS) {
        let texel = cover.first + vec2<u32>(i % cover.size.x, i / cover.size.x);
        let stretch = stretch_of_ball(cover.ball, vec2<f32>(texel) + 0.5);
        if stretch.optical_depth > 0.0 {
            let own = contribution(stretch.middle, stretch.half);
            let first = 4u * LAYERS * (texel.y * u32(splat.size.x) + texel.x);
            for (var layer = 0u; layer < LAYERS; layer++) {
                let added = vec4<i32>(round(FIXED_STEPS * stretch.optical_depth * own.layers[layer]));
                for (var channel = 0u; channel < 4u; channel++) {
                    let old = atomicAdd(&sums[min(first + 4u * layer + channel, arrayLength(&sums) - 1u)], added[channel]);
                    // The sum has another sign than both that were added.
                    let sum = old + added[channel];
                    if ((old ^ sum) & (added[channel] ^ sum)) < 0 {
                        atomicAdd(&counts[min(OVERFLOWED, arrayLength(&counts) - 1u)], 1u);
                    }
                }
            }
        }
    }
}

@compute @workgroup_size(16, 8)
fn resolve(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = min(vec2<u32>(splat.size), textureDimensions(coefficients));
    if any(id.xy >= size) {
        return;
    }
    let first = 4u * LAYERS * (id.y * u32(splat.size.x) + id.x);
    for (var layer = 0u; layer < LAYERS; layer++) {
        var sum = vec4<f32>(0.0);
        for (var channel = 0u; channel < 4u; channel++) {
            sum[channel] = f32(atomicLoad(&sums[min(first + 4u * layer + channel, arrayLength(&sums) - 1u)])) / FIXED_STEPS;
        }
        textureStore(coefficients, id.xy, layer, sum);
    }
}
