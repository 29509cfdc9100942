// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::transmittance::function_map
// summary: Transmittance function maps: transmittance itself along a light ray as a series.
// source: Delalandre, Gautron, Marvie, Francois, "Transmittance function mapping" (I3D 2011).
// note: T(x) = sum of t_j b_j(x), t_j = mean of T b_j over the range; building it needs T, so that light rays are marched and
// note: particles cannot be added in any order. The paper writes of a Fourier transform. The cosine series is meant
// note: here, as in its successor; the full period, kept for comparison, rings at both ends, since T(0) and T(d) differ.
// note: A step of the march has even extinction, and T in it is taken for its mean, which is exact.
// equation: t_j = ∫₀¹ T(x) b_j(x) dx;  T(x) = Σ_j t_j b_j(x), cut to 0..1;  mean of exp(−x) over 0..τ = (1 − exp(−τ)) / τ
// error: within the budgets of its form against the reference;
// error: test transmittance/forms::every_form_is_its_reference_and_reaches_what_it_can.
// parameter map: layers of four coefficients.
// parameter optical_depth: from 0 up.
// parameter depth: 0..1 over the range.

#import airlight::core::cosine_basis::{harmonics_first, harmonics_next, cosine_basis}
#import airlight::core::prefix_sum::one_minus_exp
#import airlight::transmittance::map_texels::{Footprint, mixed_texel}
#import airlight::transmittance::opacity_map::{periods_first, period_basis}

/// Mean of exp(-x) for x from 0 to `optical_depth`.
fn mean_transmittance(optical_depth: f32) -> f32 {
    let depth = max(optical_depth, 1e-12);
    return one_minus_exp(depth) / depth;
}

/// Transmittance 0..1 at `depth` 0..1. `layers`: of the map, four coefficients each. `periodic`: true for the series of
/// opacity_map instead of cosines.
fn function_transmittance(
    map: texture_2d_array<f32>, place: Footprint, depth: f32, layers: u32, periodic: bool
) -> f32 {
    let inside = clamp(depth, 0.0, 1.0);
    var sum = 0.0;
    if periodic {
        var at = periods_first(inside);
        for (var group = 0u; group < layers; group++) {
            sum += dot(mixed_texel(map, place, group), period_basis(at, group));
            at = harmonics_next(at);
        }
    } else {
        var at = harmonics_first(inside);
        for (var group = 0u; group < layers; group++) {
            sum += dot(mixed_texel(map, place, group), cosine_basis(at, group));
            at = harmonics_next(at);
        }
    }
    return clamp(sum, 0.0, 1.0);
}
