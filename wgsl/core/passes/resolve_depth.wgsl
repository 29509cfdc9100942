// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: A multisampled depth buffer to one depth a pixel, such that light scattered into the pixel is the mean of its samples'.
// source: Beer-Lambert law, thesis 2.4.2; see core/resolve_depth.
// note: A pixel whose samples agree keeps their depth, bit for bit.
// definition NEAREST: depth of the nearest sample.
// definition FARTHEST: depth of the farthest sample.
// definition DEPTH_TEXTURE: the buffer is bound as a depth texture; without it as unfilterable floats, which takes depth formats and r32float.
// binding camera: the camera, of any kind; its viewport is that of the buffer.
// binding parameters: extinction and distance limit of the medium; without NEAREST and FARTHEST only.
// binding samples: the depth buffer, multisampled; non-finite values count as far.
// binding resolved: out, r32float: depth 0..1 in the camera's convention.

#import airlight::core::camera::{Camera, view_ray, ndc_from_pixel}
#import airlight::core::finite::finite_or
#import airlight::core::ray_depth::{ray_depth, distance_on_ray, depth_on_ray}
#import airlight::core::resolve_depth::{averaging_extinction, distance_of_transmittance}

struct ResolveDepthParameters {
    /// Extinction in 1/m, not negative; zero for the depth of the mean distance.
    extinction: f32,
    /// Distances count up to here, metres, positive.
    distance_limit: f32,
    reserved_a: f32,
    reserved_b: f32,
}

@group(#{GROUP}) @binding(0) var<uniform> camera: Camera;
#ifndef NEAREST
#ifndef FARTHEST
@group(#{GROUP}) @binding(1) var<uniform> parameters: ResolveDepthParameters;
#endif
#endif
#ifdef DEPTH_TEXTURE
@group(#{GROUP}) @binding(2) var samples: texture_depth_multisampled_2d;
#else
@group(#{GROUP}) @binding(2) var samples: texture_multisampled_2d<f32>;
#endif
@group(#{GROUP}) @binding(3) var resolved: texture_storage_2d<r32float, write>;

/// Depth of one sample, 0..1.
fn sample_depth(pixel: vec2<u32>, index: u32) -> f32 {
#ifdef DEPTH_TEXTURE
    let value = textureLoad(samples, pixel, i32(index));
#else
    let value = textureLoad(samples, pixel, i32(index)).x;
#endif
    return clamp(finite_or(value, camera.far_depth), 0.0, 1.0);
}

@compute @workgroup_size(16, 8)
fn resolve_depth(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= textureDimensions(resolved)) {
        return;
    }
    let count = textureNumSamples(samples);
    var least = 1.0;
    var greatest = 0.0;
    for (var index = 0u; index < count; index++) {
        let value = sample_depth(id.xy, index);
        least = min(least, value);
        greatest = max(greatest, value);
    }
    let forward = camera.far_depth > camera.near_depth;
    let nearest_depth = select(greatest, least, forward);
    let farthest_depth = select(least, greatest, forward);
#ifdef NEAREST
    let depth = nearest_depth;
#else ifdef FARTHEST
    let depth = farthest_depth;
#else
    let ndc = ndc_from_pixel(camera, vec2<f32>(id.xy) + 0.5);
    let ray = ray_depth(camera, view_ray(camera, ndc), ndc);
    let nearest = distance_on_ray(ray, nearest_depth, parameters.distance_limit);
    let farthest = distance_on_ray(ray, farthest_depth, parameters.distance_limit);
    let extinction = averaging_extinction(parameters.extinction, nearest, farthest);
    var transmittance = 0.0;
    for (var index = 0u; index < count; index++) {
        let distance = distance_on_ray(ray, sample_depth(id.xy, index), parameters.distance_limit);
        transmittance += exp(-extinction * (distance - nearest));
    }
    let mean = distance_of_transmittance(nearest, extinction, transmittance / f32(count));
    let depth = select(depth_on_ray(ray, mean), least, least == greatest);
#endif
    textureStore(resolved, id.xy, vec4<f32>(depth, 0.0, 0.0, 0.0));
}
