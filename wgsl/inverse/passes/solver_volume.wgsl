// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: What the solver does with each voxel: smoothness, gradient, direction and step.
// source: Klehm, "Stylized scattering", thesis, 7.4.1 and 7.4.2; see inverse/solver_steps.
// note: Dispatch over the voxels, in an iteration in this order: smooth_solution, solver_gradient, [solver_scalars], solver_direction,
// note: smooth_direction, solver_curvature, [solver_scalars], solver_advance. Beyond the volume and of voxels that are not solved for there is
// note: nothing to differ from.
// definition RGB: three channels, four numbers a voxel; else one.
// binding part: the volume that is solved for.
// binding solved: 0 where a voxel is not solved for; else 1, and from bit 1 on which channels are held at a bound.
// binding solution: numbers a voxel, x fastest.
// binding gradient: what was projected back; solver_gradient leaves zeros for the next time.
// binding downward: the way downhill.
// binding direction: the direction in which the solution goes.
// binding roughness: discrete Laplacian of the solution or of the direction.
// binding sums: of each group two by channel: square and product of the ways downhill, or descent and curvature.
// binding scalars: of inverse/solver_scalars.

#import airlight::inverse::solver_steps::{SolverPart, SolverScalars, downhill}

@group(#{GROUP}) @binding(0) var<uniform> part: SolverPart;
@group(#{GROUP}) @binding(1) var<storage, read_write> solved: array<u32>;
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

var<workgroup> shared_sums: array<vec4<f32>, 128>;

/// A voxel of a dispatch.
struct Voxel {
    /// Along x, y and z.
    id: vec3<u32>,
    /// In vectors of a number a voxel.
    index: u32,
    /// Whether it is solved for.
    counts: bool,
}

fn index_of(id: vec3<u32>) -> u32 {
    return (id.z * part.size.y + id.y) * part.size.x + id.x;
}

fn is_solved(id: vec3<u32>) -> bool {
    return all(id < part.size) && solved[min(index_of(min(id, part.size - 1u)), arrayLength(&solved) - 1u)] != 0u;
}

fn voxel_of(id: vec3<u32>) -> Voxel {
    return Voxel(id, index_of(min(id, part.size - 1u)), is_solved(id));
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
        if is_solved(near) {
            sum += value_of(which, place_of(index_of(near), channel)) - own;
        }
    }
    return sum;
}

/// Adds up what the threads of a group have and keeps it; `kind`: 0 or 1.
fn keep_sum(thread: u32, group: u32, kind: u32, value: vec4<f32>) {
    shared_sums[thread] = value;
    workgroupBarrier();
    for (var half = 64u; half > 0u; half = half >> 1u) {
        if thread < half {
            shared_sums[thread] += shared_sums[thread + half];
        }
        workgroupBarrier();
    }
    if thread == 0u {
        sums[min(kind * part.groups + part.first_group + group, arrayLength(&sums) - 1u)] = shared_sums[0];
    }
    workgroupBarrier();
}

fn group_index(group: vec3<u32>, groups: vec3<u32>) -> u32 {
    return (group.z * groups.y + group.y) * groups.x + group.x;
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
fn smooth_direction(@builtin(global_invocation_id) id: vec3<u32>) {
    let voxel = voxel_of(id);
    if voxel.counts {
        for (var channel = 0u; channel < CHANNELS; channel++) {
            roughness[place_of(voxel.index, channel)] = laplacian_at(DIRECTION, voxel, channel);
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
        var held = 0u;
        for (var channel = 0u; channel < CHANNELS; channel++) {
            let place = place_of(voxel.index, channel);
            let value = solution[place];
            let slope = gradient[place] + part.laplacian * laplacian_at(ROUGHNESS, voxel, channel)
                + part.smallness * value + part.oneness * (value - 1.0);
            let way = downhill(part, value, slope);
            square[channel] = way * way;
            product[channel] = way * downward[place];
            held |= select(0u, 2u << channel, way == 0.0 && slope != 0.0);
            downward[place] = way;
            gradient[place] = 0.0;
        }
        solved[min(voxel.index, arrayLength(&solved) - 1u)] = 1u | held;
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
        let held = solved[min(voxel.index, arrayLength(&solved) - 1u)] >> 1u;
        for (var channel = 0u; channel < CHANNELS; channel++) {
            let place = place_of(voxel.index, channel);
            let kept = scalars.kept[channel] * direction[place];
            let next = select(downward[place] + kept, 0.0, ((held >> channel) & 1u) == 1u);
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
            curvature[channel] = part.laplacian * roughness[place] * roughness[place]
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
