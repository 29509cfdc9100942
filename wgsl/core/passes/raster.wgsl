// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Draws meshes: a shadow map from the light, a lit picture with depth from the camera, a sky behind it.
// source: Lambert's cosine law; percentage-closer filtering, Reeves et al. (1987).
// binding camera: the camera, world in metres.
// binding light: the directional light and its shadow map's clip space.
// binding sky: linear RGB radiance of the sky and the ground.
// binding shadow_map: depth of the standard shadow map, depth32float.
// binding shadow_sampler: comparison sampler, less-equal for forward depth.

#import airlight::core::camera::{Camera, view_ray, ndc_from_pixel}
#import airlight::core::light::{Light, shadow_position}

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
@group(#{GROUP}) @binding(3) var shadow_map: texture_depth_2d;
@group(#{GROUP}) @binding(4) var shadow_sampler: sampler_comparison;

@vertex
fn vertex_shadow(@location(0) position: vec3<f32>) -> @builtin(position) vec4<f32> {
    return light.clip_from_world * vec4<f32>(position, 1.0);
}

@vertex
fn vertex_surface(
    @location(0) position: vec3<f32>, @location(1) normal: vec3<f32>, @location(2) albedo: vec3<f32>
) -> Varyings {
    return Varyings(camera.clip_from_world * vec4<f32>(position, 1.0), position, normal, albedo);
}

/// Lit fraction of a surface point, 0..1, over 3x3 texels.
fn surface_visibility(point: vec3<f32>, normal: vec3<f32>) -> f32 {
    let size = vec2<f32>(textureDimensions(shadow_map));
    // Moving the point off the surface by the footprint of the filter hides the map's staircase.
    let texel = 2.0 / (size.x * length(vec3<f32>(
        light.clip_from_world[0].x, light.clip_from_world[1].x, light.clip_from_world[2].x
    )));
    let at = shadow_position(light, size, point + normal * (1.5 * texel) + light.direction * texel);
    var lit = 0.0;
    for (var tap = 0; tap < 9; tap++) {
        let offset = vec2<f32>(f32(tap % 3 - 1), f32(tap / 3 - 1));
        lit += textureSampleCompareLevel(shadow_map, shadow_sampler, (at.xy + offset) / size, at.z);
    }
    let inside = all(at.xy >= vec2<f32>(0.0)) && all(at.xy <= size);
    return select(1.0, lit / 9.0, inside);
}

@fragment
fn fragment_surface(varyings: Varyings) -> @location(0) vec4<f32> {
    // Both faces are lit, since leaves and terrain are single sheets: the normal is turned to the side of the
    // triangle that is seen. The interpolated normal alone would flip at silhouettes.
    let triangle = cross(dpdx(varyings.world), dpdy(varyings.world));
    let seen = select(-triangle, triangle, dot(triangle, camera.eye - varyings.world) >= 0.0);
    let unit = varyings.normal / max(length(varyings.normal), 1e-6);
    let normal = select(-unit, unit, dot(unit, seen) >= 0.0);
    let cosine = max(dot(normal, light.direction), 0.0);
    let sun = light.radiance * (cosine * surface_visibility(varyings.world, normal));
    let up = 0.5 + 0.5 * normal.y;
    let ambient = mix(sky.ground, 0.5 * (sky.zenith + sky.horizon), up);
    // Outgoing radiance of a Lambertian surface: albedo / pi times irradiance; that of the sky is pi times its radiance.
    return vec4<f32>(min(varyings.albedo * (sun / 3.141592653589793 + ambient), vec3<f32>(65504.0)), 1.0);
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
