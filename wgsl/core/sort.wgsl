// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::core::sort
// summary: Keys of a radix sort, and sixteen counters of 16 bits in eight words.
// source: D. Merrill and A. Grimshaw, "High performance and scalable radix sorting" (2011); M. Herf, "Radix tricks" (2001).
// note: Counters are packed so that the ranks of a workgroup of 256 threads take 8 KiB of its memory.
// equation: key = bits XOR (0xffffffff where the sign is set, else 0x80000000);  digit = (key >> shift) AND 15
// error: exact; test core/sort::keys_of_numbers_ascend_with_them.
// error: sorting is exact and stable; test core/sort::keys_of_any_number_are_sorted_and_equal_ones_keep_their_order.
// parameter value: any float.
// parameter key: any bits.
// parameter digit: 0..15.

/// Bits of a digit.
const DIGIT_BITS: u32 = 4u;
/// Values of a digit.
const DIGITS: u32 = 16u;

/// Sixteen counters up to 65535: digit d in the low half of word d / 2 for even d, else in the high half.
struct Counters {
    /// Those of the digits 0 to 7.
    low: vec4<u32>,
    /// Those of the digits 8 to 15.
    high: vec4<u32>,
}

/// A key that sorts as the number does: ascending, -0 before 0. NaNs lie beyond the infinities, by their sign.
fn ascending_key(value: f32) -> u32 {
    let bits = bitcast<u32>(value);
    return bits ^ select(0x80000000u, 0xffffffffu, bits >= 0x80000000u);
}

/// The digit of a key that begins at bit `shift`, 0..28.
fn key_digit(key: u32, shift: u32) -> u32 {
    return (key >> min(shift, 28u)) & (DIGITS - 1u);
}

/// A counter that is one for `digit`, 0..15, and zero for all others.
fn one_counted(digit: u32) -> Counters {
    let one = 1u << (16u * (digit & 1u));
    let word = digit >> 1u;
    let words = vec4<u32>(0u, 1u, 2u, 3u);
    return Counters(
        select(vec4<u32>(0u), vec4<u32>(one), words == vec4<u32>(word)),
        select(vec4<u32>(0u), vec4<u32>(one), words + 4u == vec4<u32>(word))
    );
}

/// Sums of counters, which stay below 65536.
fn counted_together(a: Counters, b: Counters) -> Counters {
    return Counters(a.low + b.low, a.high + b.high);
}

/// The counter of `digit`, 0..15.
fn counted(counters: Counters, digit: u32) -> u32 {
    let words = vec4<u32>(0u, 1u, 2u, 3u);
    let word = vec4<u32>(digit >> 1u);
    let low = select(vec4<u32>(0u), counters.low, words == word);
    let high = select(vec4<u32>(0u), counters.high, words + 4u == word);
    let both = low + high;
    let pair = both.x + both.y + both.z + both.w;
    return (pair >> (16u * (digit & 1u))) & 0xffffu;
}
