// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: stylize/transfer_layer, permutation mix (MIX)
// summary: A layer of a transfer function, blended over the layers below it.
// source: thesis 6.2.2, Figure 6.10.
// note: Non-finite texels are transparent.
// definition MIX: instead, the mean of two functions, for key frames.
// binding share: what part of the mean the second function has; with MIX only.
// binding below: what lies below, or the first function; premultiplied linear RGBA of the size of `composed`.
// binding picture: the layer's picture, or the second function; premultiplied linear RGBA of any size, any float format that filters.
// binding picture_sampler: linear, clamped to the edge.
// binding composed: out, premultiplied linear RGBA, rgba16float.

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

// ---- stylize/transfer_layer ----

/// Of two functions.
struct TransferShare {
    /// Part of the second, 0..1; the first has the rest.
    second: f32,
    reserved_a: f32,
    reserved_b: f32,
    reserved_c: f32,
}

@group(0) @binding(0) var<uniform> share: TransferShare;
@group(0) @binding(1) var below: texture_2d<f32>;
@group(0) @binding(2) var picture: texture_2d<f32>;
@group(0) @binding(3) var picture_sampler: sampler;
@group(0) @binding(4) var composed: texture_storage_2d<rgba16float, write>;

/// A texel with what is not finite replaced by 0.
fn cleaned(color: vec4<f32>) -> vec4<f32> {
    let rgb = clamp(finite_or_rgb(color.rgb, 0.0), vec3<f32>(0.0), vec3<f32>(65504.0));
    return vec4<f32>(rgb, clamp(finite_or(color.a, 0.0), 0.0, 1.0));
}

@compute @workgroup_size(16, 8)
fn compose(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = textureDimensions(composed);
    if any(id.xy >= size) {
        return;
    }
    let position = (vec2<f32>(id.xy) + 0.5) / vec2<f32>(size);
    let above = cleaned(textureSampleLevel(picture, picture_sampler, position, 0.0));
    let under = cleaned(textureLoad(below, id.xy, 0));
    let color = mix(under, above, clamp(share.second, 0.0, 1.0));
    textureStore(composed, id.xy, color);
}
