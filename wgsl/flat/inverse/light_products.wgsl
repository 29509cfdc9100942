// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: inverse/light_products, permutation default (RGB)
// summary: Products of the volume of each light with what pictures have sent back: the transpose of pictures of lights.
// source: thesis 7.4.3, with sums of groups in place of atomic additions: T'c = volume . (W'c).
// note: Dispatch volume_products over the voxels for each light, then add_products once, a group for each light. Always added up in the same order.
// binding number: which light; for add_products any.
// binding grid: the voxels.
// binding volume: what the light alone makes the volume scatter.
// binding collected: of inverse/cg_backproject, numbers a voxel.
// binding sums: of groups, by channel, one light after the other.
// binding products: in and out, numbers a light, to which is added.

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

// ---- airlight::inverse::light_numbers ----
// summary: Which of the lights that are solved for is meant, and where its numbers lie.
// source: thesis 7.4.3: pictures are a product with the light that comes from each part of the surroundings.

const CHANNELS: u32 = 3u;
const NUMBERS: u32 = 4u;

/// One of several lights. 16 bytes.
struct LightNumber {
    /// From 0.
    index: u32,
    /// How many lights there are, 1..MOST_LIGHTS.
    count: u32,
    /// Groups that each light has sums of.
    groups: u32,
    reserved_a: u32,
}

// ---- airlight::inverse::slice_steps ----
// summary: View rays in steps from slice to slice of a volume's box; a picture and its back-projection take the same.
// source: thesis 7.4.1 and Listing 7.1; slices along the main axis after Joseph (1982).

/// Voxels of what is solved for. 16 bytes.
struct VoxelGrid {
    /// Along x, y and z, each from 1 up.
    size: vec3<u32>,
    reserved_a: u32,
}

// ---- inverse/light_products ----

@group(0) @binding(0) var<uniform> number: LightNumber;
@group(0) @binding(1) var<uniform> grid: VoxelGrid;
@group(0) @binding(2) var volume: texture_3d<f32>;
@group(0) @binding(3) var<storage, read> collected: array<f32>;
@group(0) @binding(4) var<storage, read_write> sums: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read_write> products: array<f32>;

@compute @workgroup_size(8, 4, 4)
fn volume_products(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>
) {
    var product = vec4<f32>(0.0);
    if all(id < grid.size) {
        let index = (id.z * grid.size.y + id.y) * grid.size.x + id.x;
        let scattered = textureLoad(volume, min(id, textureDimensions(volume) - 1u), 0);
        for (var channel = 0u; channel < CHANNELS; channel++) {
            let sent = collected[min(NUMBERS * index + channel, arrayLength(&collected) - 1u)];
            product[channel] = scattered[channel] * sent;
        }
    }
    let sum = group_sum(thread, product);
    if thread == 0u {
        let place = number.index * number.groups + group_index(group, groups);
        sums[min(place, arrayLength(&sums) - 1u)] = sum;
    }
}

@compute @workgroup_size(128)
fn add_products(@builtin(local_invocation_index) thread: u32, @builtin(workgroup_id) group: vec3<u32>) {
    var part = vec4<f32>(0.0);
    for (var place = thread; place < min(number.groups, arrayLength(&sums)); place += GROUP_THREADS) {
        part += sums[min(group.x * number.groups + place, arrayLength(&sums) - 1u)];
    }
    let sum = group_sum(thread, part);
    if thread == 0u && group.x < number.count {
        for (var channel = 0u; channel < CHANNELS; channel++) {
            products[min(NUMBERS * group.x + channel, arrayLength(&products) - 1u)] += sum[channel];
        }
    }
}
