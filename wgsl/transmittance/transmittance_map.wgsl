// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::transmittance::transmittance_map
// summary: Callback: transmittance from a directional light to a place in its map, by whichever form the pass was built for.
// source: Gautron et al. (2011), Jansen and Bavoil (2010), Delalandre et al. (2011), Muenstermann et al. (2018).
// note: All forms answer the same question by the same call, so that an engine swaps one definition.
// note: Bilinear reads mix what is stored, which is exact for the mean of extinction, of transmittance or of moments over
// note: texels, but for BOUNDED, where four transmittances are mixed.
// note: Outside of the map to the sides transmittance is 1; before it too, and behind it what it is at the far side.
// equation: T(place, depth) of the form that was built: extinction, opacity, function map or moments; 1 outside and before the map
// error: every form within its budget, mean and greatest; test transmittance/forms::every_form_is_its_reference_and_reaches_what_it_can.
// error: places outside are lit; test transmittance/volumes::depth_may_run_either_way_and_places_outside_are_lit.
// parameter depth: 0..1 over the range.
// definition COEFFICIENTS: numbers a texel, four a layer: 4, 8 or 16, of the moments 8; 4 where it is not given.
// definition FUNCTION: transmittance function map; without this and the next four an extinction map of cosines.
// definition PERIODIC: the series of the full period instead of cosines: a Fourier opacity map, or with FUNCTION.
// definition POWER: six power moments.
// definition TRIGONOMETRIC: two trigonometric moments.
// definition BOUNDED: an extinction map over the occupied interval of each texel.
// definition MONOTONE: with the Fejer window, extinction maps only.
// definition FILTERED: bilinear means are read through a sampler: for maps of rgba16float, not BOUNDED.
// definition NEAREST: the nearest texel instead of a bilinear read.
// binding coefficients: the layers of the map, rgba32float or rgba16float.
// binding intervals: least and greatest occupied depth, 0..1, rg32float; with BOUNDED only.

#import airlight::transmittance::map_texels::{Footprint, footprint, footprint_nearest, mixed_texel}
#import airlight::transmittance::bounded_map::bounded_transmittance
#import airlight::transmittance::extinction_map::{extinction_optical_depth, transmittance_of}
#import airlight::transmittance::function_map::function_transmittance
#import airlight::transmittance::opacity_map::opacity_optical_depth
#import airlight::transmittance::transmittance_moments::{power_transmittance, trigonometric_transmittance}

@group(#{GROUP}) @binding(0) var coefficients: texture_2d_array<f32>;
#ifdef BOUNDED
@group(#{GROUP}) @binding(1) var intervals: texture_2d<f32>;
#endif

#ifdef COEFFICIENTS
const LAYERS: u32 = u32(#{COEFFICIENTS}) / 4u;
#else
const LAYERS: u32 = 1u;
#endif
#ifdef MONOTONE
const WINDOW: f32 = 1.0;
#else
const WINDOW: f32 = 0.0;
#endif
#ifdef PERIODIC
const FULL_PERIOD: bool = true;
#else
const FULL_PERIOD: bool = false;
#endif

/// Columns and rows of the map.
fn transmittance_map_size() -> vec2<u32> {
    return textureDimensions(coefficients);
}

/// Transmittance of a footprint at `depth`, 0..1.
fn footprint_transmittance(at: Footprint, depth: f32) -> f32 {
#ifdef FUNCTION
    return function_transmittance(coefficients, at, depth, LAYERS, FULL_PERIOD);
#else ifdef PERIODIC
    return transmittance_of(opacity_optical_depth(coefficients, at, depth, LAYERS));
#else ifdef POWER
    return power_transmittance(mixed_texel(coefficients, at, 0u), mixed_texel(coefficients, at, 1u), depth);
#else ifdef TRIGONOMETRIC
    return trigonometric_transmittance(mixed_texel(coefficients, at, 0u), mixed_texel(coefficients, at, 1u), depth);
#else ifdef BOUNDED
    return bounded_transmittance(coefficients, intervals, at, depth, LAYERS, WINDOW);
#else
    return transmittance_of(extinction_optical_depth(coefficients, at, depth, LAYERS, WINDOW));
#endif
}

/// Transmittance 0..1 from the light to a place in its map. `place`: texels, texel i at i + 0.5; `depth`: 0 on the near
/// side of the range, 1 on the far side; as light_space gives them.
fn transmittance(place: vec2<f32>, depth: f32) -> f32 {
    let size = transmittance_map_size();
    let inside = all(place >= vec2<f32>(0.0)) && all(place <= vec2<f32>(size)) && depth > 0.0;
#ifdef NEAREST
    let at = footprint_nearest(size, place);
#else
    let at = footprint(size, place);
#endif
    return select(1.0, footprint_transmittance(at, depth), inside);
}
