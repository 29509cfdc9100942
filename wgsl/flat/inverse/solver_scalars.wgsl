// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: inverse/solver_scalars, permutation default
// summary: Adds up what groups have summed, and says how far the solver goes.
// source: thesis 7.4.1; see inverse/solver_steps.
// note: One group, each entry: keep_residual after inverse/picture_sums, choose_direction after solver_gradient, choose_step after
// note: solver_curvature.
// binding counts: how many sums there are.
// binding sums: of groups: two a group of volumes, then one a group of pictures, by channel.
// binding scalars: of the solver, by channel: what is kept of the direction, length of the step, square of the way downhill; from the fourth
// binding scalars: on the weighed square of what is wrong, of each iteration.

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

// ---- airlight::inverse::solver_steps ----
// summary: Steps of conjugate gradients between bounds, for least squares whose matrix is a rendering.
// source: thesis 7.4.1 and 7.4.2; the direction of Polak and Ribiere (1969); Shewchuk (1994).

/// Sums of groups, and where those of pictures begin. 16 bytes.
struct SolverSums {
    /// Groups of all volumes that are solved for: their sums come first, twice.
    groups: u32,
    /// First sum of a picture.
    first_picture: u32,
    /// Sums of pictures.
    pictures: u32,
    /// From 0.
    iteration: u32,
}

/// Share of the direction before that the next one keeps. `square`: of the way downhill, times the pace; `product`: of it and the one before,
/// likewise; `before`: square of that one; `first`: whether there is none before.
fn kept_direction(square: f32, product: f32, before: f32, first: bool) -> f32 {
    let kept = max(square - product, 0.0) / max(before, 1e-30);
    // More than this says that the one before was no descent at all.
    return select(min(kept, 1e4), 0.0, first || before <= 0.0);
}

/// Length of a step along a direction. `descent`: product of the way downhill and the direction; `curvature`: of the direction, squared by the matrix.
fn step_length(descent: f32, curvature: f32) -> f32 {
    return select(0.0, descent / max(curvature, 1e-30), curvature > 0.0 && descent > 0.0);
}

// ---- inverse/solver_scalars ----

@group(0) @binding(0) var<uniform> counts: SolverSums;
@group(0) @binding(1) var<storage, read> sums: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read_write> scalars: array<vec4<f32>>;

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
