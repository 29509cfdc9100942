// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: inverse/light_columns, permutation one_channel
// summary: The picture of a volume in all lights, and what a picture says of each light: products with T, which is stored, and its transpose.
// source: thesis 7.4.3, with sums of groups in place of atomic additions.
// note: Dispatch light_picture over the picture, and light_residual with a group for each light; always added up in the same order.
// binding number: how many lights there are.
// binding columns: of inverse/keep_column.
// binding coefficients: numbers a light.
// binding picture: out, the picture; r32float, rgba32float with RGB.
// binding residual: the picture that is multiplied, of the same size; for light_residual.
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

// ---- airlight::inverse::light_numbers ----
// summary: Which of the lights that are solved for is meant, and where its numbers lie.
// source: thesis 7.4.3: pictures are a product with the light that comes from each part of the surroundings.

const CHANNELS: u32 = 1u;
const NUMBERS: u32 = 1u;

/// Most lights that are solved for.
const MOST_LIGHTS: u32 = 1024u;

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

// ---- inverse/light_columns ----

@group(0) @binding(0) var<uniform> number: LightNumber;
@group(0) @binding(1) var<storage, read> columns: array<f32>;
@group(0) @binding(2) var<storage, read> coefficients: array<f32>;
@group(0) @binding(3) var picture: texture_storage_2d<r32float, write>;
@group(0) @binding(4) var residual: texture_2d<f32>;
@group(0) @binding(5) var<storage, read_write> products: array<f32>;

/// A number of a column. `pixel`: of all of the light's.
fn column_at(light: u32, pixel: u32, pixels: u32, channel: u32) -> f32 {
    return columns[min(NUMBERS * (light * pixels + pixel) + channel, arrayLength(&columns) - 1u)];
}

@compute @workgroup_size(16, 8)
fn light_picture(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = textureDimensions(picture);
    if any(id.xy >= size) {
        return;
    }
    let pixel = id.y * size.x + id.x;
    var sum = vec4<f32>(0.0);
    for (var light = 0u; light < min(number.count, MOST_LIGHTS); light++) {
        for (var channel = 0u; channel < CHANNELS; channel++) {
            let coefficient = coefficients[min(NUMBERS * light + channel, arrayLength(&coefficients) - 1u)];
            sum[channel] += coefficient * column_at(light, pixel, size.x * size.y, channel);
        }
    }
    textureStore(picture, id.xy, vec4<f32>(sum.xyz, 1.0));
}

@compute @workgroup_size(128)
fn light_residual(@builtin(local_invocation_index) thread: u32, @builtin(workgroup_id) group: vec3<u32>) {
    let size = textureDimensions(residual);
    let pixels = size.x * size.y;
    var part = vec4<f32>(0.0);
    for (var pixel = thread; pixel < pixels; pixel += GROUP_THREADS) {
        let value = textureLoad(residual, vec2<u32>(pixel % size.x, pixel / size.x), 0);
        for (var channel = 0u; channel < CHANNELS; channel++) {
            part[channel] += value[channel] * column_at(group.x, pixel, pixels, channel);
        }
    }
    let sum = group_sum(thread, part);
    if thread == 0u && group.x < number.count {
        for (var channel = 0u; channel < CHANNELS; channel++) {
            products[min(NUMBERS * group.x + channel, arrayLength(&products) - 1u)] += sum[channel];
        }
    }
}
