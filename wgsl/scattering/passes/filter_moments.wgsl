// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Turns the rectified map into six moments and filters them along its rows by a weighted running mean.
// source: Peters et al., "Improved moment shadow maps" (JCGT 6(1), 2017); weights as in thesis 4.3.3, Eq. 4.8 and 4.9.
// note: One workgroup takes one row, each thread a stretch of it: the threads' sums are scanned, then every thread goes
// note: over its stretch again and writes. Sums of blocks of BLOCK texels keep f32 below the 21 bits of the storage.
// note: Texel i holds the mean over the texels 0 .. i. Depths outside 0..1 are clamped, non-finite ones count as unblocked.
// definition AVERAGE: plain means (average visibility) instead of means weighted by transmittance.
// binding medium: the medium; absent with AVERAGE.
// binding slices: bounds of the slices, rgba32float; absent with AVERAGE.
// binding rectified: the rectified map, depth 0..1.
// binding moments: out, six moments of 21 bits a texel, see scattering/visibility_moments.

#import airlight::core::finite::finite_or
#import airlight::scattering::visibility_moments::{moments_from_depth, pack_moments, Moments}
#ifndef AVERAGE
#import airlight::scattering::rectify::slice_from_texel
#import airlight::scattering::single_scatter::Medium

@group(#{GROUP}) @binding(0) var<uniform> medium: Medium;
@group(#{GROUP}) @binding(1) var slices: texture_2d<f32>;
#endif
@group(#{GROUP}) @binding(2) var rectified: texture_2d<f32>;
@group(#{GROUP}) @binding(3) var moments: texture_storage_2d<rgba32uint, write>;

const THREADS: u32 = 64u;
const BLOCK: u32 = 8u;

/// Sums of weighted moments.
struct MomentSum {
    /// Moments 1 to 3 times weight, and the weights.
    low: vec4<f32>,
    /// Moments 4 to 6 times weight.
    high: vec3<f32>,
}

var<workgroup> sums: array<MomentSum, THREADS>;

/// `a` and `b` together.
fn add_sums(a: MomentSum, b: MomentSum) -> MomentSum {
    return MomentSum(a.low + b.low, a.high + b.high);
}

/// Moments of the texel at `column` of `row` times its weight. `optical_step`: optical depth of one texel of the row.
fn weighted_moments(column: u32, row: u32, optical_step: f32) -> MomentSum {
    let depth = clamp(finite_or(textureLoad(rectified, vec2<u32>(column, row), 0).x, 1.0), 0.0, 1.0);
    let own = moments_from_depth(depth);
#ifdef AVERAGE
    let weight = 1.0;
#else
    let weight = exp(-optical_step * f32(column));
#endif
    return MomentSum(weight * vec4<f32>(own.low, 1.0), weight * own.high);
}

@compute @workgroup_size(THREADS)
fn filter_moments(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let size = textureDimensions(rectified);
    let row = group.y;
    if row >= min(size.y, textureDimensions(moments).y) {
        return;
    }
#ifdef AVERAGE
    let optical_step = 0.0;
#else
    let slice = slice_from_texel(textureLoad(slices, vec2<u32>(row, 0u), 0));
    let optical_step = max(medium.extinction * slice.radius_max / (f32(size.x) * slice.reference), 0.0);
#endif
    let length = (size.x + THREADS - 1u) / THREADS;
    let begin = min(thread * length, size.x);
    let end = min(begin + length, size.x);

    var total = MomentSum();
    for (var first = begin; first < end; first += BLOCK) {
        var block = MomentSum();
        for (var column = first; column < min(first + BLOCK, end); column++) {
            block = add_sums(block, weighted_moments(column, row, optical_step));
        }
        total = add_sums(total, block);
    }
    sums[thread] = total;
    for (var distance = 1u; distance < THREADS; distance *= 2u) {
        workgroupBarrier();
        var before = MomentSum();
        if thread >= distance {
            before = sums[thread - distance];
        }
        workgroupBarrier();
        total = add_sums(before, total);
        sums[thread] = total;
    }
    workgroupBarrier();
    var before = MomentSum();
    if thread > 0u {
        before = sums[thread - 1u];
    }

    for (var first = begin; first < end; first += BLOCK) {
        var block = MomentSum();
        for (var column = first; column < min(first + BLOCK, end); column++) {
            block = add_sums(block, weighted_moments(column, row, optical_step));
            let sum = add_sums(before, block);
            // The first weight is 1.
            let scale = 1.0 / max(sum.low.w, 1.0);
            let packed = pack_moments(Moments(scale * sum.low.xyz, scale * sum.high));
            textureStore(moments, vec2<u32>(column, row), packed);
        }
        before = add_sums(before, block);
    }
}
