// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: The rank structure of every row of a rectified map, for exact visibility.
// source: none; see scattering/visibility_rank and docs/src/rank.md.
// note: One workgroup sorts a row by counting, in workgroup memory, and cuts the order of its texels into cells.
// note: Plain counts do not tell which of two equal texels comes first, and it is left to the adapter. Weighted queries
// note: do, where equal texels lie in two chunks: one thread then gives out the ranks in the order of the columns.
// note: Rows of more than 2048 columns are not taken: their order would not fit into workgroup memory.
// definition RANK: bits of a depth, 8 to 12.
// definition AVERAGE: cells count texels, instead of adding their transmittance at two optical depths of a texel.
// binding medium: the medium; without AVERAGE.
// binding slices: bounds of the slices, rgba32float; without AVERAGE.
// binding rectified: the rectified map, r32float or a depth format; non-finite values count as 1, lit.
// binding rank_cells: out, rg32uint: a texel for each chunk and block of 32, chunk times blocks plus block, a row each.
// binding rank_starts: out, r32uint: how many texels of a row have a smaller value, two of 16 bits a texel, a row each.
// binding rank_planes: out, rgba32uint: bit planes, four a layer, lowest first; one texel for 32 columns, a row each.

#import airlight::core::prefix_sum::prefix_weight
#import airlight::scattering::rank_sort::{rectified, counts, texels, sort_row, THREADS, COLUMNS, NONE}
#import airlight::scattering::rectify::{slice_from_texel, greatest_sine}
#import airlight::scattering::single_scatter::Medium

#ifndef AVERAGE
@group(#{GROUP}) @binding(0) var<uniform> medium: Medium;
@group(#{GROUP}) @binding(1) var slices: texture_2d<f32>;
#endif
@group(#{GROUP}) @binding(3) var rank_cells: texture_storage_2d<rg32uint, write>;

/// Threads of the workgroup of a row.
const GROUP_THREADS: u32 = 64u;
/// Cells that are made at a time: first their masks in `counts` and, behind CELLS of them, what they weigh at the lesser
/// step, and then at the greater one.
const CELLS: u32 = 1024u;
#ifdef AVERAGE
const WORDS_PER_CELL: u32 = 1u;
#else
const WORDS_PER_CELL: u32 = 3u;
/// Steps of a weight. The first weighs all of them.
const WEIGHT_STEPS: f32 = 65535.0;
#endif

@compute @workgroup_size(GROUP_THREADS)
fn rank_row(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let size = textureDimensions(rectified);
    let row = group.x;
    let columns = min(size.x, COLUMNS);
    let words = (columns + 1u) / 2u;
    let blocks = (columns + 31u) / 32u;
    if row >= size.y {
        return;
    }
#ifdef AVERAGE
    let least_step = 0.0;
    let rankers = THREADS;
#else
    let rankers = 1u;
    let slice = slice_from_texel(textureLoad(slices, vec2<u32>(row, 0u), 0));
    let least_step = max(medium.extinction * slice.radius_max / (f32(size.x) * greatest_sine(slice)), 0.0);
#endif
    sort_row(thread, row, columns, rankers);
    // As many chunks at a time as there is room for.
    let strip = CELLS / blocks;
    var base = vec2<u32>(0u);
    for (var first = 0u; first < blocks; first += strip) {
        workgroupBarrier();
        for (var cell = thread; cell < WORDS_PER_CELL * CELLS; cell += THREADS) {
            atomicStore(&counts[cell], 0u);
        }
        workgroupBarrier();
        for (var word = thread; word < words; word += THREADS) {
            let ranks = texels[word];
            add_texel(2u * word, ranks & 0xffffu, first, strip, blocks, least_step);
            add_texel(2u * word + 1u, ranks >> 16u, first, strip, blocks, least_step);
        }
        workgroupBarrier();
        for (var chunk = thread; chunk < strip; chunk += THREADS) {
            sum_blocks(chunk * blocks, blocks);
        }
        workgroupBarrier();
        if thread < blocks {
            base = write_cells(thread, row, first, min(strip, blocks - first), blocks, base, least_step);
        }
    }
}

/// Adds a texel to the cell of its chunk and block, if the chunk is one of `strip` from `first` on. `least_step`: the
/// lesser optical depth of a texel.
fn add_texel(column: u32, rank: u32, first: u32, strip: u32, blocks: u32, least_step: f32) {
    let chunk = rank / 32u - first;
    // Chunks before the first wrap to great numbers, and NONE is one.
    if chunk >= strip || rank == NONE {
        return;
    }
    let cell = min(chunk * blocks + column / 32u, CELLS - 1u);
    atomicOr(&counts[cell], 1u << (rank & 31u));
#ifndef AVERAGE
    let weight = exp(-least_step * f32(column));
    atomicAdd(&counts[CELLS + cell], u32(weight * WEIGHT_STEPS + 0.5));
    atomicAdd(&counts[2u * CELLS + cell], u32(weight * weight * WEIGHT_STEPS + 0.5));
#endif
}

/// Turns what is in each block of a chunk, from `begin` on, into what is left of the block.
fn sum_blocks(begin: u32, blocks: u32) {
    var mask = 0u;
    var lesser = 0u;
    var greater = 0u;
    for (var cell = begin; cell < begin + blocks; cell++) {
        mask |= atomicExchange(&counts[cell], mask);
#ifndef AVERAGE
        lesser += atomicExchange(&counts[CELLS + cell], lesser);
        greater += atomicExchange(&counts[2u * CELLS + cell], greater);
#endif
    }
}

/// The cells of a block with `count` chunks from `first` on; gives the base after them. `least_step`: as in `add_texel`.
fn write_cells(
    block: u32, row: u32, first: u32, count: u32, blocks: u32, before: vec2<u32>, least_step: f32
) -> vec2<u32> {
    var base = before;
#ifndef AVERAGE
    let columns = f32(32u * block);
    let whole = vec2<f32>(prefix_weight(least_step, columns), prefix_weight(2.0 * least_step, columns));
    let share = 1.0 / max(whole * WEIGHT_STEPS, vec2<f32>(1.0));
#endif
    for (var chunk = 0u; chunk < count; chunk++) {
        let cell = chunk * blocks + block;
        let mask = atomicLoad(&counts[cell]);
#ifdef AVERAGE
        let stored = base.x;
        base.x += countOneBits(mask);
#else
        let stored = pack2x16unorm(vec2<f32>(base) * share);
        base += vec2<u32>(atomicLoad(&counts[CELLS + cell]), atomicLoad(&counts[2u * CELLS + cell]));
#endif
        textureStore(rank_cells, vec2<u32>(first * blocks + cell, row), vec4<u32>(mask, stored, 0u, 0u));
    }
    return base;
}
