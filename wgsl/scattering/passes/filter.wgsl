// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Turns the rectified map into Fourier bases and filters them along its rows by a weighted running mean.
// source: thesis 4.3.1 to 4.3.3, Eq. 4.6 to 4.9, Listings 4.1 to 4.3.
// note: One thread takes one row and BASES_PER_THREAD bases, four of them a vector.
// note: Blockers are moved away from the light by about half the width of the series' edge (surface_bias), which
// note: the thesis does not do: otherwise lit surfaces shade the ends of their own rays.
// note: Depths outside 0..1 are clamped, non-finite ones count as unblocked.
// definition BASES: number M of bases, a multiple of 4 from 4 to 128.
// definition BASES_PER_THREAD: bases a thread filters, a multiple of 4.
// definition REGIONS: regions of equal width that a row is filtered in, each by itself and by a thread of its own.
// definition DIRECT: sines and cosines of every basis instead of the recurrence by rotation.
// definition AVERAGE: plain means (average visibility) instead of means weighted by transmittance.
// definition RGBA16FLOAT: store as rgba16float instead of rgba8unorm.
// binding medium: the medium, for its extinction; absent with AVERAGE.
// binding slices: bounds of the slices, rgba32float; absent with AVERAGE.
// binding rectified: the rectified map, depth 0..1.
// binding bases: out, M/4 layers of the filtered bases; -1..1 is stored as 0..1.

#import airlight::core::finite::finite_or
#import airlight::core::fourier_basis::{series_at, series_next, stored_from_basis, surface_bias}
#import airlight::core::prefix_sum::{row_weights, row_weights_next, running_mean}
#import airlight::scattering::rectify::slice_from_texel
#import airlight::scattering::rows::region_begin
#import airlight::scattering::single_scatter::Medium

#ifndef AVERAGE
@group(#{GROUP}) @binding(0) var<uniform> medium: Medium;
@group(#{GROUP}) @binding(1) var slices: texture_2d<f32>;
#endif
@group(#{GROUP}) @binding(2) var rectified: texture_2d<f32>;
#ifdef RGBA16FLOAT
@group(#{GROUP}) @binding(3) var bases: texture_storage_2d_array<rgba16float, write>;
#else
@group(#{GROUP}) @binding(3) var bases: texture_storage_2d_array<rgba8unorm, write>;
#endif

const LAYERS: u32 = u32(#{BASES}) / 4u;
#ifdef REGIONS
const ROW_REGIONS: u32 = u32(#{REGIONS});
#else
const ROW_REGIONS: u32 = 1u;
#endif
const PER_THREAD: u32 = u32(#{BASES_PER_THREAD}) / 4u;

@compute @workgroup_size(32)
fn filter_rows(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = textureDimensions(rectified);
    let row = id.x;
    let first = id.y * PER_THREAD;
    if row >= min(size.y, textureDimensions(bases).y) || first >= LAYERS || id.z >= ROW_REGIONS {
        return;
    }
#ifdef AVERAGE
    var weights = row_weights(0.0);
#else
    let slice = slice_from_texel(textureLoad(slices, vec2<u32>(row, 0u), 0));
    var weights = row_weights(medium.extinction * slice.radius_max / (f32(size.x) * slice.reference));
#endif
    var means = array<vec4<f32>, PER_THREAD>();
    let end = region_begin(id.z + 1u, size.x, ROW_REGIONS);
    for (var column = region_begin(id.z, size.x, ROW_REGIONS); column < end; column++) {
        let depth = clamp(finite_or(textureLoad(rectified, vec2<u32>(column, row), 0).x, 1.0), 0.0, 1.0);
        let blocker = min(depth + surface_bias(4u * LAYERS), 1.0);
        var series = series_at(blocker, first);
        for (var group = 0u; group < PER_THREAD; group++) {
            means[group] = running_mean(means[group], series.basis, weights);
            if first + group < LAYERS {
                textureStore(bases, vec2<u32>(column, row), first + group, stored_from_basis(means[group]));
            }
#ifdef DIRECT
            series = series_at(blocker, first + group + 1u);
#else
            series = series_next(series);
#endif
        }
        weights = row_weights_next(weights);
    }
}
