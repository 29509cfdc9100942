// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::core::arc_cosine
// summary: The angle whose cosine is given, as exact as its cosine.
// source: acos(x) = atan2(sqrt(1 - x^2), x), by which the WGSL specification bounds the error of acos.
// note: Drivers use their leave to be off by 6.8e-5 radians; there is no such leave for atan2, and its errors are about 3e-6.

/// Radians 0..pi; a cosine outside -1..1 counts as the nearer end.
fn arc_cosine(cosine: f32) -> f32 {
    let held = clamp(cosine, -1.0, 1.0);
    return atan2(sqrt((1.0 - held) * (1.0 + held)), held);
}
