// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Splats particles into an extinction or Fourier opacity map: an instanced quad each, blended additively.
// source: Gautron et al., "Extinction transmittance maps" (2011), Eq. 1; Jansen, Bavoil (2010) with PERIODIC.
// note: One colour target a layer, cleared to zeros, blended as source + destination; rgba16float blends in core WebGPU,
// note: rgba32float with the feature float32-blendable. Six vertices an instance, an instance a particle.
// note: The order of particles changes a coefficient by no more than half a unit in the last place of the target for each of
// note: them, at the greatest partial sum. The pass splat_fixed does not depend on the order at all.
// definition COEFFICIENTS: numbers a texel, four a target: 4, 8 or 16.
// definition PERIODIC: the series of the full period instead of cosines: a Fourier opacity map.
// binding light: the directional light of the map.
// binding splat: size of the map, number of particles.
// binding particles: the particles.

#import airlight::core::light::Light
#import airlight::transmittance::map_form::contribution
#import airlight::transmittance::particles::{
    Ball, Particle, SplatTarget, ball_in_map, particle_defect, stretch_of_ball, PARTICLE_KEPT
}

@group(#{GROUP}) @binding(0) var<uniform> light: Light;
@group(#{GROUP}) @binding(1) var<uniform> splat: SplatTarget;
@group(#{GROUP}) @binding(2) var<storage, read> particles: array<Particle>;

struct Corner {
    @builtin(position) clip: vec4<f32>,
    @location(0) @interpolate(flat) middle_and_reach: vec4<f32>,
    @location(1) @interpolate(flat) along: vec4<f32>,
}

#if COEFFICIENTS == 4
struct Layers {
    @location(0) first: vec4<f32>,
}
#else if COEFFICIENTS == 8
struct Layers {
    @location(0) first: vec4<f32>,
    @location(1) second: vec4<f32>,
}
#else
struct Layers {
    @location(0) first: vec4<f32>,
    @location(1) second: vec4<f32>,
    @location(2) third: vec4<f32>,
    @location(3) fourth: vec4<f32>,
}
#endif

@vertex
fn vertex_particle(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> Corner {
    let particle = particles[min(instance, arrayLength(&particles) - 1u)];
    let ball = ball_in_map(particle, light, splat.size);
    let kept = instance < splat.count && particle_defect(particle, ball, splat.size) == PARTICLE_KEPT;
    // Corners 0 1 2 and 2 1 3 of a square.
    let corner = select(vertex, select(5u - vertex, 3u, vertex > 4u), vertex > 2u);
    let side = vec2<f32>(select(-1.0, 1.0, (corner & 1u) == 1u), select(-1.0, 1.0, corner > 1u));
    let texels = ball.middle + side * ball.reach;
    let clip = vec4<f32>(texels / splat.size * vec2<f32>(2.0, -2.0) + vec2<f32>(-1.0, 1.0), 0.5, 1.0);
    // What is dropped has no area, and lies beside the map.
    return Corner(
        select(vec4<f32>(-2.0, -2.0, 0.5, 1.0), clip, kept),
        select(vec4<f32>(1.0), vec4<f32>(ball.middle, ball.reach), kept),
        select(vec4<f32>(0.0), vec4<f32>(ball.depth, ball.radius, ball.optical_depth, 0.0), kept)
    );
}

@fragment
fn fragment_particle(corner: Corner) -> Layers {
    let ball = Ball(
        corner.middle_and_reach.xy, corner.middle_and_reach.zw, corner.along.x, corner.along.y, corner.along.z
    );
    let stretch = stretch_of_ball(ball, corner.clip.xy);
    let own = contribution(stretch.middle, stretch.half);
    var layers: Layers;
    layers.first = stretch.optical_depth * own.layers[0];
#if COEFFICIENTS != 4
    layers.second = stretch.optical_depth * own.layers[1];
#if COEFFICIENTS != 8
    layers.third = stretch.optical_depth * own.layers[2];
    layers.fourth = stretch.optical_depth * own.layers[3];
#endif
#endif
    return layers;
}
