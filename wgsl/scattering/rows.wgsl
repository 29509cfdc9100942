// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::scattering::rows
// summary: Where a view ray lies in a rectified map, and how the means of a row's regions are put together.
// source: thesis 4.3.3 (regions), 4.4.2 (near plane).
// note: A row may be filtered in several regions of equal width, each by itself. The mean over a stretch of the row is
// note: then the sum of whole regions, plus the part of the last region, minus the part of the first.
// note: Subtracting amplifies what the bases are stored with: 8 bits of a mean over 1024 texels are 0.013 of a mean over
// note: its last 64. Short stretches are widened to LEAST_STRETCH texels towards the eye.
// equation: region r of n begins at ⌈r width / n⌉;  a ray of s texels is read at s − ½
// error: pictures with regions within 5e-4 of those without; test scattering/projective/pictures::regions_and_near_planes_keep_the_figures.
// parameter begin, end: texels before the ray begins and ends, fractional.
// parameter texels: fractional, from 0 up.
// parameter width: columns of the map.
// parameter region: number of the region, from 0.
// parameter regions: how many, from 1 up.
// parameter first: first texel of the region.

/// A view ray in a rectified map.
struct RowRay {
    /// Row, fractional; row j is at the value j.
    row: f32,
    /// Texels before the ray begins, fractional.
    begin: f32,
    /// Texels before the ray ends, fractional.
    end: f32,
    /// Depth of the ray, 0..1.
    depth: f32,
}

/// Stretches that do not begin at the row's start are at least this long, texels.
const LEAST_STRETCH: f32 = 4.0;

/// `begin` of a stretch, moved towards the eye where the stretch is short.
fn stretch_begin(begin: f32, end: f32) -> f32 {
    return clamp(min(begin, end - LEAST_STRETCH), 0.0, end);
}

/// The region of a row of `width` texels in `regions` regions that holds the `texels`-th texel.
fn region_of(texels: f32, width: u32, regions: u32) -> u32 {
    // A ray that ends at the border of two regions needs nothing of the second.
    let last = u32(max(ceil(texels) - 1.0, 0.0));
    return min(last * regions / width, regions - 1u);
}

/// First texel of a region; of the region after the last, the width.
fn region_begin(region: u32, width: u32, regions: u32) -> u32 {
    return (region * width + regions - 1u) / regions;
}

/// Where the prefix mean over the texels before `texels` is read, in texels: texel i holds the mean over the texels
/// up to and with i, so that half a texel is taken off; at the start of the region that begins at `first` it stays inside.
fn prefix_column(texels: f32, first: f32) -> f32 {
    return max(texels - 0.5, first + 0.5);
}
