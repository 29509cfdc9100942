// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Lights what `iso_raycast` has written with DEFERRED: Phong lighting by colour and normal.
// source: dissertation on painterly volume rendering, 4.1.4, Eq. 4.2: illumination deferred to a later step.
// note: What is not finite counts as 0.
// binding camera: the camera that the rays were cast with.
// binding lighting: how the surface is lit.
// binding color: unlit colour, and 1 where the surface is seen.
// binding surface: unit normal in the world.
// binding picture: out, rgba16float: linear RGB radiance, premultiplied, and 1 where the surface is seen.

#import airlight::core::camera::{Camera, view_ray, ndc_from_pixel}
#import airlight::core::finite::{finite_or, finite_or_rgb}
#import airlight::painterly::iso_surface::{SurfaceLighting, phong}

@group(#{GROUP}) @binding(0) var<uniform> camera: Camera;
@group(#{GROUP}) @binding(1) var<uniform> lighting: SurfaceLighting;
@group(#{GROUP}) @binding(2) var color: texture_2d<f32>;
@group(#{GROUP}) @binding(3) var surface: texture_2d<f32>;
@group(#{GROUP}) @binding(4) var picture: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(16, 8)
fn shade(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= textureDimensions(picture)) {
        return;
    }
    let texel = textureLoad(color, id.xy, 0);
    let unlit = vec4<f32>(finite_or_rgb(texel.rgb, 0.0), finite_or(texel.a, 0.0));
    let stored = finite_or_rgb(textureLoad(surface, id.xy, 0).xyz, 0.0);
    // Half floats that were cut short are too short for a high power.
    let normal = stored / max(length(stored), 1e-6);
    let ray = view_ray(camera, ndc_from_pixel(camera, vec2<f32>(id.xy) + 0.5));
    let lit = min(phong(lighting, unlit.xyz, normal, ray.direction), vec3<f32>(65504.0));
    textureStore(picture, id.xy, select(vec4<f32>(0.0), vec4<f32>(lit, unlit.w), unlit.w > 0.0));
}
