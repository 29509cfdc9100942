// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: The picture through the medium: surface radiance dimmed by transmittance, plus scattered radiance.
// source: thesis 2.4.2 and 2.4.4.
// note: Non-finite surface radiance counts as black.
// binding camera: the camera.
// binding medium: the medium.
// binding depth: depth buffer of the picture, a depth format or r32float.
// binding surface: linear RGB radiance of the surfaces and the sky.
// binding scattered: linear RGB in-scattered radiance.
// binding composed: out, linear RGB radiance, rgba16float.

#import airlight::core::camera::{Camera, view_ray, ndc_from_pixel, distance_from_depth}
#import airlight::core::finite::{finite_or, finite_or_rgb}
#import airlight::scattering::single_scatter::{Medium, transmittance}

@group(#{GROUP}) @binding(0) var<uniform> camera: Camera;
@group(#{GROUP}) @binding(1) var<uniform> medium: Medium;
@group(#{GROUP}) @binding(2) var depth: texture_2d<f32>;
@group(#{GROUP}) @binding(3) var surface: texture_2d<f32>;
@group(#{GROUP}) @binding(4) var scattered: texture_2d<f32>;
@group(#{GROUP}) @binding(5) var composed: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(16, 8)
fn composite(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= textureDimensions(composed)) {
        return;
    }
    let ndc = ndc_from_pixel(camera, vec2<f32>(id.xy) + 0.5);
    let ray = view_ray(camera, ndc);
    let at_depth = clamp(finite_or(textureLoad(depth, id.xy, 0).x, camera.far_depth), 0.0, 1.0);
    let distance = distance_from_depth(camera, ray, ndc, at_depth, medium.distance_limit);
    let behind = finite_or_rgb(textureLoad(surface, id.xy, 0).rgb, 0.0);
    let added = finite_or_rgb(textureLoad(scattered, id.xy, 0).rgb, 0.0);
    let radiance = behind * transmittance(medium.extinction * distance) + added;
    textureStore(composed, id.xy, vec4<f32>(clamp(radiance, vec3<f32>(0.0), vec3<f32>(65504.0)), 1.0));
}
