// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: What each step of a ray sends back into the volume: a pixel's value times the step's weight.
// source: thesis 7.4.1; see inverse/render_slices, whose weights these are.
// note: Dispatch over some rows of the picture of a view, then inverse/cg_backproject with the same rows. For extinction, where a step weighs its
// note: length, one slice stands for all: `weighed` has what a step sends back that crosses its slice whole.
// definition PATHS: weights of extinction, the lengths of steps.
// definition ALBEDO: weights of albedo; without it and PATHS those of emission.
// definition RGB: three channels, each by itself; else one.
// binding view: the view.
// binding spans: which part of each ray lies in the volume, rg32float; without PATHS.
// binding rows: which rows of the picture.
// binding picture: what is projected back.
// binding extinction: of the medium, 1/m; without PATHS.
// binding scattered: radiance that an albedo of 1 scatters towards the eye; with ALBEDO.
// binding weighed: out, columns, rows of the picture from the first on, slices; r32float, rgba32float with RGB. One
// binding weighed: slice with PATHS.

#import airlight::inverse::slice_steps::{SliceView, PictureRows, slice_ray}
#import airlight::inverse::channels::{channels_of, texel_of}
#ifdef PATHS
#import airlight::inverse::slice_steps::whole_slice_metres
#else
#import airlight::inverse::slice_steps::{slice_walk, slice_of_step, slice_part}
#import airlight::inverse::channels::{all_channels, step_weight}
#import airlight::inverse::basis::triangle_field
#endif

@group(#{GROUP}) @binding(0) var<uniform> view: SliceView;
#ifndef PATHS
@group(#{GROUP}) @binding(1) var spans: texture_2d<f32>;
#endif
@group(#{GROUP}) @binding(2) var<uniform> rows: PictureRows;
@group(#{GROUP}) @binding(3) var picture: texture_2d<f32>;
#ifndef PATHS
@group(#{GROUP}) @binding(4) var extinction: texture_3d<f32>;
#endif
#ifdef ALBEDO
@group(#{GROUP}) @binding(5) var scattered: texture_3d<f32>;
#endif
#ifdef RGB
@group(#{GROUP}) @binding(6) var weighed: texture_storage_3d<rgba32float, write>;
#else
@group(#{GROUP}) @binding(6) var weighed: texture_storage_3d<r32float, write>;
#endif

@compute @workgroup_size(16, 8)
fn weigh_slices(@builtin(global_invocation_id) id: vec3<u32>) {
    let pixel = vec2<u32>(id.x, id.y + rows.first);
    if id.y >= rows.count || any(pixel >= vec2<u32>(view.width, view.height)) {
        return;
    }
    let ray = slice_ray(view, vec2<f32>(pixel) + 0.5);
    let value = channels_of(textureLoad(picture, min(pixel, textureDimensions(picture) - 1u), 0));
#ifdef PATHS
    textureStore(weighed, vec3<u32>(id.xy, 0u), texel_of(value * whole_slice_metres(view, ray)));
#else
    let span = textureLoad(spans, min(pixel, textureDimensions(spans) - 1u), 0).xy;
    let walk = slice_walk(view, ray, span);
    var depth = all_channels(0.0);
    for (var step = walk.first; step < walk.end; step++) {
        let slice = slice_of_step(walk, step);
        let part = slice_part(view, ray, span, slice);
        var weight = step_weight(&depth, channels_of(triangle_field(extinction, part.place)), part.metres);
#ifdef ALBEDO
        weight *= channels_of(triangle_field(scattered, part.place));
#endif
        textureStore(weighed, vec3<u32>(id.xy, slice), texel_of(value * weight));
    }
#endif
}
