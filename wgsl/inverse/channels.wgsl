// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::inverse::channels
// summary: One number or three a voxel and a pixel.
// source: none; arithmetic of one and of three is the same.
// definition RGB: three channels, each a system of its own; else one.

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
#endif
