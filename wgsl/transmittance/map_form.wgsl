// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::transmittance::map_form
// summary: Callback: what a stretch of extinction adds to the layers of a map, by whichever form the pass was built for.
// source: the algorithm modules of the forms.
// note: All forms but the transmittance function map add up: the layers of a texel are sums over the stretches that its light
// note: ray meets, in any order, of optical depth times what is given here.
// equation: layer_g += τ φ_g(middle, half), φ_g the group g of the chosen form for a stretch of optical depth 1
// equation: walk: φ_g = spread_g(step / 2) · basis_g(middle), middles led on by rotation
// error: maps from particles and volumes within the budgets of their forms;
// error: test transmittance/particles::balls_are_the_series_of_their_chords.
// parameter middle: depth of the middle of a stretch, 0..1 over the range or the interval.
// parameter half: half its length, the same.
// parameter step: its length, the same.
// parameter weight: optical depth, from 0 up.
// definition COEFFICIENTS: numbers a texel, four a layer: 4, 8 or 16, of the moments 8; 4 where it is not given.
// definition PERIODIC: the series of the full period instead of cosines.
// definition POWER: six power moments.
// definition TRIGONOMETRIC: two trigonometric moments.

#ifdef POWER
#import airlight::transmittance::transmittance_moments::power_layer
#else ifdef TRIGONOMETRIC
#import airlight::transmittance::transmittance_moments::trigonometric_layer
#else
#import airlight::core::cosine_basis::{
    Harmonics, harmonics_first, harmonics_next, harmonics_sum, cosine_spread, ROOT_OF_TWO
}
#ifdef PERIODIC
#import airlight::transmittance::opacity_map::{periods_first, period_spread, opacity_coefficients}
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

/// Even stretches one after the other along a light ray, each as long as the way from one middle to the next. Those of a series
/// share all but the basis at their middles, which a rotation leads on: no sine a stretch.
struct Walk {
#ifdef POWER
    /// Middle of the stretch, 0..1.
    middle: f32,
    /// From one middle to the next.
    step: f32,
#else ifdef TRIGONOMETRIC
    /// Middle of the stretch, 0..1.
    middle: f32,
    /// From one middle to the next.
    step: f32,
#else
    /// Harmonics of the middle of the stretch.
    middle: Harmonics,
    /// Of the way from one middle to the next.
    step: Harmonics,
#endif
}

/// A walk that begins at the stretch around `middle`; stretches are `step` long, 0..1. Rounding grows by about 1e-7 a stretch:
/// begin anew every 16 of them or so.
fn walk_from(middle: f32, step: f32) -> Walk {
#ifdef POWER
    return Walk(middle, step);
#else ifdef TRIGONOMETRIC
    return Walk(middle, step);
#else ifdef PERIODIC
    return Walk(periods_first(middle), periods_first(step));
#else
    return Walk(harmonics_first(middle), harmonics_first(step));
#endif
}

/// At the next stretch.
fn walk_on(walk: Walk) -> Walk {
#ifdef POWER
    return Walk(walk.middle + walk.step, walk.step);
#else ifdef TRIGONOMETRIC
    return Walk(walk.middle + walk.step, walk.step);
#else
    return Walk(harmonics_sum(walk.middle, walk.step), walk.step);
#endif
}

/// `sums`, and `weight` times what the stretch adds, but for the factor of `walk_sum`.
fn walk_add(sums: Contribution, walk: Walk, weight: f32) -> Contribution {
    var all = sums;
#ifdef POWER
    let own = contribution(walk.middle, 0.5 * walk.step);
    for (var layer = 0u; layer < LAYERS; layer++) {
        all.layers[layer] += weight * own.layers[layer];
    }
#else ifdef TRIGONOMETRIC
    let own = contribution(walk.middle, 0.5 * walk.step);
    for (var layer = 0u; layer < LAYERS; layer++) {
        all.layers[layer] += weight * own.layers[layer];
    }
#else
    var at = walk.middle;
    for (var layer = 0u; layer < LAYERS; layer++) {
#ifdef PERIODIC
        let mean = select(at.sine.x, 1.0, layer == 0u);
        all.layers[layer] += weight * vec4<f32>(mean, at.cosine.y, at.sine.z, at.cosine.w);
#else
        all.layers[layer] += weight * at.cosine;
#endif
        at = harmonics_next(at);
    }
#endif
    return all;
}

/// The sums of `walk_add` over stretches that are `step` long, as sums of `contribution`.
fn walk_sum(sums: Contribution, step: f32) -> Contribution {
#ifdef POWER
    return sums;
#else ifdef TRIGONOMETRIC
    return sums;
#else
    var all = sums;
#ifdef PERIODIC
    var extent = periods_first(0.5 * step);
#else
    var extent = harmonics_first(0.5 * step);
#endif
    for (var layer = 0u; layer < LAYERS; layer++) {
        let first = vec4<f32>(select(ROOT_OF_TWO, 1.0, layer == 0u), vec3<f32>(ROOT_OF_TWO));
#ifdef PERIODIC
        all.layers[layer] *= first * period_spread(extent, 0.5 * step, layer);
#else
        all.layers[layer] *= first * cosine_spread(extent, 0.5 * step, layer);
#endif
        extent = harmonics_next(extent);
    }
    return all;
#endif
}
