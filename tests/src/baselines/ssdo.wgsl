// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Light of an environment at what is seen, gathered along each direction in which nothing is in the way.
// source: Ritschel, Grosch and Seidel, "Approximating dynamic global illumination in image space" (2009), Section 3.1; thesis 3.5, Fig. 3.11.
// note: Directions, steps and what blocks are those of ambient/occlude, so that both see the same; each direction's light is looked up.
// note: Directions are spread with the cosine, so that each counts alike. Sums of light take the place of sums of directions: what is open
// note: times the mean light of open directions, as the cones have it, outliers included.
// definition LIGHTS: directions are those of lights drawn from the environment by its brightness, whatever the normal.
// definition UNIFORM: directions are spread evenly and weighted with the cosine: more noise.
// binding camera: the camera; its viewport is the size of `depth`.
// binding settings: how occlusion is looked for.
// binding depth: depth buffer, a depth format or r32float.
// binding normals: unit normals in the world, any float format.
// binding radiance: linear RGB of far away, latitude-longitude as in ambient/environment, constant over a texel; finite.
// binding lights: with LIGHTS, in place of `radiance`: unit vectors towards lights and their irradiance over pi, linear RGB, in turn; `samples` in
// binding lights: all for each pixel of the pattern, those of one pixel `side` times `side` lights apart.
// binding light: out, rgba16float: linear RGB radiance that a white surface sends out; alpha 1 where there is one, else 0.

#import airlight::core::camera::{Camera, towards_viewer}
#import airlight::core::tangent_frame::tangent_frame
#import airlight::ambient::bent_cone::{bent_nothing, bent_add, openness, mean_direction}
#import airlight::ambient::environment::environment_coordinates
#import airlight::ambient::occluders::{OcclusionSettings, occluder_weight, elevation_sine}
#import airlight::ambient::sample_pattern::{sample_shift, sample_place, hemisphere_direction}
#import airlight::ambient::seen_surface::{SeenSurface, seen_surface, seen_place, seen_normal}

@group(#{GROUP}) @binding(0) var<uniform> camera: Camera;
@group(#{GROUP}) @binding(1) var<uniform> settings: OcclusionSettings;
@group(#{GROUP}) @binding(2) var depth: texture_2d<f32>;
@group(#{GROUP}) @binding(3) var normals: texture_2d<f32>;
#ifdef LIGHTS
@group(#{GROUP}) @binding(4) var<storage, read> lights: array<vec4<f32>>;
#else
@group(#{GROUP}) @binding(4) var radiance: texture_2d<f32>;
#endif
@group(#{GROUP}) @binding(5) var light: texture_storage_2d<rgba16float, write>;

/// Greatest half.
const BRIGHTEST: f32 = 65504.0;

/// What is seen at a pixel of the picture.
fn seen_at(pixel: vec2<i32>) -> SeenSurface {
    let at = clamp(pixel, vec2<i32>(0), vec2<i32>(textureDimensions(depth)) - 1);
    return seen_surface(camera, at, textureLoad(depth, at, 0).x);
}

#ifndef LIGHTS
/// Radiance from a direction.
fn radiance_from(direction: vec3<f32>) -> vec3<f32> {
    let size = textureDimensions(radiance);
    let texel = vec2<u32>(environment_coordinates(direction) * vec2<f32>(size));
    return textureLoad(radiance, min(texel, size - 1u), 0).rgb;
}
#endif

@compute @workgroup_size(16, 8)
fn ssdo(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= textureDimensions(light)) {
        return;
    }
    let own = seen_at(vec2<i32>(id.xy));
    let place = own.place;
    let towards_eye = towards_viewer(camera, place);
    let viewer = towards_eye / max(length(towards_eye), 1e-20);
    let normal = seen_normal(textureLoad(normals, min(id.xy, textureDimensions(normals) - 1u), 0).xyz, viewer);
    let basis = tangent_frame(normal);
    let shift = sample_shift(id.xy, settings.side, settings.frame);
    var sum = bent_nothing();
    let samples = select(0u, settings.samples, own.known);
    for (var index = 0u; index < samples; index++) {
#ifdef LIGHTS
        let cells = settings.side * settings.side;
        let cell = id.x % settings.side + id.y % settings.side * settings.side;
        let chosen = 2u * min(index * cells + cell, arrayLength(&lights) / 2u - 1u);
        let direction = lights[chosen].xyz;
        let weight = max(dot(direction, normal), 0.0);
#else
        let even = sample_place(index, settings.samples, shift);
#ifdef UNIFORM
        let local = hemisphere_direction(even);
        let weight = 2.0 * local.z;
#else
        let local = hemisphere_direction(vec2<f32>(sqrt(even.x), even.y));
        let weight = 1.0;
#endif
        let direction = basis * local;
#endif
        var visibility = 1.0;
        var outlier = false;
        for (var step = 0u; step < settings.steps; step++) {
            let part = (f32(step) + shift.steps) / f32(settings.steps);
            let reached = place + direction * (settings.radius * part * part);
            let at = seen_place(camera, reached);
            let seen = seen_at(vec2<i32>(floor(at.pixel)));
            let towards = seen.place - place;
            let before = dot(seen.place - reached, viewer);
            let rises = at.inside && seen.known && before > 0.0 && elevation_sine(towards, normal) > settings.bias;
            let blocks = rises && before < settings.thickness;
            visibility = min(visibility, select(1.0, 1.0 - occluder_weight(length(towards), settings.radius), blocks));
            outlier = outlier || (rises && !blocks);
        }
        var lit = vec3<f32>(0.0);
        if visibility > 0.0 {
#ifdef LIGHTS
            lit = weight * f32(cells) * lights[chosen + 1u].rgb;
#else
            lit = weight * radiance_from(direction);
#endif
        }
        sum = bent_add(sum, lit, visibility, outlier && visibility >= 1.0);
    }
#ifdef LIGHTS
    let gathered = min(sum.direction, vec3<f32>(BRIGHTEST));
#else
    let gathered = min(openness(sum) * mean_direction(sum), vec3<f32>(BRIGHTEST));
#endif
    textureStore(light, id.xy, vec4<f32>(gathered, select(0.0, 1.0, own.known)));
}
