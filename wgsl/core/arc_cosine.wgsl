// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::core::arc_cosine
// summary: The angle whose cosine is given, as exact as its cosine.
// source: acos(x) = atan2(sqrt(1 - x^2), x), by which the WGSL specification bounds the error of acos.
// note: Drivers' own acos may be off by 6.8e-5 radians and is, near the ends by 4e-4; by their atan2 it is off by 3e-6.
// equation: angle = atan2(√((1 − c)(1 + c)), c),  c = clamp(cosine, −1, 1)
// error: within 8e-6 radians; test core/directions::angles_have_their_cosines.
// parameter cosine: of the angle, -1..1; beyond that the nearer end.

/// Radians 0..pi; a cosine outside -1..1 counts as the nearer end.
fn arc_cosine(cosine: f32) -> f32 {
    let held = clamp(cosine, -1.0, 1.0);
    return atan2(sqrt((1.0 - held) * (1.0 + held)), held);
}
