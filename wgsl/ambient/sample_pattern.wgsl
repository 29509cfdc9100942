// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::ambient::sample_pattern
// summary: Directions about a normal, other ones for each pixel of a repeated square.
// source: Keller and Heidrich, "Interleaved sampling" (2001), as in thesis 3.4; Roberts, the R2 sequence (2018).
// note: A pixel has a stratified set of its own: a Hammersley set, shifted by a point of the R2 sequence. All pixels of the square together
// note: have the hemisphere evenly, so a mean over it has little noise. Frames shift all sets on; frame 0 is the static pattern.
// equation: point i of n: ((i + a) / n, fract(radical inverse of i in base 2 + b)), (a, b) a point of the R2 sequence per pixel
// equation: direction = (√(1 − u²) cos 2πv, √(1 − u²) sin 2πv, u)
// error: a direction in every stratum, places within 1e-6; test ambient/places::a_pixel_has_a_direction_in_every_stratum.
// error: unit length within 1e-5; test ambient/functions::patterns_fill_the_hemisphere_and_frames_move_them.
// parameter bits: any 32 of them.
// parameter pixel: column and row, from 0.
// parameter frame: number of the frame; 0 is the static pattern.
// parameter index: number of the direction, from 0.
// parameter samples: directions of a pixel, from 1 up.
// parameter place: two coordinates, [0, 1).

/// One over the plastic number, and its square: steps of the R2 sequence, by 2^32.
const FIRST_STEP: u32 = 3242174889u;
const SECOND_STEP: u32 = 2447445414u;
/// One over the golden ratio by 2^32: how much a frame shifts.
const GOLDEN_STEP: u32 = 2654435769u;

/// Where a pixel's set is shifted to.
struct SampleShift {
    /// Of both coordinates of directions, [0, 1).
    directions: vec2<f32>,
    /// Of steps along each, [0, 1).
    steps: f32,
}

/// A whole number's bits as a fraction, [0, 1).
fn fraction_of(bits: u32) -> f32 {
    return f32(bits >> 8u) * (1.0 / 16777216.0);
}

/// The shift of a pixel in a square of `side` pixels, from 1 up.
fn sample_shift(pixel: vec2<u32>, side: u32, frame: u32) -> SampleShift {
    let within = pixel % max(side, 1u);
    // Odd multiples scatter neighbours over the sequence.
    let index = within.y * side + within.x;
    // From the middle on: a pattern of one pixel has its set in the middle of its strata.
    let turn = 2147483648u + frame * GOLDEN_STEP;
    return SampleShift(
        vec2<f32>(fraction_of(index * FIRST_STEP + turn), fraction_of(index * SECOND_STEP + turn)),
        fraction_of((within.x * 5u + within.y * 3u) * GOLDEN_STEP + turn)
    );
}

/// Coordinates [0, 1) of a direction of `samples`.
fn sample_place(index: u32, samples: u32, shift: SampleShift) -> vec2<f32> {
    let second = fraction_of(reverseBits(index)) + shift.directions.y;
    return vec2<f32>((f32(index) + shift.directions.x) / f32(max(samples, 1u)), fract(second));
}

/// A unit vector of the hemisphere about +z, evenly over the solid angle.
fn hemisphere_direction(place: vec2<f32>) -> vec3<f32> {
    let turn = 6.2831855 * place.y;
    let across = sqrt(max(1.0 - place.x * place.x, 0.0));
    return vec3<f32>(across * cos(turn), across * sin(turn), place.x);
}
