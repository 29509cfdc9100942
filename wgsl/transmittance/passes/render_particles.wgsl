// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
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

#import airlight::core::camera::{Camera, view_ray, ndc_from_pixel, distance_from_depth}
#import airlight::core::finite::finite_or
#import airlight::core::light::Light
#import airlight::transmittance::medium::{
    MediumLighting, source_radiance, marched_nothing, marched_on, medium_pixel
}
#import airlight::transmittance::particles::Particle
#import airlight::transmittance::seen_particles::{SeenBall, seen_ball, outline_corner, seen_optical_depth}

@group(#{GROUP}) @binding(0) var<uniform> camera: Camera;
@group(#{GROUP}) @binding(1) var<uniform> light: Light;
@group(#{GROUP}) @binding(2) var<uniform> lighting: MediumLighting;
@group(#{GROUP}) @binding(3) var<storage, read> particles: array<Particle>;
@group(#{GROUP}) @binding(4) var<storage, read> order: array<u32>;
@group(#{GROUP}) @binding(5) var<storage, read> transmittances: array<f32>;
@group(#{GROUP}) @binding(6) var depth: texture_2d<f32>;

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
