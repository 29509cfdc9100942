// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: scattering/rank_weights, permutation projective_average (AVERAGE PROJECTIVE RANK=12 WEIGHT_BITS=16)
// summary: The rank structure of every row of a rectified map whose columns have weights of their own.
// source: none; see scattering/visibility_rank_weights and docs/src/rank.md.
// note: One workgroup sorts a row by counting, in workgroup memory, and cuts the order of its texels into cells. Each thread
// note: owns a block of 32 columns, so that weights are added in the order of the columns, and need no atomics.
// note: Ranks are given out in the order of the columns, by one thread: sums of f32 are the same bits each time.
// note: Rows of more than 2048 columns are not taken: their order would not fit into workgroup memory.
// definition RANK: bits of a depth, 8 to 12.
// definition WEIGHT_BITS: bits of a weight, 8 or 16.
// definition AVERAGE: all columns of slices, and all metres of projective rows, weigh alike.
// definition PROJECTIVE: projective rows, whose texels differ in length. Not with LOCAL or COLORS.
// binding rows: the projective rows; with PROJECTIVE only.
// binding rectified: the rectified map, r32float or a depth format; non-finite values count as 1, lit.
// binding rank_cells: out, rg32uint, with LIGHT_TEXTURE rgba32uint: mask, and for each colour a weight in the bits of an f32; a texel for each chunk and block of 32, chunk times blocks plus block, a row each.
// binding rank_starts: out, r32uint: how many texels of a row have a smaller value, two of 16 bits a texel, a row each.
// binding rank_planes: out, rgba32uint: bit planes, four a layer, lowest first; one texel for 32 columns, a row each.
// binding rank_weights: out, rgba32uint: three layers of f32 in bits, steps of a block, weights left of it, steps of a chunk; then bit planes of weights, four a layer, lowest first, of the columns for each channel and of the ranks for each colour; one texel for 32 columns, or ranks, a row each.

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

// ---- airlight::scattering::projective ----
// summary: Projective rows around a directional light: view rays run along rows at constant depth after one matrix.
// source: thesis 4.4.2; weights after 4.3.2, Eq. 4.8.

/// Perspective camera: rows and depth are slopes.
const PERSPECTIVE: u32 = 0u;

/// The rows of a camera and a light, made by the host. 96 bytes.
struct ProjectiveRows {
    /// The eye; of an orthographic camera the centre of its near plane. World, metres.
    origin: vec3<f32>,
    /// X at the left end of column 0, metres; positive in perspective.
    near: f32,
    /// Unit vector of X, at right angles to the light, along the middle of the view rays.
    along: vec3<f32>,
    /// Metres of Z that a view ray of an orthographic camera takes for one of X; 0 in perspective.
    tilt: f32,
    /// Unit vector of Y.
    across: vec3<f32>,
    /// Slope Y / X (orthographic: Y, metres) at the upper border of row 0.
    row_min: f32,
    /// Unit vector of Z, AWAY from the light.
    away: vec3<f32>,
    /// From there to the lower border of the last row, positive.
    row_span: f32,
    /// X at the right end of each split, metres, growing; the last one in use and all after it are the far end.
    bounds: vec4<f32>,
    /// Least slope Z / X (orthographic: Z - tilt X, metres) of view rays.
    depth_min: f32,
    /// Range of those, positive.
    depth_span: f32,
    /// Number of splits, 1..4.
    splits: u32,
    /// PERSPECTIVE, or 1 for orthographic.
    projection: u32,
}

/// X at the left end of `split`, metres.
fn split_begin(rows: ProjectiveRows, split: u32) -> f32 {
    return select(rows.bounds[max(split, 1u) - 1u], rows.near, split == 0u);
}

/// X in metres of a fractional `column`, 0..`width`: what `column_from_x` did, undone.
fn x_from_column(rows: ProjectiveRows, width: f32, column: f32) -> f32 {
    let share = column * f32(rows.splits) / width;
    let split = min(u32(max(share, 0.0)), rows.splits - 1u);
    let unit = clamp(share - f32(split), 0.0, 1.0);
    let begin = split_begin(rows, split);
    let end = rows.bounds[split];
    let divided = begin * end / (end - unit * (end - begin));
    return select(begin + unit * (end - begin), divided, rows.projection == PERSPECTIVE);
}

/// X of the right edge of texel `column`, metres.
fn texel_end(rows: ProjectiveRows, width: f32, column: u32) -> f32 {
    return x_from_column(rows, width, f32(column) + 1.0);
}

/// X of the left edge of texel `column`, metres: in perspective texel 0 begins at the eye.
fn texel_begin(rows: ProjectiveRows, width: f32, column: u32) -> f32 {
    let at_eye = column == 0u && rows.projection == PERSPECTIVE;
    return select(x_from_column(rows, width, f32(column)), 0.0, at_eye);
}

/// Slope (orthographic: Y) in the middle of `row`, of `height` rows.
fn row_slope(rows: ProjectiveRows, height: f32, row: f32) -> f32 {
    return rows.row_min + rows.row_span * (row + 0.5) / height;
}

/// Metres along the reference ray of `row` for one of X: the bisectrix of the row's view rays that cross a texel fastest
/// and slowest, as for slices.
fn reference_reach(rows: ProjectiveRows, height: f32, row: f32) -> f32 {
    let slope = row_slope(rows, height, row);
    let depth_max = rows.depth_min + rows.depth_span;
    let side = sqrt(1.0 + slope * slope);
    let fastest = vec2<f32>(side, clamp(0.0, rows.depth_min, depth_max));
    let slowest = vec2<f32>(side, select(rows.depth_min, depth_max, abs(depth_max) > abs(rows.depth_min)));
    let middle = normalize(fastest) + normalize(slowest);
    let parallel = sqrt(1.0 + rows.tilt * rows.tilt);
    return select(parallel, side * length(middle) / middle.x, rows.projection == PERSPECTIVE);
}

/// Integral of transmittance over `metres` from where it is 1, metres: the weight of that stretch of a ray. `extinction`
/// in 1/m; 0 gives `metres`, the weight of a plain mean. Relative error below 1e-6.
fn stretch_weight(extinction: f32, metres: f32) -> f32 {
    let depth = extinction * metres;
    return select(one_minus_exp(depth) / max(extinction, 1e-30), metres * (1.0 - 0.5 * depth), depth < 1e-4);
}

// ---- airlight::scattering::column_weights ----
// summary: Callback: what the columns of a row weigh in the means over it, and the light's fall-off on them.
// source: thesis 4.3.2, Eq. 4.8 and 4.12; 4.4.2.

@group(0) @binding(8) var<uniform> rows: ProjectiveRows;

/// A column of a row, from which one steps to the next.
struct WeightedColumn {
    /// Its row.
    row: u32,
    /// Its number.
    column: u32,
    /// Its weight, not negative: of slices in units of that of the first column; of projective rows in metres, times the
    /// transmittance from the first column on.
    weight: f32,
    /// Transmittance at its left edge from the first column on; of projective rows only.
    through: f32,
    /// Its length on the reference ray, metres; of projective rows only.
    metres: f32,
    /// X of its right edge, metres; of projective rows only.
    edge: f32,
    /// Metres along the reference ray for one of X; of slices, transmittance from a column to the next; around a light
    /// the metres from it to the eye.
    factor: f32,
    /// The slice's texel.
    slice: vec4<f32>,
}

/// Extinction that weighs, 1/m.
fn weighing_extinction() -> f32 {
    return 0.0;
}

/// The column `column` of a row of a map of `size` texels, weighed from the column `first` of it on.
fn weighted_column(row: u32, size: vec2<u32>, first: u32, column: u32) -> WeightedColumn {
    let width = f32(size.x);
    let reach = reference_reach(rows, f32(size.y), f32(row));
    let begin = texel_begin(rows, width, column);
    let end = texel_end(rows, width, column);
    let before = (begin - texel_begin(rows, width, first)) * reach;
    let through = exp(-weighing_extinction() * before);
    let metres = (end - begin) * reach;
    let weight = through * stretch_weight(weighing_extinction(), metres);
    return WeightedColumn(row, column, weight, through, metres, end, reach, vec4<f32>(0.0));
}

/// The column after `current`.
fn next_column(current: WeightedColumn, size: vec2<u32>) -> WeightedColumn {
    var next = current;
    next.column += 1u;
    next.edge = texel_end(rows, f32(size.x), next.column);
    next.through = current.through * exp(-weighing_extinction() * current.metres);
    next.metres = (next.edge - current.edge) * current.factor;
    next.weight = next.through * stretch_weight(weighing_extinction(), next.metres);
    return next;
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

// ---- airlight::scattering::visibility_rank_weights ----
// summary: Mean of visibility times fall-off of a view ray over columns that have weights of their own, by one rank query.
// source: none; a rank structure over a permutation whose points have weights: docs/src/rank.md explains it.

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

// ---- scattering/rank_weights ----

@group(0) @binding(3) var rank_cells: texture_storage_2d<rg32uint, write>;
@group(0) @binding(11) var rank_weights: texture_storage_2d_array<rgba32uint, write>;

/// Threads of the workgroup of a row.
const GROUP_THREADS: u32 = 64u;
/// Bits of a weight, and layers of their planes.
const WEIGHT_BITS: u32 = u32(16);
const LAYERS: u32 = WEIGHT_BITS / 4u;
const COLORS_ASKED: u32 = 0u;
const COLOR_COUNT: u32 = 1u;
const CHANNELS: u32 = 1u;
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
        column_weights[i] = weight;
        sums.x += weight;
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
    }
    return base;
}
