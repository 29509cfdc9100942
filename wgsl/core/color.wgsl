// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::core::color
// summary: Luminance, a filmic tone curve, and the sRGB transfer function.
// source: IEC 61966-2-1 (sRGB); tone curve: K. Narkowicz, "ACES filmic tone mapping curve" (2015).
// note: all colours are scene-linear with BT.709 primaries unless said otherwise.
// equation: Y = 0.2126 r + 0.7152 g + 0.0722 b
// equation: tone(x) = x (2.51 x + 0.03) / (x (2.43 x + 0.59) + 0.14), cut to 0..1
// equation: sRGB(x) = 12.92 x up to 0.0031308, else 1.055 x^(1/2.4) − 0.055
// error: luminance within 3e-7 relative, tone curve 1e-6, sRGB 5e-6; test core/values::colours_follow_their_closed_forms.
// parameter color: scene-linear RGB, from 0 up; of `srgb_from_linear` display-linear, 0..1.

/// Relative luminance of a linear colour.
fn luminance(color: vec3<f32>) -> f32 {
    return dot(color, vec3<f32>(0.2126, 0.7152, 0.0722));
}

/// Scene-linear radiance, any non-negative value, to display-linear 0..1.
fn tone_curve(color: vec3<f32>) -> vec3<f32> {
    // Beyond 1e4 the curve is 1 in f32, and squares of larger numbers would overflow.
    let x = clamp(color, vec3<f32>(0.0), vec3<f32>(1e4));
    return clamp((x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14), vec3<f32>(0.0), vec3<f32>(1.0));
}

/// Display-linear 0..1 to sRGB-encoded 0..1.
fn srgb_from_linear(color: vec3<f32>) -> vec3<f32> {
    let x = clamp(color, vec3<f32>(0.0), vec3<f32>(1.0));
    let curve = 1.055 * pow(max(x, vec3<f32>(0.0031308)), vec3<f32>(1.0 / 2.4)) - 0.055;
    return select(curve, 12.92 * x, x <= vec3<f32>(0.0031308));
}
