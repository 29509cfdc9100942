// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Adds what inverse/scatter_steps has scattered to what is collected, and leaves zeros.
// source: none; fixed point as floats.
// note: Dispatch over the voxels, with RGB and SWAP as inverse/scatter_steps has them.
// definition RGB: three channels, each by itself; else one.
// definition SWAP: sums are floats in single words.
// binding view: the view.
// binding grid: the voxels.
// binding greatest: of inverse/greatest_values; without SWAP.
// binding words: in and out, sums and then zeros.
// binding solved: 0 where a voxel is not solved for: it stays as it is. A number a voxel, x fastest.
// binding collected: in and out, a number a voxel; four with RGB, of which the last stays as it is.

#import airlight::inverse::slice_steps::{SliceView, VoxelGrid}
#import airlight::inverse::fixed_point::{fixed_exponent, fixed_number, pixel_exponent}

@group(#{GROUP}) @binding(0) var<uniform> view: SliceView;
@group(#{GROUP}) @binding(1) var<uniform> grid: VoxelGrid;
#ifndef SWAP
@group(#{GROUP}) @binding(2) var<storage, read> greatest: array<u32>;
#endif
@group(#{GROUP}) @binding(3) var<storage, read_write> words: array<u32>;
@group(#{GROUP}) @binding(4) var<storage, read> solved: array<f32>;
@group(#{GROUP}) @binding(5) var<storage, read_write> collected: array<f32>;

/// Takes a number out of the words. `channel`: of it, 0 to 2.
fn taken(number: u32, channel: u32) -> f32 {
#ifdef SWAP
    let place = min(number, arrayLength(&words) - 1u);
    let sum = bitcast<f32>(words[place]);
    words[place] = 0u;
    return sum;
#else
    let place = min(2u * number, max(arrayLength(&words), 2u) - 2u);
    let both = vec2<u32>(words[place], words[min(place + 1u, arrayLength(&words) - 1u)]);
    words[place] = 0u;
    words[min(place + 1u, arrayLength(&words) - 1u)] = 0u;
    let most = arrayLength(&greatest) - 1u;
    let exponent = fixed_exponent(greatest[min(channel, most)], greatest[min(4u + channel, most)]);
    return fixed_number(both, exponent, pixel_exponent(view.width * view.height));
#endif
}

@compute @workgroup_size(8, 4, 4)
fn scattered_sums(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id >= grid.size) {
        return;
    }
    let index = (id.z * grid.size.y + id.y) * grid.size.x + id.x;
    let wanted = solved[min(index, arrayLength(&solved) - 1u)] != 0.0;
#ifdef RGB
    for (var channel = 0u; channel < 3u; channel++) {
        let sum = taken(3u * index + channel, channel);
        let place = min(4u * index + channel, arrayLength(&collected) - 1u);
        collected[place] += select(0.0, sum, wanted);
    }
#else
    let sum = taken(index, 0u);
    collected[min(index, arrayLength(&collected) - 1u)] += select(0.0, sum, wanted);
#endif
}
