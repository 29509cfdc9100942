// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::transmittance::extinction_map
// summary: Extinction transmittance maps: extinction along a light ray as a cosine series, transmittance from its integral.
// source: Gautron, Delalandre, Marvie, "Extinction transmittance maps" (SIGGRAPH Asia 2011 sketches), Eq. 1 to 3.
// note: sigma(x) = sum of c_j b_j(x), c_j = (1/d) sum of d_i sigma_i b_j(x_i), T(x) = exp(-sum of c_j B_j(x)); x in metres.
// note: Here depths are x / d, 0..1, and what is stored is c_j d: an optical depth, without unit, whatever the scale of the
// note: world. Then T(x) = exp(-sum of (c_j d) B_j(x / d)), with the basis of core/cosine_basis, so that d cancels.
// note: The paper prints i for j in b_j. Its (2 x + 1) / (2 d) is the discrete transform, x being the number of a sample and
// note: d that of samples; in metres it shifts depths by half a metre. The continuous basis is used.
// note: B_0 = x: the printed form divides by j = 0. The printed B_j has its lower limit subtracted already, and
// note: Eq. 3 does so again; it is 0 at the near side.
// note: Eq. 1 takes b_j at the middle of a stretch d_i. Here its mean over the stretch is taken, exact for even extinction.
// note: T at the far side is exact for any number of coefficients. A truncated series rings: sums of extinction may be
// note: negative, so that T may rise along the ray and is clamped to 0..1. With `monotone` the Fejer window keeps the series
// note: of extinction from 0 up, and T falls everywhere, at 1.2 to 2.5 times the mean error; both ends are as they were.
// equation: c_j d = Σ_i τ_i mean of b_j over stretch i;  τ(x) = Σ_j (c_j d) B_j(x);  T(x) = exp(−max(τ(x), 0))
// error: slabs and boxes within 1e-4 of the truncated series, half floats 1e-3;
// error: test transmittance/volumes::slabs_and_boxes_are_their_truncated_series_in_closed_form.
// error: an even slab over the range within 3e-6; test transmittance/volumes::an_even_slab_over_the_range_is_exact.
// parameter group: number of four coefficients, from 0.
// parameter half: half the length of the stretch, 0..1 over the range.
// parameter map: layers of four coefficients, rgba32float or rgba16float.
// parameter optical_depth: any; negative by ringing.
// parameter depth: 0..1 over the range.

#import airlight::core::cosine_basis::{
    Harmonics, harmonics_first, harmonics_next, cosine_basis, cosine_integral, cosine_spread, fejer_window
}
#import airlight::transmittance::map_texels::{Footprint, mixed_texel}

/// Coefficients of a group of a stretch of optical depth 1. `middle` and `extent`: harmonics of the depth of its middle and
/// of its half length, `half`, all over the range of the map.
fn extinction_coefficients(middle: Harmonics, extent: Harmonics, half: f32, group: u32) -> vec4<f32> {
    return cosine_basis(middle, group) * cosine_spread(extent, half, group);
}

/// Optical depth from the near side to `depth` 0..1, which ringing may make negative. `layers`: of the map, four
/// coefficients each. `monotone`: 1 for the Fejer window, 0 for the plain series.
fn extinction_optical_depth(
    map: texture_2d_array<f32>, place: Footprint, depth: f32, layers: u32, monotone: f32
) -> f32 {
    let inside = clamp(depth, 0.0, 1.0);
    var at = harmonics_first(inside);
    var sum = 0.0;
    for (var group = 0u; group < layers; group++) {
        let window = mix(vec4<f32>(1.0), fejer_window(group, 4u * layers), monotone);
        sum += dot(mixed_texel(map, place, group) * window, cosine_integral(at, inside, group));
        at = harmonics_next(at);
    }
    return sum;
}

/// Transmittance 0..1 of an optical depth; 1 where that is negative.
fn transmittance_of(optical_depth: f32) -> f32 {
    return exp(-max(optical_depth, 0.0));
}
