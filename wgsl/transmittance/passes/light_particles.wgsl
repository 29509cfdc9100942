// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Light at each particle through a transmittance map, and keys that sort particles back to front.
// source: Gautron et al., "Extinction transmittance maps" (2011), Eq. 3.
// note: Before `render_particles`: this pass, then `core/sort` of `keys` and `order`, 32 bits.
// note: A particle is lit as its middle is, the near half of its own extinction included. What a map does not take is dropped:
// note: it comes last, with the transmittance -1. Particles of the same depth keep their order.
// note: With REFERENCE, `light_particles` is followed by `sum_particles`: for each particle all others, whatever their number, so that
// note: its cost grows with the square of it. Balls count whole then, not widened and not cut to the range of the map.
// definition REFERENCE: optical depths summed over all particles instead of a map: what maps are measured against.
// definition COEFFICIENTS: numbers a texel, four a layer: 4, 8 or 16, of the moments 8; 4 where it is not given.
// definition FUNCTION: transmittance function map; without this and the next four an extinction map of cosines.
// definition PERIODIC: the series of the full period instead of cosines: a Fourier opacity map, or with FUNCTION.
// definition POWER: six power moments.
// definition TRIGONOMETRIC: two trigonometric moments.
// definition BOUNDED: an extinction map over the occupied interval of each texel.
// definition MONOTONE: with the Fejer window, extinction maps only.
// definition FILTERED: bilinear means are read through a sampler: for maps of rgba16float, not BOUNDED.
// definition NEAREST: the nearest texel instead of a bilinear read.
// binding coefficients: the layers of the map, rgba32float or rgba16float; not with REFERENCE.
// binding map_sampler: linear, clamped to the edge; with FILTERED only.
// binding intervals: least and greatest occupied depth, 0..1, rg32float; with BOUNDED only.
// binding camera: the camera, perspective or orthographic.
// binding light: the directional light of the map.
// binding splat: size of the map, number of particles; with REFERENCE the size that tells what lies outside.
// binding particles: the particles.
// binding keys: out, ascending from the farthest to the nearest.
// binding order: out, the number of each particle.
// binding transmittances: out, from the light to each, 0..1; -1 for what is dropped.

#import airlight::core::camera::Camera
#import airlight::core::light::Light
#import airlight::core::sort::ascending_key
#import airlight::transmittance::particles::{
    Particle, SplatTarget, ball_in_map, particle_defect, optical_depth_towards, PARTICLE_KEPT
}
#import airlight::transmittance::seen_particles::view_depth
#ifndef REFERENCE
#import airlight::transmittance::transmittance_map::transmittance
#endif

@group(#{GROUP}) @binding(2) var<uniform> camera: Camera;
@group(#{GROUP}) @binding(3) var<uniform> light: Light;
@group(#{GROUP}) @binding(4) var<uniform> splat: SplatTarget;
@group(#{GROUP}) @binding(5) var<storage, read> particles: array<Particle>;
@group(#{GROUP}) @binding(6) var<storage, read_write> keys: array<u32>;
@group(#{GROUP}) @binding(7) var<storage, read_write> order: array<u32>;
@group(#{GROUP}) @binding(8) var<storage, read_write> transmittances: array<f32>;

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
#ifdef REFERENCE
    transmittances[index] = select(-1.0, 1.0, kept);
#else
    let middle = select(vec2<f32>(0.0), ball.middle, kept);
    transmittances[index] = select(-1.0, transmittance(middle, select(0.0, ball.depth, kept)), kept);
#endif
}

#ifdef REFERENCE
@compute @workgroup_size(64)
fn sum_particles(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let index = id.x + id.y * groups.x * 64u;
    let count = particle_count();
    if index >= count || keys[min(index, count - 1u)] == LAST_KEY {
        return;
    }
    let point = particles[index].position;
    var sum = 0.0;
    for (var i = 0u; i < count; i++) {
        if keys[i] != LAST_KEY {
            sum += optical_depth_towards(particles[i], point, light.direction);
        }
    }
    transmittances[index] = exp(-sum);
}
#endif
