// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Light that a volume scatters in several lights at once: the volume of one light, times its coefficient, is added.
// source: thesis 7.4.3: light volumes.
// note: Dispatch over the voxels for each light, the first one first: it replaces what was there. Then inverse/pack_volume.
// binding number: which light.
// binding grid: the voxels.
// binding coefficients: numbers a light.
// binding volume: what the light alone makes the volume scatter.
// binding sums: in and out, numbers a voxel, x fastest.

#import airlight::inverse::slice_steps::VoxelGrid
#import airlight::inverse::light_numbers::{LightNumber, CHANNELS, NUMBERS}

@group(#{GROUP}) @binding(0) var<uniform> number: LightNumber;
@group(#{GROUP}) @binding(1) var<uniform> grid: VoxelGrid;
@group(#{GROUP}) @binding(2) var<storage, read> coefficients: array<f32>;
@group(#{GROUP}) @binding(3) var volume: texture_3d<f32>;
@group(#{GROUP}) @binding(4) var<storage, read_write> sums: array<f32>;

@compute @workgroup_size(8, 4, 4)
fn combine_light(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id >= grid.size) {
        return;
    }
    let index = (id.z * grid.size.y + id.y) * grid.size.x + id.x;
    let scattered = textureLoad(volume, min(id, textureDimensions(volume) - 1u), 0);
    for (var channel = 0u; channel < CHANNELS; channel++) {
        let coefficient = coefficients[min(NUMBERS * number.index + channel, arrayLength(&coefficients) - 1u)];
        let place = min(NUMBERS * index + channel, arrayLength(&sums) - 1u);
        sums[place] = select(sums[place], 0.0, number.index == 0u) + coefficient * scattered[channel];
    }
}
