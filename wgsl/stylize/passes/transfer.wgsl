// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Scattered light of every pixel, of any method, as a transfer function has it; or where pixels lie in the function.
// source: stylized scattering, 4.2; thesis 6.2.2.
// note: The angle to a light at a point is that at the camera.
// note: Non-finite values of the scattered light count as 0, such depths as far.
// definition PICK: instead of a picture, constraints that name a pixel are given its position.
// definition VISIBLE_DEPTH: marches the shadow map for the mean distance of a ray's lit points.
// definition SHADOW_ARRAY: with VISIBLE_DEPTH, shadow maps of several views.
// binding camera: the camera, any.
// binding light: the light.
// binding transfer_function: what is looked up, and what is made of it.
// binding depth: depth buffer of the picture, a depth format or r32float.
// binding scattered: what a scattering method wrote: linear RGB radiance, and in alpha the mean visibility 0..1.
// binding transfer_map: the function, premultiplied linear RGBA, any float format that filters; without PICK.
// binding transfer_sampler: linear, clamped to the edge; without PICK.
// binding shadow_map: depth of the standard shadow map; with VISIBLE_DEPTH, without SHADOW_ARRAY.
// binding shadow_maps: depth of the views, a layer each; with VISIBLE_DEPTH and SHADOW_ARRAY.
// binding shadow_views: the views; with VISIBLE_DEPTH and SHADOW_ARRAY.
// binding constraints: whose positions are written where they name a pixel; with PICK only.
// binding restyled: out of the compute entry point (the fragment entry point returns it), rgba16float: linear RGB radiance, and in alpha the mean visibility 0..1.

#import airlight::core::camera::{Camera, view_ray, ndc_from_pixel}
#import airlight::core::finite::{finite_or, finite_or_rgb}
#import airlight::core::light::{Light, direction_to_light}
#import airlight::core::picture::picture_corner
#import airlight::core::ray_depth::{ray_depth, distance_on_ray}
#ifdef VISIBLE_DEPTH
#import airlight::scattering::lit::lit_at
#endif
#import airlight::stylize::tf_diffuse::Constraint
#import airlight::stylize::tf_lookup::{
    TransferFunction, RayProperties, picture_angle, transfer_position, transfer_lookup, transfer_phase, stylized
}

@group(#{GROUP}) @binding(0) var<uniform> camera: Camera;
@group(#{GROUP}) @binding(1) var<uniform> light: Light;
@group(#{GROUP}) @binding(2) var<uniform> transfer_function: TransferFunction;
@group(#{GROUP}) @binding(3) var depth: texture_2d<f32>;
@group(#{GROUP}) @binding(4) var scattered: texture_2d<f32>;
#ifdef PICK
@group(#{GROUP}) @binding(5) var<storage, read_write> constraints: array<Constraint>;
#else
@group(#{GROUP}) @binding(7) var transfer_map: texture_2d<f32>;
@group(#{GROUP}) @binding(8) var transfer_sampler: sampler;
@group(#{GROUP}) @binding(9) var restyled: texture_storage_2d<rgba16float, write>;
#endif

#ifdef VISIBLE_DEPTH
/// Points of a ray at which the shadow map is looked up.
const STEPS: u32 = 96u;

/// Mean distance of the lit points of a ray of `distance` metres; half of that where nothing is lit.
fn visible_distance(origin: vec3<f32>, direction: vec3<f32>, distance: f32) -> f32 {
    var sum = 0.0;
    var lit = 0.0;
    for (var step = 0u; step < STEPS; step++) {
        let along = distance * (f32(step) + 0.5) / f32(STEPS);
        let weight = max(lit_at(light, origin + along * direction).x, 0.0);
        sum += weight * along;
        lit += weight;
    }
    return select(0.5 * distance, sum / max(lit, 1e-20), lit > 0.0);
}
#endif

/// What the function is asked about a pixel.
fn pixel_properties(pixel: vec2<u32>) -> RayProperties {
    let ndc = ndc_from_pixel(camera, vec2<f32>(pixel) + 0.5);
    let view = view_ray(camera, ndc);
    let surface = clamp(finite_or(textureLoad(depth, pixel, 0).x, camera.far_depth), 0.0, 1.0);
    // Every ray that reaches the limit looks the same to the function.
    let distance = distance_on_ray(ray_depth(camera, view, ndc), surface, clamp(transfer_function.depth_limit, 1e-6, 1e15));
    let visibility = clamp(finite_or(textureLoad(scattered, pixel, 0).a, 0.0), 0.0, 1.0);
    let cosine = dot(view.direction, direction_to_light(light, view.origin));
    var ray = RayProperties(visibility, distance, cosine, picture_angle(camera, light, ndc), 0.0);
#ifdef VISIBLE_DEPTH
    ray.visible_distance = visible_distance(view.origin, view.direction, distance);
#endif
    return ray;
}

#ifdef PICK
@compute @workgroup_size(64)
fn pick(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&constraints) {
        return;
    }
    let pixel = constraints[id.x].pixel;
    if all(pixel >= vec2<f32>(0.0)) {
        let last = vec2<f32>(textureDimensions(scattered) - 1u);
        let ray = pixel_properties(vec2<u32>(min(pixel, last)));
        constraints[id.x].position = transfer_position(transfer_function, ray);
    }
}
#else
/// Radiance, and mean visibility in alpha, of a pixel.
fn pixel_light(pixel: vec2<u32>) -> vec4<f32> {
    let ray = pixel_properties(pixel);
    let color = transfer_lookup(transfer_map, transfer_sampler, transfer_position(transfer_function, ray));
    let radiance = clamp(finite_or_rgb(textureLoad(scattered, pixel, 0).rgb, 0.0), vec3<f32>(0.0), vec3<f32>(65504.0));
    let phase = transfer_phase(transfer_function, ray.cosine);
    return vec4<f32>(stylized(transfer_function, color, radiance, light.radiance, phase), ray.visibility);
}

@compute @workgroup_size(16, 8)
fn transfer(@builtin(global_invocation_id) id: vec3<u32>) {
    if all(id.xy < textureDimensions(restyled)) {
        textureStore(restyled, id.xy, pixel_light(id.xy));
    }
}

@vertex
fn vertex_picture(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return picture_corner(index);
}

@fragment
fn fragment_transfer(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return pixel_light(vec2<u32>(position.xy));
}
#endif
