// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: What arrives of an area light at a sheet, and what the sheet does to the layers of the shadow buffer.
// source: Zhang and Crawfis, 5.1; see splatting/soft_shadow.
// note: Dispatch over the shadow buffer for each sheet before its picture, with `splatting/soften_sheet` between sheets, and once
// note: more behind the last. Layers need no zeros before the first: none is read before something was written.
// note: A surface is lit by what arrives at the sheet in which it lies, which `held` keeps.
// definition POLYGONS: there are surfaces besides the volume.
// binding number: which sheet; as many as there are behind the last.
// binding soft: the buffer, and solids.
// binding light_camera: the light as a camera of the buffer.
// binding light: the light.
// binding sheets: the sheets.
// binding lighting: extinction.
// binding light_sheet: mean values of the sheet along the light rays, rgba16float.
// binding transfer: finite colour and opacity of values 0..1, one row, rgba16float or rgba8unorm.
// binding linear_sampler: linear, clamped to the edge.
// binding merges: what each sheet does with layers.
// binding layers: transmittances of the volume, layer after layer, row after row; in and out.
// binding shadow: out, what arrives of the light at the sheet, linear RGB.
// binding kept: of surfaces, 1 less what each layer newly takes of the light; like layers, with POLYGONS only.
// binding filled: transmittances of solids; like layers, with POLYGONS only.
// binding light_heights: of the first surface along each light ray, along the normal of the sheets, metres, 1e30 where there is none; with
// binding light_heights: POLYGONS only, r32float.
// binding light_exit_heights: the same of the first surface that turns its back to the light; with POLYGONS only, r32float.
// binding held: out, what arrives at the first surface along each light ray, linear RGB; with POLYGONS only.

#import airlight::core::camera::{Camera, view_ray, ndc_from_pixel}
#import airlight::core::light::Light
#import airlight::splatting::sheets::{Sheets, SheetNumber, metres_in_sheet, sheet_mean}
#import airlight::splatting::sheet_shading::{SheetLighting, sheet_matter}
#import airlight::splatting::soft_shadow::{SOFT_LAYERS, LayerMerge, SoftLight, layers_in_use}
#ifdef POLYGONS
#import airlight::core::finite::finite_or
#import airlight::splatting::sheets::sheet_heights
#import airlight::splatting::surface_shadow::NO_SURFACE
#import airlight::splatting::soft_shadow::{texel_metres, surface_slope, solid_depth, surface_in_sheet, surfaces_left}
#endif

@group(#{GROUP}) @binding(0) var<uniform> number: SheetNumber;
@group(#{GROUP}) @binding(1) var<uniform> soft: SoftLight;
@group(#{GROUP}) @binding(2) var<uniform> light_camera: Camera;
@group(#{GROUP}) @binding(3) var<uniform> light: Light;
@group(#{GROUP}) @binding(4) var<uniform> sheets: Sheets;
@group(#{GROUP}) @binding(5) var<uniform> lighting: SheetLighting;
@group(#{GROUP}) @binding(6) var light_sheet: texture_2d<f32>;
@group(#{GROUP}) @binding(7) var transfer: texture_2d<f32>;
@group(#{GROUP}) @binding(8) var linear_sampler: sampler;
@group(#{GROUP}) @binding(9) var<storage, read> merges: array<LayerMerge>;
@group(#{GROUP}) @binding(10) var<storage, read_write> layers: array<f32>;
@group(#{GROUP}) @binding(11) var shadow: texture_storage_2d<rgba16float, write>;
#ifdef POLYGONS
@group(#{GROUP}) @binding(12) var<storage, read_write> kept: array<f32>;
@group(#{GROUP}) @binding(13) var<storage, read_write> filled: array<f32>;
@group(#{GROUP}) @binding(14) var light_heights: texture_2d<f32>;
@group(#{GROUP}) @binding(15) var light_exit_heights: texture_2d<f32>;
@group(#{GROUP}) @binding(16) var held: texture_storage_2d<rgba16float, write>;
#endif

/// Where a texel of a layer lies in the buffers.
fn layer_place(layer: u32, pixel: vec2<u32>) -> u32 {
    let place = (layer * soft.size.y + pixel.y) * soft.size.x + pixel.x;
    return min(place, arrayLength(&layers) - 1u);
}

#ifdef POLYGONS
/// Height of the first surface along a texel's light ray, metres.
fn first_height(pixel: vec2<u32>) -> f32 {
    return finite_or(textureLoad(light_heights, min(pixel, textureDimensions(light_heights) - 1u), 0).x, NO_SURFACE);
}

/// How deep the solid behind a texel's surface is, metres.
fn depth_behind(pixel: vec2<u32>, height: f32) -> f32 {
    let low = max(pixel, vec2<u32>(1u)) - 1u;
    let before = vec2<f32>(first_height(vec2<u32>(low.x, pixel.y)), first_height(vec2<u32>(pixel.x, low.y)));
    let behind = vec2<f32>(first_height(pixel + vec2<u32>(1u, 0u)), first_height(pixel + vec2<u32>(0u, 1u)));
    let slope = surface_slope(height, before, behind, texel_metres(soft, height));
    let end = finite_or(textureLoad(light_exit_heights, min(pixel, textureDimensions(light_exit_heights) - 1u), 0).x, NO_SURFACE);
    return solid_depth(soft, height, slope, sheets.thickness, end);
}
#endif

/// What arrives of the light at a texel, of its radiance.
fn arriving_share(pixel: vec2<u32>) -> f32 {
    var share = 1.0;
    for (var layer = 0u; layer < layers_in_use(number.index); layer++) {
        share *= clamp(layers[layer_place(layer, pixel)], 0.0, 1.0);
    }
#ifdef POLYGONS
    var taken = 0.0;
    var darkest = 1.0;
    for (var layer = 0u; layer < layers_in_use(number.index); layer++) {
        let place = layer_place(layer, pixel);
        taken += 1.0 - kept[min(place, arrayLength(&kept) - 1u)];
        darkest = min(darkest, filled[min(place, arrayLength(&filled) - 1u)]);
    }
    share *= surfaces_left(taken, darkest);
#endif
    return share;
}

@compute @workgroup_size(16, 8)
fn soft_light(@builtin(global_invocation_id) id: vec3<u32>) {
    let pixel = id.xy;
    if any(pixel >= soft.size) {
        return;
    }
    let arrived = clamp(light.radiance, vec3<f32>(0.0), vec3<f32>(65504.0)) * arriving_share(pixel);
    textureStore(shadow, pixel, vec4<f32>(arrived, 1.0));
    if number.index >= min(sheets.count, arrayLength(&merges)) {
        return;
    }
    let merge = merges[number.index];
    let open = layer_place(min(merge.open, SOFT_LAYERS - 1u), pixel);
    let into = layer_place(min(merge.into, SOFT_LAYERS - 1u), pixel);
    let merging = merge.into < SOFT_LAYERS;
    let value = sheet_mean(textureLoad(light_sheet, pixel, 0));
    let ray = view_ray(light_camera, ndc_from_pixel(light_camera, vec2<f32>(pixel) + 0.5));
    let extinction = lighting.extinction * sheet_matter(transfer, linear_sampler, value).a;
    let through = exp(-min(extinction * metres_in_sheet(sheets, ray.direction), 80.0));
    if merging {
        layers[into] = layers[into] * layers[open];
    }
    layers[open] = through;
#ifdef POLYGONS
    let heights = sheet_heights(sheets, number.index);
    let height = first_height(pixel);
    if height >= heights.x || number.index == 0u {
        textureStore(held, pixel, vec4<f32>(arrived, 1.0));
    }
    let here = surface_in_sheet(height, heights, number.index);
    let solid = here || (height < heights.y && height + depth_behind(pixel, height) > heights.x);
    let ends = vec2<u32>(arrayLength(&kept), arrayLength(&filled)) - 1u;
    if merging {
        kept[min(into, ends.x)] = kept[min(into, ends.x)] + kept[min(open, ends.x)] - 1.0;
        filled[min(into, ends.y)] = min(filled[min(into, ends.y)], filled[min(open, ends.y)]);
    }
    kept[min(open, ends.x)] = select(1.0, 0.0, here);
    filled[min(open, ends.y)] = select(1.0, 0.0, solid);
#endif
}
