// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::transmittance::medium
// summary: Single scattering of a directional light along a view ray through a medium of varying extinction.
// source: the equation of radiative transfer without multiple scattering; Gautron et al. (2011) for what lights a step.
// note: L = albedo p L_e int sigma T_eye T_light dt, p the phase function. In a step extinction is even and T_light is that at
// note: its middle, so that the step's share T_eye (1 - exp(-tau)) T_light is exact in T_eye.
// note: Pictures of media are premultiplied: linear RGB radiance that reaches the eye, and in alpha the transmittance to the
// note: background, 1 where there is no medium. Over a picture they are radiance + alpha * background.
// equation: L = albedo p(cos) L_e Σ_i T_eye,i (1 − exp(−τ_i)) T_light,i;  T_eye,i+1 = T_eye,i exp(−τ_i)
// error: radiance within 1.5 % rms of the f64 march, transmittance 1 %;
// error: test transmittance/pictures::surfaces_cut_the_medium_before_any_camera.
// error: against the same march without a map 1 %, 0.2 %; test transmittance/pictures::a_cloud_through_maps_is_the_march_in_f64.
// parameter value: of the volume's texture, any; not finite or negative is no medium.
// parameter cosine: -1..1.
// parameter light_radiance: linear RGB, from 0 up.
// parameter source: linear RGB, from 0 up.

#import airlight::core::finite::finite_or
#import airlight::core::phase::henyey_greenstein
#import airlight::core::prefix_sum::one_minus_exp
#import airlight::core::volume::VolumeSpace

/// How a medium scatters light. 32 bytes.
struct MediumLighting {
    /// Single-scattering albedo, 0..1 for each colour.
    albedo: vec3<f32>,
    /// Mean cosine of the Henyey-Greenstein phase function, -0.999..0.999.
    g: f32,
    /// View rays end here if they meet nothing nearer, metres, positive.
    distance_limit: f32,
    reserved_a: f32,
    reserved_b: f32,
    reserved_c: f32,
}

/// The greatest half float.
const GREATEST_RADIANCE: f32 = 65504.0;

/// More than any extinction may be, 1/m.
const GREATEST_EXTINCTION: f32 = 1e6;

/// Extinction in 1/m of a value of the volume's texture; 0 for what is not finite or negative.
fn extinction_of_value(value: f32, volume: VolumeSpace) -> f32 {
    return clamp(finite_or(value * volume.value_scale, 0.0), 0.0, GREATEST_EXTINCTION);
}

/// What was met on a view ray from the eye up to a place.
struct Marched {
    /// Sum of T_eye (1 - exp(-tau)) T_light over the steps, 0..1: the share of `source_radiance` that reaches the eye.
    scattered: f32,
    /// Transmittance from the eye to that place, 0..1.
    transmittance: f32,
}

/// Linear RGB radiance of an opaque medium in full light. `light_radiance`: irradiance of the light at normal incidence;
/// `cosine`: view direction times direction TOWARDS the light.
fn source_radiance(lighting: MediumLighting, light_radiance: vec3<f32>, cosine: f32) -> vec3<f32> {
    return lighting.albedo * light_radiance * henyey_greenstein(cosine, lighting.g);
}

/// Nothing was met yet.
fn marched_nothing() -> Marched {
    return Marched(0.0, 1.0);
}

/// With a step of `optical_depth` more, from 0 up. `light_transmittance`: from the light to it, 0..1.
fn marched_on(before: Marched, optical_depth: f32, light_transmittance: f32) -> Marched {
    let scattered = one_minus_exp(optical_depth);
    return Marched(
        before.scattered + before.transmittance * scattered * light_transmittance,
        before.transmittance * (1.0 - scattered)
    );
}

/// A pixel: premultiplied radiance, and transmittance to the background in alpha. `source`: of `source_radiance`.
fn medium_pixel(source: vec3<f32>, marched: Marched) -> vec4<f32> {
    let radiance = clamp(source * marched.scattered, vec3<f32>(0.0), vec3<f32>(GREATEST_RADIANCE));
    return vec4<f32>(radiance, clamp(marched.transmittance, 0.0, 1.0));
}
