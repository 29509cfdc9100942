// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::scattering::visibility_wavelet
// summary: Exact mean visibility of a view ray in the least memory: a count by a wavelet matrix of four digits a level.
// source: none; a wavelet matrix (Information Systems 47, 2015) with digits of two bits: docs/src/wavelet.md explains it.
// note: Depths are rounded to `bits` bits as in visibility_rank, an even number. A level holds the texels of a row in the
// note: order of their earlier digits, the last of these first; equal ones stay in the order of the columns. The texels
// note: that a ray covers and that agree with it so far are neighbours in it: from `low` to before `high`.
// note: One texel of rgba32uint holds 32 places of a level: a bit of the digit each in x and y, and in z and w four sums of
// note: 16 bits. The sum d is that of the places in the next level of the first digits 0..d from this block on. So the
// note: difference of two sums is a place, and of the sums of two blocks how many smaller digits lie between them.
// equation: level by level: low ← next(d) + equal before low, high the same, dark ← dark + smaller between low and high
// equation: V̄ = 1 − (dark + part [end dark]) / s
// error: exactly what rank queries count; test scattering/wavelet::pictures_are_those_of_rank_queries.
// parameter texel: two bits of 32 places and four sums.
// parameter wavelet: levels one after the other along columns, rgba32uint.
// parameter first: first column of the level.
// parameter blocks: of 32 places, a level.
// parameter row: of the map, from 0.
// parameter depth: of the ray, 0..1.
// parameter digit: 0..3.

#import airlight::scattering::visibility_rank::{rank_value, low_bits, LEAST_TEXELS}

/// The sums of a block in two words. `places`: in the next level, of the first of each digit from this block on.
fn wavelet_sums(places: vec4<u32>) -> vec2<u32> {
    let one = places.x + places.y;
    let two = one + places.z;
    return vec2<u32>(places.x | (one << 16u), two | ((two + places.w) << 16u));
}

/// How the digits of a block compare with that of a ray.
struct WaveletBlock {
    /// Places with a smaller digit, a bit each.
    less: u32,
    /// Places with the same digit, a bit each.
    equal: u32,
    /// Smaller digits before the block, and a sum that all blocks of the level share.
    smaller: u32,
    /// Place in the next level of the first same digit from the block on.
    next: u32,
}

/// Compares a texel of the matrix with a `digit`, 0..3.
fn wavelet_block(texel: vec4<u32>, digit: u32) -> WaveletBlock {
    let odd = 0u - (digit & 1u);
    let upper = 0u - (digit >> 1u);
    let same = ~(texel.y ^ upper);
    // The sums `digit` and, one before it, `digit - 1`, of which that before the first is 0.
    let sums = select(texel.z, texel.w, digit >= 2u);
    let before = select(texel.z << 16u, (texel.w << 16u) | (texel.z >> 16u), digit >= 2u);
    let shift = 16u * (digit & 1u);
    let smaller = (before >> shift) & 0xffffu;
    return WaveletBlock(
        (upper & ~texel.y) | (same & odd & ~texel.x), same & ~(texel.x ^ odd),
        smaller, ((sums >> shift) & 0xffffu) - smaller
    );
}

/// The way of a query through the levels.
struct WaveletPath {
    /// Place of the first texel that agrees with the ray so far.
    low: u32,
    /// One after the last of those that the ray covers: where the texel is in which it ends, if that agrees too.
    high: u32,
    /// Covered texels below the ray by the digits so far.
    dark: u32,
    /// 1 where the texel in which the ray ends is below it by the digits so far.
    end_dark: u32,
    /// 1 where that texel agrees with the ray so far.
    end_equal: u32,
}

/// One level down. `first`: column of the level in the matrix; `digit` of the ray, 0..3.
fn wavelet_step(
    wavelet: texture_2d<u32>, path: WaveletPath, first: u32, blocks: u32, row: u32, digit: u32
) -> WaveletPath {
    // Behind the last place of a full block is its place 32.
    let low_block = min(path.low / 32u, blocks - 1u);
    let high_block = min(path.high / 32u, blocks - 1u);
    let low = wavelet_block(textureLoad(wavelet, vec2<u32>(first + low_block, row), 0), digit);
    let high = wavelet_block(textureLoad(wavelet, vec2<u32>(first + high_block, row), 0), digit);
    let low_inside = low_bits(path.low - 32u * low_block);
    let high_inside = low_bits(path.high - 32u * high_block);
    let end = path.high & 31u;
    return WaveletPath(
        low.next + countOneBits(low.equal & low_inside),
        high.next + countOneBits(high.equal & high_inside),
        path.dark + high.smaller + countOneBits(high.less & high_inside)
            - low.smaller - countOneBits(low.less & low_inside),
        path.end_dark | (path.end_equal & (high.less >> end)),
        path.end_equal & (high.equal >> end),
    );
}

/// Mean visibility of the first `texels` texels of `row` at the depth of a ray, 0..1: the exact count, and of the last
/// texel the part that is covered. `bits` of a depth: 8, 10 or 12; `columns` of the map; `texels`: fractional.
fn wavelet_visibility(
    wavelet: texture_2d<u32>, bits: u32, columns: u32, row: u32, texels: f32, depth: f32
) -> f32 {
    let covered = clamp(texels, LEAST_TEXELS, f32(columns));
    let column = min(u32(covered), columns - 1u);
    let blocks = (columns + 31u) / 32u;
    // Twelve bits: the value's first digit highest.
    let value = rank_value(depth, bits) << (12u - bits);
    var path = WaveletPath(0u, column, 0u, 0u, 1u);
    // Software adapters are slow at loops.
    path = wavelet_step(wavelet, path, 0u, blocks, row, value >> 10u);
    path = wavelet_step(wavelet, path, blocks, blocks, row, (value >> 8u) & 3u);
    path = wavelet_step(wavelet, path, 2u * blocks, blocks, row, (value >> 6u) & 3u);
    path = wavelet_step(wavelet, path, 3u * blocks, blocks, row, (value >> 4u) & 3u);
    if bits > 8u {
        path = wavelet_step(wavelet, path, 4u * blocks, blocks, row, (value >> 2u) & 3u);
    }
    if bits > 10u {
        path = wavelet_step(wavelet, path, 5u * blocks, blocks, row, value & 3u);
    }
    let dark = f32(path.dark) + (covered - f32(column)) * f32(path.end_dark & 1u);
    return clamp(1.0 - dark / covered, 0.0, 1.0);
}
