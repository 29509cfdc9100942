// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: scattering/filter, permutation projective (BASES=32 BASES_PER_THREAD=8 PROJECTIVE)
// summary: Turns the rectified map into Fourier bases and filters them along its rows by a weighted running mean.
// source: thesis 4.3.1 to 4.3.3, Eq. 4.6 to 4.9, Listings 4.1 to 4.3.
// note: One thread takes one row and BASES_PER_THREAD bases, four of them a vector.
// note: Blockers are moved away from the light by about half the width of the series' edge (surface_bias), which
// note: the thesis does not do: otherwise lit surfaces shade the ends of their own rays.
// note: Depths outside 0..1 are clamped, non-finite ones count as unblocked.
// note: A light's angular fall-off and texture belong to its light rays, that is to columns: with COLORS each column
// note: enters the means times its fall-off, and so does the constant 1/2 of the series, whose mean is one layer more.
// definition BASES: number M of bases, a multiple of 4 from 4 to 128.
// definition BASES_PER_THREAD: bases a thread filters, a multiple of 4.
// definition PROJECTIVE: projective rows, whose texels differ in length, instead of epipolar slices. Not with LOCAL or COLORS.
// binding medium: the medium; absent with AVERAGE.
// binding rows: the projective rows; with PROJECTIVE only.
// binding rectified: the rectified map, depth 0..1.
// binding bases: out, M/4 layers of the filtered bases; -1..1 is stored as 0..1. With COLORS the layers of each colour, and a layer of the mean fall-off, 0..1.

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

// ---- airlight::core::fourier_basis ----
// summary: Visibility as a Fourier series of the depth difference, four bases at a time.
// source: thesis 4.3.1, Eq. 4.7, after Annen et al., "Convolution shadow maps" (2007).

const PI: f32 = 3.141592653589793;

/// Part of the depth range at either end that is kept free of view rays.
const GUARD: f32 = 0.05;

/// What is added to the depth of a blocker before its bases are taken, up to 1: about half the width
/// of the softened edge. Without it a lit surface shades the end of every ray that meets it, because
/// the series is 1/2, not 1, at the depth of the blocker itself. `bases`: M.
fn surface_bias(bases: u32) -> f32 {
    return min(0.6 / f32(bases), 0.8 * GUARD);
}

/// Four bases and the rotation that leads to the next four.
struct Series {
    /// sin, cos of the first frequency, sin, cos of the second.
    basis: vec4<f32>,
    /// sin and cos of 4 pi z, the angle from one group to the next.
    turn: vec2<f32>,
}

/// (sin, cos) of pi times `half_turns`, exact reduction for large arguments.
fn sine_cosine(half_turns: f32) -> vec2<f32> {
    let angle = PI * (half_turns - 2.0 * round(0.5 * half_turns));
    return vec2<f32>(sin(angle), cos(angle));
}

/// (sin, cos) of the sum of two angles given by (sin, cos).
fn rotate(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    return vec2<f32>(a.x * b.y + a.y * b.x, a.y * b.y - a.x * b.x);
}

/// The bases of `group` at depth `z`, 0..1, ready to step on.
fn series_at(z: f32, group: u32) -> Series {
    let first = sine_cosine(f32(4u * group + 1u) * z);
    let double = sine_cosine(2.0 * z);
    return Series(vec4<f32>(first, rotate(first, double)), rotate(double, double));
}

/// The next group, by a rotation instead of new sines. The error grows by about 1e-7 a step.
fn series_next(series: Series) -> Series {
    return Series(
        vec4<f32>(rotate(series.basis.xy, series.turn), rotate(series.basis.zw, series.turn)),
        series.turn
    );
}

/// Bases -1..1 to the range 0..1 in which textures store them.
fn stored_from_basis(basis: vec4<f32>) -> vec4<f32> {
    return 0.5 + 0.5 * basis;
}

// ---- airlight::core::prefix_sum ----
// summary: Running weighted mean along a row: the prefix sum that filters basis textures.
// source: thesis 4.3.3, Listings 4.1 and 4.2.

/// Weights of one row: each is `ratio` times the one before it.
struct RowWeights {
    /// Weight of the current texel.
    weight: f32,
    /// Sum of the weights up to and with it.
    total: f32,
    /// From a texel to the next, 0..1.
    ratio: f32,
}

/// `mean` with `value` taken in at the current texel's weight.
fn running_mean(mean: vec4<f32>, value: vec4<f32>, weights: RowWeights) -> vec4<f32> {
    return mean + (value - mean) * (weights.weight / weights.total);
}

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

// ---- airlight::scattering::rows ----
// summary: Where a view ray lies in a rectified map, and how the means of a row's regions are put together.
// source: thesis 4.3.3 (regions), 4.4.2 (near plane).

/// First texel of a region; of the region after the last, the width.
fn region_begin(region: u32, width: u32, regions: u32) -> u32 {
    return (region * width + regions - 1u) / regions;
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

// ---- airlight::scattering::column_weights ----
// summary: Callback: what the columns of a row weigh in the means over it, and the light's fall-off on them.
// source: thesis 4.3.2, Eq. 4.8 and 4.12; 4.4.2.

@group(0) @binding(8) var<uniform> rows: ProjectiveRows;
@group(0) @binding(0) var<uniform> medium: Medium;

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
    return medium.extinction;
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

// ---- scattering/filter ----

@group(0) @binding(2) var rectified: texture_2d<f32>;
@group(0) @binding(3) var bases: texture_storage_2d_array<rgba8unorm, write>;

const LAYERS: u32 = u32(32) / 4u;
const ROW_REGIONS: u32 = 1u;
const PER_THREAD: u32 = u32(8) / 4u;
const COLOR_COUNT: u32 = 1u;

@compute @workgroup_size(32)
fn filter_rows(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = textureDimensions(rectified);
    let row = id.x;
    let first = id.y * PER_THREAD;
    if row >= min(size.y, textureDimensions(bases).y) || first >= LAYERS || id.z >= ROW_REGIONS {
        return;
    }
    let begin = region_begin(id.z, size.x, ROW_REGIONS);
    var at_column = weighted_column(row, size, begin, begin);
    var total = 0.0;
    var means = array<vec4<f32>, PER_THREAD * COLOR_COUNT>();
    let end = region_begin(id.z + 1u, size.x, ROW_REGIONS);
    for (var column = begin; column < end; column++) {
        total += at_column.weight;
        let weights = RowWeights(at_column.weight, total, 1.0);
        let depth = clamp(finite_or(textureLoad(rectified, vec2<u32>(column, row), 0).x, 1.0), 0.0, 1.0);
        let blocker = min(depth + surface_bias(4u * LAYERS), 1.0);
        var series = series_at(blocker, first);
        for (var group = 0u; group < PER_THREAD; group++) {
            means[group] = running_mean(means[group], series.basis, weights);
            if first + group < LAYERS {
                textureStore(bases, vec2<u32>(column, row), first + group, stored_from_basis(means[group]));
            }
            series = series_next(series);
        }
        at_column = next_column(at_column, size);
    }
}
