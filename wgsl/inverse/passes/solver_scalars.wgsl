// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Adds up what groups have summed, and says how far the solver goes.
// source: thesis 7.4.1; see inverse/solver_steps.
// note: One group, each entry: keep_residual after inverse/picture_sums, choose_direction after solver_gradient, choose_step after
// note: solver_curvature.
// binding counts: how many sums there are.
// binding sums: of groups: two a group of volumes, then one a group of pictures, by channel.
// binding scalars: of the solver, by channel: what is kept of the direction, length of the step, square of the way downhill; from the fourth
// binding scalars: on the weighed square of what is wrong, of each iteration.

#import airlight::inverse::solver_steps::{SolverSums, kept_direction, step_length}
#import airlight::inverse::group_sum::{GROUP_THREADS, group_sum}

@group(#{GROUP}) @binding(0) var<uniform> counts: SolverSums;
@group(#{GROUP}) @binding(1) var<storage, read> sums: array<vec4<f32>>;
@group(#{GROUP}) @binding(2) var<storage, read_write> scalars: array<vec4<f32>>;

/// First of the residuals.
const RESIDUALS: u32 = 3u;

/// The sum of `count` sums from `first` on, in all threads.
fn total(thread: u32, first: u32, count: u32) -> vec4<f32> {
    var sum = vec4<f32>(0.0);
    for (var place = thread; place < min(count, arrayLength(&sums)); place += GROUP_THREADS) {
        sum += sums[min(first + place, arrayLength(&sums) - 1u)];
    }
    return group_sum(thread, sum);
}

@compute @workgroup_size(128)
fn keep_residual(@builtin(local_invocation_index) thread: u32) {
    let square = total(thread, counts.first_picture, counts.pictures);
    if thread == 0u {
        scalars[min(RESIDUALS + counts.iteration, arrayLength(&scalars) - 1u)] = square;
    }
}

@compute @workgroup_size(128)
fn choose_direction(@builtin(local_invocation_index) thread: u32) {
    let square = total(thread, 0u, counts.groups);
    let product = total(thread, counts.groups, counts.groups);
    if thread == 0u {
        let before = scalars[min(2, arrayLength(&scalars) - 1u)];
        let first = counts.iteration == 0u;
        scalars[min(0, arrayLength(&scalars) - 1u)] = vec4<f32>(
            kept_direction(square.x, product.x, before.x, first),
            kept_direction(square.y, product.y, before.y, first),
            kept_direction(square.z, product.z, before.z, first),
            0.0
        );
        scalars[min(2, arrayLength(&scalars) - 1u)] = square;
    }
}

@compute @workgroup_size(128)
fn choose_step(@builtin(local_invocation_index) thread: u32) {
    let descent = total(thread, 0u, counts.groups);
    let curvature = total(thread, counts.groups, counts.groups) + total(thread, counts.first_picture, counts.pictures);
    if thread == 0u {
        scalars[min(1, arrayLength(&scalars) - 1u)] = vec4<f32>(
            step_length(descent.x, curvature.x),
            step_length(descent.y, curvature.y),
            step_length(descent.z, curvature.z),
            0.0
        );
    }
}
