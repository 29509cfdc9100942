// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
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
// definition REGIONS: regions of equal width that a row is filtered in, each by itself and by a thread of its own.
// definition DIRECT: sines and cosines of every basis instead of the recurrence by rotation.
// definition AVERAGE: plain means (average visibility) instead of means weighted by transmittance.
// definition LOCAL: rows around a spot or point light. Not with REGIONS, unless with AVERAGE.
// definition PROJECTIVE: projective rows, whose texels differ in length, instead of epipolar slices. Not with LOCAL or COLORS.
// definition COLORS: 1 for the fall-off of a spot, 3 with LIGHT_TEXTURE; that many times M bases, and one layer more.
// definition LIGHT_TEXTURE: a texture colours the light; with COLORS=3.
// definition RGBA16FLOAT: store as rgba16float instead of rgba8unorm.
// binding medium: the medium; absent with AVERAGE.
// binding slices: bounds of the slices, rgba32float; absent with PROJECTIVE, and with AVERAGE unless with COLORS.
// binding rows: the projective rows; with PROJECTIVE only.
// binding rectified: the rectified map, depth 0..1.
// binding bases: out, M/4 layers of the filtered bases; -1..1 is stored as 0..1. With COLORS the layers of each colour, and a layer of the mean fall-off, 0..1.
// binding light: the light; with LOCAL or COLORS only.
// binding frame: the frame of the slices; with LOCAL or COLORS only.
// binding light_texture: linear RGB 0..1 over the whole shadow map, any float format that filters; with LIGHT_TEXTURE only.
// binding light_sampler: linear, clamped to the edge; with LIGHT_TEXTURE only.

#import airlight::core::finite::finite_or
#import airlight::core::fourier_basis::{series_at, series_next, stored_from_basis, surface_bias}
#import airlight::core::prefix_sum::{RowWeights, running_mean}
#import airlight::scattering::column_weights::{weighted_column, next_column, falloff_of_column}
#import airlight::scattering::rows::region_begin

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
#ifdef COLORS
const COLOR_COUNT: u32 = u32(#{COLORS});
#else
const COLOR_COUNT: u32 = 1u;
#endif

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
#ifdef COLORS
    var mean_falloff = vec4<f32>(0.0);
#endif
    let end = region_begin(id.z + 1u, size.x, ROW_REGIONS);
    for (var column = begin; column < end; column++) {
        total += at_column.weight;
        let weights = RowWeights(at_column.weight, total, 1.0);
        let depth = clamp(finite_or(textureLoad(rectified, vec2<u32>(column, row), 0).x, 1.0), 0.0, 1.0);
        let blocker = min(depth + surface_bias(4u * LAYERS), 1.0);
#ifdef COLORS
        let falloff = falloff_of_column(row, (f32(column) + 0.5) / f32(size.x));
        mean_falloff = running_mean(mean_falloff, vec4<f32>(falloff, 1.0), weights);
        if first == 0u {
            textureStore(bases, vec2<u32>(column, row), COLOR_COUNT * LAYERS, mean_falloff);
        }
#endif
        var series = series_at(blocker, first);
        for (var group = 0u; group < PER_THREAD; group++) {
#ifdef COLORS
            for (var color = 0u; color < COLOR_COUNT; color++) {
                let at = group * COLOR_COUNT + color;
                means[at] = running_mean(means[at], series.basis * falloff[color], weights);
                if first + group < LAYERS {
                    let layer = color * LAYERS + first + group;
                    textureStore(bases, vec2<u32>(column, row), layer, stored_from_basis(means[at]));
                }
            }
#else
            means[group] = running_mean(means[group], series.basis, weights);
            if first + group < LAYERS {
                textureStore(bases, vec2<u32>(column, row), first + group, stored_from_basis(means[group]));
            }
#endif
#ifdef DIRECT
            series = series_at(blocker, first + group + 1u);
#else
            series = series_next(series);
#endif
        }
        at_column = next_column(at_column, size);
    }
}
