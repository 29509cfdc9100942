// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
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

#import airlight::inverse::solver_steps::{SolverPart, SolverScalars, downhill, pace_of}
#import airlight::inverse::group_sum::{group_sum, group_index}

@group(#{GROUP}) @binding(0) var<uniform> part: SolverPart;
@group(#{GROUP}) @binding(1) var<storage, read_write> solved: array<f32>;
@group(#{GROUP}) @binding(2) var<storage, read_write> solution: array<f32>;
@group(#{GROUP}) @binding(3) var<storage, read_write> gradient: array<f32>;
@group(#{GROUP}) @binding(4) var<storage, read_write> downward: array<f32>;
@group(#{GROUP}) @binding(5) var<storage, read_write> direction: array<f32>;
@group(#{GROUP}) @binding(6) var<storage, read_write> roughness: array<f32>;
@group(#{GROUP}) @binding(7) var<storage, read_write> sums: array<vec4<f32>>;
@group(#{GROUP}) @binding(8) var<uniform> scalars: SolverScalars;

#ifdef RGB
const CHANNELS: u32 = 3u;
const NUMBERS: u32 = 4u;
#else
const CHANNELS: u32 = 1u;
const NUMBERS: u32 = 1u;
#endif

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
