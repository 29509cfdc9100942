// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: core/tonemap, permutation default
// summary: Scene-linear radiance to an sRGB-encoded 8-bit picture.
// source: core/color; dither: J. Jimenez, "Next generation post processing in Call of Duty" (2014).
// binding parameters: exposure and dither.
// binding radiance: linear RGB, any float format.
// binding picture: sRGB-encoded, rgba8unorm.

// ---- airlight::core::color ----
// summary: Luminance, a filmic tone curve, and the sRGB transfer function.
// source: IEC 61966-2-1 (sRGB); tone curve: K. Narkowicz, "ACES filmic tone mapping curve" (2015).

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

// ---- airlight::core::finite ----
// summary: Replaces NaN and infinities in data that comes from outside.
// source: IEEE 754 binary32: all exponent bits set means NaN or infinity.

/// True if `x` is neither NaN nor infinite.
fn is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u;
}

/// `x` where it is finite, `fallback` elsewhere.
fn finite_or(x: f32, fallback: f32) -> f32 {
    return select(fallback, x, is_finite(x));
}

/// Like `finite_or`, each component by itself.
fn finite_or_rgb(x: vec3<f32>, fallback: f32) -> vec3<f32> {
    return vec3<f32>(finite_or(x.x, fallback), finite_or(x.y, fallback), finite_or(x.z, fallback));
}

// ---- core/tonemap ----

struct TonemapParameters {
    /// Factor on the radiance, before the curve.
    exposure: f32,
    /// Amplitude of the dither in steps of 1/255; 1 hides banding, 0 is off.
    dither: f32,
    reserved_a: f32,
    reserved_b: f32,
}

@group(0) @binding(0) var<uniform> parameters: TonemapParameters;
@group(0) @binding(1) var radiance: texture_2d<f32>;
@group(0) @binding(2) var picture: texture_storage_2d<rgba8unorm, write>;

@compute @workgroup_size(16, 8)
fn tonemap(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= textureDimensions(picture)) {
        return;
    }
    let linear = finite_or_rgb(textureLoad(radiance, id.xy, 0).rgb, 0.0);
    let encoded = srgb_from_linear(tone_curve(linear * parameters.exposure));
    let noise = fract(52.9829189 * fract(dot(vec2<f32>(id.xy), vec2<f32>(0.06711056, 0.00583715)))) - 0.5;
    textureStore(picture, id.xy, vec4<f32>(encoded + noise * parameters.dither / 255.0, 1.0));
}
