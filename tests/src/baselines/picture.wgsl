// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: In-scattered radiance of every pixel from a competitor's average visibility over the nearest row.
// source: thesis 4.2.1, Eq. 4.2; the competitor follows below.
// note: Everything but `average_visibility` is what the march along rows does, in its fragment form.
// binding camera: the camera, perspective.
// binding light: the directional light.
// binding medium: the medium.
// binding frame: the frame of the slices.
// binding slices: their bounds, rgba32float.
// binding depth: depth buffer of the picture, a depth format or r32float; non-finite values count as far.

#import airlight::core::camera::{Camera, ndc_from_pixel}
#import airlight::core::finite::finite_or
#import airlight::core::light::Light
#import airlight::scattering::rectify::{Frame, epipolar_ray, nearest_row, slice_from_texel, depth_from_ray}
#import airlight::scattering::single_scatter::{Medium, in_scattered}

@group(#{GROUP}) @binding(0) var<uniform> camera: Camera;
@group(#{GROUP}) @binding(1) var<uniform> light: Light;
@group(#{GROUP}) @binding(2) var<uniform> medium: Medium;
@group(#{GROUP}) @binding(3) var<uniform> frame: Frame;
@group(#{GROUP}) @binding(4) var slices: texture_2d<f32>;
@group(#{GROUP}) @binding(5) var depth: texture_2d<f32>;

/// Radiance, and average visibility in alpha, of a pixel.
fn pixel_light(pixel: vec2<u32>) -> vec4<f32> {
    let ndc = ndc_from_pixel(camera, vec2<f32>(pixel) + 0.5);
    let surface = clamp(finite_or(textureLoad(depth, pixel, 0).x, camera.far_depth), 0.0, 1.0);
    let ray = epipolar_ray(frame, ndc, surface, medium.distance_limit);
    let row = nearest_row(frame, ray.row);
    let slice = slice_from_texel(textureLoad(slices, vec2<u32>(row, 0u), 0));
    let columns = f32(row_columns());
    let texels = clamp(columns * ray.distance * ray.sine / slice.radius_max, 1e-3, columns);
    let visibility = clamp(average_visibility(row, depth_from_ray(slice, ray), texels), 0.0, 1.0);
    let radiance = in_scattered(medium, light.radiance, ray.cosine, ray.distance, visibility);
    return vec4<f32>(min(radiance, vec3<f32>(65504.0)), visibility);
}

/// One triangle over the whole picture.
@vertex
fn vertex_picture(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return vec4<f32>(vec2<f32>(f32(index & 1u), f32(index >> 1u)) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn fragment_evaluate(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return pixel_light(vec2<u32>(position.xy));
}
