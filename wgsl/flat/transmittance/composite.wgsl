// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: transmittance/composite, permutation default
// summary: A picture of a medium over what lies behind it: radiance + transmittance * background.
// source: none; premultiplied blending with transmittance in place of opacity.
// note: Values that are not finite count as 0, transmittances that are not as 1.
// binding surface: linear RGB radiance of the surfaces and the sky.
// binding picture: premultiplied linear RGB radiance of the medium, and in alpha the transmittance to the background.
// binding composed: out, linear RGB radiance, rgba16float.

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

// ---- transmittance/composite ----

@group(0) @binding(0) var surface: texture_2d<f32>;
@group(0) @binding(1) var picture: texture_2d<f32>;
@group(0) @binding(2) var composed: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(16, 8)
fn composite(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= textureDimensions(composed)) {
        return;
    }
    let behind = finite_or_rgb(textureLoad(surface, id.xy, 0).rgb, 0.0);
    let medium = textureLoad(picture, id.xy, 0);
    let through = clamp(finite_or(medium.a, 1.0), 0.0, 1.0);
    let radiance = finite_or_rgb(medium.rgb, 0.0) + through * behind;
    textureStore(composed, id.xy, vec4<f32>(clamp(radiance, vec3<f32>(0.0), vec3<f32>(65504.0)), 1.0));
}
