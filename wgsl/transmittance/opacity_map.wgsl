// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::transmittance::opacity_map
// summary: Fourier opacity maps: extinction along a light ray as a Fourier series with the range as its period.
// source: Jansen, Bavoil, "Fourier opacity mapping" (I3D 2010).
// note: The orthonormal functions over 0..1 are 1, then sqrt(2) cos(2 pi k x) and sqrt(2) sin(2 pi k x). What is stored is
// note: the optical depth times their means, as in extinction_map. Group g holds
// note:   sin 2 g, cos (2 g + 1), sin (2 g + 1), cos (2 g + 2) of the angle 2 pi x, and 1 in place of the sine of 0.
// note: The last cosine has no sine beside it: of four coefficients three are the pairs that the paper means, and the fourth
// note: still lowers the error of extinction.
// note: The series is periodic: what leaves at the far side comes in at the near one. Where extinction differs at both ends
// note: it rings there, which extinction_map, an even series, does not.
// equation: functions 1, √2 cos(2πk x), √2 sin(2πk x);  τ(x) = Σ_j c_j ∫₀ˣ;  T(x) = exp(−max(τ(x), 0))
// error: within the budgets of its form against the reference;
// error: test transmittance/forms::every_form_is_its_reference_and_reaches_what_it_can.
// parameter group: number of four coefficients, from 0.
// parameter half: half the length of a stretch, 0..0.5 over the range.
// parameter map: layers of four coefficients.
// parameter depth: 0..1 over the range.

#import airlight::core::cosine_basis::{Harmonics, harmonics_next, sine_over_angle, ROOT_OF_TWO}
#import airlight::core::fourier_basis::{rotate, sine_cosine, PI}
#import airlight::transmittance::map_texels::{Footprint, mixed_texel}

/// Frequencies of a group, periods over the range.
fn period_orders(group: u32) -> vec4<f32> {
    return f32(2u * group) + vec4<f32>(0.0, 1.0, 1.0, 2.0);
}

/// Harmonics of the first group at `depth`, or of a half length; core/cosine_basis goes on with `harmonics_next`.
fn periods_first(depth: f32) -> Harmonics {
    let one = sine_cosine(2.0 * depth);
    let two = rotate(one, one);
    return Harmonics(vec4<f32>(1.0, one.y, one.y, two.y), vec4<f32>(0.0, one.x, one.x, two.x), two);
}

/// The functions of a group.
fn period_basis(at: Harmonics, group: u32) -> vec4<f32> {
    let own = ROOT_OF_TWO * vec4<f32>(at.sine.x, at.cosine.y, at.sine.z, at.cosine.w);
    return vec4<f32>(select(own.x, 1.0, group == 0u), own.yzw);
}

/// Their integrals from 0 to `depth`. `at`: of the same depth.
fn period_integral(at: Harmonics, depth: f32, group: u32) -> vec4<f32> {
    let scale = ROOT_OF_TWO / (2.0 * PI * max(period_orders(group), vec4<f32>(1.0)));
    let own = scale * vec4<f32>(1.0 - at.cosine.x, at.sine.y, 1.0 - at.cosine.z, at.sine.w);
    return vec4<f32>(select(own.x, depth, group == 0u), own.yzw);
}

/// What the functions of a group at the middle of a stretch are multiplied by to give their means over it, as `cosine_spread`.
fn period_spread(at_half: Harmonics, half: f32, group: u32) -> vec4<f32> {
    return sine_over_angle(at_half.sine, 2.0 * PI * half * period_orders(group));
}

/// Coefficients of a group of a stretch of optical depth 1, as `extinction_coefficients`, the harmonics being those of
/// `periods_first`.
fn opacity_coefficients(middle: Harmonics, extent: Harmonics, half: f32, group: u32) -> vec4<f32> {
    return period_basis(middle, group) * period_spread(extent, half, group);
}

/// Optical depth from the near side to `depth` 0..1, which ringing may make negative. `layers`: of the map.
fn opacity_optical_depth(map: texture_2d_array<f32>, place: Footprint, depth: f32, layers: u32) -> f32 {
    let inside = clamp(depth, 0.0, 1.0);
    var at = periods_first(inside);
    var sum = 0.0;
    for (var group = 0u; group < layers; group++) {
        sum += dot(mixed_texel(map, place, group), period_integral(at, inside, group));
        at = harmonics_next(at);
    }
    return sum;
}
