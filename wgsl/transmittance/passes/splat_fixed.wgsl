// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Splats particles into any additive map in fixed point: the result does not depend on their order at all.
// source: Gautron et al., "Extinction transmittance maps" (2011), Eq. 1.
// note: Whole numbers add up to the same sum in any order. A workgroup takes a particle and goes over the texels it covers; then
// note: `resolve` turns sums into layers. With BOUNDED, `occupy` finds the intervals first, by maxima of bit patterns,
// note: which are ordered as the positive floats are. FIXED_STEPS to a unit: each particle is off by at most half a step, and
// note: sums overflow beyond an optical depth of 5792. Overflows are counted.
// definition COEFFICIENTS: numbers a texel, four a layer: 4, 8 or 16, of the moments 8; 4 where it is not given.
// definition PERIODIC: the series of the full period instead of cosines: a Fourier opacity map.
// definition POWER: six power moments.
// definition TRIGONOMETRIC: two trigonometric moments.
// definition BOUNDED: an extinction map over the occupied interval of each texel.
// definition RGBA16FLOAT: half floats; not for moments, which need 32 bits.
// binding light: the directional light of the map.
// binding splat: size of the map, number of particles.
// binding particles: the particles.
// binding sums: one for each coefficient of each texel, zeros before `accumulate`.
// binding counts: the sixth number counts overflows.
// binding bounds: two a texel, zeros before `occupy`: 1 less the bits of the least occupied depth, and the bits of the greatest; with BOUNDED only.
// binding coefficients: out, the layers of the map.
// binding intervals: out, least and greatest occupied depth, 0..1; 1 and 0 where there is none. With BOUNDED only.

#import airlight::core::light::Light
#import airlight::transmittance::map_form::{contribution, LAYERS}
#import airlight::transmittance::particles::{
    Ball, Particle, SplatTarget, ball_in_map, particle_defect, stretch_of_ball, PARTICLE_KEPT
}
#ifdef BOUNDED
#import airlight::transmittance::bounded_map::{depth_in_interval, length_in_interval}
#endif

@group(#{GROUP}) @binding(0) var<uniform> light: Light;
@group(#{GROUP}) @binding(1) var<uniform> splat: SplatTarget;
@group(#{GROUP}) @binding(2) var<storage, read> particles: array<Particle>;
@group(#{GROUP}) @binding(3) var<storage, read_write> sums: array<atomic<i32>>;
@group(#{GROUP}) @binding(4) var<storage, read_write> counts: array<atomic<u32>>;
#ifdef RGBA16FLOAT
@group(#{GROUP}) @binding(5) var coefficients: texture_storage_2d_array<rgba16float, write>;
#else
@group(#{GROUP}) @binding(5) var coefficients: texture_storage_2d_array<rgba32float, write>;
#endif
#ifdef BOUNDED
@group(#{GROUP}) @binding(6) var<storage, read_write> bounds: array<atomic<u32>>;
@group(#{GROUP}) @binding(7) var intervals: texture_storage_2d<rg32float, write>;
#endif

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

#ifdef BOUNDED
@compute @workgroup_size(THREADS)
fn occupy(
    @builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32
) {
    let cover = covered(group, groups, arrayLength(&bounds) / 2u);
    for (var i = thread; i < cover.size.x * cover.size.y; i += THREADS) {
        let texel = cover.first + vec2<u32>(i % cover.size.x, i / cover.size.x);
        let stretch = stretch_of_ball(cover.ball, vec2<f32>(texel) + 0.5);
        if stretch.optical_depth > 0.0 {
            let at = 2u * (texel.y * u32(splat.size.x) + texel.x);
            let near = clamp(stretch.middle - stretch.half, 0.0, 1.0);
            let far = clamp(stretch.middle + stretch.half, 0.0, 1.0);
            atomicMax(&bounds[min(at, arrayLength(&bounds) - 1u)], BITS_OF_ONE - (bitcast<u32>(near) & NO_SIGN));
            atomicMax(&bounds[min(at + 1u, arrayLength(&bounds) - 1u)], bitcast<u32>(far) & NO_SIGN);
        }
    }
}

fn interval_of(texel: vec2<u32>) -> vec2<f32> {
    let at = 2u * (texel.y * u32(splat.size.x) + texel.x);
    let near = bitcast<f32>(BITS_OF_ONE - atomicLoad(&bounds[min(at, arrayLength(&bounds) - 1u)]));
    return vec2<f32>(near, bitcast<f32>(atomicLoad(&bounds[min(at + 1u, arrayLength(&bounds) - 1u)])));
}
#endif

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
#ifdef BOUNDED
            let interval = interval_of(texel);
            let own = contribution(
                depth_in_interval(interval, stretch.middle), length_in_interval(interval, stretch.half)
            );
#else
            let own = contribution(stretch.middle, stretch.half);
#endif
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
#ifdef BOUNDED
    textureStore(intervals, id.xy, vec4<f32>(interval_of(id.xy), 0.0, 0.0));
#endif
}
