// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: scattering/rank, permutation default (RANK=12)
// summary: The rank structure of every row of a rectified map, for exact visibility.
// source: none; see scattering/visibility_rank and docs/src/rank.md.
// note: One workgroup sorts a row by counting, in workgroup memory, and cuts the order of its texels into cells.
// note: Plain counts do not tell which of two equal texels comes first, and it is left to the adapter. Weighted queries
// note: do, where equal texels lie in two chunks: one thread then gives out the ranks in the order of the columns.
// note: Rows of more than 2048 columns are not taken: their order would not fit into workgroup memory.
// definition RANK: bits of a depth, 8 to 12.
// binding medium: the medium; without AVERAGE.
// binding slices: bounds of the slices, rgba32float; without AVERAGE.
// binding rectified: the rectified map, r32float or a depth format; non-finite values count as 1, lit.
// binding rank_cells: out, rg32uint: a texel for each chunk and block of 32, chunk times blocks plus block, a row each.
// binding rank_starts: out, r32uint: how many texels of a row have a smaller value, two of 16 bits a texel, a row each.
// binding rank_planes: out, rgba32uint: bit planes, four a layer, lowest first; one texel for 32 columns, a row each.

// ---- airlight::core::finite ----
// summary: Replaces NaN and infinities in data that comes from outside.
// source: IEEE 754 binary32: all exponent bits set means NaN or infinity.

/// True if `x` is neither NaN nor infinite.
fn is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u;
}

/// `x` where it is finite, `fallback` elsewhere.
fn finite_or(x: f32, fallback: f32) -> f32 {
    return select(fallback, x, is_finite(x));
}

// ---- airlight::core::prefix_sum ----
// summary: Running weighted mean along a row: the prefix sum that filters basis textures.
// source: thesis 4.3.3, Listings 4.1 and 4.2.

/// 1 - exp(-x) for x >= 0, without cancellation for small x. Relative error below 1e-6.
fn one_minus_exp(x: f32) -> f32 {
    const third: f32 = 1.0 / 3.0;
    const sixth: f32 = 1.0 / 6.0;
    let series = x * (1.0 - x * 0.5 * (1.0 - x * third * (1.0 - x * 0.25 * (1.0 - x * 0.2 * (1.0 - x * sixth)))));
    return select(1.0 - exp(-x), series, x < 0.3);
}

/// Weight of the first `texels` texels of a row, fractional, in units of the first texel's. `optical_step`: optical
/// depth of one texel; zero gives the number of texels. Relative error below 2e-6.
fn prefix_weight(optical_step: f32, texels: f32) -> f32 {
    // So thin that 1 - exp(-x) is x.
    let thickness = max(optical_step, 1e-30);
    return one_minus_exp(thickness * texels) / one_minus_exp(thickness);
}

// ---- airlight::scattering::rectify ----
// summary: Epipolar coordinates around a directional light: rows are slices, columns radii, depth the angle to the light.
// source: thesis 4.4.1, after Baran et al., "A hierarchical volumetric shadow algorithm" (2010); Eq. 4.12.

const PI: f32 = 3.141592653589793;

/// Bounds of one slice.
struct Slice {
    /// Least angle to the light of its view rays, radians.
    angle_min: f32,
    /// Greatest angle to the light of its view rays, radians.
    angle_max: f32,
    /// Radius in metres at the right end of its row.
    radius_max: f32,
    /// k of the reference ray, the bisectrix: sine of its angle to the light.
    reference: f32,
}

/// Greatest sine of an angle to the light between the bounds of a slice, within 2 %.
fn greatest_sine(slice: Slice) -> f32 {
    let off = max(max(slice.angle_min - 0.5 * PI, 0.5 * PI - slice.angle_max), 0.0);
    let square = min(off * off, 0.25 * PI * PI);
    return 1.0 - square * (0.5 - square / 24.0);
}

/// What `slice_texel` did, undone.
fn slice_from_texel(texel: vec4<f32>) -> Slice {
    return Slice(texel.x, texel.y, texel.z, texel.w);
}

// ---- airlight::scattering::single_scatter ----
// summary: Single scattering of a directional light in a homogeneous medium, given the visibility along a ray.
// source: thesis 4.2.1, Eq. 4.1 and 4.2; 4.3.2, Eq. 4.8 and 4.9; Listing 4.4.

/// A homogeneous medium. 32 bytes.
struct Medium {
    /// Single-scattering albedo, 0..1 for each colour.
    albedo: vec3<f32>,
    /// Extinction coefficient in 1/m, not negative; zero is a clear picture.
    extinction: f32,
    /// Mean cosine of the Henyey-Greenstein phase function, -0.999..0.999.
    g: f32,
    /// Rays end here if they meet nothing nearer, metres, positive.
    distance_limit: f32,
    reserved_a: f32,
    reserved_b: f32,
}

// ---- airlight::scattering::visibility_rank ----
// summary: Exact mean visibility of a view ray: how many of the first texels of a row lie behind it, by one rank query.
// source: none; a rank structure over a permutation, cut into words: docs/src/rank.md explains it with a drawing.

/// A depth, clamped to 0..1, as a whole number of `bits` bits.
fn rank_value(depth: f32, bits: u32) -> u32 {
    return u32(clamp(depth, 0.0, 1.0) * f32((1u << bits) - 1u) + 0.5);
}

// ---- airlight::scattering::rank_sort ----
// summary: Callback: sorts a row of the rectified map by counting, in workgroup memory, for the passes that make rank structures.
// source: none; see scattering/visibility_rank and docs/src/rank.md.

@group(0) @binding(2) var rectified: texture_2d<f32>;
@group(0) @binding(9) var rank_starts: texture_storage_2d<r32uint, write>;
@group(0) @binding(10) var rank_planes: texture_storage_2d_array<rgba32uint, write>;

const BITS: u32 = u32(12);
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

// ---- scattering/rank ----

@group(0) @binding(0) var<uniform> medium: Medium;
@group(0) @binding(1) var slices: texture_2d<f32>;
@group(0) @binding(3) var rank_cells: texture_storage_2d<rg32uint, write>;

/// Threads of the workgroup of a row.
const GROUP_THREADS: u32 = 64u;
/// Cells that are made at a time: first their masks in `counts` and, behind CELLS of them, what they weigh at the lesser
/// step, and then at the greater one.
const CELLS: u32 = 1024u;
const WORDS_PER_CELL: u32 = 3u;
/// Steps of a weight. The first weighs all of them.
const WEIGHT_STEPS: f32 = 65535.0;

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
    let rankers = 1u;
    let slice = slice_from_texel(textureLoad(slices, vec2<u32>(row, 0u), 0));
    let least_step = max(medium.extinction * slice.radius_max / (f32(size.x) * greatest_sine(slice)), 0.0);
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
    let weight = exp(-least_step * f32(column));
    atomicAdd(&counts[CELLS + cell], u32(weight * WEIGHT_STEPS + 0.5));
    atomicAdd(&counts[2u * CELLS + cell], u32(weight * weight * WEIGHT_STEPS + 0.5));
}

/// Turns what is in each block of a chunk, from `begin` on, into what is left of the block.
fn sum_blocks(begin: u32, blocks: u32) {
    var mask = 0u;
    var lesser = 0u;
    var greater = 0u;
    for (var cell = begin; cell < begin + blocks; cell++) {
        mask |= atomicExchange(&counts[cell], mask);
        lesser += atomicExchange(&counts[CELLS + cell], lesser);
        greater += atomicExchange(&counts[2u * CELLS + cell], greater);
    }
}

/// The cells of a block with `count` chunks from `first` on; gives the base after them. `least_step`: as in `add_texel`.
fn write_cells(
    block: u32, row: u32, first: u32, count: u32, blocks: u32, before: vec2<u32>, least_step: f32
) -> vec2<u32> {
    var base = before;
    let columns = f32(32u * block);
    let whole = vec2<f32>(prefix_weight(least_step, columns), prefix_weight(2.0 * least_step, columns));
    let share = 1.0 / max(whole * WEIGHT_STEPS, vec2<f32>(1.0));
    for (var chunk = 0u; chunk < count; chunk++) {
        let cell = chunk * blocks + block;
        let mask = atomicLoad(&counts[cell]);
        let stored = pack2x16unorm(vec2<f32>(base) * share);
        base += vec2<u32>(atomicLoad(&counts[CELLS + cell]), atomicLoad(&counts[2u * CELLS + cell]));
        textureStore(rank_cells, vec2<u32>(first * blocks + cell, row), vec4<u32>(mask, stored, 0u, 0u));
    }
    return base;
}
