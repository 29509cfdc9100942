// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: In-scattered radiance of every pixel by marching the shadow maps of any light: spot, point, cascades, light texture.
// source: thesis 2.4.4, Eq. 2.20; 4.2.1; C. Kulla and M. Fajardo, "Importance sampling techniques for path tracing in participating media" (2012).
// note: The naive form for every light; `march` is the fastest one for a directional light with one shadow map.
// note: Around a light at a point steps are equal angles at the light, which the fall-off with distance makes alike.
// definition LOCAL: a spot or point light.
// definition SHADOW_ARRAY: shadow maps of several views: cascades of a directional light, faces around a point light.
// definition LIGHT_TEXTURE: a texture colours the light.
// definition AVERAGE: average visibility instead of visibility weighted by transmittance.
// binding camera: the camera, any.
// binding light: the light, directional without LOCAL.
// binding medium: the medium.
// binding depth: depth buffer of the picture, a depth format or r32float; non-finite values count as far.
// binding shadow_map: depth of the standard shadow map; without SHADOW_ARRAY.
// binding shadow_maps: depth of the views, a layer each; with SHADOW_ARRAY only.
// binding shadow_views: the views; with SHADOW_ARRAY only.
// binding light_texture: linear RGB 0..1 over the whole shadow map, any float format that filters; with LIGHT_TEXTURE only.
// binding light_sampler: linear, clamped to the edge; with LIGHT_TEXTURE only.
// binding parameters: number of steps.
// binding scattered: out of the compute entry point (the fragment entry point returns it), rgba16float: linear RGB radiance, and in alpha the mean visibility times fall-off 0..1.

#import airlight::core::camera::{Camera, view_ray, ndc_from_pixel, distance_from_depth}
#import airlight::core::finite::finite_or
#import airlight::core::light::Light
#import airlight::core::picture::picture_corner
#import airlight::scattering::lit::{marched_light, marched_local_light}
#import airlight::scattering::local_light::{
    place_of_light, local_ray, airlight, local_in_scattered
}
#import airlight::scattering::single_scatter::{Medium, in_scattered}

struct MarchParameters {
    /// Steps a ray, 1..65536.
    steps: u32,
    /// Where in each step the sample lies, 0..1.
    offset: f32,
    /// Unused here.
    frame: u32,
    reserved: u32,
}

@group(#{GROUP}) @binding(0) var<uniform> camera: Camera;
@group(#{GROUP}) @binding(1) var<uniform> light: Light;
@group(#{GROUP}) @binding(2) var<uniform> medium: Medium;
@group(#{GROUP}) @binding(5) var depth: texture_2d<f32>;
@group(#{GROUP}) @binding(8) var<uniform> parameters: MarchParameters;
@group(#{GROUP}) @binding(9) var scattered: texture_storage_2d<rgba16float, write>;
/// Radiance, and mean visibility times fall-off in alpha, of a pixel.
fn pixel_light(pixel: vec2<u32>) -> vec4<f32> {
    let ndc = ndc_from_pixel(camera, vec2<f32>(pixel) + 0.5);
    let surface = clamp(finite_or(textureLoad(depth, pixel, 0).x, camera.far_depth), 0.0, 1.0);
    let ray = view_ray(camera, ndc);
    let distance = distance_from_depth(camera, ray, ndc, surface, medium.distance_limit);
    let span = vec2<f32>(0.0, distance);
    let steps = max(parameters.steps, 1u);
#ifdef AVERAGE
    let extinction = 0.0;
#else
    let extinction = medium.extinction;
#endif
#ifdef LOCAL
    let place = place_of_light(light.position, ray.origin, ray.direction);
    let cosine = dot(ray.direction, place.xyz);
    let sine = length(cross(ray.direction, place.xyz));
    let lit = marched_local_light(
        light, medium.g, ray.origin, ray.direction, place.w, cosine, sine, span, extinction, steps, parameters.offset
    );
    let integral = airlight(local_ray(place.w, cosine, sine, light.radius), medium.extinction, medium.g, 0.0, distance);
    let radiance = local_in_scattered(medium, light.radiance, integral, lit);
#else
    let lit = marched_light(light, ray.origin, ray.direction, span, extinction, steps, parameters.offset);
    let cosine = dot(ray.direction, light.direction);
    let radiance = lit * in_scattered(medium, light.radiance, cosine, distance, 1.0);
#endif
    return vec4<f32>(min(radiance, vec3<f32>(65504.0)), dot(lit, vec3<f32>(1.0 / 3.0)));
}

@compute @workgroup_size(16, 8)
fn march_light(@builtin(global_invocation_id) id: vec3<u32>) {
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
