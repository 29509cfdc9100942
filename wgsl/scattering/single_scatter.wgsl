// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::scattering::single_scatter
// summary: Single scattering of a directional light in a homogeneous medium, given the visibility along a ray.
// source: thesis 4.2.1, Eq. 4.1 and 4.2; 4.3.2, Eq. 4.8 and 4.9; Listing 4.4.
// note: L = albedo sigma p L_e int_0^s exp(-sigma t) V dt = albedo p L_e (1 - exp(-sigma s)) Vbar, where Vbar is
// note: the mean of V weighted by transmittance. With plain average visibility the same form is Eq. 4.2.
// note: Listing 4.4 prints exp(disToSurface * sigma): the exponent is negative.
// equation: L = albedo p(cos) L_e (1 − exp(−σ s)) V̄;  T = exp(−τ)
// error: in_scattered within 5e-6 relative, transmittance 3e-7; test core/fourier::absorption_and_in_scattering_keep_their_precision.
// parameter optical_depth: from 0 up; less counts as 0.
// parameter light_radiance: irradiance at normal incidence, linear RGB, from 0 up.

#import airlight::core::phase::henyey_greenstein
#import airlight::core::prefix_sum::one_minus_exp

/// A homogeneous medium. 32 bytes.
struct Medium {
    /// Single-scattering albedo, 0..1 for each colour.
    albedo: vec3<f32>,
    /// Extinction coefficient in 1/m, not negative; zero is a clear picture.
    extinction: f32,
    /// Mean cosine of the Henyey-Greenstein phase function, -0.999..0.999.
    g: f32,
    /// Rays end here if they meet nothing nearer, metres, positive.
    distance_limit: f32,
    reserved_a: f32,
    reserved_b: f32,
}

/// Transmittance over `optical_depth`, 0..1.
fn transmittance(optical_depth: f32) -> f32 {
    return exp(-max(optical_depth, 0.0));
}

/// Radiance scattered into a view ray. `visibility`: mean over the ray, weighted by transmittance or
/// plain, 0..1; `distance`: length of the ray in metres; `cosine`: view direction times direction
/// towards the light.
fn in_scattered(medium: Medium, light_radiance: vec3<f32>, cosine: f32, distance: f32, visibility: f32) -> vec3<f32> {
    let phase = henyey_greenstein(cosine, medium.g);
    return medium.albedo * light_radiance * (phase * one_minus_exp(medium.extinction * distance) * visibility);
}
