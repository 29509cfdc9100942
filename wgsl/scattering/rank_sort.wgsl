// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::scattering::rank_sort
// summary: Callback: sorts a row of the rectified map by counting, in workgroup memory, for the passes that make rank structures.
// source: none; see scattering/visibility_rank and docs/src/rank.md.
// note: Unlike algorithm modules a callback holds bindings, those that passes share, and here the workgroup's memory: after
// note: the sort `counts` is free for what a pass makes of the ranks.
// note: Rows of more than 2048 columns are not taken: their order would not fit into workgroup memory.
// equation: value = ⌊depth (2^bits − 1) + ½⌋;  start(v) = texels with a smaller value;  rank = start(value) + equal ones before
// error: exact; test scattering/rank/counts::counts_are_exactly_those_of_the_stepped_map.
// parameter column, row, columns: of the rectified map, 2048 columns at most.
// parameter value: 0 .. 2^RANK - 1, or NONE.
// parameter block, blocks: of 32 columns.
// parameter rankers: 1..64.
// definition RANK: bits of a depth, 8 to 12.
// binding rectified: the rectified map, r32float or a depth format; non-finite values count as 1, lit.
// binding rank_starts: out, r32uint: how many texels of a row have a smaller value, two of 16 bits a texel, a row each.
// binding rank_planes: out, rgba32uint: bit planes, four a layer, lowest first; one texel for 32 columns, a row each.

#import airlight::core::finite::finite_or
#import airlight::scattering::visibility_rank::rank_value

@group(#{GROUP}) @binding(2) var rectified: texture_2d<f32>;
@group(#{GROUP}) @binding(9) var rank_starts: texture_storage_2d<r32uint, write>;
@group(#{GROUP}) @binding(10) var rank_planes: texture_storage_2d_array<rgba32uint, write>;

const BITS: u32 = u32(#{RANK});
/// Threads of a workgroup, which takes a row.
const THREADS: u32 = 64u;
/// Columns of the widest row.
const COLUMNS: u32 = 2048u;
/// Pairs of values.
const PAIRS: u32 = 1u << (BITS - 1u);
const PAIRS_PER_THREAD: u32 = PAIRS / THREADS;
/// Words of `counts`: pairs of values of 12 bits and, behind SUMS of them, the texels of each thread's values.
const COUNTS: u32 = 3072u;
const SUMS: u32 = 2048u;
const EIGHTS: u32 = THREADS / 8u;
/// Stands for the texel beyond the last of a row.
const NONE: u32 = 0xffffu;

/// How many texels have each value, then how many have a smaller one, two of 16 bits a word; after the sort it is the
/// pass' own.
var<workgroup> counts: array<atomic<u32>, COUNTS>;
/// Values of the texels, then their ranks, two of 16 bits a word.
var<workgroup> texels: array<u32, COLUMNS / 2u>;

/// Value of a texel, counted; NONE beyond the row.
fn counted_value(column: u32, row: u32, columns: u32) -> u32 {
    if column >= columns {
        return NONE;
    }
    let value = rank_value(finite_or(textureLoad(rectified, vec2<u32>(column, row), 0).x, 1.0), BITS);
    atomicAdd(&counts[value / 2u], 1u << (16u * (value & 1u)));
    return value;
}

/// The next rank of a value; NONE for NONE.
fn next_rank(value: u32) -> u32 {
    if value == NONE {
        return NONE;
    }
    let shift = 16u * (value & 1u);
    return (atomicAdd(&counts[value / 2u], 1u << shift) >> shift) & 0xffffu;
}

/// Sorts a row: writes starts and planes, and leaves the ranks in `texels`. `thread` of the workgroup; `rankers`: threads
/// that give out ranks; one alone gives those of equal values in the order of their columns. The caller waits for all
/// threads before it reads ranks of others.
fn sort_row(thread: u32, row: u32, columns: u32, rankers: u32) {
    let words = (columns + 1u) / 2u;
    let blocks = (columns + 31u) / 32u;
    for (var word = thread; word < words; word += THREADS) {
        let first = counted_value(2u * word, row, columns);
        texels[word] = first | (counted_value(2u * word + 1u, row, columns) << 16u);
    }
    workgroupBarrier();

    write_planes(thread, row, blocks);
    var sum = 0u;
    for (var pair = thread * PAIRS_PER_THREAD; pair < (thread + 1u) * PAIRS_PER_THREAD; pair++) {
        let both = atomicLoad(&counts[pair]);
        sum += (both & 0xffffu) + (both >> 16u);
    }
    atomicStore(&counts[SUMS + thread], sum);
    workgroupBarrier();
    // Sums of eight threads each, then what is before a thread of eights and of single ones.
    if thread < EIGHTS {
        var eight = 0u;
        for (var one = 0u; one < 8u; one++) {
            eight += atomicLoad(&counts[SUMS + 8u * thread + one]);
        }
        atomicStore(&counts[SUMS + THREADS + thread], eight);
    }
    workgroupBarrier();
    var start = 0u;
    for (var before = 0u; before < EIGHTS; before++) {
        start += select(0u, atomicLoad(&counts[SUMS + THREADS + before]), before < thread / 8u);
    }
    for (var before = 0u; before < 8u; before++) {
        start += select(0u, atomicLoad(&counts[SUMS + (thread & ~7u) + before]), before < (thread & 7u));
    }
    for (var pair = thread * PAIRS_PER_THREAD; pair < (thread + 1u) * PAIRS_PER_THREAD; pair++) {
        let both = atomicLoad(&counts[pair]);
        let packed = start | ((start + (both & 0xffffu)) << 16u);
        atomicStore(&counts[pair], packed);
        textureStore(rank_starts, vec2<u32>(pair, row), vec4<u32>(packed, 0u, 0u, 0u));
        start += (both & 0xffffu) + (both >> 16u);
    }
    workgroupBarrier();
    if thread < rankers {
        for (var word = thread; word < words; word += rankers) {
            let values = texels[word];
            let first = next_rank(values & 0xffffu);
            texels[word] = first | (next_rank(values >> 16u) << 16u);
        }
    }
}

/// Bit planes of the values of a block.
fn write_planes(block: u32, row: u32, blocks: u32) {
    if block >= blocks {
        return;
    }
    var low = vec4<u32>(0u);
    var middle = vec4<u32>(0u);
    var high = vec4<u32>(0u);
    // Columns beyond the row are never asked for.
    for (var column = 0u; column < 32u; column++) {
        let value = (texels[16u * block + column / 2u] >> (16u * (column & 1u))) & 0xffffu;
        let bits = vec4<u32>(value) >> vec4<u32>(0u, 1u, 2u, 3u);
        low |= (bits & vec4<u32>(1u)) << vec4<u32>(column);
        middle |= ((bits >> vec4<u32>(4u)) & vec4<u32>(1u)) << vec4<u32>(column);
        high |= ((bits >> vec4<u32>(8u)) & vec4<u32>(1u)) << vec4<u32>(column);
    }
    textureStore(rank_planes, vec2<u32>(block, row), 0u, low);
    textureStore(rank_planes, vec2<u32>(block, row), 1u, middle);
    if BITS > 8u {
        textureStore(rank_planes, vec2<u32>(block, row), 2u, high);
    }
}
