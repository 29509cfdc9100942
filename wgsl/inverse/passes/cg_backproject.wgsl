// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Projects a picture back into the volume: the product with the transpose of W, in which each voxel collects.
// source: Klehm, "Stylized scattering", thesis, 7.4.1; see the module of this name.
// note: Dispatch over the voxels for each view and each group of its rows; `collected` adds up, from zero on. No additions race: results are
// note: the same bits in every run.
// definition PATHS: weights of extinction, the lengths of steps; else what inverse/weigh_slices left.
// definition RGB: three channels, each by itself; else one.
// definition BOX: what is solved for is constant in each voxel; else straight between them.
// binding view: the view.
// binding spans: which part of each ray lies in the volume, rg32float.
// binding rows: which rows of the picture.
// binding grid: the voxels.
// binding picture: what is projected back; with PATHS.
// binding weighed: of inverse/weigh_slices; without PATHS.
// binding solved: 0 where a voxel is not solved for: it stays as it is. A number a voxel, x fastest.
// binding collected: in and out, a number a voxel; four with RGB, of which the last stays as it is.

#import airlight::inverse::slice_steps::{SliceView, PictureRows, VoxelGrid, SlicePart, slice_ray, slice_part, whole_slice}
#import airlight::inverse::channels::{channels_of, all_channels}
#import airlight::inverse::basis::{box_weights, triangle_weights}
#import airlight::inverse::cg_backproject::{support_of, slices_of_support, pixels_of_slice, only_whole_slices}

@group(#{GROUP}) @binding(0) var<uniform> view: SliceView;
@group(#{GROUP}) @binding(1) var spans: texture_2d<f32>;
@group(#{GROUP}) @binding(2) var<uniform> rows: PictureRows;
@group(#{GROUP}) @binding(3) var<uniform> grid: VoxelGrid;
#ifdef PATHS
@group(#{GROUP}) @binding(4) var picture: texture_2d<f32>;
#else
@group(#{GROUP}) @binding(5) var weighed: texture_3d<f32>;
#endif
@group(#{GROUP}) @binding(6) var<storage, read> solved: array<f32>;
@group(#{GROUP}) @binding(7) var<storage, read_write> collected: array<f32>;

@compute @workgroup_size(8, 4, 4)
fn cg_backproject(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id >= grid.size) {
        return;
    }
    let index = (id.z * grid.size.y + id.y) * grid.size.x + id.x;
    if index >= arrayLength(&solved) || solved[index] == 0.0 {
        return;
    }
#ifdef BOX
    let support = support_of(id, grid.size, 0.5);
#else
    let support = support_of(id, grid.size, 1.0);
#endif
    let slices = slices_of_support(view, support);
    let last_row = i32(rows.first + rows.count) - 1;
    let whole = only_whole_slices(view, support);
    var sum = all_channels(0.0);
    for (var slice = slices.x; slice < slices.y; slice++) {
        var pixels = pixels_of_slice(view, support, slice, whole);
        pixels.y = max(pixels.y, i32(rows.first));
        pixels.w = min(pixels.w, last_row);
        for (var row = pixels.y; row <= pixels.w; row++) {
            let left = slice_ray(view, vec2<f32>(f32(pixels.x), f32(row)) + 0.5);
            for (var column = pixels.x; column <= pixels.z; column++) {
                let pixel = vec2<u32>(u32(column), u32(row));
                var part: SlicePart;
                if whole {
                    part = whole_slice(view, left, f32(column - pixels.x), slice);
                } else {
                    let span = textureLoad(spans, pixel, 0).xy;
                    part = slice_part(view, slice_ray(view, vec2<f32>(pixel) + 0.5), span, slice);
                }
#ifdef BOX
                let weights = box_weights(part.place, id, grid.size);
#else
                let weights = triangle_weights(part.place, id, grid.size);
#endif
                let weight = weights.x * weights.y * weights.z;
#ifdef PATHS
                sum += weight * part.metres * channels_of(textureLoad(picture, pixel, 0));
#else
                let sent = channels_of(textureLoad(weighed, vec3<u32>(pixel.x, pixel.y - rows.first, slice), 0));
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
