// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: What a sheet leaves of the light: the shadow buffer is multiplied by the sheet's transmittance.
// source: Zhang and Crawfis, 4.1 step 21, Eq. 5 without scattering.
// note: Drawn indirectly over the shadow buffer, blended as destination * source; a sheet without splats draws nothing.
// binding light_camera: the light as a camera.
// binding sheets: the sheets.
// binding lighting: extinction.
// binding light_sheet: mean values of the sheet along the light rays, r16float.
// binding transfer: colour and opacity of values 0..1, one row, rgba16float or rgba8unorm.
// binding linear_sampler: linear, clamped to the edge.

#import airlight::core::camera::{Camera, view_ray, ndc_from_pixel}
#import airlight::core::picture::picture_corner
#import airlight::splatting::sheets::{Sheets, metres_in_sheet}
#import airlight::splatting::sheet_shading::{SheetLighting, classified}

@group(#{GROUP}) @binding(0) var<uniform> light_camera: Camera;
@group(#{GROUP}) @binding(1) var<uniform> sheets: Sheets;
@group(#{GROUP}) @binding(2) var<uniform> lighting: SheetLighting;
@group(#{GROUP}) @binding(3) var light_sheet: texture_2d<f32>;
@group(#{GROUP}) @binding(4) var transfer: texture_2d<f32>;
@group(#{GROUP}) @binding(5) var linear_sampler: sampler;

@vertex
fn vertex_picture(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return picture_corner(index);
}

@fragment
fn fragment_light_sheet(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let value = textureLoad(light_sheet, vec2<u32>(position.xy), 0).x;
    let ray = view_ray(light_camera, ndc_from_pixel(light_camera, position.xy));
    let extinction = lighting.extinction * classified(transfer, linear_sampler, value).a;
    return vec4<f32>(exp(-min(extinction * metres_in_sheet(sheets, ray.direction), 80.0)));
}
