// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::inverse::channels
// summary: One number or three a voxel and a pixel.
// source: none; arithmetic of one and of three is the same.
// equation: weight of a step = exp(−τ) (1 − exp(−σ d)),  τ ← τ + σ d
// error: haze is not lost: 1e-5; test inverse/projection::haze_is_not_lost_in_rounding.
// parameter texel: of a picture or volume.
// parameter value: a number, or three.
// parameter extinction: 1/m; negative counts as 0.
// parameter metres: length of the step, from 0 up.
// parameter depth: optical depth, from 0 up.
// definition RGB: three channels, each a system of its own; else one.

#import airlight::core::prefix_sum::one_minus_exp

#ifdef RGB
/// The channels of a texel.
fn channels_of(texel: vec4<f32>) -> vec3<f32> {
    return texel.rgb;
}

/// The texel of channels.
fn texel_of(value: vec3<f32>) -> vec4<f32> {
    return vec4<f32>(value, 1.0);
}

/// The same number in all channels.
fn all_channels(value: f32) -> vec3<f32> {
    return vec3<f32>(value);
}

/// Optical depth of a step through an extinction; below 0 there is none.
fn step_depth(extinction: vec3<f32>, metres: f32) -> vec3<f32> {
    return max(extinction, vec3<f32>(0.0)) * metres;
}

/// What a step of an optical depth takes of what passes.
fn taken_of(depth: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(one_minus_exp(depth.x), one_minus_exp(depth.y), one_minus_exp(depth.z));
}

/// What a step through an extinction weighs behind an optical depth, to which it is added.
fn step_weight(depth: ptr<function, vec3<f32>>, extinction: vec3<f32>, metres: f32) -> vec3<f32> {
    let passed = step_depth(extinction, metres);
    let weight = exp(-*depth) * taken_of(passed);
    *depth += passed;
    return weight;
}
#else
/// The channel of a texel.
fn channels_of(texel: vec4<f32>) -> f32 {
    return texel.x;
}

/// The texel of a channel.
fn texel_of(value: f32) -> vec4<f32> {
    return vec4<f32>(value, 0.0, 0.0, 1.0);
}

/// The number itself.
fn all_channels(value: f32) -> f32 {
    return value;
}

/// Optical depth of a step through an extinction; below 0 there is none.
fn step_depth(extinction: f32, metres: f32) -> f32 {
    return max(extinction, 0.0) * metres;
}

/// What a step of an optical depth takes of what passes.
fn taken_of(depth: f32) -> f32 {
    return one_minus_exp(depth);
}

/// What a step through an extinction weighs behind an optical depth, to which it is added.
fn step_weight(depth: ptr<function, f32>, extinction: f32, metres: f32) -> f32 {
    let passed = step_depth(extinction, metres);
    let weight = exp(-*depth) * taken_of(passed);
    *depth += passed;
    return weight;
}
#endif
