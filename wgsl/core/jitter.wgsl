// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::core::jitter
// summary: Where in each step of a march a pixel's samples lie, 0..1: interleaved gradient noise, blue noise from a tile.
// source: Jimenez, "Next generation post processing in Call of Duty: Advanced Warfare" (2014); Ulichney, "The void-and-cluster method for dither array generation" (1993).
// note: Frame 0 always is the static pattern. Gradient noise moves by 5.588238 pixels a frame in x and y and
// note: repeats after 64 frames; blue noise is turned by the golden ratio, which spreads the values that one
// note: pixel sees evenly and leaves every frame as blue as the tile.
// equation: gradient noise: fract(52.9829189 fract(0.06711056 x + 0.00583715 y)), (x, y) = pixel + 5.588238 (frame mod 64)
// equation: blue noise: fract(tile(pixel) + frame / φ), φ the golden ratio
// error: gradient noise within 3e-3 of a turn; test core/jitter::gradient_noise_is_that_of_jimenez.
// error: blue noise within 2e-7 of a turn, whatever the frame; test core/jitter::blue_noise_turns_by_the_golden_ratio.
// parameter pixel: column and row, whole pixels, from 0.
// parameter frame: number of the frame, from 0; 0 is the static pattern.

#import airlight::core::finite::finite_or

/// Pixels that the gradient noise moves by, in x and in y, a frame.
const GRADIENT_SHIFT: f32 = 5.588238;
/// Frames after which the gradient noise repeats: positions stay small enough for f32.
const GRADIENT_PERIOD: u32 = 64u;
/// 2^32 over the golden ratio: a turn a frame in fixed point, exact for every frame.
const GOLDEN_TURN: u32 = 2654435769u;

/// Interleaved gradient noise at a pixel, in [0, 1): any 3x3 pixels hold nine evenly spread values.
fn gradient_noise_offset(pixel: vec2<u32>, frame: u32) -> f32 {
    let at = vec2<f32>(pixel) + GRADIENT_SHIFT * f32(frame % GRADIENT_PERIOD);
    return fract(52.9829189 * fract(dot(at, vec2<f32>(0.06711056, 0.00583715))));
}

/// Blue noise at a pixel, in [0, 1). `tile`: values 0..1, repeated over the picture, r32float or r8unorm;
/// a value that is not finite counts as 0.
fn blue_noise_offset(tile: texture_2d<f32>, pixel: vec2<u32>, frame: u32) -> f32 {
    let value = textureLoad(tile, pixel % textureDimensions(tile), 0).x;
    let turn = f32(frame * GOLDEN_TURN) * (1.0 / 4294967296.0);
    return fract(clamp(finite_or(value, 0.0), 0.0, 1.0) + turn);
}
