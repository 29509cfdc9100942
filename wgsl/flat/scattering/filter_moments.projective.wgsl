// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: scattering/filter_moments, permutation projective (PROJECTIVE)
// summary: Turns the rectified map into six moments and filters them along its rows by a weighted running mean.
// source: Peters et al., "Improved moment shadow maps" (JCGT 6(1), 2017); weights as in thesis 4.3.3, Eq. 4.8 and 4.9.
// note: One workgroup takes one row, each thread a stretch of it: the threads' sums are scanned, then every thread goes
// note: over its stretch again and writes. Sums of blocks of BLOCK texels keep f32 below the 21 bits of the storage.
// note: Texel i holds the mean over the texels 0 .. i. Depths outside 0..1 are clamped, non-finite ones count as unblocked.
// note: With COLORS each column enters the moments of a colour times its fall-off, and a layer more holds the mean fall-off.
// definition PROJECTIVE: projective rows, whose texels differ in length, instead of epipolar slices. Not with LOCAL or COLORS.
// binding medium: the medium; absent with AVERAGE.
// binding rows: the projective rows; with PROJECTIVE only.
// binding rectified: the rectified map, depth 0..1.
// binding moments: out, six moments of 21 bits a texel, see scattering/visibility_moments. With COLORS an array: a layer of moments for each colour, and one of the mean fall-off of each, 0..1, in bits of f32.

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

/// Part of the depth range at either end that is kept free of view rays.
const GUARD: f32 = 0.05;

// ---- airlight::core::moment_bounds ----
// summary: Six moments of a distribution on -1..1, and the bounds that they give of its share beyond a place.
// source: Algorithm 1 of Peters et al., "Improved moment shadow maps for translucent occluders, soft shadows and single scattering" (2017).

/// Means of the Chebyshev polynomials T_1 to T_6.
struct Moments {
    /// Of degree 1, 2 and 3, -1..1.
    low: vec3<f32>,
    /// Of degree 4, 5 and 6, -1..1.
    high: vec3<f32>,
}

/// T_1, T_2, T_3 at `z`.
fn chebyshev(z: f32) -> vec3<f32> {
    return vec3<f32>(z, 2.0 * z * z - 1.0, z * (4.0 * z * z - 3.0));
}

/// Moments of a single place `z`, -1..1.
fn moments_at(z: f32) -> Moments {
    let low = chebyshev(z);
    let high = vec3<f32>(2.0 * low.y * low.y, 2.0 * low.y * low.z, 2.0 * low.z * low.z);
    return Moments(low, high - vec3<f32>(1.0, low.x, 1.0));
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

// ---- airlight::scattering::visibility_moments ----
// summary: Mean visibility of a view ray from six filtered moments of the stored depths: bounds of the share beyond it.
// source: Peters et al., "Improved moment shadow maps for translucent occluders, soft shadows and single scattering" (2017).

/// View rays keep this far from the ends of the signed depths, in depth 0..1.
const MARGIN: f32 = 0.01;
/// Steps of a moment's 21 bits.
const STEPS: f32 = 2097151.0;

/// Depth 0..1 to -1..1. Blockers in the guard beyond every view ray are all the same.
fn signed_depth(depth: f32) -> f32 {
    return clamp((depth - 0.5) / (0.5 - GUARD + MARGIN), -1.0, 1.0);
}

/// Moments of a single stored `depth`, 0..1.
fn moments_from_depth(depth: f32) -> Moments {
    return moments_at(signed_depth(depth));
}

/// Moments as one texel of an rgba32uint texture: the first four in the low 21 bits, the last two in what is left.
fn pack_moments(moments: Moments) -> vec4<u32> {
    let low = vec3<u32>(round(clamp(moments.low * 0.5 + 0.5, vec3<f32>(0.0), vec3<f32>(1.0)) * STEPS));
    let high = vec3<u32>(round(clamp(moments.high * 0.5 + 0.5, vec3<f32>(0.0), vec3<f32>(1.0)) * STEPS));
    return vec4<u32>(
        low.x | ((high.y & 0x7ffu) << 21u), low.y | ((high.y >> 11u) << 21u),
        low.z | ((high.z & 0x7ffu) << 21u), high.x | ((high.z >> 11u) << 21u)
    );
}

// ---- scattering/filter_moments ----

@group(0) @binding(2) var rectified: texture_2d<f32>;
@group(0) @binding(3) var moments: texture_storage_2d<rgba32uint, write>;
const SETS: u32 = 1u;

const THREADS: u32 = 64u;
const BLOCK: u32 = 8u;
/// More than any weight may be, so that sums stay finite.
const GREATEST_WEIGHT: f32 = 1e30;
/// Less weight than this counts as none.
const LEAST_WEIGHT: f32 = 1e-35;

/// Sums of weighted moments.
struct MomentSum {
    /// Moments 1 to 3 times weight, and the weights.
    low: vec4<f32>,
    /// Moments 4 to 6 times weight.
    high: vec3<f32>,
}

/// Sums over columns.
struct RowSum {
    /// Moments, each colour weighted by its own fall-off too.
    sets: array<MomentSum, SETS>,
}

var<workgroup> sums: array<RowSum, THREADS>;

/// `a` and `b` together.
fn add_sums(a: RowSum, b: RowSum) -> RowSum {
    var both = a;
    for (var color = 0u; color < SETS; color++) {
        both.sets[color].low += b.sets[color].low;
        both.sets[color].high += b.sets[color].high;
    }
    return both;
}

/// Moments of the texel of a column times its weight. `width`: of the row, texels.
fn weighted_moments(at: WeightedColumn, width: u32) -> RowSum {
    let depth = clamp(finite_or(textureLoad(rectified, vec2<u32>(at.column, at.row), 0).x, 1.0), 0.0, 1.0);
    let own = moments_from_depth(depth);
    let weight = clamp(finite_or(at.weight, 0.0), 0.0, GREATEST_WEIGHT);
    var sum = RowSum();
    sum.sets[0] = MomentSum(weight * vec4<f32>(own.low, 1.0), weight * own.high);
    return sum;
}

/// Writes the means that `sum` stands for.
fn write_means(sum: RowSum, column: u32, row: u32) {
    let own = sum.sets[0];
    let scale = 1.0 / max(own.low.w, LEAST_WEIGHT);
    textureStore(moments, vec2<u32>(column, row), pack_moments(Moments(scale * own.low.xyz, scale * own.high)));
}

@compute @workgroup_size(THREADS)
fn filter_moments(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let size = textureDimensions(rectified);
    let row = group.y;
    if row >= min(size.y, textureDimensions(moments).y) {
        return;
    }
    let length = (size.x + THREADS - 1u) / THREADS;
    let begin = min(thread * length, size.x);
    let end = min(begin + length, size.x);

    var total = RowSum();
    for (var first = begin; first < end; first += BLOCK) {
        var block = RowSum();
        var at = weighted_column(row, size, 0u, first);
        for (var column = first; column < min(first + BLOCK, end); column++) {
            block = add_sums(block, weighted_moments(at, size.x));
            at = next_column(at, size);
        }
        total = add_sums(total, block);
    }
    sums[thread] = total;
    for (var distance = 1u; distance < THREADS; distance *= 2u) {
        workgroupBarrier();
        var before = RowSum();
        if thread >= distance {
            before = sums[thread - distance];
        }
        workgroupBarrier();
        total = add_sums(before, total);
        sums[thread] = total;
    }
    workgroupBarrier();
    var before = RowSum();
    if thread > 0u {
        before = sums[thread - 1u];
    }

    for (var first = begin; first < end; first += BLOCK) {
        var block = RowSum();
        var at = weighted_column(row, size, 0u, first);
        for (var column = first; column < min(first + BLOCK, end); column++) {
            block = add_sums(block, weighted_moments(at, size.x));
            write_means(add_sums(before, block), column, row);
            at = next_column(at, size);
        }
        before = add_sums(before, block);
    }
}
