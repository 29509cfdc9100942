// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: The rank structure of every row of a rectified map whose columns have weights of their own.
// source: none; see scattering/visibility_rank_weights and docs/src/rank.md.
// note: One workgroup sorts a row by counting, in workgroup memory, and cuts the order of its texels into cells. Each thread
// note: owns a block of 32 columns, so that weights are added in the order of the columns, and need no atomics.
// note: Ranks are given out in the order of the columns, by one thread: sums of f32 are the same bits each time.
// note: Rows of more than 2048 columns are not taken: their order would not fit into workgroup memory.
// definition RANK: bits of a depth, 8 to 12.
// definition WEIGHT_BITS: bits of a weight, 8 or 16.
// definition AVERAGE: all columns of slices, and all metres of projective rows, weigh alike.
// definition LOCAL: rows around a spot or point light.
// definition PROJECTIVE: projective rows, whose texels differ in length. Not with LOCAL or COLORS.
// definition COLORS: 1 for the fall-off of a spot, 3 with LIGHT_TEXTURE.
// definition LIGHT_TEXTURE: a texture colours the light; with COLORS=3.
// binding medium: the medium; absent with AVERAGE.
// binding slices: bounds of the slices, rgba32float; absent with PROJECTIVE, and with AVERAGE unless with COLORS.
// binding rows: the projective rows; with PROJECTIVE only.
// binding rectified: the rectified map, r32float or a depth format; non-finite values count as 1, lit.
// binding light: the light; with LOCAL or COLORS only.
// binding frame: the frame of the slices; with LOCAL or COLORS only.
// binding light_texture: linear RGB 0..1 over the whole shadow map, any float format that filters; with LIGHT_TEXTURE only.
// binding light_sampler: linear, clamped to the edge; with LIGHT_TEXTURE only.
// binding rank_cells: out, rg32uint, with LIGHT_TEXTURE rgba32uint: mask, and for each colour a weight in the bits of an f32; a texel for each chunk and block of 32, chunk times blocks plus block, a row each.
// binding rank_starts: out, r32uint: how many texels of a row have a smaller value, two of 16 bits a texel, a row each.
// binding rank_planes: out, rgba32uint: bit planes, four a layer, lowest first; one texel for 32 columns, a row each.
// binding rank_weights: out, rgba32uint: three layers of f32 in bits, steps of a block, weights left of it, steps of a chunk; then bit planes of weights, four a layer, lowest first, of the columns for each channel and of the ranks for each colour; one texel for 32 columns, or ranks, a row each.

#import airlight::core::finite::finite_or
#import airlight::scattering::column_weights::{weighted_column, next_column, falloff_of_column}
#import airlight::scattering::rank_sort::{rectified, counts, texels, sort_row, THREADS, COLUMNS, COUNTS, SUMS, NONE}
#import airlight::scattering::visibility_rank_weights::{column_layer, rank_layer, weight_steps}

#ifdef LIGHT_TEXTURE
@group(#{GROUP}) @binding(3) var rank_cells: texture_storage_2d<rgba32uint, write>;
#else
@group(#{GROUP}) @binding(3) var rank_cells: texture_storage_2d<rg32uint, write>;
#endif
@group(#{GROUP}) @binding(11) var rank_weights: texture_storage_2d_array<rgba32uint, write>;

/// Threads of the workgroup of a row.
const GROUP_THREADS: u32 = 64u;
/// Bits of a weight, and layers of their planes.
const WEIGHT_BITS: u32 = u32(#{WEIGHT_BITS});
const LAYERS: u32 = WEIGHT_BITS / 4u;
#ifdef COLORS
/// Colours as the query counts them, those whose dark weight it asks for, and what is added.
const COLORS_ASKED: u32 = u32(#{COLORS});
const COLOR_COUNT: u32 = COLORS_ASKED;
const CHANNELS: u32 = COLORS_ASKED + 1u;
#else
const COLORS_ASKED: u32 = 0u;
const COLOR_COUNT: u32 = 1u;
const CHANNELS: u32 = 1u;
#endif
/// Cells that are made at a time: first their masks in `counts` and, behind CELLS of them, the weights of each colour.
const CELLS: u32 = COUNTS / (COLOR_COUNT + 1u);
/// More than any sum of a row may be, over its columns.
const GREATEST_WEIGHT: f32 = 1e30;

/// Weights of the columns of the thread's block, channel after channel.
var<private> column_weights: array<f32, 32u * CHANNELS>;
/// What is to be stored as bit planes.
var<private> stored: array<f32, 32>;

/// The component of a channel: the plain weight is the last one.
fn component_of(channel: u32) -> vec4<bool> {
    let component = select(channel, 3u, COLORS_ASKED > 0u && channel == COLORS_ASKED);
    return vec4<u32>(0u, 1u, 2u, 3u) == vec4<u32>(component);
}

/// Rank of a column; NONE beyond the row.
fn rank_of(column: u32, columns: u32) -> u32 {
    let both = texels[min(column, COLUMNS - 1u) / 2u];
    return select(NONE, (both >> (16u * (column & 1u))) & 0xffffu, column < columns);
}

/// Writes `stored` as bit planes; gives the weight of a step.
fn write_weight_planes(place: vec2<u32>, layer: u32) -> f32 {
    var greatest = 0.0;
    for (var i = 0u; i < 32u; i++) {
        greatest = max(greatest, stored[i]);
    }
    var planes = array<vec4<u32>, LAYERS>();
    for (var i = 0u; i < 32u; i++) {
        let steps = weight_steps(stored[i], greatest, WEIGHT_BITS);
        for (var four = 0u; four < LAYERS; four++) {
            let bits = vec4<u32>(steps) >> (vec4<u32>(0u, 1u, 2u, 3u) + 4u * four);
            planes[four] |= (bits & vec4<u32>(1u)) << vec4<u32>(i);
        }
    }
    for (var four = 0u; four < LAYERS; four++) {
        textureStore(rank_weights, place, layer + four, planes[four]);
    }
    return greatest / f32((1u << WEIGHT_BITS) - 1u);
}

/// What the columns of a block weigh together, a component for each channel: it lies behind what `counts` holds of ranks.
fn block_sum(block: u32) -> vec4<f32> {
    let word = SUMS + 4u * block;
    return bitcast<vec4<f32>>(vec4<u32>(
        atomicLoad(&counts[word]), atomicLoad(&counts[word + 1u]), atomicLoad(&counts[word + 2u]),
        atomicLoad(&counts[word + 3u])
    ));
}

/// Weighs the columns of a block and adds them; writes their planes and steps.
fn weigh_block(block: u32, row: u32, size: vec2<u32>, columns: u32) {
    var sums = vec4<f32>(0.0);
    var at = weighted_column(row, size, 0u, 32u * block);
    for (var i = 0u; i < 32u; i++) {
        let finite = clamp(finite_or(at.weight, 0.0), 0.0, GREATEST_WEIGHT);
        let weight = select(0.0, finite, at.column < columns);
#ifdef COLORS
        let falloff = falloff_of_column(row, (f32(at.column) + 0.5) / f32(size.x));
        let weighted = weight * clamp(falloff, vec3<f32>(0.0), vec3<f32>(1.0));
        column_weights[i] = weighted.x;
#ifdef LIGHT_TEXTURE
        column_weights[32u + i] = weighted.y;
        column_weights[64u + i] = weighted.z;
#endif
        column_weights[32u * COLORS_ASKED + i] = weight;
        sums += vec4<f32>(weighted, weight);
#else
        column_weights[i] = weight;
        sums.x += weight;
#endif
        at = next_column(at, size);
    }
    for (var channel = 0u; channel < 4u; channel++) {
        atomicStore(&counts[SUMS + 4u * block + channel], bitcast<u32>(sums[channel]));
    }
    var steps = vec4<f32>(0.0);
    for (var channel = 0u; channel < CHANNELS; channel++) {
        for (var i = 0u; i < 32u; i++) {
            stored[i] = column_weights[32u * channel + i];
        }
        let step = write_weight_planes(vec2<u32>(block, row), column_layer(channel, WEIGHT_BITS));
        steps = select(steps, vec4<f32>(step), component_of(channel));
    }
    textureStore(rank_weights, vec2<u32>(block, row), 0u, bitcast<vec4<u32>>(steps));
}

@compute @workgroup_size(GROUP_THREADS)
fn rank_weighted_row(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let size = textureDimensions(rectified);
    let row = group.x;
    let columns = min(size.x, COLUMNS);
    let blocks = (columns + 31u) / 32u;
    if row >= size.y {
        return;
    }
    sort_row(thread, row, columns, 1u);
    if thread < blocks {
        weigh_block(thread, row, size, columns);
    }
    workgroupBarrier();
    if thread < blocks {
        var left = vec4<f32>(0.0);
        for (var before = 0u; before < THREADS; before++) {
            left += select(vec4<f32>(0.0), block_sum(before), before < thread);
        }
        textureStore(rank_weights, vec2<u32>(thread, row), 1u, bitcast<vec4<u32>>(left));
    }
    // Weights in the order of ranks, one colour after the other.
    var steps = vec4<f32>(0.0);
    for (var color = 0u; color < COLOR_COUNT; color++) {
        workgroupBarrier();
        if thread < blocks {
            for (var i = 0u; i < 32u; i++) {
                let rank = rank_of(32u * thread + i, columns);
                if rank < COUNTS {
                    atomicStore(&counts[rank], bitcast<u32>(column_weights[32u * color + i]));
                }
            }
        }
        workgroupBarrier();
        if thread < blocks {
            for (var i = 0u; i < 32u; i++) {
                let rank = 32u * thread + i;
                stored[i] = select(0.0, bitcast<f32>(atomicLoad(&counts[rank])), rank < columns);
            }
            let step = write_weight_planes(vec2<u32>(thread, row), rank_layer(color, COLORS_ASKED, WEIGHT_BITS));
            steps = select(steps, vec4<f32>(step), component_of(color));
        }
    }
    if thread < blocks {
        textureStore(rank_weights, vec2<u32>(thread, row), 2u, bitcast<vec4<u32>>(steps));
    }
    // As many chunks at a time as there is room for.
    let strip = CELLS / blocks;
    var base = vec3<f32>(0.0);
    for (var first = 0u; first < blocks; first += strip) {
        workgroupBarrier();
        for (var word = thread; word < COUNTS; word += THREADS) {
            atomicStore(&counts[word], 0u);
        }
        workgroupBarrier();
        if thread < blocks {
            for (var i = 0u; i < 32u; i++) {
                add_column(thread, i, columns, first, strip, blocks);
            }
        }
        workgroupBarrier();
        for (var chunk = thread; chunk < strip; chunk += THREADS) {
            sum_blocks(chunk * blocks, blocks);
        }
        workgroupBarrier();
        if thread < blocks {
            base = write_cells(thread, row, first, min(strip, blocks - first), blocks, base);
        }
    }
}

/// Adds column `i` of a block to its cell, if its chunk is one of `strip` from `first` on. Only the block's own thread
/// writes there.
fn add_column(block: u32, i: u32, columns: u32, first: u32, strip: u32, blocks: u32) {
    let rank = rank_of(32u * block + i, columns);
    // Chunks before the first wrap to great numbers, and NONE is beyond all.
    let chunk = rank / 32u - first;
    if chunk >= strip || rank == NONE {
        return;
    }
    let cell = min(chunk * blocks + block, CELLS - 1u);
    atomicOr(&counts[cell], 1u << (rank & 31u));
    for (var color = 0u; color < COLOR_COUNT; color++) {
        let word = (color + 1u) * CELLS + cell;
        let sum = bitcast<f32>(atomicLoad(&counts[word])) + column_weights[32u * color + i];
        atomicStore(&counts[word], bitcast<u32>(sum));
    }
}

/// Turns what is in each block of a chunk, from `begin` on, into what is left of the block.
fn sum_blocks(begin: u32, blocks: u32) {
    var mask = 0u;
    for (var cell = begin; cell < begin + blocks; cell++) {
        mask |= atomicExchange(&counts[cell], mask);
    }
    for (var color = 0u; color < COLOR_COUNT; color++) {
        var sum = 0.0;
        for (var cell = begin; cell < begin + blocks; cell++) {
            let word = (color + 1u) * CELLS + cell;
            sum += bitcast<f32>(atomicExchange(&counts[word], bitcast<u32>(sum)));
        }
    }
}

/// The cells of a block with `count` chunks from `first` on; gives the base after them, a component for each colour.
fn write_cells(block: u32, row: u32, first: u32, count: u32, blocks: u32, before: vec3<f32>) -> vec3<f32> {
    var base = before;
    for (var chunk = 0u; chunk < count; chunk++) {
        let cell = chunk * blocks + block;
        let texel = vec4<u32>(atomicLoad(&counts[cell]), bitcast<vec3<u32>>(base));
        textureStore(rank_cells, vec2<u32>(first * blocks + cell, row), texel);
        base.x += bitcast<f32>(atomicLoad(&counts[CELLS + cell]));
#ifdef LIGHT_TEXTURE
        base.y += bitcast<f32>(atomicLoad(&counts[2u * CELLS + cell]));
        base.z += bitcast<f32>(atomicLoad(&counts[3u * CELLS + cell]));
#endif
    }
    return base;
}
