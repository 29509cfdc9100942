// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Products of the volume of each light with what pictures have sent back: the transpose of pictures of lights.
// source: thesis 7.4.3, with sums of groups in place of atomic additions: T'c = volume . (W'c).
// note: Dispatch volume_products over the voxels for each light, then add_products once, a group for each light. Always added up in the same order.
// binding number: which light; for add_products any.
// binding grid: the voxels.
// binding volume: what the light alone makes the volume scatter.
// binding collected: of inverse/cg_backproject, numbers a voxel.
// binding sums: of groups, by channel, one light after the other.
// binding products: in and out, numbers a light, to which is added.

#import airlight::inverse::slice_steps::VoxelGrid
#import airlight::inverse::light_numbers::{LightNumber, CHANNELS, NUMBERS}
#import airlight::inverse::group_sum::{GROUP_THREADS, group_sum, group_index}

@group(#{GROUP}) @binding(0) var<uniform> number: LightNumber;
@group(#{GROUP}) @binding(1) var<uniform> grid: VoxelGrid;
@group(#{GROUP}) @binding(2) var volume: texture_3d<f32>;
@group(#{GROUP}) @binding(3) var<storage, read> collected: array<f32>;
@group(#{GROUP}) @binding(4) var<storage, read_write> sums: array<vec4<f32>>;
@group(#{GROUP}) @binding(5) var<storage, read_write> products: array<f32>;

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
