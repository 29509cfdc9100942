// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::core::phase
// summary: Phase functions, normalised to one over the sphere.
// source: thesis 2.4, Eq. 2.11 (Henyey and Greenstein 1941).
// note: the thesis writes p(w_i, w_l) without a sign. The scattering angle lies between directions of
// note: propagation, so with the view direction w (camera to scene) and l TOWARDS the light,
// note: cos(theta) = dot(w, l): looking at the sun is forward scattering.
// equation: p_iso = 1 / (4π)
// equation: p_HG(cos θ) = (1 − g²) / (4π (1 + g² − 2 g cos θ)^(3/2)),  ∫ p dω = 1,  ∫ p cos θ dω = g
// error: henyey_greenstein within 2e-6 relative, isotropic 1e-7; test core/light::phase_functions_are_those_of_the_reference.
// error: norm and mean cosine within 1e-4; test core/light::phase_functions_are_normalised_with_mean_cosine_g.

/// 1 / (4 pi), the value of the isotropic phase function, 1/sr.
const ISOTROPIC: f32 = 0.07957747154594767;

/// The isotropic phase function, 1/sr.
fn isotropic() -> f32 {
    return ISOTROPIC;
}

/// The Henyey-Greenstein phase function, 1/sr. `cosine`: of the scattering angle, -1..1;
/// `g`: mean cosine, clamped to -0.999..0.999, zero is isotropic.
fn henyey_greenstein(cosine: f32, g: f32) -> f32 {
    let mean = clamp(g, -0.999, 0.999);
    // (1 - g)^2 + 2 g (1 - cos) is 1 + g^2 - 2 g cos without the cancellation near the peak.
    let near = (1.0 - abs(mean)) * (1.0 - abs(mean));
    let turn = 1.0 - clamp(select(-cosine, cosine, mean >= 0.0), -1.0, 1.0);
    let inverse = inverseSqrt(near + 2.0 * abs(mean) * turn);
    return ISOTROPIC * (1.0 - mean * mean) * (inverse * inverse * inverse);
}
