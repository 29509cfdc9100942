// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::inverse::group_sum
// summary: The sum over a group of 128 threads, always added up in the same order.
// source: none; a tree of halves.
// equation: sum = Σ over 128 threads by halves: s_t += s_(t + 64), s_t += s_(t + 32), ..
// error: the same order in every run; solvers with it reach the least squares;
// error: test inverse/solver::iterations_come_to_the_least_squares_between_bounds.
// parameter value: any four numbers.
// parameter group, groups: number of the group and numbers of groups along each axis.

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
