// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: In-scattered radiance of every pixel by marching: along rows of the rectified map, or through the standard shadow map.
// source: thesis 4.2.1 and 4.3.1, Eq. 4.4 and 4.8.
// note: Rows: the nearest row, one texture load a step; one step a texel, or with STEPS `steps` equal steps a ray.
// definition AVERAGE: average visibility instead of visibility weighted by transmittance.
// definition STEPS: rows by `steps` equal steps, average visibility.
// definition PROJECTIVE: rows of a projective map, the exact sum over its texels; without STEPS and SHADOW_MAP.
// definition SHADOW_MAP: march the standard shadow map by `steps` equal steps a ray.
// definition JITTER_GRADIENT: each pixel's samples are shifted by interleaved gradient noise; with SHADOW_MAP or STEPS only.
// definition JITTER_BLUE_NOISE: each pixel's samples are shifted by blue noise; with SHADOW_MAP or STEPS only.
// binding camera: the camera, perspective (epipolar rows) or any.
// binding light: the directional light.
// binding medium: the medium.
// binding frame: the frame of the slices; epipolar rows only.
// binding slices: their bounds, rgba32float; epipolar rows only.
// binding rows: the projective rows; with PROJECTIVE only.
// binding depth: depth buffer of the picture, a depth format or r32float; non-finite values count as far.
// binding rectified: the rectified map; rows only.
// binding shadow_map: depth of the standard shadow map; with SHADOW_MAP only.
// binding parameters: number of steps, place of the samples, frame; with SHADOW_MAP or STEPS only.
// binding blue_noise: tile of blue noise 0..1, repeated over the picture, r32float or r8unorm; with JITTER_BLUE_NOISE only.
// binding scattered: out of the compute entry point (the fragment entry point returns it), rgba16float: linear RGB radiance, and in alpha the mean visibility 0..1.

#import airlight::core::camera::{Camera, view_ray, ndc_from_pixel, distance_from_depth}
#import airlight::core::finite::finite_or
#import airlight::core::jitter::{gradient_noise_offset, blue_noise_offset}
#import airlight::core::light::Light
#import airlight::core::picture::picture_corner
#import airlight::scattering::march::{march_row, march_row_steps, march_shadow_map}
#import airlight::scattering::projective::{ProjectiveRows, projective_ray, march_projective_row}
#import airlight::scattering::rectify::{
    Frame, epipolar_ray, nearest_row, slice_from_texel, depth_from_ray
}
#import airlight::scattering::single_scatter::{Medium, in_scattered}

struct MarchParameters {
    /// Steps a ray, 1..65536.
    steps: u32,
    /// Where in each step the sample lies, 0..1; unused with jitter.
    offset: f32,
    /// Number of the frame, for jitter; 0 is the static pattern.
    frame: u32,
    reserved: u32,
}

@group(#{GROUP}) @binding(0) var<uniform> camera: Camera;
@group(#{GROUP}) @binding(1) var<uniform> light: Light;
@group(#{GROUP}) @binding(2) var<uniform> medium: Medium;
#ifdef SHADOW_MAP
@group(#{GROUP}) @binding(7) var shadow_map: texture_2d<f32>;
#else
#ifdef PROJECTIVE
@group(#{GROUP}) @binding(10) var<uniform> rows: ProjectiveRows;
#else
@group(#{GROUP}) @binding(3) var<uniform> frame: Frame;
@group(#{GROUP}) @binding(4) var slices: texture_2d<f32>;
#endif
@group(#{GROUP}) @binding(6) var rectified: texture_2d<f32>;
#endif
#ifdef SHADOW_MAP
@group(#{GROUP}) @binding(8) var<uniform> parameters: MarchParameters;
#else ifdef STEPS
@group(#{GROUP}) @binding(8) var<uniform> parameters: MarchParameters;
#endif
#ifdef JITTER_BLUE_NOISE
@group(#{GROUP}) @binding(10) var blue_noise: texture_2d<f32>;
#endif
@group(#{GROUP}) @binding(5) var depth: texture_2d<f32>;
@group(#{GROUP}) @binding(9) var scattered: texture_storage_2d<rgba16float, write>;

/// Where in each step the samples of a pixel lie, 0..1.
fn step_offset(pixel: vec2<u32>, march: MarchParameters) -> f32 {
#ifdef JITTER_GRADIENT
    return gradient_noise_offset(pixel, march.frame);
#else ifdef JITTER_BLUE_NOISE
    return blue_noise_offset(blue_noise, pixel, march.frame);
#else
    return march.offset;
#endif
}

/// Radiance, and mean visibility in alpha, of a pixel.
fn pixel_light(pixel: vec2<u32>) -> vec4<f32> {
    let ndc = ndc_from_pixel(camera, vec2<f32>(pixel) + 0.5);
    let surface = clamp(finite_or(textureLoad(depth, pixel, 0).x, camera.far_depth), 0.0, 1.0);
#ifdef SHADOW_MAP
    let ray = view_ray(camera, ndc);
    let distance = distance_from_depth(camera, ray, ndc, surface, medium.distance_limit);
    let cosine = dot(ray.direction, light.direction);
#else ifdef PROJECTIVE
    let ray = view_ray(camera, ndc);
    let distance = distance_from_depth(camera, ray, ndc, surface, medium.distance_limit);
    let cosine = dot(ray.direction, light.direction);
#else
    let ray = epipolar_ray(frame, ndc, surface, medium.distance_limit);
    let distance = ray.distance;
    let cosine = ray.cosine;
#endif
#ifdef AVERAGE
    let extinction = 0.0;
#else
    let extinction = medium.extinction;
#endif

#ifdef SHADOW_MAP
    let visibility = march_shadow_map(
        shadow_map, light, ray.origin, ray.direction, distance, extinction,
        max(parameters.steps, 1u), step_offset(pixel, parameters)
    );
#else ifdef PROJECTIVE
    let size = textureDimensions(rectified);
    let along = projective_ray(rows, f32(size.y), ray.origin, ray.direction, distance);
    let row = min(u32(along.row + 0.5), size.y - 1u);
    let visibility = march_projective_row(rectified, rows, row, along, extinction);
#else
    let row = nearest_row(frame, ray.row);
    let slice = slice_from_texel(textureLoad(slices, vec2<u32>(row, 0u), 0));
    let width = f32(textureDimensions(rectified).x);
    let radius = distance * ray.sine;
    // A texel of a ray that barely leaves the light's direction is longer than any ray: the clamp keeps it finite.
    let optical_step = extinction * slice.radius_max / (width * max(ray.sine, 1e-6));
    let texels = width * radius / slice.radius_max;
#ifdef STEPS
    let visibility = march_row_steps(
        rectified, row, depth_from_ray(slice, ray), texels, parameters.steps, step_offset(pixel, parameters)
    );
#else
    let visibility = march_row(rectified, row, depth_from_ray(slice, ray), texels, optical_step);
#endif
#endif
    let radiance = in_scattered(medium, light.radiance, cosine, distance, visibility);
    return vec4<f32>(min(radiance, vec3<f32>(65504.0)), visibility);
}

@compute @workgroup_size(16, 8)
fn march(@builtin(global_invocation_id) id: vec3<u32>) {
    if all(id.xy < textureDimensions(scattered)) {
        textureStore(scattered, id.xy, pixel_light(id.xy));
    }
}

@vertex
fn vertex_picture(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return picture_corner(index);
}

@fragment
fn fragment_march(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return pixel_light(vec2<u32>(position.xy));
}
