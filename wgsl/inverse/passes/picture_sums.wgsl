// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: What is wrong with a picture, or the picture itself, weighed, and sums of squares over it.
// source: thesis 7.4.1: c = W a - o, and per-pixel weights of 7.4.2.
// note: Dispatch over the picture: weigh_difference before the picture is projected back, weigh_picture of the picture of a direction. Sums of
// note: groups are added up by inverse/solver_scalars, always in the same order. A channel of `wanted` or a weight that is not finite counts for
// note: nothing.
// definition RGB: three channels; else one.
// binding rows: `first` is where the sums of this picture begin, groups.
// binding rendered: the picture, r32float or rgba32float.
// binding wanted: the picture that is wanted, likewise; for weigh_difference.
// binding weights: how much each pixel counts, from 0 up, r32float.
// binding difference: out, what was weighed, like `rendered`.
// binding sums: out, of each group, weighed sum of squares of the difference, or of the picture, by channel.

#import airlight::core::finite::{finite_or, finite_or_rgb}
#import airlight::inverse::slice_steps::PictureRows
#import airlight::inverse::group_sum::{group_sum, group_index}

@group(#{GROUP}) @binding(0) var<uniform> rows: PictureRows;
@group(#{GROUP}) @binding(1) var rendered: texture_2d<f32>;
@group(#{GROUP}) @binding(2) var wanted: texture_2d<f32>;
@group(#{GROUP}) @binding(3) var weights: texture_2d<f32>;
#ifdef RGB
@group(#{GROUP}) @binding(4) var difference: texture_storage_2d<rgba32float, write>;
#else
@group(#{GROUP}) @binding(4) var difference: texture_storage_2d<r32float, write>;
#endif
@group(#{GROUP}) @binding(5) var<storage, read_write> sums: array<vec4<f32>>;

/// Adds up what the threads of a group have and keeps it.
fn keep_sum(thread: u32, group: u32, value: vec4<f32>) {
    let sum = group_sum(thread, value);
    if thread == 0u {
        sums[min(rows.first + group, arrayLength(&sums) - 1u)] = sum;
    }
}

@compute @workgroup_size(16, 8)
fn weigh_difference(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>
) {
    let size = textureDimensions(rendered);
    let inside = all(id.xy < size);
    let pixel = min(id.xy, size - 1u);
    let weight = finite_or(textureLoad(weights, pixel, 0).x, 0.0);
    let apart = textureLoad(rendered, pixel, 0).rgb - textureLoad(wanted, pixel, 0).rgb;
    let off = vec4<f32>(finite_or_rgb(apart, 0.0), 0.0);
    if inside {
        textureStore(difference, pixel, weight * off);
    }
    keep_sum(thread, group_index(group, groups), select(vec4<f32>(0.0), weight * off * off, inside));
}

@compute @workgroup_size(16, 8)
fn weigh_picture(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>
) {
    let size = textureDimensions(rendered);
    let pixel = min(id.xy, size - 1u);
    let value = textureLoad(rendered, pixel, 0) * vec4<f32>(1.0, 1.0, 1.0, 0.0);
    let weight = finite_or(textureLoad(weights, pixel, 0).x, 0.0);
    let inside = all(id.xy < size);
    if inside {
        textureStore(difference, pixel, weight * value);
    }
    keep_sum(thread, group_index(group, groups), select(vec4<f32>(0.0), weight * value * value, inside));
}
