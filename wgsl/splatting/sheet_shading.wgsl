// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::splatting::sheet_shading
// summary: What a sheet's mean values become: extinction and colour, gradient, light that comes from the sheet to the eye.
// source: Zhang and Crawfis, 3.1 Eq. 1 and 5, 4.1 steps 16 to 20; Mueller et al., "Splatting without the blur" (1999).
// note: Means are classified after they are added up (post-classification). The part of the light that a sheet takes from
// note: itself is the mean over its depth, so that a picture of few sheets is neither too bright nor too dark.
// equation: mean of exp(−x) over 0..τ = (1 − exp(−τ)) / τ;  ∇f = (Δa b×c + Δb c×a + Δc a×b) / (a · b×c)
// equation: scattered = albedo opacity (ambient + E p_HG(cos));  Phong: opacity (color (A + E/π k_d <n, l>) + E/π k_s <r, e>^α)
// error: mean transmittance within 1.5e-6; test splatting/functions::the_mean_transmittance_is_that_of_the_depth.
// error: gradients of linear fields within 5e-6 relative; test splatting/functions::gradients_of_linear_fields_are_exact.
// parameter transfer: one row, linear RGB and opacity.
// parameter linear_sampler: linear, clamped to the edge.
// parameter value: mean value of the sheet, from 0 up.
// parameter optical_depth: from 0 up.
// parameter a, b, c: vectors in the world, metres, not in one plane.
// parameter changes: of the field along each of the three.
// parameter albedo, color: linear RGB, 0..1.
// parameter opacity: 0..1.
// parameter cosine: -1..1.

#import airlight::core::phase::henyey_greenstein
#import airlight::core::transfer_function::classified

/// How sheets are lit. 64 bytes.
struct SheetLighting {
    /// Radiance from all around, linear RGB.
    ambient: vec3<f32>,
    /// Extinction where the transfer function's opacity is 1, 1/m.
    extinction: f32,
    /// Mean cosine of the phase function, -0.99..0.99.
    g: f32,
    /// Share of diffuse reflection, from 0 up; with PHONG.
    diffuse: f32,
    /// Share of mirror-like reflection, from 0 up; with PHONG.
    specular: f32,
    /// Exponent of mirror-like reflection, from 1 up; with PHONG.
    shininess: f32,
}

/// Linear RGB and opacity of a sheet's mean value by a transfer function, as `classified` takes it; none of them negative.
fn sheet_matter(transfer: texture_2d<f32>, linear_sampler: sampler, value: f32) -> vec4<f32> {
    return clamp(classified(transfer, linear_sampler, value), vec4<f32>(0.0), vec4<f32>(65504.0));
}

/// Mean of exp(-x) from 0 to the optical depth: the share of light that a sheet has on average.
fn mean_transmittance(optical_depth: f32) -> f32 {
    let x = max(optical_depth, 0.0);
    // The series where the quotient would lose its digits.
    let near = 1.0 - x * (0.5 - x * (1.0 / 6.0 - x * (1.0 / 24.0 - x * (1.0 / 120.0 - x / 720.0))));
    return select((1.0 - exp(-x)) / max(x, 0.1), near, x < 0.2);
}

/// Gradient of a field, in 1/m of what it is made of, from its changes along three vectors, metres; 0 where these lie in a plane.
fn gradient_of_changes(
    a: vec3<f32>, b: vec3<f32>, c: vec3<f32>, changes: vec3<f32>
) -> vec3<f32> {
    let bc = cross(b, c);
    let volume = dot(a, bc);
    let sound = abs(volume) > 1e-6 * length(a) * length(bc) && abs(volume) > 1e-30;
    let sum = changes.x * bc + changes.y * cross(c, a) + changes.z * cross(a, b);
    return select(vec3<f32>(0.0), sum / select(1.0, volume, sound), sound);
}

/// Radiance, linear RGB, that a medium scatters to the eye, where `opacity` of the way is taken. `light`: irradiance that
/// arrives; `cosine`: between the ways of the light and of the view ray reversed, that is of the light on to the eye.
fn scattered_radiance(
    lighting: SheetLighting, albedo: vec3<f32>, opacity: f32, light: vec3<f32>, cosine: f32
) -> vec3<f32> {
    return albedo * opacity * (lighting.ambient + light * henyey_greenstein(cosine, lighting.g));
}

/// Radiance, linear RGB, of a surface in the medium by Phong, where `opacity` of the way is taken. `normal`: unit, to the outside, or
/// 0 where there is none; `to_light`, `to_eye`: unit vectors TOWARDS both; `light`: irradiance that arrives.
fn phong_radiance(
    lighting: SheetLighting, color: vec3<f32>, opacity: f32, normal: vec3<f32>, to_light: vec3<f32>,
    to_eye: vec3<f32>, light: vec3<f32>
) -> vec3<f32> {
    let facing = dot(normal, to_light);
    let mirrored = 2.0 * facing * normal - to_light;
    // pow(0, x) is fine; of a negative base it is not.
    let gloss = pow(max(dot(mirrored, to_eye), 0.0), max(lighting.shininess, 1.0));
    let lit = select(0.0, 1.0, facing > 0.0) * light * 0.31830989;
    let diffuse = color * (lighting.ambient + lit * (lighting.diffuse * max(facing, 0.0)));
    return opacity * (diffuse + lit * (lighting.specular * gloss));
}
