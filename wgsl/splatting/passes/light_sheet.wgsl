// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: The light before the first sheet, and what each sheet leaves of it.
// source: Zhang and Crawfis, 4.1 steps 6 and 21, Eq. 5 without scattering.
// note: Dispatch begin_light over the shadow buffer, then light_sheet_left for each sheet, indirectly, after its picture; a sheet
// note: without splats runs nothing. What is left adds up in 32 bits, whatever blending rounds; the texture is for filtered reads.
// definition POLYGONS: sheets end at surfaces; a texel keeps what reached its surface.
// definition LIGHT_TEXTURE: a texture colours the light.
// binding light_camera: the light as a camera.
// binding light: the light.
// binding sheets: the sheets.
// binding lighting: extinction.
// binding light_sheet: mean values of the sheet along the light rays, rgba16float.
// binding transfer: finite colour and opacity of values 0..1, one row, rgba16float or rgba8unorm.
// binding linear_sampler: linear, clamped to the edge.
// binding number: which sheet; with POLYGONS only.
// binding light_heights: of the first surface along each light ray, metres, NO_SURFACE where there is none, r32float; with POLYGONS only.
// binding left: what is left of the light, linear RGB, a vector a texel of the shadow buffer, row after row.
// binding shadow: out, the same.
// binding light_texture: linear RGB 0..1 over the whole shadow buffer, any float format that filters; with LIGHT_TEXTURE only.

#import airlight::core::camera::{Camera, view_ray, ndc_from_pixel}
#import airlight::core::light::Light
#ifdef LIGHT_TEXTURE
#import airlight::core::light::{shadow_point, light_texture_color}
#endif
#import airlight::splatting::sheets::{Sheets, metres_in_sheet, sheet_mean}
#import airlight::splatting::sheet_shading::{SheetLighting, sheet_matter}
#ifdef POLYGONS
#import airlight::splatting::sheets::SheetNumber
#import airlight::splatting::surface_shadow::{heights_before_surface, share_of_sheet, mean_before_surface}
#endif

@group(#{GROUP}) @binding(0) var<uniform> light_camera: Camera;
@group(#{GROUP}) @binding(1) var<uniform> light: Light;
@group(#{GROUP}) @binding(2) var<uniform> sheets: Sheets;
@group(#{GROUP}) @binding(3) var<uniform> lighting: SheetLighting;
@group(#{GROUP}) @binding(4) var light_sheet: texture_2d<f32>;
@group(#{GROUP}) @binding(5) var transfer: texture_2d<f32>;
@group(#{GROUP}) @binding(6) var linear_sampler: sampler;
@group(#{GROUP}) @binding(7) var<storage, read_write> left: array<vec4<f32>>;
@group(#{GROUP}) @binding(8) var shadow: texture_storage_2d<rgba16float, write>;
#ifdef POLYGONS
@group(#{GROUP}) @binding(9) var light_heights: texture_2d<f32>;
@group(#{GROUP}) @binding(10) var<uniform> number: SheetNumber;
#endif
#ifdef LIGHT_TEXTURE
@group(#{GROUP}) @binding(11) var light_texture: texture_2d<f32>;
#endif

/// Keeps what is left of the light at a texel.
fn keep(texel: vec2<u32>, light_left: vec4<f32>) {
    let place = texel.y * textureDimensions(shadow).x + texel.x;
    if place < arrayLength(&left) {
        left[place] = light_left;
    }
    textureStore(shadow, texel, min(light_left, vec4<f32>(65504.0)));
}

@compute @workgroup_size(16, 8)
fn begin_light(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = textureDimensions(shadow);
    if any(id.xy >= size) {
        return;
    }
    var color = vec3<f32>(1.0);
#ifdef LIGHT_TEXTURE
    // Any depth serves.
    let point = shadow_point(light, vec2<f32>(size), vec2<f32>(id.xy) + 0.5, 0.5);
    color = light_texture_color(light, light_texture, linear_sampler, point);
#endif
    keep(id.xy, vec4<f32>(color * max(light.radiance, vec3<f32>(0.0)), 1.0));
}

@compute @workgroup_size(16, 8)
fn light_sheet_left(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = textureDimensions(shadow);
    if any(id.xy >= size) {
        return;
    }
    let mean = sheet_mean(textureLoad(light_sheet, id.xy, 0));
#ifdef POLYGONS
    let seen = heights_before_surface(sheets, number.index, true, textureLoad(light_heights, id.xy, 0).x);
    let share = share_of_sheet(sheets, seen);
    let value = mean_before_surface(mean, share);
#else
    let share = 1.0;
    let value = mean;
#endif
    let ray = view_ray(light_camera, ndc_from_pixel(light_camera, vec2<f32>(id.xy) + 0.5));
    let extinction = lighting.extinction * sheet_matter(transfer, linear_sampler, value).a;
    let through = exp(-min(extinction * share * metres_in_sheet(sheets, ray.direction), 80.0));
    keep(id.xy, through * left[min(id.y * size.x + id.x, arrayLength(&left) - 1u)]);
}
