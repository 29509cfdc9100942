// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: inverse/picture_sums, permutation default (RGB)
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

// ---- airlight::core::finite ----
// summary: Replaces NaN and infinities in data that comes from outside.
// source: IEEE 754 binary32: all exponent bits set means NaN or infinity.

/// True if `x` is neither NaN nor infinite.
fn is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u;
}

/// `x` where it is finite, `fallback` elsewhere.
fn finite_or(x: f32, fallback: f32) -> f32 {
    return select(fallback, x, is_finite(x));
}

/// Like `finite_or`, each component by itself.
fn finite_or_rgb(x: vec3<f32>, fallback: f32) -> vec3<f32> {
    return vec3<f32>(finite_or(x.x, fallback), finite_or(x.y, fallback), finite_or(x.z, fallback));
}

// ---- airlight::inverse::group_sum ----
// summary: The sum over a group of 128 threads, always added up in the same order.
// source: none; a tree of halves.

/// Threads of a group.
const GROUP_THREADS: u32 = 128u;

var<workgroup> group_sums: array<vec4<f32>, GROUP_THREADS>;

/// The sum of what the threads of a group have, in all of them. `thread`: index in the group. In uniform control flow.
fn group_sum(thread: u32, value: vec4<f32>) -> vec4<f32> {
    group_sums[min(thread, GROUP_THREADS - 1u)] = value;
    workgroupBarrier();
    for (var half = GROUP_THREADS / 2u; half > 0u; half = half >> 1u) {
        if thread < half {
            group_sums[thread] += group_sums[thread + half];
        }
        workgroupBarrier();
    }
    let sum = group_sums[0];
    // So that the next sum does not overwrite what some thread has yet to read.
    workgroupBarrier();
    return sum;
}

/// Number of a group of a dispatch, the first axis fastest.
fn group_index(group: vec3<u32>, groups: vec3<u32>) -> u32 {
    return (group.z * groups.y + group.y) * groups.x + group.x;
}

// ---- airlight::inverse::slice_steps ----
// summary: View rays in steps from slice to slice of a volume's box; a picture and its back-projection take the same.
// source: thesis 7.4.1 and Listing 7.1; slices along the main axis after Joseph (1982).

/// Rows of a picture. 16 bytes.
struct PictureRows {
    /// From 0 at the top.
    first: u32,
    /// How many.
    count: u32,
    reserved_a: u32,
    reserved_b: u32,
}

// ---- inverse/picture_sums ----

@group(0) @binding(0) var<uniform> rows: PictureRows;
@group(0) @binding(1) var rendered: texture_2d<f32>;
@group(0) @binding(2) var wanted: texture_2d<f32>;
@group(0) @binding(3) var weights: texture_2d<f32>;
@group(0) @binding(4) var difference: texture_storage_2d<rgba32float, write>;
@group(0) @binding(5) var<storage, read_write> sums: array<vec4<f32>>;

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
