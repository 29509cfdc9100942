// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Diffuse surfaces in the light of an environment, by bent cones, bent normals or occlusion alone.
// source: thesis 3.3.3 and 3.3.4, Eq. 3.7 to 3.10.
// note: Dispatch over the picture. The light of a direction and an angle comes from ambient/convolve_cones, whose light is the same for every
// note: angle under light that is the same from everywhere. So brightness is 2 * openness * dot(mean direction, normal), which is what an even light
// note: sends exactly, whatever is open: thesis Eq. 3.10's factor with the mean direction at twice its length. As printed, openness * dot(bent
// note: normal, normal) is too dark by up to a half inside cones; PRINTED keeps it.
// definition OCCLUSION: light of the whole hemisphere about the normal, times openness (Eq. 3.8 with the normal).
// definition NORMALS: light of the whole hemisphere about the bent normal (Eq. 3.8).
// definition EXACT: the cone whose directions have the mean's length; else Eq. 3.6. Of cones only.
// definition PRINTED: brightness as printed.
// binding camera: the camera; its viewport is the size of `depth`.
// binding depth: depth buffer, a depth format or r32float.
// binding normals: unit normals in the world, any float format.
// binding albedos: linear RGB albedo 0..1, any float format.
// binding bent: of ambient/occlude, ambient/blur_bent or ambient/upsample_bent; with OCCLUSION only its openness counts.
// binding lights: of ambient/convolve_cones.
// binding light_sampler: linear, clamped to the edge.
// binding picture: out, rgba16float: linear RGB radiance of surfaces; alpha is 1 where there is a surface, else 0.

#import airlight::core::camera::{Camera, towards_viewer}
#import airlight::core::finite::finite_or_rgb
#import airlight::ambient::seen_surface::{seen_surface, seen_normal}
#ifdef OCCLUSION
#import airlight::ambient::cone_light::preconvolved_radiance
#endif
#ifdef NORMALS
#import airlight::ambient::cone_light::preconvolved_radiance
#endif
#ifndef OCCLUSION
#import airlight::ambient::bent_cone::bent_normal
#ifdef PRINTED
#import airlight::ambient::cone_light::geometric_term
#else
#import airlight::ambient::bent_cone::irradiance_share
#endif
#ifndef NORMALS
#import airlight::ambient::cone_light::cone_radiance
#ifdef EXACT
#import airlight::ambient::bent_cone::cone_angle_exact
#else
#import airlight::ambient::bent_cone::cone_angle
#endif
#endif
#endif

@group(#{GROUP}) @binding(0) var<uniform> camera: Camera;
@group(#{GROUP}) @binding(1) var depth: texture_2d<f32>;
@group(#{GROUP}) @binding(2) var normals: texture_2d<f32>;
@group(#{GROUP}) @binding(3) var albedos: texture_2d<f32>;
@group(#{GROUP}) @binding(4) var bent: texture_2d<f32>;
@group(#{GROUP}) @binding(5) var lights: texture_2d_array<f32>;
@group(#{GROUP}) @binding(6) var light_sampler: sampler;
@group(#{GROUP}) @binding(7) var picture: texture_storage_2d<rgba16float, write>;

/// Greatest half.
const BRIGHTEST: f32 = 65504.0;

/// Radiance that a white surface sends out. `found`: mean direction and openness.
fn radiance_of(found: vec4<f32>, normal: vec3<f32>) -> vec3<f32> {
#ifdef OCCLUSION
    return found.w * preconvolved_radiance(lights, light_sampler, normal);
#else
#ifdef PRINTED
    let share = found.w * geometric_term(found.xyz, normal);
#else
    let share = irradiance_share(found.xyz, found.w, normal);
#endif
    let towards = bent_normal(found.xyz, normal);
#ifdef NORMALS
    return share * preconvolved_radiance(lights, light_sampler, towards);
#else
#ifdef EXACT
    let angle = cone_angle_exact(length(found.xyz));
#else
    let angle = cone_angle(length(found.xyz));
#endif
    return share * cone_radiance(lights, light_sampler, towards, angle);
#endif
#endif
}

@compute @workgroup_size(16, 8)
fn shade_bent(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= textureDimensions(picture)) {
        return;
    }
    let pixel = vec2<i32>(min(id.xy, textureDimensions(depth) - 1u));
    let seen = seen_surface(camera, pixel, textureLoad(depth, pixel, 0).x);
    let towards = towards_viewer(camera, seen.place);
    let viewer = towards / max(length(towards), 1e-20);
    let normal = seen_normal(textureLoad(normals, min(id.xy, textureDimensions(normals) - 1u), 0).xyz, viewer);
    let albedo = clamp(finite_or_rgb(textureLoad(albedos, min(id.xy, textureDimensions(albedos) - 1u), 0).rgb, 0.0), vec3<f32>(0.0), vec3<f32>(1.0));
    let found = textureLoad(bent, min(id.xy, textureDimensions(bent) - 1u), 0);
    let radiance = min(albedo * radiance_of(found, normal), vec3<f32>(BRIGHTEST));
    textureStore(picture, id.xy, select(vec4<f32>(0.0), vec4<f32>(radiance, 1.0), seen.known));
}
