// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::scattering::visibility_rank_weights
// summary: Mean of visibility times fall-off of a view ray over columns that have weights of their own, by one rank query.
// source: none; a rank structure over a permutation whose points have weights: docs/src/rank.md explains it.
// note: Like visibility_rank; but instead of points their weights are added. Cells hold the weight of the ranks of earlier
// note: chunks left of the block. Those of the last chunk, and the columns of the last block, are 32 bits of a word each,
// note: and their weights are bit planes: sum_p 2^p popcount(plane_p & word) is their sum. Both are exact for the weights
// note: as stored, in steps of the greatest one of their chunk or block.
// note: A channel is what is added: the weight times each colour's fall-off, and with these the plain weight that divides.
// note: The error of a mean is at most (2 n B + m C) / (2 (2^weight_bits - 1)) over the weight of what the ray covers: B the
// note: greatest weight of the block, n <= 32 of its columns covered; C that of the chunk, m <= 32 of its ranks meant; plus
// note: an eighth of the optical depth of a texel, in which weights are taken as constant, and 1e-5 for f32.
// equation: mean = (left − dark + Σ_p 2^p popcount(plane_p AND lit) step) / total, weights in steps of the greatest of their chunk or block
// error: within the bound of the note for any weights; test scattering/rank/weights::means_err_by_no_more_than_proven_whatever_the_weights.
// error: equal weights within 1e-6; test scattering/rank/weights::equal_weights_are_counted_exactly.
// parameter colors: 0, 1 or 3.
// parameter channel: 0 .. colors.
// parameter weight_bits: of a weight, 8 or 16.
// parameter weight, greatest: from 0 up, of one unit.
// parameter weights: heads and bit planes of weights.
// parameter depth: of the ray, 0..1.
// parameter cells, starts, planes: as of `visibility_rank`.
// parameter bits: of a depth, 8..12.
// parameter row: of the map, from 0.

#import airlight::scattering::visibility_rank::{rank_place, low_bits}

/// Layers of `weights` before its planes: the steps of the columns of a block, the weight left of a block, and the steps
/// of the ranks of a chunk. A component is a channel: colours, or the weight alone without these, and last the plain weight.
const WEIGHT_HEADS: u32 = 3u;

/// Channels for so many colours; 0 for the weight alone.
fn weight_channels(colors: u32) -> u32 {
    return colors + 1u;
}

/// First layer of the columns' planes of a channel.
fn column_layer(channel: u32, weight_bits: u32) -> u32 {
    return WEIGHT_HEADS + channel * (weight_bits / 4u);
}

/// First layer of the ranks' planes of a channel, which is not the plain weight next to colours.
fn rank_layer(channel: u32, colors: u32, weight_bits: u32) -> u32 {
    return WEIGHT_HEADS + (weight_channels(colors) + channel) * (weight_bits / 4u);
}

/// A weight in steps of which `greatest` is the last, of `bits` bits.
fn weight_steps(weight: f32, greatest: f32, bits: u32) -> u32 {
    let share = select(0.0, weight / greatest, greatest > 1e-37);
    return u32(clamp(share, 0.0, 1.0) * f32((1u << bits) - 1u) + 0.5);
}

/// Steps, summed, of the columns or ranks that are set in `which`, and `part` of those in `partly`: for two words at once.
/// `place`: the block, or chunk, and row; `layer`: the first of the planes.
fn weight_sums(
    weights: texture_2d_array<u32>, place: vec2<u32>, layer: u32, weight_bits: u32, which: vec2<u32>,
    partly: vec2<u32>, part: f32
) -> vec2<f32> {
    var whole = vec2<u32>(0u);
    var last = vec2<u32>(0u);
    for (var four = 0u; four < weight_bits / 4u; four++) {
        let planes = textureLoad(weights, place, layer + four, 0);
        let each = vec4<u32>(1u, 2u, 4u, 8u) << vec4<u32>(4u * four);
        whole.x += dot(countOneBits(planes & vec4<u32>(which.x)), each);
        whole.y += dot(countOneBits(planes & vec4<u32>(which.y)), each);
        last.x += dot(countOneBits(planes & vec4<u32>(partly.x)), each);
        last.y += dot(countOneBits(planes & vec4<u32>(partly.y)), each);
    }
    return vec2<f32>(whole) + part * vec2<f32>(last);
}

/// What of a row a query adds.
struct RankWords {
    /// Block and row.
    block: vec2<u32>,
    /// Chunk and row.
    chunk: vec2<u32>,
    /// Ranks of the chunk that are meant: left of the block, and dark.
    meant: u32,
    /// Columns of the block that are covered: those lit, and all.
    covered: vec2<u32>,
    /// The column in which the ray ends, the same.
    last: vec2<u32>,
    /// What of that is covered, 0..1.
    part: f32,
}

/// Steps of a channel: of the dark ranks of the chunk, and of the lit and of all columns of the block that are covered.
fn channel_steps(
    weights: texture_2d_array<u32>, words: RankWords, channel: u32, colors: u32, weight_bits: u32
) -> vec3<f32> {
    let ranks = weight_sums(
        weights, words.chunk, rank_layer(channel, colors, weight_bits), weight_bits, vec2<u32>(words.meant),
        vec2<u32>(0u), 0.0
    );
    let columns = weight_sums(
        weights, words.block, column_layer(channel, weight_bits), weight_bits, words.covered, words.last, words.part
    );
    return vec3<f32>(ranks.x, columns);
}

/// Mean of visibility times fall-off, for each of `colors` colours (0: the mean visibility, 1: the same for all), of the
/// first `texels` texels of `row` at the depth of a ray, 0..1. `cells`, `starts`, `planes` and `weights` are what the pass
/// `rank_weights` makes, for depths of `bits` bits and weights of `weight_bits` bits; `columns` of the map.
fn rank_means(
    cells: texture_2d<u32>, starts: texture_2d<u32>, planes: texture_2d_array<u32>, weights: texture_2d_array<u32>,
    bits: u32, weight_bits: u32, colors: u32, columns: u32, row: u32, texels: f32, depth: f32
) -> vec3<f32> {
    let at = rank_place(starts, planes, bits, columns, row, texels, depth);
    let cell = textureLoad(cells, vec2<u32>(at.cell, row), 0);
    let base = bitcast<vec3<f32>>(cell.yzw);
    let covered = low_bits(at.column & 31u);
    let last = 1u << (at.column & 31u);
    let words = RankWords(
        vec2<u32>(at.column / 32u, row),
        vec2<u32>(at.cell / ((columns + 31u) / 32u), row),
        cell.x & low_bits(at.ranks),
        vec2<u32>(covered & ~at.less, covered),
        vec2<u32>(last & ~at.less, last),
        at.part
    );
    let column_step = bitcast<vec4<f32>>(textureLoad(weights, words.block, 0u, 0));
    let left = bitcast<vec4<f32>>(textureLoad(weights, words.block, 1u, 0));
    let rank_step = bitcast<vec4<f32>>(textureLoad(weights, words.chunk, 2u, 0)).xyz;

    let first = channel_steps(weights, words, 0u, colors, weight_bits);
    var ranks = vec3<f32>(first.x);
    var lit = vec3<f32>(first.y);
    var total = left.x + column_step.x * first.z;
    if colors == 3u {
        let second = channel_steps(weights, words, 1u, colors, weight_bits);
        let third = channel_steps(weights, words, 2u, colors, weight_bits);
        ranks = vec3<f32>(first.x, second.x, third.x);
        lit = vec3<f32>(first.y, second.y, third.y);
    }
    if colors > 0u {
        // The plain weight is a channel of its own.
        let layer = column_layer(colors, weight_bits);
        let plain = weight_sums(weights, words.block, layer, weight_bits, words.covered, words.last, words.part);
        total = left.w + column_step.w * plain.y;
    }
    // Left of the block all but the dark, in it the lit.
    let each = left.xyz - (base + rank_step * ranks) + column_step.xyz * lit;
    let sum = select(vec3<f32>(each.x), each, colors == 3u);
    // Where all that is covered weighs next to nothing, the last texel stands for it.
    let seen = select(0.0, 1.0, colors == 0u && words.last.x != 0u);
    return select(vec3<f32>(seen), clamp(sum / max(total, 1e-35), vec3<f32>(0.0), vec3<f32>(1.0)), total > 1e-35);
}
