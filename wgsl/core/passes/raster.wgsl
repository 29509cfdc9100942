// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Draws meshes: shadow maps from the light, a lit picture with depth from the camera, a sky behind it.
// source: Lambert's cosine law; percentage-closer filtering, Reeves et al. (1987).
// note: Any camera: forward, reversed and infinite depth differ in the clear value and the comparison of the pipeline.
// note: With several samples a pixel is lit once. Light reaches surfaces through clear air.
// definition SHADOW_ARRAY: shadow maps of several views in the layers of an array: cascades, or faces around a point light.
// definition LIGHT_TEXTURE: a texture colours the light.
// binding camera: the camera, world in metres.
// binding light: the light and its shadow map's clip space.
// binding sky: linear RGB radiance of the sky and the ground.
// binding shadow_map: depth of the standard shadow map, depth32float; of a directional light or a spot.
// binding shadow_maps: depth of the views, a layer each, depth32float; with SHADOW_ARRAY only.
// binding shadow_views: the views; `vertex_shadow` draws into the one that the instance index names; with SHADOW_ARRAY only.
// binding shadow_sampler: comparison sampler, less-equal for forward depth.
// binding light_texture: linear RGB 0..1 over the whole shadow map of a directional light or a spot, any float format that filters; with LIGHT_TEXTURE only.
// binding light_sampler: linear, clamped to the edge; with LIGHT_TEXTURE only.

#import airlight::core::camera::{Camera, view_ray, ndc_from_pixel, towards_viewer}
#import airlight::core::light::{
    DIRECTIONAL, Light, direction_to_light, light_falloff, light_texture_color, metres_of_texel, texels_from_clip
}
#ifdef SHADOW_ARRAY
#import airlight::core::shadow_views::{ShadowViews, clip_in_views}
#endif

/// Radiance of the surroundings, linear RGB. 48 bytes.
struct Sky {
    /// Straight up.
    zenith: vec3<f32>,
    reserved_a: f32,
    /// At the horizon.
    horizon: vec3<f32>,
    reserved_b: f32,
    /// From below, onto surfaces that face down.
    ground: vec3<f32>,
    reserved_c: f32,
}

struct Varyings {
    @builtin(position) position: vec4<f32>,
    @location(0) world: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) albedo: vec3<f32>,
}

@group(#{GROUP}) @binding(0) var<uniform> camera: Camera;
@group(#{GROUP}) @binding(1) var<uniform> light: Light;
@group(#{GROUP}) @binding(2) var<uniform> sky: Sky;
@group(#{GROUP}) @binding(4) var shadow_sampler: sampler_comparison;
#ifdef SHADOW_ARRAY
@group(#{GROUP}) @binding(3) var shadow_maps: texture_depth_2d_array;
@group(#{GROUP}) @binding(5) var<uniform> shadow_views: ShadowViews;
#else
@group(#{GROUP}) @binding(3) var shadow_map: texture_depth_2d;
#endif
#ifdef LIGHT_TEXTURE
@group(#{GROUP}) @binding(6) var light_texture: texture_2d<f32>;
@group(#{GROUP}) @binding(7) var light_sampler: sampler;
#endif

#ifdef SHADOW_ARRAY
@vertex
fn vertex_shadow(
    @location(0) position: vec3<f32>, @builtin(instance_index) view: u32
) -> @builtin(position) vec4<f32> {
    return shadow_views.clip_from_world[min(view, 5u)] * vec4<f32>(position, 1.0);
}
#else
@vertex
fn vertex_shadow(@location(0) position: vec3<f32>) -> @builtin(position) vec4<f32> {
    return light.clip_from_world * vec4<f32>(position, 1.0);
}
#endif

@vertex
fn vertex_surface(
    @location(0) position: vec3<f32>, @location(1) normal: vec3<f32>, @location(2) albedo: vec3<f32>
) -> Varyings {
    return Varyings(camera.clip_from_world * vec4<f32>(position, 1.0), position, normal, albedo);
}

/// Clip position of a surface point, moved off the surface by the footprint of the filter, which hides the staircase of
/// the map. `clip_from_world`: of the map; `width`: of the map in texels.
fn shadow_clip(clip_from_world: mat4x4<f32>, width: f32, point: vec3<f32>, normal: vec3<f32>) -> vec4<f32> {
    // Of a light at a point it grows towards the corners of a wide view.
    let wider = select(1.5, 1.0, light.kind == DIRECTIONAL);
    let texel = wider * metres_of_texel(clip_from_world, width, point);
    let towards = direction_to_light(light, point);
    return clip_from_world * vec4<f32>(point + normal * (1.5 * texel) + towards * texel, 1.0);
}

/// Lit fraction of a surface point, 0..1, over 3x3 texels.
fn surface_visibility(point: vec3<f32>, normal: vec3<f32>) -> f32 {
#ifdef SHADOW_ARRAY
    let size = vec2<f32>(textureDimensions(shadow_maps));
    let found = clip_in_views(shadow_views, point);
    let view = found.view;
    let at = texels_from_clip(shadow_clip(shadow_views.clip_from_world[view], size.x, point, normal), size);
    let inside = found.inside == 1u;
#else
    let size = vec2<f32>(textureDimensions(shadow_map));
    let at = texels_from_clip(shadow_clip(light.clip_from_world, size.x, point, normal), size);
    let inside = all(at.xy >= vec2<f32>(0.0)) && all(at.xy <= size);
#endif
    var lit = 0.0;
    for (var tap = 0; tap < 9; tap++) {
        let offset = vec2<f32>(f32(tap % 3 - 1), f32(tap / 3 - 1));
#ifdef SHADOW_ARRAY
        lit += textureSampleCompareLevel(shadow_maps, shadow_sampler, (at.xy + offset) / size, view, at.z);
#else
        lit += textureSampleCompareLevel(shadow_map, shadow_sampler, (at.xy + offset) / size, at.z);
#endif
    }
    return select(1.0, lit / 9.0, inside);
}

@fragment
fn fragment_surface(varyings: Varyings) -> @location(0) vec4<f32> {
    // Both faces are lit, since leaves and terrain are single sheets: the normal is turned to the side of the
    // triangle that is seen. The interpolated normal alone would flip at silhouettes.
    let triangle = cross(dpdx(varyings.world), dpdy(varyings.world));
    let seen = select(-triangle, triangle, dot(triangle, towards_viewer(camera, varyings.world)) >= 0.0);
    let unit = varyings.normal / max(length(varyings.normal), 1e-6);
    let normal = select(-unit, unit, dot(unit, seen) >= 0.0);
    let cosine = max(dot(normal, direction_to_light(light, varyings.world)), 0.0);
    let visibility = surface_visibility(varyings.world, normal);
    var irradiance = light.radiance * (cosine * visibility * light_falloff(light, varyings.world));
#ifdef LIGHT_TEXTURE
    irradiance *= light_texture_color(light, light_texture, light_sampler, varyings.world);
#endif
    let up = 0.5 + 0.5 * normal.y;
    let ambient = mix(sky.ground, 0.5 * (sky.zenith + sky.horizon), up);
    // Outgoing radiance of a Lambertian surface: albedo / pi times irradiance; that of the sky is pi times its radiance.
    return vec4<f32>(min(varyings.albedo * (irradiance / 3.141592653589793 + ambient), vec3<f32>(65504.0)), 1.0);
}

/// One triangle over the whole picture, at the far plane.
@vertex
fn vertex_background(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    let corner = vec2<f32>(f32(index & 1u), f32(index >> 1u)) * 4.0 - 1.0;
    return vec4<f32>(corner, camera.far_depth, 1.0);
}

@fragment
fn fragment_background(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let direction = view_ray(camera, ndc_from_pixel(camera, position.xy)).direction;
    let up = direction.y;
    let above = mix(sky.horizon, sky.zenith, sqrt(clamp(up, 0.0, 1.0)));
    let below = mix(sky.horizon, sky.ground, smoothstep(0.0, 0.12, -up));
    return vec4<f32>(select(below, above, up >= 0.0), 1.0);
}
