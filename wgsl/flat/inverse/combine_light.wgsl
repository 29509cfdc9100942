// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: inverse/combine_light, permutation default (RGB)
// summary: Light that a volume scatters in several lights at once: the volume of one light, times its coefficient, is added.
// source: thesis 7.4.3: light volumes.
// note: Dispatch over the voxels for each light, the first one first: it replaces what was there. Then inverse/pack_volume.
// binding number: which light.
// binding grid: the voxels.
// binding coefficients: numbers a light.
// binding volume: what the light alone makes the volume scatter.
// binding sums: in and out, numbers a voxel, x fastest.

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

// ---- inverse/combine_light ----

@group(0) @binding(0) var<uniform> number: LightNumber;
@group(0) @binding(1) var<uniform> grid: VoxelGrid;
@group(0) @binding(2) var<storage, read> coefficients: array<f32>;
@group(0) @binding(3) var volume: texture_3d<f32>;
@group(0) @binding(4) var<storage, read_write> sums: array<f32>;

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
