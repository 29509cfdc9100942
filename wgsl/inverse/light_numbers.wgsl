// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::inverse::light_numbers
// summary: Which of the lights that are solved for is meant, and where its numbers lie.
// source: thesis 7.4.3: pictures are a product with the light that comes from each part of the surroundings.
// equation: none: it only says where the numbers of a light lie.
// error: none of its own; both ways multiply with the matrix of lights within 1e-4;
// error: test inverse/light_solver::both_ways_multiply_with_the_matrix_of_lights_and_its_transpose.
// definition RGB: three channels, four numbers a light and a pixel; else one.

#ifdef RGB
const CHANNELS: u32 = 3u;
const NUMBERS: u32 = 4u;
#else
const CHANNELS: u32 = 1u;
const NUMBERS: u32 = 1u;
#endif

/// Most lights that are solved for.
const MOST_LIGHTS: u32 = 1024u;

/// One of several lights. 16 bytes.
struct LightNumber {
    /// From 0.
    index: u32,
    /// How many lights there are, 1..MOST_LIGHTS.
    count: u32,
    /// Groups that each light has sums of.
    groups: u32,
    reserved_a: u32,
}
