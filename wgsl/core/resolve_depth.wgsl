// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::core::resolve_depth
// summary: One distance for the samples of a pixel: that at which the transmittance is the mean of theirs.
// source: Beer-Lambert law, thesis 2.4.2; light scattered into a lit ray is affine in transmittance (thesis Eq. 4.2).
// note: With a mean of distances a pixel half near, half sky scatters up to a third too much; with the mean of
// note: transmittances it scatters what its samples scatter on average. Without extinction both are the same.
// equation: T̄ = mean of exp(−σ (s_i − nearest));  s = nearest − ln(T̄) / σ,  σ = max(extinction, LEAST_SPREAD / (farthest − nearest))
// error: within 2e-4 of the spread of the samples; test core/camera::distances_of_mean_transmittance.
// parameter extinction: 1/m, from 0 up.
// parameter nearest, farthest: metres, from 0 up.
// parameter mean_transmittance: 0..1.

/// Optical spread of the samples below which the mean of distances stands in for that of transmittances.
const LEAST_SPREAD: f32 = 1e-3;

/// The extinction in 1/m to average with for samples between the distances `nearest` and `farthest` in
/// metres: `extinction`, but at least so much that the samples differ; the mean distance is then off by
/// less than 2e-4 of their spread.
fn averaging_extinction(extinction: f32, nearest: f32, farthest: f32) -> f32 {
    return max(extinction, LEAST_SPREAD / max(farthest - nearest, 1e-6));
}

/// Distance in metres at which the transmittance from `nearest` on is `mean_transmittance`, 0..1, at the
/// `extinction` that `averaging_extinction` gave.
fn distance_of_transmittance(nearest: f32, extinction: f32, mean_transmittance: f32) -> f32 {
    return nearest - log(clamp(mean_transmittance, 1e-30, 1.0)) / extinction;
}
