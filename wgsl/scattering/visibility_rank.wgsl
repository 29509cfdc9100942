// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::scattering::visibility_rank
// summary: Exact mean visibility of a view ray: how many of the first texels of a row lie behind it, by one rank query.
// source: none; a rank structure over a permutation, cut into words: docs/src/rank.md explains it with a drawing.
// note: Depths are rounded to `bits` bits: 2^bits - 1 steps. A texel is dark if and only if its value is less than that of
// note: the ray, as z_ray <= z_stored is lit; equal values are lit.
// note: Sorted by value, the texels of a row are ranks; those below the ray are the ranks before `start`. Ranks are cut
// note: into chunks and columns into blocks of 32. A cell holds, for a chunk and a block, a mask of the chunk's ranks that
// note: lie left of the block, and the base: how many (or how much weight) of all ranks of earlier chunks do. What is
// note: left are columns inside the last block: bit planes of their values are compared with the ray's value, 32 at once.
// note: Weighted means: exact but for the ranks of the last chunk, of which the mask tells how many are meant but not
// note: which. They get the mean weight of their chunk. With n of N ranks meant and weights 1 .. e^-t left of the block the
// note: error is at most n (N - n) / N (1 - e^-t) <= 8 (1 - e^-t). In the last block the weights of eight columns become
// note: that of their middle. For the first m of eight, in units of the first, that is too little by at most
// note: 3.5 (1 - e^-(a m)) for the columns before the middle and too much by at most 4 (1 - e^-(a m)) for those behind it,
// note: a the optical depth of a texel; over m columns of the block at most 4 e^-t (1 - e^-(a m)). All is at most
// note: 8 (1 - e^-(t + a m)), and the row's weight (1 - e^-(t + a m)) / (1 - e^-a) or more, so that visibility errs by at
// note: most 8 (1 - e^-a); on average by a thirtieth of it.
// note: Rays of a row differ in the optical depth of a texel, so the base is stored for two such depths, as shares of the
// note: weight left of the block, and interpolated for each ray. With u the optical depth of the ray left of the block and
// note: u0, u1 = 2 u0 those of the stored ones that errs by at most |u - u0| |u - u1| / 62. The lesser one is that of the
// note: ray that crosses texels fastest, at right angles to the light where the row has such a ray.
// equation: V̄ = 1 − |{i < s : z_i < z_ray}| / s,  count = base + popcount(mask AND low(rank mod 32)) + popcount(less AND low(column mod 32))
// equation: weighted: shares of exp(−τ i) in place of ones
// error: counts exact; test scattering/rank/counts::counts_are_exactly_those_of_the_stepped_map.
// error: weighted means within 8 (1 − e^-a), a the optical depth of a texel; test scattering/rank/weighted::weighted_means_err_by_no_more_than_proven.
// parameter depth: of the ray, 0..1.
// parameter less, limit: a bit a column; four bits of the ray's value.
// parameter planes: bit planes, four a layer.
// parameter bits: of a depth, 8..12.
// parameter row: of the map, from 0.
// parameter cells: mask and base of each chunk and block.
// parameter starts: texels with a smaller value, two a word.
// parameter columns: of the map, 2048 at most.
// parameter texels: that the ray covers, fractional.
// parameter optical_step, least_step: optical depths of a texel, from 0 up.

#import airlight::core::prefix_sum::one_minus_exp

/// Least stretch that is asked for, texels: shorter ones see their texel.
const LEAST_TEXELS: f32 = 1e-3;

/// A depth, clamped to 0..1, as a whole number of `bits` bits.
fn rank_value(depth: f32, bits: u32) -> u32 {
    return u32(clamp(depth, 0.0, 1.0) * f32((1u << bits) - 1u) + 0.5);
}

/// The lowest `count` bits, 0..32.
fn low_bits(count: u32) -> u32 {
    return select((1u << (count & 31u)) - 1u, 0xffffffffu, count >= 32u);
}

/// Four bit planes more of the comparison `value < limit` of 32 values at once, from the lowest plane up. `limit`: its
/// four bits lowest.
fn less_by_planes(less: u32, planes: vec4<u32>, limit: u32) -> u32 {
    var result = less;
    result = select(result & ~planes.x, result | ~planes.x, (limit & 1u) != 0u);
    result = select(result & ~planes.y, result | ~planes.y, (limit & 2u) != 0u);
    result = select(result & ~planes.z, result | ~planes.z, (limit & 4u) != 0u);
    return select(result & ~planes.w, result | ~planes.w, (limit & 8u) != 0u);
}

/// Where a query lies in the structure.
struct RankPlace {
    /// Texels that the ray covers, at least LEAST_TEXELS.
    covered: f32,
    /// Of the last of these, in which the ray ends.
    column: u32,
    /// What of it is covered, 0..1.
    part: f32,
    /// The cell: chunk times the number of blocks plus block.
    cell: u32,
    /// Ranks of the chunk that are below the ray, 0..32.
    ranks: u32,
    /// The columns of the block with a value below that of the ray, a bit each.
    less: u32,
}

/// The place of a query. `starts`: how many texels of a row have a smaller value, two values of 16 bits a texel;
/// `planes`: bit planes, four a layer, one texel a block; `columns` of the map; `texels`: fractional.
fn rank_place(
    starts: texture_2d<u32>, planes: texture_2d_array<u32>, bits: u32, columns: u32, row: u32, texels: f32, depth: f32
) -> RankPlace {
    let covered = clamp(texels, LEAST_TEXELS, f32(columns));
    let column = min(u32(covered), columns - 1u);
    let block = column / 32u;
    let value = rank_value(depth, bits);
    let pair = textureLoad(starts, vec2<u32>(value / 2u, row), 0).x;
    let start = (pair >> (16u * (value & 1u))) & 0xffffu;
    let blocks = (columns + 31u) / 32u;
    let chunk = min(start / 32u, blocks - 1u);
    var less = 0u;
    for (var layer = 0u; layer < (bits + 3u) / 4u; layer++) {
        less = less_by_planes(less, textureLoad(planes, vec2<u32>(block, row), layer, 0), value >> (4u * layer));
    }
    return RankPlace(
        covered, column, covered - f32(column), chunk * blocks + block, start - 32u * chunk, less
    );
}

/// Mean visibility of the first `texels` texels of `row` at the depth of a ray, 0..1: the exact count, and of the last
/// texel the part that is covered.
fn rank_visibility(
    cells: texture_2d<u32>, starts: texture_2d<u32>, planes: texture_2d_array<u32>, bits: u32, columns: u32,
    row: u32, texels: f32, depth: f32
) -> f32 {
    let at = rank_place(starts, planes, bits, columns, row, texels, depth);
    let cell = textureLoad(cells, vec2<u32>(at.cell, row), 0).xy;
    let inside = at.column & 31u;
    let whole = cell.y + countOneBits(cell.x & low_bits(at.ranks)) + countOneBits(at.less & low_bits(inside));
    let dark = f32(whole) + at.part * f32((at.less >> inside) & 1u);
    return clamp(1.0 - dark / at.covered, 0.0, 1.0);
}

/// Like `rank_visibility`, weighted by transmittance. Optical depths of one texel, `optical_step`: of the ray;
/// `least_step`: that by which the structure was built, and twice of which.
fn rank_visibility_weighted(
    cells: texture_2d<u32>, starts: texture_2d<u32>, planes: texture_2d_array<u32>, bits: u32, columns: u32,
    row: u32, texels: f32, depth: f32, optical_step: f32, least_step: f32
) -> f32 {
    let at = rank_place(starts, planes, bits, columns, row, texels, depth);
    let blocks = (columns + 31u) / 32u;
    let cell = textureLoad(cells, vec2<u32>(at.cell, row), 0).xy;
    let block_begin = f32(at.column & ~31u);
    // Where the ray lies between the two steps; beyond both where it is thin or oblique, but there rows are short.
    let least = max(least_step, 1e-30);
    let between = min((optical_step - least) / least, 64.0);
    let stored = unpack2x16unorm(cell.y);
    let base = mix(stored.x, stored.y, between);
    // Where the next chunk begins, all ranks of this one are counted; after the last chunk all ranks are.
    let next = at.cell + blocks;
    let after = unpack2x16unorm(textureLoad(cells, vec2<u32>(min(next, blocks * blocks - 1u), row), 0).y);
    let chunk = max(select(1.0, mix(after.x, after.y, between), next < blocks * blocks) - base, 0.0);
    let meant = f32(countOneBits(cell.x & low_bits(at.ranks)));
    let share = base + chunk * meant / max(f32(countOneBits(cell.x)), 1.0);
    // Weights are in units of the integral of transmittance over 1 / extinction, so that none is divided.
    let thickness = max(optical_step, 1e-30);
    let texel = one_minus_exp(thickness);
    let left = one_minus_exp(thickness * block_begin);
    let whole = one_minus_exp(thickness * f32(at.column));
    let covered = one_minus_exp(thickness * at.covered);
    // Eight columns at a time share a weight.
    let inside = at.column & 31u;
    let dark = at.less & low_bits(inside);
    let through = 1.0 - texel;
    let square = through * through;
    let eighth = square * square * square * square;
    var columns_dark = f32(countOneBits(dark >> 24u));
    columns_dark = columns_dark * eighth + f32(countOneBits(dark & 0xff0000u));
    columns_dark = columns_dark * eighth + f32(countOneBits(dark & 0xff00u));
    columns_dark = columns_dark * eighth + f32(countOneBits(dark & 0xffu));
    let block = (1.0 - left) * texel * columns_dark * square * through * sqrt(through);
    let last = select(0.0, max(covered - whole, 0.0), ((at.less >> inside) & 1u) != 0u);
    return clamp(1.0 - (clamp(share, 0.0, 1.0) * left + block + last) / covered, 0.0, 1.0);
}
