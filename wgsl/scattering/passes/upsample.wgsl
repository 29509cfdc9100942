// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: In-scattered radiance of every pixel from a picture that was evaluated at a half or a quarter of the resolution.
// source: joint bilateral upsampling, Kopf, Cohen, Lischinski and Uyttendaele (2007); thesis Eq. 4.2.
// note: What is interpolated is the visibility: the pixel's own distance and phase function then give its
// note: radiance, so that edges of the picture stay as sharp as its depth buffer. Rays begin at the eye: a
// note: picture that was evaluated with NEAR_PLANE needs RADIANCE.
// note: Non-finite values of the evaluated picture count as 0.
// definition RADIANCE: interpolates radiance as well, for light that is no product of visibility and a function of the ray.
// binding camera: the camera of the full picture, any.
// binding light: the directional light; without RADIANCE only.
// binding medium: the medium.
// binding reduction: the factor, and the tolerance of distances.
// binding depth: depth buffer of the full picture, a depth format or r32float; non-finite values count as far.
// binding reduced_depth: depth of the evaluated pixels, from the pass reduce_depth.
// binding reduced: their radiance and, in alpha, visibility 0..1; rgba16float.
// binding scattered: out of the compute entry point (the fragment entry point returns it), rgba16float: linear RGB radiance, and in alpha the mean visibility 0..1.

#import airlight::core::camera::{Camera, view_ray, ndc_from_pixel}
#import airlight::core::finite::{finite_or, finite_or_rgb}
#import airlight::core::light::Light
#import airlight::core::ray_depth::{ray_depth, distance_on_ray}
#import airlight::core::picture::picture_corner
#import airlight::scattering::single_scatter::{Medium, in_scattered}
#import airlight::scattering::upsample::{Reduction, evaluated_neighbours, closeness, upsampling_weights}

@group(#{GROUP}) @binding(0) var<uniform> camera: Camera;
#ifndef RADIANCE
@group(#{GROUP}) @binding(1) var<uniform> light: Light;
#endif
@group(#{GROUP}) @binding(2) var<uniform> medium: Medium;
@group(#{GROUP}) @binding(3) var<uniform> reduction: Reduction;
@group(#{GROUP}) @binding(4) var depth: texture_2d<f32>;
@group(#{GROUP}) @binding(5) var reduced_depth: texture_2d<f32>;
@group(#{GROUP}) @binding(6) var reduced: texture_2d<f32>;
@group(#{GROUP}) @binding(7) var scattered: texture_storage_2d<rgba16float, write>;

/// Depth 0..1 of an evaluated pixel.
fn depth_at(pixel: vec2<u32>) -> f32 {
    return clamp(finite_or(textureLoad(reduced_depth, pixel, 0).x, camera.far_depth), 0.0, 1.0);
}

#ifdef RADIANCE
/// Radiance and visibility of an evaluated pixel.
fn light_at(pixel: vec2<u32>) -> vec4<f32> {
    let value = textureLoad(reduced, pixel, 0);
    return vec4<f32>(finite_or_rgb(value.rgb, 0.0), finite_or(value.a, 0.0));
}
#else
/// Visibility of an evaluated pixel.
fn light_at(pixel: vec2<u32>) -> f32 {
    return finite_or(textureLoad(reduced, pixel, 0).a, 0.0);
}
#endif

/// Radiance, and mean visibility in alpha, of a pixel.
fn pixel_light(pixel: vec2<u32>) -> vec4<f32> {
    let ndc = ndc_from_pixel(camera, vec2<f32>(pixel) + 0.5);
    let view = view_ray(camera, ndc);
    let ray = ray_depth(camera, view, ndc);
    let surface = clamp(finite_or(textureLoad(depth, pixel, 0).x, camera.far_depth), 0.0, 1.0);
    let distance = distance_on_ray(ray, surface, medium.distance_limit);

    let near = evaluated_neighbours(reduction, pixel, textureDimensions(reduced));
    let right = vec2<u32>(near.behind.x, near.before.y);
    let below = vec2<u32>(near.before.x, near.behind.y);
    // Distances of the neighbours' depths on this pixel's ray: their own rays are as long to a pixel's width.
    let distances = vec4<f32>(
        distance_on_ray(ray, depth_at(near.before), medium.distance_limit),
        distance_on_ray(ray, depth_at(right), medium.distance_limit),
        distance_on_ray(ray, depth_at(below), medium.distance_limit),
        distance_on_ray(ray, depth_at(near.behind), medium.distance_limit)
    );
    let weights = upsampling_weights(near.bilinear, closeness(distance, distances, reduction.tolerance));
#ifdef RADIANCE
    let light = light_at(near.before) * weights.x + light_at(right) * weights.y
        + light_at(below) * weights.z + light_at(near.behind) * weights.w;
    return vec4<f32>(clamp(light.rgb, vec3<f32>(0.0), vec3<f32>(65504.0)), clamp(light.a, 0.0, 1.0));
#else
    let mean = light_at(near.before) * weights.x + light_at(right) * weights.y
        + light_at(below) * weights.z + light_at(near.behind) * weights.w;
    let visibility = clamp(mean, 0.0, 1.0);
    let cosine = dot(view.direction, light.direction);
    let radiance = in_scattered(medium, light.radiance, cosine, distance, visibility);
    return vec4<f32>(min(radiance, vec3<f32>(65504.0)), visibility);
#endif
}

@compute @workgroup_size(16, 8)
fn upsample(@builtin(global_invocation_id) id: vec3<u32>) {
    if all(id.xy < textureDimensions(scattered)) {
        textureStore(scattered, id.xy, pixel_light(id.xy));
    }
}

@vertex
fn vertex_picture(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return picture_corner(index);
}

@fragment
fn fragment_upsample(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return pixel_light(vec2<u32>(position.xy));
}
