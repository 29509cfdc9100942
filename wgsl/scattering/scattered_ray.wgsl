// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::scattering::scattered_ray
// summary: What evaluating a pixel's view ray gives, and the texel that is kept of it.
// source: thesis 4.3.3, Listing 4.4.
// equation: none: it only says what is kept of a ray.
// error: exact; test stylize/transfer/fused::directional_lights_are_restyled_as_by_a_pass_of_its_own.

/// What stands for infinity, metres.
const FARTHEST: f32 = 1e15;

/// A view ray and the light that the air scatters into it.
struct ScatteredRay {
    /// Linear RGB radiance at the eye, at most 65504.
    radiance: vec3<f32>,
    /// Mean visibility of the light along it, 0..1; where columns have a fall-off, the mean of that times visibility over the
    /// colours.
    visibility: f32,
    /// Where it passes through the picture.
    ndc: vec2<f32>,
    /// Its length in metres up to the surface, from the eye or the near plane of an orthographic camera, at most FARTHEST;
    /// the medium may end before.
    distance: f32,
    /// View direction times the unit vector at its origin towards the light, -1..1.
    cosine: f32,
}

/// What passes write of it: radiance, and in alpha the mean visibility.
fn scattered_texel(ray: ScatteredRay) -> vec4<f32> {
    return vec4<f32>(ray.radiance, ray.visibility);
}
