// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Scene-linear radiance to an sRGB-encoded 8-bit picture.
// source: core/color; dither: J. Jimenez, "Next generation post processing in Call of Duty" (2014).
// binding parameters: exposure and dither.
// binding radiance: linear RGB, any float format.
// binding picture: sRGB-encoded, rgba8unorm.

#import airlight::core::color::{tone_curve, srgb_from_linear}
#import airlight::core::finite::finite_or_rgb

struct TonemapParameters {
    /// Factor on the radiance, before the curve.
    exposure: f32,
    /// Amplitude of the dither in steps of 1/255; 1 hides banding, 0 is off.
    dither: f32,
    reserved_a: f32,
    reserved_b: f32,
}

@group(#{GROUP}) @binding(0) var<uniform> parameters: TonemapParameters;
@group(#{GROUP}) @binding(1) var radiance: texture_2d<f32>;
@group(#{GROUP}) @binding(2) var picture: texture_storage_2d<rgba8unorm, write>;

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
