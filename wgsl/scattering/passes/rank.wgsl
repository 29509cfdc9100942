// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: The rank structure of every row of a rectified map, for exact visibility.
// source: none; see scattering/visibility_rank and docs/src/rank.md.
// note: One workgroup sorts a row by counting, in workgroup memory, and cuts the order of its texels into cells.
// note: Which of two equal texels comes first is left to the adapter: no query tells them apart.
// note: Rows of more than 2048 columns are not taken: their order would not fit into workgroup memory.
// definition RANK: bits of a depth, 8 to 12.
// definition AVERAGE: cells count texels, instead of adding their transmittance on the reference ray.
// binding medium: the medium; without AVERAGE.
// binding slices: bounds of the slices, rgba32float; without AVERAGE.
// binding rectified: the rectified map, r32float or a depth format; non-finite values count as 1, lit.
// binding rank_cells: out, rg32uint: a texel for each chunk and block of 32, chunk times blocks plus block, a row each.
// binding rank_starts: out, r32uint: how many texels of a row have a smaller value, two of 16 bits a texel, a row each.
// binding rank_planes: out, rgba32uint: bit planes, four a layer, lowest first; one texel for 32 columns, a row each.

#import airlight::core::finite::finite_or
#import airlight::scattering::rectify::slice_from_texel
#import airlight::scattering::single_scatter::Medium
#import airlight::scattering::visibility_rank::{rank_value, WEIGHT_STEPS}

#ifndef AVERAGE
@group(#{GROUP}) @binding(0) var<uniform> medium: Medium;
@group(#{GROUP}) @binding(1) var slices: texture_2d<f32>;
#endif
@group(#{GROUP}) @binding(2) var rectified: texture_2d<f32>;
@group(#{GROUP}) @binding(3) var rank_cells: texture_storage_2d<rg32uint, write>;
@group(#{GROUP}) @binding(4) var rank_starts: texture_storage_2d<r32uint, write>;
@group(#{GROUP}) @binding(5) var rank_planes: texture_storage_2d_array<rgba32uint, write>;

const BITS: u32 = u32(#{RANK});
const THREADS: u32 = 64u;
/// Columns of the widest row.
const COLUMNS: u32 = 2048u;
/// Pairs of values.
const PAIRS: u32 = 1u << (BITS - 1u);
const PAIRS_PER_THREAD: u32 = PAIRS / THREADS;

/// First how many texels have each value, then how many have a smaller one; two of 16 bits a word.
var<workgroup> counts: array<atomic<u32>, PAIRS>;
/// The columns in order of their values, and their weights in the upper 16 bits; before that the sums of the threads.
var<workgroup> order: array<u32, COLUMNS>;

/// Value of a texel.
fn value_at(column: u32, row: u32) -> u32 {
    return rank_value(finite_or(textureLoad(rectified, vec2<u32>(column, row), 0).x, 1.0), BITS);
}

@compute @workgroup_size(THREADS)
fn rank_row(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let size = textureDimensions(rectified);
    let row = group.x;
    let columns = min(size.x, COLUMNS);
    if row >= size.y {
        return;
    }
    for (var column = thread; column < columns; column += THREADS) {
        let value = value_at(column, row);
        atomicAdd(&counts[value / 2u], 1u << (16u * (value & 1u)));
    }
    workgroupBarrier();

    var sum = 0u;
    for (var pair = thread * PAIRS_PER_THREAD; pair < (thread + 1u) * PAIRS_PER_THREAD; pair++) {
        let both = atomicLoad(&counts[pair]);
        sum += (both & 0xffffu) + (both >> 16u);
    }
    order[thread] = sum;
    workgroupBarrier();
    var start = 0u;
    for (var before = 0u; before < THREADS; before++) {
        start += select(0u, order[before], before < thread);
    }
    for (var pair = thread * PAIRS_PER_THREAD; pair < (thread + 1u) * PAIRS_PER_THREAD; pair++) {
        let both = atomicLoad(&counts[pair]);
        let packed = start | ((start + (both & 0xffffu)) << 16u);
        atomicStore(&counts[pair], packed);
        textureStore(rank_starts, vec2<u32>(pair, row), vec4<u32>(packed, 0u, 0u, 0u));
        start += (both & 0xffffu) + (both >> 16u);
    }
    workgroupBarrier();

#ifndef AVERAGE
    let slice = slice_from_texel(textureLoad(slices, vec2<u32>(row, 0u), 0));
    let optical_step = max(medium.extinction * slice.radius_max / (f32(size.x) * slice.reference), 0.0);
#endif
    for (var column = thread; column < columns; column += THREADS) {
        let value = value_at(column, row);
        let shift = 16u * (value & 1u);
        let rank = (atomicAdd(&counts[value / 2u], 1u << shift) >> shift) & 0xffffu;
#ifdef AVERAGE
        let weight = 0u;
#else
        let weight = u32(exp(-optical_step * f32(column)) * WEIGHT_STEPS + 0.5);
#endif
        order[min(rank, COLUMNS - 1u)] = column | (weight << 16u);
    }
    workgroupBarrier();

    let blocks = (columns + 31u) / 32u;
    for (var block = thread; block < blocks; block += THREADS) {
        write_planes(block, row, columns);
        write_cells(block, row, columns, blocks);
    }
}

/// Bit planes of the values of a block.
fn write_planes(block: u32, row: u32, columns: u32) {
    for (var layer = 0u; layer < (BITS + 3u) / 4u; layer++) {
        var planes = vec4<u32>(0u);
        for (var column = 0u; column < 32u; column++) {
            // Columns beyond the row are never asked for.
            let value = value_at(min(32u * block + column, columns - 1u), row) >> (4u * layer);
            planes |= ((vec4<u32>(value) >> vec4<u32>(0u, 1u, 2u, 3u)) & vec4<u32>(1u)) << vec4<u32>(column);
        }
        textureStore(rank_planes, vec2<u32>(block, row), layer, planes);
    }
}

/// The cells of a block with all chunks.
fn write_cells(block: u32, row: u32, columns: u32, blocks: u32) {
    var base = 0u;
    for (var chunk = 0u; chunk < blocks; chunk++) {
        var mask = 0u;
        var added = 0u;
        for (var rank = 0u; rank < min(32u, columns - 32u * chunk); rank++) {
            let entry = order[32u * chunk + rank];
            let left = (entry & 0xffffu) < 32u * block;
            mask |= select(0u, 1u, left) << rank;
            added += select(0u, entry >> 16u, left);
        }
        textureStore(rank_cells, vec2<u32>(chunk * blocks + block, row), vec4<u32>(mask, base, 0u, 0u));
#ifdef AVERAGE
        base += countOneBits(mask);
#else
        base += added;
#endif
    }
}
