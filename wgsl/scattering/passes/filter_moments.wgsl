// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Turns the rectified map into six moments and filters them along its rows by a weighted running mean.
// source: Peters et al., "Improved moment shadow maps" (JCGT 6(1), 2017); weights as in thesis 4.3.3, Eq. 4.8 and 4.9.
// note: One workgroup takes one row, each thread a stretch of it: the threads' sums are scanned, then every thread goes
// note: over its stretch again and writes. Sums of blocks of BLOCK texels keep f32 below the 21 bits of the storage.
// note: Texel i holds the mean over the texels 0 .. i. Depths outside 0..1 are clamped, non-finite ones count as unblocked.
// note: With COLORS each column enters the moments of a colour times its fall-off, and a layer more holds the mean fall-off.
// definition AVERAGE: plain means (average visibility) instead of means weighted by transmittance.
// definition LOCAL: rows around a spot or point light.
// definition PROJECTIVE: projective rows, whose texels differ in length, instead of epipolar slices. Not with LOCAL or COLORS.
// definition COLORS: 1 for the fall-off of a spot, 3 with LIGHT_TEXTURE; that many sets of moments, and one layer more.
// definition LIGHT_TEXTURE: a texture colours the light; with COLORS=3.
// binding medium: the medium; absent with AVERAGE.
// binding slices: bounds of the slices, rgba32float; absent with PROJECTIVE, and with AVERAGE unless with COLORS.
// binding rows: the projective rows; with PROJECTIVE only.
// binding rectified: the rectified map, depth 0..1.
// binding moments: out, six moments of 21 bits a texel, see scattering/visibility_moments. With COLORS an array: a layer of moments for each colour, and one of the mean fall-off of each, 0..1, in bits of f32.
// binding light: the light; with LOCAL or COLORS only.
// binding frame: the frame of the slices; with LOCAL or COLORS only.
// binding light_texture: linear RGB 0..1 over the whole shadow map, any float format that filters; with LIGHT_TEXTURE only.
// binding light_sampler: linear, clamped to the edge; with LIGHT_TEXTURE only.

#import airlight::core::finite::finite_or
#import airlight::core::moment_bounds::Moments
#import airlight::scattering::column_weights::{WeightedColumn, weighted_column, next_column, falloff_of_column}
#import airlight::scattering::visibility_moments::{moments_from_depth, pack_moments}

@group(#{GROUP}) @binding(2) var rectified: texture_2d<f32>;
#ifdef COLORS
@group(#{GROUP}) @binding(3) var moments: texture_storage_2d_array<rgba32uint, write>;
const SETS: u32 = u32(#{COLORS});
#else
@group(#{GROUP}) @binding(3) var moments: texture_storage_2d<rgba32uint, write>;
const SETS: u32 = 1u;
#endif

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
#ifdef COLORS
    /// Weights without fall-off.
    weight: f32,
#endif
}

var<workgroup> sums: array<RowSum, THREADS>;

/// `a` and `b` together.
fn add_sums(a: RowSum, b: RowSum) -> RowSum {
    var both = a;
    for (var color = 0u; color < SETS; color++) {
        both.sets[color].low += b.sets[color].low;
        both.sets[color].high += b.sets[color].high;
    }
#ifdef COLORS
    both.weight += b.weight;
#endif
    return both;
}

/// Moments of the texel of a column times its weight. `width`: of the row, texels.
fn weighted_moments(at: WeightedColumn, width: u32) -> RowSum {
    let depth = clamp(finite_or(textureLoad(rectified, vec2<u32>(at.column, at.row), 0).x, 1.0), 0.0, 1.0);
    let own = moments_from_depth(depth);
    let weight = clamp(finite_or(at.weight, 0.0), 0.0, GREATEST_WEIGHT);
    var sum = RowSum();
#ifdef COLORS
    let falloff = falloff_of_column(at.row, (f32(at.column) + 0.5) / f32(width));
    for (var color = 0u; color < SETS; color++) {
        let part = weight * clamp(falloff[color], 0.0, 1.0);
        sum.sets[color] = MomentSum(part * vec4<f32>(own.low, 1.0), part * own.high);
    }
    sum.weight = weight;
#else
    sum.sets[0] = MomentSum(weight * vec4<f32>(own.low, 1.0), weight * own.high);
#endif
    return sum;
}

/// Writes the means that `sum` stands for.
fn write_means(sum: RowSum, column: u32, row: u32) {
#ifdef COLORS
    var falloff = vec4<f32>(1.0);
    for (var color = 0u; color < SETS; color++) {
        let own = sum.sets[color];
        let scale = 1.0 / max(own.low.w, LEAST_WEIGHT);
        let packed = pack_moments(Moments(scale * own.low.xyz, scale * own.high));
        textureStore(moments, vec2<u32>(column, row), color, packed);
        falloff[color] = clamp(own.low.w / max(sum.weight, LEAST_WEIGHT), 0.0, 1.0);
    }
    textureStore(moments, vec2<u32>(column, row), SETS, bitcast<vec4<u32>>(falloff));
#else
    let own = sum.sets[0];
    let scale = 1.0 / max(own.low.w, LEAST_WEIGHT);
    textureStore(moments, vec2<u32>(column, row), pack_moments(Moments(scale * own.low.xyz, scale * own.high)));
#endif
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
