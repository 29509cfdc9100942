// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::transmittance::map_form
// summary: Callback: what a stretch of extinction adds to the layers of a map, by whichever form the pass was built for.
// source: the algorithm modules of the forms.
// note: All forms but the transmittance function map add up: the layers of a texel are sums over the stretches that its light
// note: ray meets, in any order, of optical depth times what is given here.
// definition COEFFICIENTS: numbers a texel, four a layer: 4, 8 or 16, of the moments 8; 4 where it is not given.
// definition PERIODIC: the series of the full period instead of cosines.
// definition POWER: six power moments.
// definition TRIGONOMETRIC: two trigonometric moments.

#ifdef POWER
#import airlight::transmittance::transmittance_moments::power_layer
#else ifdef TRIGONOMETRIC
#import airlight::transmittance::transmittance_moments::trigonometric_layer
#else
#import airlight::core::cosine_basis::{Harmonics, harmonics_first, harmonics_next}
#ifdef PERIODIC
#import airlight::transmittance::opacity_map::{periods_first, opacity_coefficients}
#else
#import airlight::transmittance::extinction_map::extinction_coefficients
#endif
#endif

/// Layers of a map.
#ifdef COEFFICIENTS
const LAYERS: u32 = u32(#{COEFFICIENTS}) / 4u;
#else
const LAYERS: u32 = 1u;
#endif

/// What a stretch of optical depth 1 adds to each layer.
struct Contribution {
    /// Layer by layer.
    layers: array<vec4<f32>, LAYERS>,
}

/// What the stretch around `middle`, `half` to both sides, 0..1 over the range or the interval, adds.
fn contribution(middle: f32, half: f32) -> Contribution {
    var all: Contribution;
#ifdef POWER
    for (var layer = 0u; layer < LAYERS; layer++) {
        all.layers[layer] = power_layer(middle, half, layer);
    }
#else ifdef TRIGONOMETRIC
    for (var layer = 0u; layer < LAYERS; layer++) {
        all.layers[layer] = trigonometric_layer(middle, half, layer);
    }
#else
#ifdef PERIODIC
    var at = periods_first(middle);
    var extent = periods_first(half);
#else
    var at = harmonics_first(middle);
    var extent = harmonics_first(half);
#endif
    for (var layer = 0u; layer < LAYERS; layer++) {
#ifdef PERIODIC
        all.layers[layer] = opacity_coefficients(at, extent, half, layer);
#else
        all.layers[layer] = extinction_coefficients(at, extent, half, layer);
#endif
        at = harmonics_next(at);
        extent = harmonics_next(extent);
    }
#endif
    return all;
}
