// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::core::finite
// summary: Replaces NaN and infinities in data that comes from outside.
// source: IEEE 754 binary32: all exponent bits set means NaN or infinity.
// note: WGSL lets a compiler assume that floats are finite, so `x != x` may be folded away; the
// note: test is made on the bits.
// equation: finite(x) ⇔ bits(x) AND 0x7f800000 ≠ 0x7f800000
// error: exact; test core/values::what_is_not_finite_is_replaced.
// parameter x: any, NaN and infinities too.
// parameter fallback: what stands for what is not finite, in the unit of `x`.

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
