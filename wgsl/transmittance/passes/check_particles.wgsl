// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Counts the particles that the splatting passes keep and drop.
// source: none; bad input is dropped, and that is reported.
// binding light: the directional light of the map.
// binding splat: size of the map, number of particles.
// binding particles: the particles.
// binding counts: out, how many are kept, not finite, of an impossible radius, of negative extinction, outside of the map; zeros before.

#import airlight::core::light::Light
#import airlight::transmittance::particles::{Particle, SplatTarget, ball_in_map, particle_defect}

@group(#{GROUP}) @binding(0) var<uniform> light: Light;
@group(#{GROUP}) @binding(1) var<uniform> splat: SplatTarget;
@group(#{GROUP}) @binding(2) var<storage, read> particles: array<Particle>;
@group(#{GROUP}) @binding(3) var<storage, read_write> counts: array<atomic<u32>>;

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
