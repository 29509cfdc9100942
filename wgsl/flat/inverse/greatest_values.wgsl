// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: inverse/greatest_values, permutation default
// summary: Greatest absolute values of a picture and of scattered light: how fine fixed point can be.
// source: none; maxima of bit patterns, which are ordered as the positive floats are.
// note: Dispatch `greatest_picture` over the picture and, with ALBEDO, `greatest_light` over the texels of `scattered`. Begin with zeros, and without ALBEDO with the bounds of row sums. Channel by
// note: channel; what is not finite counts as 0. The result is the same in every run.
// binding picture: the picture.
// binding greatest: in and out, bits of four channels of the picture, then of the bounds of row sums (inverse/fixed_point), which are
// binding greatest: the greatest values of scattered light with ALBEDO; else they stay as they are.

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

// ---- inverse/greatest_values ----

@group(0) @binding(0) var picture: texture_2d<f32>;
@group(0) @binding(2) var<storage, read_write> greatest: array<atomic<u32>>;

var<workgroup> group_greatest: array<atomic<u32>, 4>;

/// Makes the maximum over a group and adds it to the result. In uniform control flow.
fn gather(thread: u32, first: u32, texel: vec4<f32>) {
    // Zero to begin with, as all memory of groups.
    for (var channel = 0u; channel < 4u; channel++) {
        atomicMax(&group_greatest[channel], bitcast<u32>(abs(finite_or(texel[channel], 0.0))));
    }
    workgroupBarrier();
    if thread < 4u {
        atomicMax(&greatest[min(first + thread, arrayLength(&greatest) - 1u)], atomicLoad(&group_greatest[thread]));
    }
}

@compute @workgroup_size(16, 8)
fn greatest_picture(@builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    // What lies outside repeats the last texel.
    gather(thread, 0u, textureLoad(picture, min(id.xy, textureDimensions(picture) - 1u), 0));
}
