// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Projects a picture back into the volume: the product with the transpose of W, in which each ray scatters.
// source: thesis 7.4.1; see inverse/render_slices, whose steps and weights these are.
// note: Dispatch over the picture of a view, into zeros; then inverse/scattered_sums. Additions are of whole numbers, 64 bits each: results are
// note: the same bits in every run, although no one knows the order. See inverse/fixed_point for why they do not overflow.
// note: Where each voxel collects, inverse/cg_backproject, the products are the same; here rays may be bent, and no volume of weighed steps is needed.
// definition PATHS: weights of extinction, the lengths of steps.
// definition ALBEDO: weights of albedo; else of emission. Without PATHS.
// definition RGB: three channels, each by itself; else one.
// definition BOX: what is solved for is constant in each voxel; else straight between them.
// definition SWAP: sums are floats in single words, added by compare and exchange: half the memory, and not the same in every run.
// definition BENT: rays are bent by an index of refraction.
// binding view: the view.
// binding spans: which part of each ray lies in the volume, rg32float; of inverse/ray_spans, with BENT if this has it.
// binding steps: of its rays; with BENT.
// binding grid: the voxels.
// binding picture: what is projected back.
// binding extinction: of the medium, 1/m; without PATHS.
// binding scattered: radiance that an albedo of 1 scatters towards the eye; with ALBEDO.
// binding refraction: index of refraction; with BENT.
// binding greatest: of inverse/greatest_values; without SWAP.
// binding words: in and out, channel by channel and x fastest, two words a number, the lower first; with SWAP one.

#import airlight::core::finite::finite_or
#import airlight::inverse::slice_steps::{SliceView, VoxelGrid, slice_ray}
#ifdef BENT
#import airlight::inverse::slice_steps::{RaySteps, MOST_RAY_STEPS}
#import airlight::inverse::bent_rays::{bent_ray, next_part, box_slopes}
#else
#import airlight::inverse::slice_steps::{slice_walk, slice_of_step, slice_part}
#endif
#import airlight::inverse::channels::{channels_of, all_channels}
#ifndef PATHS
#import airlight::inverse::channels::step_weight
#endif
#import airlight::inverse::basis::{triangle_corner, triangle_field, voxel_of_place}
#import airlight::inverse::fixed_point::{fixed_exponent, fixed_words, pixel_exponent}

@group(#{GROUP}) @binding(0) var<uniform> view: SliceView;
@group(#{GROUP}) @binding(1) var spans: texture_2d<f32>;
#ifdef BENT
@group(#{GROUP}) @binding(2) var<uniform> steps: RaySteps;
#endif
@group(#{GROUP}) @binding(3) var<uniform> grid: VoxelGrid;
@group(#{GROUP}) @binding(4) var picture: texture_2d<f32>;
#ifndef PATHS
@group(#{GROUP}) @binding(5) var extinction: texture_3d<f32>;
#endif
#ifdef ALBEDO
@group(#{GROUP}) @binding(6) var scattered: texture_3d<f32>;
#endif
#ifdef BENT
@group(#{GROUP}) @binding(7) var refraction: texture_3d<f32>;
#endif
#ifndef SWAP
@group(#{GROUP}) @binding(8) var<storage, read> greatest: array<u32>;
#endif
@group(#{GROUP}) @binding(9) var<storage, read_write> words: array<atomic<u32>>;

#ifdef SWAP
/// Adds to a number.
fn add(number: u32, value: f32, exponent: i32, pixels: i32) {
    let place = min(number, arrayLength(&words) - 1u);
    var old = atomicLoad(&words[place]);
    loop {
        let tried = atomicCompareExchangeWeak(&words[place], old, bitcast<u32>(bitcast<f32>(old) + value));
        if tried.exchanged {
            break;
        }
        old = tried.old_value;
    }
}
#else
/// Adds to a number. Each time the lower word runs over, who sees it carries.
fn add(number: u32, value: f32, exponent: i32, pixels: i32) {
    let place = min(2u * number, max(arrayLength(&words), 2u) - 2u);
    let added = fixed_words(value, exponent, pixels);
    let old = atomicAdd(&words[place], added.x);
    let carried = select(0u, 1u, old > 0xffffffffu - added.x);
    atomicAdd(&words[min(place + 1u, arrayLength(&words) - 1u)], added.y + carried);
}
#endif

/// Adds channels to a voxel's sums.
#ifdef RGB
fn add_channels(voxel: vec3<u32>, value: vec3<f32>, exponents: vec3<i32>, pixels: i32) {
    let index = (voxel.z * grid.size.y + voxel.y) * grid.size.x + voxel.x;
    for (var channel = 0u; channel < 3u; channel++) {
        add(3u * index + channel, value[channel], exponents[channel], pixels);
    }
}
#else
fn add_channels(voxel: vec3<u32>, value: f32, exponents: vec3<i32>, pixels: i32) {
    let index = (voxel.z * grid.size.y + voxel.y) * grid.size.x + voxel.x;
    add(index, value, exponents.x, pixels);
}
#endif

/// Exponents of fixed point, by channel.
fn exponents_of_channels() -> vec3<i32> {
    var exponents = vec3<i32>(0);
#ifndef SWAP
    for (var channel = 0u; channel < 3u; channel++) {
        let most = arrayLength(&greatest) - 1u;
        exponents[channel] = fixed_exponent(greatest[min(channel, most)], greatest[min(4u + channel, most)]);
    }
#endif
    return exponents;
}

@compute @workgroup_size(16, 8)
fn scatter_steps(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= vec2<u32>(view.width, view.height)) {
        return;
    }
    let ray = slice_ray(view, vec2<f32>(id.xy) + 0.5);
    let span = textureLoad(spans, min(id.xy, textureDimensions(spans) - 1u), 0).xy;
    let texel = textureLoad(picture, min(id.xy, textureDimensions(picture) - 1u), 0);
    let value = channels_of(vec4<f32>(finite_or(texel.x, 0.0), finite_or(texel.y, 0.0), finite_or(texel.z, 0.0), 0.0));
    let exponents = exponents_of_channels();
    let pixels = pixel_exponent(view.width * view.height);
#ifdef BENT
    let slopes = box_slopes(view);
    var bent = bent_ray(refraction, view, ray, span);
    let first = 0u;
    let end = min(steps.most, MOST_RAY_STEPS);
#else
    let walk = slice_walk(view, ray, span);
    let first = walk.first;
    let end = walk.end;
#endif
#ifndef PATHS
    var depth = all_channels(0.0);
#endif
    for (var step = first; step < end; step++) {
#ifdef BENT
        let part = next_part(refraction, slopes, &bent, steps.metres);
        if part.metres <= 0.0 {
            break;
        }
#else
        let part = slice_part(view, ray, span, slice_of_step(walk, step));
#endif
#ifdef PATHS
        let sent = value * part.metres;
#else
        var weight = step_weight(&depth, channels_of(triangle_field(extinction, part.place)), part.metres);
#ifdef ALBEDO
        weight *= channels_of(triangle_field(scattered, part.place));
#endif
        let sent = value * weight;
#endif
        if part.metres > 0.0 {
#ifdef BOX
            add_channels(voxel_of_place(part.place, grid.size), sent, exponents, pixels);
#else
            for (var corner = 0u; corner < 8u; corner++) {
                let reached = triangle_corner(part.place, grid.size, corner);
                add_channels(reached.voxel, reached.weight * sent, exponents, pixels);
            }
#endif
        }
    }
}
