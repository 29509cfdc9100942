// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: inverse/keep_column, permutation one_channel
// summary: Keeps the picture of a volume in one light: a column of the matrix T.
// source: thesis 7.4.3: T is stored.
// note: Dispatch over the picture, after it has been rendered, for each light.
// binding number: which light.
// binding rendered: the picture, r32float or rgba32float.
// binding columns: out, numbers a pixel, row after row, one light after the other.

// ---- airlight::inverse::light_numbers ----
// summary: Which of the lights that are solved for is meant, and where its numbers lie.
// source: thesis 7.4.3: pictures are a product with the light that comes from each part of the surroundings.

const CHANNELS: u32 = 1u;
const NUMBERS: u32 = 1u;

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

// ---- inverse/keep_column ----

@group(0) @binding(0) var<uniform> number: LightNumber;
@group(0) @binding(1) var rendered: texture_2d<f32>;
@group(0) @binding(2) var<storage, read_write> columns: array<f32>;

@compute @workgroup_size(16, 8)
fn keep_column(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = textureDimensions(rendered);
    if any(id.xy >= size) {
        return;
    }
    let pixel = (number.index * size.y + id.y) * size.x + id.x;
    let value = textureLoad(rendered, id.xy, 0);
    for (var channel = 0u; channel < CHANNELS; channel++) {
        columns[min(NUMBERS * pixel + channel, arrayLength(&columns) - 1u)] = value[channel];
    }
}
