// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Projects a picture back into the volume: the product with the transpose of W, in which each voxel collects.
// source: thesis 7.4.1; see the module of this name.
// note: Dispatch over the voxels for each view and each group of its rows; `collected` adds up, from zero on. No additions race: results are
// note: the same bits in every run.
// definition PATHS: weights of extinction, the lengths of steps.
// definition RGB: three channels, each by itself; else one.
// definition BOX: what is solved for is constant in each voxel; else straight between them.
// binding view: the view.
// binding spans: which part of each ray lies in the volume, rg32float.
// binding rows: which rows of the picture.
// binding grid: the voxels.
// binding picture: what is projected back; with PATHS.
// binding weighed: of inverse/weigh_slices.
// binding solved: 0 where a voxel is not solved for: it stays as it is. A number a voxel, x fastest.
// binding collected: in and out, a number a voxel; four with RGB, of which the last stays as it is.

#import airlight::inverse::slice_steps::{SliceView, PictureRows, VoxelGrid, slice_ray, slice_part}
#import airlight::inverse::channels::{channels_of, all_channels}
#import airlight::inverse::basis::{box_weights, triangle_weights}
#import airlight::inverse::cg_backproject::{support_of, slices_of_support, pixels_of_slice, only_whole_slices}
#ifndef BOX
#import airlight::inverse::cg_backproject::{crossings_of_slice, crossing_weight, pixels_of_plane}
#endif

@group(#{GROUP}) @binding(0) var<uniform> view: SliceView;
@group(#{GROUP}) @binding(1) var spans: texture_2d<f32>;
@group(#{GROUP}) @binding(2) var<uniform> rows: PictureRows;
@group(#{GROUP}) @binding(3) var<uniform> grid: VoxelGrid;
#ifdef PATHS
@group(#{GROUP}) @binding(4) var picture: texture_2d<f32>;
#endif
@group(#{GROUP}) @binding(5) var weighed: texture_3d<f32>;
@group(#{GROUP}) @binding(6) var<storage, read> solved: array<f32>;
@group(#{GROUP}) @binding(7) var<storage, read_write> collected: array<f32>;

/// Pixels in the rows that are projected back, and in the picture.
fn in_rows(pixels: vec4<i32>) -> vec4<i32> {
    let first = i32(rows.first);
    let last = vec2<i32>(textureDimensions(spans)) - 1;
    let end = min(first + i32(rows.count) - 1, last.y);
    return vec4<i32>(pixels.x, max(pixels.y, first), min(pixels.z, last.x), min(pixels.w, end));
}

/// Where `weighed` has a pixel's step in a slice.
fn step_of(column: i32, row: i32, slice: u32) -> vec3<u32> {
#ifdef PATHS
    return vec3<u32>(u32(column), u32(row) - rows.first, 0u);
#else
    return vec3<u32>(u32(column), u32(row) - rows.first, slice);
#endif
}

@compute @workgroup_size(8, 4, 4)
fn cg_backproject(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id >= grid.size) {
        return;
    }
    let index = (id.z * grid.size.y + id.y) * grid.size.x + id.x;
    if index >= arrayLength(&solved) || solved[index] == 0.0 {
        return;
    }
    var sum = all_channels(0.0);
#ifdef BOX
    let support = support_of(id, grid.size, 0.5);
    let slices = slices_of_support(view, support);
#else
    let support = support_of(id, grid.size, 1.0);
    let all_slices = slices_of_support(view, support);
    // Where rays cross slices whole their samples are where they cross the middle plane, which is less to work out. Loops that end at once are skipped
    // where branches that nothing takes would not be.
    let whole = only_whole_slices(view, support);
    let slices = vec2<u32>(all_slices.x, select(all_slices.y, all_slices.x, whole));
    for (var slice = slices.y; slice < select(all_slices.x, all_slices.y, whole); slice++) {
        let crossings = crossings_of_slice(view, id, grid.size, slice);
        let pixels = in_rows(pixels_of_plane(view, support, slice));
        for (var row = pixels.y; row <= pixels.w; row++) {
            for (var column = pixels.x; column <= pixels.z; column++) {
                let weight = crossing_weight(crossings, vec2<f32>(f32(column), f32(row)));
                let sent = channels_of(textureLoad(weighed, step_of(column, row, slice), 0));
                // Rays that pass beside the voxel may have no step there.
                sum += select(all_channels(0.0), weight * sent, weight > 0.0);
            }
        }
    }
#endif
    for (var slice = slices.x; slice < slices.y; slice++) {
        let pixels = in_rows(pixels_of_slice(view, support, slice));
        for (var row = pixels.y; row <= pixels.w; row++) {
            for (var column = pixels.x; column <= pixels.z; column++) {
                let pixel = vec2<u32>(u32(column), u32(row));
                let span = textureLoad(spans, pixel, 0).xy;
                let part = slice_part(view, slice_ray(view, vec2<f32>(pixel) + 0.5), span, slice);
#ifdef BOX
                let weights = box_weights(part.place, id, grid.size);
#else
                let weights = triangle_weights(part.place, id, grid.size);
#endif
                let weight = weights.x * weights.y * weights.z;
#ifdef PATHS
                sum += weight * part.metres * channels_of(textureLoad(picture, pixel, 0));
#else
                let sent = channels_of(textureLoad(weighed, step_of(column, row, slice), 0));
                sum += select(all_channels(0.0), weight * sent, part.metres > 0.0);
#endif
            }
        }
    }
#ifdef RGB
    for (var channel = 0u; channel < 3u; channel++) {
        let place = min(4u * index + channel, arrayLength(&collected) - 1u);
        collected[place] += sum[channel];
    }
#else
    collected[min(index, arrayLength(&collected) - 1u)] += sum;
#endif
}
