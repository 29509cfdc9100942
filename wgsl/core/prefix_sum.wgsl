// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::core::prefix_sum
// summary: Running weighted mean along a row: the prefix sum that filters basis textures.
// source: thesis 4.3.3, Listings 4.1 and 4.2.
// note: Listing 4.1 fetches texel x inside a loop over i: it must be i. Listing 4.2 writes the product of
// note: transmittances from j = 0: it starts at 1. Constant factors of the weights cancel, so the first is 1.
// note: The mean over the texels 0 .. i is stored at texel i (an inclusive prefix).
// equation: mean_i = mean_(i−1) + (v_i − mean_(i−1)) w_i / W_i,  w_i = q^i, W_i = w_0 + .. + w_i,  q = exp(−optical_step)
// equation: prefix weight of s texels: (1 − exp(−τ s)) / (1 − exp(−τ)), s for τ = 0
// error: running mean within 5e-6; test core/fourier::running_means_are_those_of_the_reference.
// error: one_minus_exp within 1e-6 relative, prefix_weight 6e-4 over the range of the test;
// error: test core/fourier::absorption_and_in_scattering_keep_their_precision.
// parameter x: optical depth, from 0 up.
// parameter texels: fractional, from 0 up.
// parameter optical_step: optical depth of one texel, from 0 up.
// parameter mean, value: four numbers of any unit, the same of both.
// parameter weights, current: of the texel.

/// Weights of one row: each is `ratio` times the one before it.
struct RowWeights {
    /// Weight of the current texel.
    weight: f32,
    /// Sum of the weights up to and with it.
    total: f32,
    /// From a texel to the next, 0..1.
    ratio: f32,
}

/// The weights at the first texel. `optical_step`: optical depth of one texel; zero gives the plain mean.
fn row_weights(optical_step: f32) -> RowWeights {
    return RowWeights(1.0, 1.0, exp(-max(optical_step, 0.0)));
}

/// The weights at the next texel.
fn row_weights_next(current: RowWeights) -> RowWeights {
    let weight = current.weight * current.ratio;
    return RowWeights(weight, current.total + weight, current.ratio);
}

/// `mean` with `value` taken in at the current texel's weight.
fn running_mean(mean: vec4<f32>, value: vec4<f32>, weights: RowWeights) -> vec4<f32> {
    return mean + (value - mean) * (weights.weight / weights.total);
}

/// 1 - exp(-x) for x >= 0, without cancellation for small x. Relative error below 1e-6.
fn one_minus_exp(x: f32) -> f32 {
    const third: f32 = 1.0 / 3.0;
    const sixth: f32 = 1.0 / 6.0;
    let series = x * (1.0 - x * 0.5 * (1.0 - x * third * (1.0 - x * 0.25 * (1.0 - x * 0.2 * (1.0 - x * sixth)))));
    return select(1.0 - exp(-x), series, x < 0.3);
}

/// Weight of the first `texels` texels of a row, fractional, in units of the first texel's. `optical_step`: optical
/// depth of one texel; zero gives the number of texels. Relative error below 2e-6.
fn prefix_weight(optical_step: f32, texels: f32) -> f32 {
    // So thin that 1 - exp(-x) is x.
    let thickness = max(optical_step, 1e-30);
    return one_minus_exp(thickness * texels) / one_minus_exp(thickness);
}
