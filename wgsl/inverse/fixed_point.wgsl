// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::inverse::fixed_point
// summary: Sums of a back-projection in fixed point of 64 bits: no order of additions changes them.
// source: none; two's complement in two words, the lower one first.
// note: Let y be the greatest absolute value of a picture of N pixels, and R a bound of each row sum of W. A voxel's sum is at most N y R in
// note: absolute value, since what one pixel adds to it is at most y R. With 2^e > y R and 2^b > N, sums in units of 2^(e + b - 61) are less than
// note: 2^61; what is cut off is less than a unit an addition, and there are at most N times 65536. So 64 bits with a sign never overflow.
// note: R is 1 for emission: a ray's weights T (1 - exp(-s d)) add up to 1 - T, and basis functions at a place add up to 1. For albedo it is the
// note: greatest scattered radiance, for extinction the longest way in the box. With 2^20 pixels a unit is y R 2^-41 or a little more: 17 bits
// note: more than the 24 that a float has.
// note: e is from -60 to 120, so that all powers of two that occur are floats: pictures below 1e-18 lose bits.
// equation: n = trunc(value 2^(61 − e − b)), 64 bits with sign;  2^e > greatest value × bound of row sums, 2^b > pixels
// error: the same bits in any order, within 1e-6 of what voxels collect;
// error: test inverse/scatter::fixed_point_is_what_voxels_collect_and_the_same_bits_in_every_run.
// error: sums do not overflow; test inverse/scatter::sums_do_not_overflow_where_all_rays_meet_one_voxel.
// parameter bits: of a float, sign ignored.
// parameter pixels: of the picture, from 1 up; of `fixed_words` and `fixed_number` their exponent b.
// parameter words: low and high 32 bits.
// parameter value: within greatest value times bound.
// parameter exponent: e of the note, -60..120.

/// A power of two. `exponent`: -126 to 127.
fn power_of_two(exponent: i32) -> f32 {
    return bitcast<f32>(u32(clamp(exponent, -126, 127) + 127) << 23u);
}

/// Exponent of a power of two that is greater than what the bits of a float say.
fn exponent_above(bits: u32) -> i32 {
    return i32((bits & 0x7fffffffu) >> 23u) - 126;
}

/// The exponent e of the note. Bits of floats: `greatest` of the picture's greatest absolute value, `bound` of the bound of row sums.
fn fixed_exponent(greatest: u32, bound: u32) -> i32 {
    return clamp(exponent_above(greatest) + exponent_above(bound), -60, 120);
}

/// The exponent b of the note.
fn pixel_exponent(pixels: u32) -> i32 {
    return 32 - i32(countLeadingZeros(pixels));
}

/// The negative of a number of two words.
fn negative_words(words: vec2<u32>) -> vec2<u32> {
    return vec2<u32>(~words.x + 1u, ~words.y + select(0u, 1u, words.x == 0u));
}

/// A number in fixed point, cut off towards 0. `exponent`: e, `pixels`: b of the note.
fn fixed_words(value: f32, exponent: i32, pixels: i32) -> vec2<u32> {
    let share = clamp(value * power_of_two(-exponent), -1.0, 1.0);
    let upper = abs(share) * power_of_two(29 - pixels);
    let whole = floor(upper);
    let words = vec2<u32>(u32((upper - whole) * 4294967296.0), u32(whole));
    return select(words, negative_words(words), share < 0.0);
}

/// The float next to a number in fixed point, or next but one.
fn fixed_number(words: vec2<u32>, exponent: i32, pixels: i32) -> f32 {
    let negative = words.y >= 0x80000000u;
    let size = select(words, negative_words(words), negative);
    let unit = exponent + pixels - 61;
    let number = f32(size.y) * power_of_two(unit + 32) + f32(size.x) * power_of_two(unit);
    return select(number, -number, negative);
}
