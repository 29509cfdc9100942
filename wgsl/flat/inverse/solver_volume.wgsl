// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: inverse/solver_volume, permutation default (RGB)
// summary: What the solver does with each voxel: smoothness, gradient, direction and step.
// source: thesis 7.4.1 and 7.4.2; see inverse/solver_steps.
// note: Dispatch over the voxels: solver_paces once, of what the weighed pictures of ones send back; then in an iteration in this order:
// note: smooth_solution, solver_gradient, [solver_scalars], solver_direction, solver_curvature, [solver_scalars], solver_advance. Beyond the
// note: volume and of voxels that are not solved for there is nothing to differ from.
// definition RGB: three channels, four numbers a voxel; else one.
// binding part: the volume that is solved for.
// binding solved: the pace of a voxel; 0 where it is not solved for.
// binding solution: numbers a voxel, x fastest.
// binding gradient: what was projected back; solver_gradient leaves zeros for the next time.
// binding downward: the way downhill.
// binding direction: the direction in which the solution goes.
// binding roughness: discrete Laplacian of the solution.
// binding sums: of each group two by channel: square and product of the ways downhill, each times the pace, or descent and curvature.
// binding scalars: of inverse/solver_scalars.

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

// ---- airlight::inverse::solver_steps ----
// summary: Steps of conjugate gradients between bounds, for least squares whose matrix is a rendering.
// source: thesis 7.4.1 and 7.4.2; the direction of Polak and Ribiere (1969); Shewchuk (1994).

/// One volume that is solved for. 48 bytes.
struct SolverPart {
    /// Voxels along x, y and z.
    size: vec3<u32>,
    /// Where its sums begin, groups.
    first_group: u32,
    /// Weight of the squared Laplacian.
    laplacian: f32,
    /// Weight of the squared value.
    smallness: f32,
    /// Weight of the squared difference from 1.
    oneness: f32,
    /// Least value.
    low: f32,
    /// Greatest value.
    high: f32,
    /// Groups of all volumes that are solved for.
    groups: u32,
    /// Least of what a pace is one over.
    steepest: f32,
    reserved_a: u32,
}

/// How far the solver goes, by channel. 48 bytes.
struct SolverScalars {
    /// What is kept of the direction before.
    kept: vec4<f32>,
    /// Length of the step along the direction.
    step: vec4<f32>,
    /// Square of the way downhill, times the pace.
    square: vec4<f32>,
}

/// How far a voxel goes for a slope: one over a bound of its share in the matrix. `sent`: what the weighed pictures of ones send back to it, the
/// row of W'C W summed up, which no eigenvalue of that matrix scaled by it exceeds.
fn pace_of(part: SolverPart, sent: f32) -> f32 {
    // 42 is on the diagonal of L'L where all six neighbours are solved for.
    return 1.0 / max(sent + 42.0 * part.laplacian + part.smallness + part.oneness, max(part.steepest, 1e-30));
}

/// What is left of a half gradient as the way downhill, at a value between its bounds.
fn downhill(part: SolverPart, value: f32, gradient: f32) -> f32 {
    let held = (value <= part.low && gradient > 0.0) || (value >= part.high && gradient < 0.0);
    return select(-gradient, 0.0, held);
}

// ---- inverse/solver_volume ----

@group(0) @binding(0) var<uniform> part: SolverPart;
@group(0) @binding(1) var<storage, read_write> solved: array<f32>;
@group(0) @binding(2) var<storage, read_write> solution: array<f32>;
@group(0) @binding(3) var<storage, read_write> gradient: array<f32>;
@group(0) @binding(4) var<storage, read_write> downward: array<f32>;
@group(0) @binding(5) var<storage, read_write> direction: array<f32>;
@group(0) @binding(6) var<storage, read_write> roughness: array<f32>;
@group(0) @binding(7) var<storage, read_write> sums: array<vec4<f32>>;
@group(0) @binding(8) var<uniform> scalars: SolverScalars;

const CHANNELS: u32 = 3u;
const NUMBERS: u32 = 4u;

/// What a Laplacian is taken of.
const SOLUTION: u32 = 0u;
const DIRECTION: u32 = 1u;
const ROUGHNESS: u32 = 2u;

/// A voxel of a dispatch.
struct Voxel {
    /// Along x, y and z.
    id: vec3<u32>,
    /// In vectors of a number a voxel.
    index: u32,
    /// Whether it is solved for.
    counts: bool,
    /// How far it goes for a slope.
    pace: f32,
}

fn index_of(id: vec3<u32>) -> u32 {
    return (id.z * part.size.y + id.y) * part.size.x + id.x;
}

/// The pace of a voxel; 0 of one that is not solved for, or beyond the volume.
fn pace_at(id: vec3<u32>) -> f32 {
    let place = min(index_of(min(id, part.size - 1u)), arrayLength(&solved) - 1u);
    return select(0.0, solved[place], all(id < part.size));
}

fn voxel_of(id: vec3<u32>) -> Voxel {
    let pace = pace_at(id);
    return Voxel(id, index_of(min(id, part.size - 1u)), pace != 0.0, pace);
}

/// Where a channel of a voxel lies.
fn place_of(index: u32, channel: u32) -> u32 {
    return min(NUMBERS * index + channel, arrayLength(&solution) - 1u);
}

fn value_of(which: u32, place: u32) -> f32 {
    if which == SOLUTION {
        return solution[place];
    }
    if which == DIRECTION {
        return direction[place];
    }
    return roughness[place];
}

/// The sum of differences of the six neighbours that are solved for.
fn laplacian_at(which: u32, voxel: Voxel, channel: u32) -> f32 {
    let own = value_of(which, place_of(voxel.index, channel));
    var sum = 0.0;
    for (var side = 0u; side < 6u; side++) {
        let axis = vec3<u32>(vec3<u32>(side >> 1u) == vec3<u32>(0u, 1u, 2u));
        // Below 0 it wraps to a number that is beyond the volume.
        let near = select(voxel.id + axis, voxel.id - axis, (side & 1u) == 1u);
        if pace_at(near) != 0.0 {
            sum += value_of(which, place_of(index_of(near), channel)) - own;
        }
    }
    return sum;
}

/// Adds up what the threads of a group have and keeps it; `kind`: 0 or 1.
fn keep_sum(thread: u32, group: u32, kind: u32, value: vec4<f32>) {
    let sum = group_sum(thread, value);
    if thread == 0u {
        sums[min(kind * part.groups + part.first_group + group, arrayLength(&sums) - 1u)] = sum;
    }
}

@compute @workgroup_size(8, 4, 4)
fn solver_paces(@builtin(global_invocation_id) id: vec3<u32>) {
    let voxel = voxel_of(id);
    if voxel.counts {
        var sum = 0.0;
        for (var channel = 0u; channel < CHANNELS; channel++) {
            let place = place_of(voxel.index, channel);
            sum += gradient[place];
            gradient[place] = 0.0;
        }
        solved[min(voxel.index, arrayLength(&solved) - 1u)] = pace_of(part, sum / f32(CHANNELS));
    }
}

@compute @workgroup_size(8, 4, 4)
fn smooth_solution(@builtin(global_invocation_id) id: vec3<u32>) {
    let voxel = voxel_of(id);
    if voxel.counts {
        for (var channel = 0u; channel < CHANNELS; channel++) {
            roughness[place_of(voxel.index, channel)] = laplacian_at(SOLUTION, voxel, channel);
        }
    }
}

@compute @workgroup_size(8, 4, 4)
fn solver_gradient(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>
) {
    let voxel = voxel_of(id);
    var square = vec4<f32>(0.0);
    var product = vec4<f32>(0.0);
    if voxel.counts {
        for (var channel = 0u; channel < CHANNELS; channel++) {
            let place = place_of(voxel.index, channel);
            let value = solution[place];
            let slope = gradient[place] + part.laplacian * laplacian_at(ROUGHNESS, voxel, channel)
                + part.smallness * value + part.oneness * (value - 1.0);
            let way = downhill(part, value, slope);
            square[channel] = voxel.pace * way * way;
            product[channel] = voxel.pace * way * downward[place];
            // One that is held at a bound stays there.
            direction[place] = select(direction[place], 0.0, way == 0.0 && slope != 0.0);
            downward[place] = way;
            gradient[place] = 0.0;
        }
    }
    let place = group_index(group, groups);
    keep_sum(thread, place, 0u, square);
    keep_sum(thread, place, 1u, product);
}

@compute @workgroup_size(8, 4, 4)
fn solver_direction(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>
) {
    let voxel = voxel_of(id);
    var descent = vec4<f32>(0.0);
    if voxel.counts {
        for (var channel = 0u; channel < CHANNELS; channel++) {
            let place = place_of(voxel.index, channel);
            let next = voxel.pace * downward[place] + scalars.kept[channel] * direction[place];
            descent[channel] = downward[place] * next;
            direction[place] = next;
        }
    }
    keep_sum(thread, group_index(group, groups), 0u, descent);
}

@compute @workgroup_size(8, 4, 4)
fn solver_curvature(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>
) {
    let voxel = voxel_of(id);
    var curvature = vec4<f32>(0.0);
    if voxel.counts {
        for (var channel = 0u; channel < CHANNELS; channel++) {
            let place = place_of(voxel.index, channel);
            let along = direction[place];
            let rough = laplacian_at(DIRECTION, voxel, channel);
            curvature[channel] = part.laplacian * rough * rough
                + (part.smallness + part.oneness) * along * along;
        }
    }
    keep_sum(thread, group_index(group, groups), 1u, curvature);
}

@compute @workgroup_size(8, 4, 4)
fn solver_advance(@builtin(global_invocation_id) id: vec3<u32>) {
    let voxel = voxel_of(id);
    if voxel.counts {
        for (var channel = 0u; channel < CHANNELS; channel++) {
            let place = place_of(voxel.index, channel);
            solution[place] = clamp(solution[place] + scalars.step[channel] * direction[place], part.low, part.high);
        }
    }
}
