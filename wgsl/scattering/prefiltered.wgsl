// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::scattering::prefiltered
// summary: Callback: mean visibility of a stretch of a row, by whichever method the pass was built for.
// source: thesis 4.3.1 and 4.3.3, Eq. 4.6 and 4.9, Listing 4.4; visibility_rank and visibility_moments for the others.
// note: Unlike algorithm modules a callback holds bindings, those that passes share. All methods answer the same question:
// note: which share of the first texels of a row is lit at the depth of a ray.
// equation: none of its own: the mean over the first texels of a row by the method that was built, rows mixed by their share
// error: by the method: see visibility_fourier, visibility_moments, visibility_rank and visibility_wavelet;
// error: test scattering/rank/pictures::pictures_mix_the_rows_about_a_ray_around_the_seam_too.
// parameter row: of the map, whole.
// parameter depth: of the ray, 0..1.
// parameter color: 0..2.
// definition RANK: rank queries, bits of a depth as in the pass `rank`; Fourier bases without RANK and MOMENTS.
// definition WAVELET: by a wavelet matrix, as of the pass `wavelet`; with RANK, an even number, and AVERAGE.
// definition MOMENTS: six moments.
// definition AVERAGE: what was stored holds plain means.
// definition BASES: number M of Fourier bases, as in the filter.
// definition WEIGHT_BITS: bits of a weight, as in the pass `rank_weights`; with RANK, where columns have weights of their own.
// definition COLORS: colours of the light, as in the filter; Fourier bases, MOMENTS, or RANK and WEIGHT_BITS.
// definition LIGHT_TEXTURE: a texture colours the light; with COLORS=3.
// definition LANCZOS: window the coefficients against ringing; for M of 8 and more.
// definition NEAREST: the nearest row, and the nearest texel of what was stored, instead of a bilinear blend; no sampler.
// binding wavelet: what `wavelet` makes, rgba32uint; with WAVELET only.
// binding rank_cells: what `rank` makes, rg32uint, or `rank_weights`, with LIGHT_TEXTURE rgba32uint; with RANK only, without WAVELET; so the next two.
// binding rank_starts: the same, r32uint.
// binding rank_planes: the same, rgba32uint.
// binding rank_weights: what `rank_weights` makes, rgba32uint; with RANK and WEIGHT_BITS only.
// binding rectified: the rectified map, of which only the size is read; with RANK only.
// binding moments: what `filter_moments` makes, rgba32uint, with COLORS an array; with MOMENTS only.
// binding bases: what `filter` makes, rgba8unorm or rgba16float; without RANK and MOMENTS.
// binding bases_sampler: linear; clamp to edge in u, repeat in v; with Fourier bases, absent with NEAREST.

#import airlight::scattering::rows::prefix_column
#import airlight::scattering::visibility_fourier::{
    fourier_visibility, fourier_visibility_nearest, fourier_colors, fourier_colors_nearest
}
#import airlight::scattering::visibility_moments::{
    moments_visibility, moments_visibility_nearest, moments_color, moments_color_nearest
}
#import airlight::scattering::visibility_rank::{rank_visibility, rank_visibility_weighted}
#import airlight::scattering::visibility_rank_weights::rank_means
#import airlight::scattering::visibility_wavelet::wavelet_visibility

#ifdef RANK
#ifdef WAVELET
@group(#{GROUP}) @binding(7) var wavelet: texture_2d<u32>;
#else
@group(#{GROUP}) @binding(7) var rank_cells: texture_2d<u32>;
@group(#{GROUP}) @binding(8) var rank_starts: texture_2d<u32>;
@group(#{GROUP}) @binding(13) var rank_planes: texture_2d_array<u32>;
#endif
@group(#{GROUP}) @binding(14) var rectified: texture_2d<f32>;
const RANK_BITS: u32 = u32(#{RANK});
#ifdef WEIGHT_BITS
@group(#{GROUP}) @binding(15) var rank_weights: texture_2d_array<u32>;
const BITS_OF_WEIGHTS: u32 = u32(#{WEIGHT_BITS});
#ifdef COLORS
const RANK_COLORS: u32 = u32(#{COLORS});
#else
const RANK_COLORS: u32 = 0u;
#endif
#endif
#else ifdef MOMENTS
#ifdef COLORS
@group(#{GROUP}) @binding(7) var moments: texture_2d_array<u32>;
const MOMENT_COLORS: u32 = u32(#{COLORS});
#else
@group(#{GROUP}) @binding(7) var moments: texture_2d<u32>;
#endif
#else
@group(#{GROUP}) @binding(7) var bases: texture_2d_array<f32>;
#ifndef NEAREST
@group(#{GROUP}) @binding(8) var bases_sampler: sampler;
#endif
#ifdef BASES
const LAYERS: u32 = u32(#{BASES}) / 4u;
#else
const LAYERS: u32 = 8u;
#endif
#ifdef LANCZOS
const WINDOWED: bool = true;
#else
const WINDOWED: bool = false;
#endif
#endif

/// The stretch of a row from the texel at which a region begins.
struct Prefix {
    /// Row, fractional; row j is at the value j.
    row: f32,
    /// 1 where the row after the last is the first, else 0.
    wraps: f32,
    /// First texel of the region.
    first: f32,
    /// Where the stretch ends, texels from the start of the row, fractional.
    texels: f32,
    /// Optical depth of a texel of the ray; 0 for plain means.
    optical_step: f32,
    /// By which what was stored is weighted: that of the reference ray, with RANK the least of the row.
    stored_step: f32,
}

/// Columns and rows of the rectified map.
fn map_size() -> vec2<u32> {
#ifdef RANK
    return textureDimensions(rectified);
#else ifdef MOMENTS
    return textureDimensions(moments);
#else
    return textureDimensions(bases).xy;
#endif
}

/// The row nearest to that of a stretch, always inside the map.
fn prefix_row(at: Prefix) -> u32 {
    let rows = map_size().y;
    let nearest = u32(max(at.row, 0.0) + 0.5);
    // Half a row beyond the last is the first, where rows wrap.
    return select(min(nearest, rows - 1u), 0u, nearest >= rows && at.wraps > 0.0);
}

#ifdef RANK
/// What the stretch in a whole `row` gives, 0..1: the mean visibility, or with COLORS that times fall-off, for each colour.
fn row_means(at: Prefix, row: u32, depth: f32) -> vec3<f32> {
    let columns = map_size().x;
#ifdef WAVELET
    return vec3<f32>(wavelet_visibility(wavelet, RANK_BITS, columns, row, at.texels, depth));
#else ifdef WEIGHT_BITS
    return rank_means(
        rank_cells, rank_starts, rank_planes, rank_weights, RANK_BITS, BITS_OF_WEIGHTS, RANK_COLORS, columns, row,
        at.texels, depth
    );
#else ifdef AVERAGE
    return vec3<f32>(
        rank_visibility(rank_cells, rank_starts, rank_planes, RANK_BITS, columns, row, at.texels, depth)
    );
#else
    return vec3<f32>(rank_visibility_weighted(
        rank_cells, rank_starts, rank_planes, RANK_BITS, columns, row, at.texels, depth, at.optical_step,
        at.stored_step
    ));
#endif
}

/// The means of the nearest row, or of the two about the stretch.
fn mixed_means(at: Prefix, depth: f32) -> vec3<f32> {
#ifdef NEAREST
    return row_means(at, prefix_row(at), depth);
#else
    let rows = map_size().y;
    let whole = min(u32(max(at.row, 0.0)), rows - 1u);
    let next = select(min(whole + 1u, rows - 1u), 0u, whole + 1u >= rows && at.wraps > 0.0);
    let share = clamp(at.row - f32(whole), 0.0, 1.0);
    return mix(row_means(at, whole, depth), row_means(at, next, depth), share);
#endif
}

#ifdef COLORS
/// Mean of visibility times fall-off of a stretch at the depth of a ray, for each colour.
fn prefix_colors(at: Prefix, depth: f32) -> vec3<f32> {
    return mixed_means(at, depth);
}
#else
/// Mean visibility of a stretch at the depth of a ray, 0..1.
fn prefix_visibility(at: Prefix, depth: f32) -> f32 {
    return mixed_means(at, depth).x;
}
#endif
#else ifdef MOMENTS
#ifdef COLORS
/// Mean of visibility times fall-off of a stretch at the depth of a ray, for one colour.
fn prefix_color(at: Prefix, color: u32, depth: f32) -> f32 {
    let column = prefix_column(at.texels, at.first);
#ifdef NEAREST
    let place = min(vec2<u32>(u32(column), prefix_row(at)), map_size() - 1u);
    return moments_color_nearest(moments, place, color, MOMENT_COLORS, depth);
#else
    return moments_color(moments, vec2<f32>(column, at.row), at.wraps > 0.0, color, MOMENT_COLORS, depth);
#endif
}

/// Mean of visibility times fall-off of a stretch at the depth of a ray, for each colour.
fn prefix_colors(at: Prefix, depth: f32) -> vec3<f32> {
#ifdef LIGHT_TEXTURE
    return vec3<f32>(prefix_color(at, 0u, depth), prefix_color(at, 1u, depth), prefix_color(at, 2u, depth));
#else
    return vec3<f32>(prefix_color(at, 0u, depth));
#endif
}
#else
/// Mean visibility of a stretch at the depth of a ray, 0..1.
fn prefix_visibility(at: Prefix, depth: f32) -> f32 {
    let column = prefix_column(at.texels, at.first);
#ifdef NEAREST
    let place = min(vec2<u32>(u32(column), prefix_row(at)), map_size() - 1u);
    return moments_visibility_nearest(moments, place, depth);
#else
    return moments_visibility(moments, vec2<f32>(column, at.row), at.wraps > 0.0, depth);
#endif
}
#endif
#else
/// Mean visibility of a stretch at the depth of a ray; not clamped: the series overshoots.
fn prefix_visibility(at: Prefix, depth: f32) -> f32 {
    let column = prefix_column(at.texels, at.first);
#ifdef NEAREST
    let place = min(vec2<u32>(u32(column), prefix_row(at)), map_size() - 1u);
    return fourier_visibility_nearest(bases, place, depth, LAYERS, WINDOWED);
#else
    let place = vec2<f32>(column, at.row + 0.5) / vec2<f32>(map_size());
    return fourier_visibility(bases, bases_sampler, place, depth, LAYERS, WINDOWED);
#endif
}

#ifdef COLORS
/// Mean of visibility times fall-off of a stretch at the depth of a ray, for each colour.
fn prefix_colors(at: Prefix, depth: f32) -> vec3<f32> {
    let column = prefix_column(at.texels, at.first);
#ifdef NEAREST
    let place = min(vec2<u32>(u32(column), prefix_row(at)), map_size() - 1u);
    return fourier_colors_nearest(bases, place, depth, LAYERS, u32(#{COLORS}), WINDOWED);
#else
    let place = vec2<f32>(column, at.row + 0.5) / vec2<f32>(map_size());
    return fourier_colors(bases, bases_sampler, place, depth, LAYERS, u32(#{COLORS}), WINDOWED);
#endif
}
#endif
#endif
