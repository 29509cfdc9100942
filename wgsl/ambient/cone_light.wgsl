// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::ambient::cone_light
// summary: Light from far away that comes in through a cone, looked up by the cone's direction and angle.
// source: O. Klehm, thesis, Section 3.3.3 and 3.3.4, Eq. 3.7 to 3.10.
// note: L_c(direction, angle) = t / pi times the integral of L(w) <direction, w> over the cap of that half angle about the direction.
// note: The printed t = 1 / (1 - cos(angle)) does not give equal results in constant light L, as the text wants, but
// note: L (1 + cos(angle)): the integral of the cosine over the cap is pi sin^2(angle). Here t = 1 / sin^2(angle), so that L_c is a mean
// note: of L, whatever the angle. What is not hidden has to be multiplied in: by Eq. 3.8 and 3.10 occlusion and `geometric_term`.
// note: In constant light the exact factor is the cosine-weighted open share K = 2 A <N, n>, of the uniform open share A and the mean
// note: direction N at its own length (Eq. 3.5): it holds the geometric term already.
// note: The maps are an array of octahedral maps (`ambient/octahedral`), rgba16float, layer k of 8 for the angle
// note: 90 degrees (k + 1) / 8, made by the pass `ambient/convolve_cones`; the sampler is linear.
// equation: L_c(n, α) = 1 / (π sin² α) ∫ over the cap of half angle α about n of L(ω) <n, ω> dω;  L_p(n) = L_c(n, π/2)
// equation: lit = L_c(N, α) A <N̂, n>  (Eq. 3.10 with normalised N̂)
// error: light linear in the direction within 1.5e-3 by all texels, 0.01 by samples;
// error: test ambient/light::light_linear_in_the_direction_has_its_closed_form.
// error: look-ups within 5e-3 relative; test ambient/light::look_ups_find_directions_and_angles.
// error: the geometric term within 2e-6; test ambient/light::the_geometric_term_is_a_cosine_of_both_normalised.
// parameter layer: 0..7.
// parameter cones: octahedral maps, rgba16float, 8 layers, linear RGB.
// parameter cone_sampler: linear, clamped to the edge.
// parameter angle: radians, 0..pi/2.
// parameter bent_normal, normal: any length.

#import airlight::ambient::octahedral::octahedral_coordinates
#import airlight::core::finite::is_finite

/// Number of angles.
const CONE_LAYERS: u32 = 8u;
/// From one layer's angle to the next: 11.25 degrees in radians.
const CONE_ANGLE_STEP: f32 = 0.19634954;

/// The half angle of a layer's cone, radians.
fn cone_layer_angle(layer: u32) -> f32 {
    return CONE_ANGLE_STEP * f32(layer + 1u);
}

/// L_c of Eq. 3.9: mean radiance in the cone of half angle `angle` (radians) about `direction` (any length), weighted by
/// the cosine to it; linear RGB. Linear between the layers' angles; below the first that of the first, above the last, and for
/// an angle that is not finite, that of the last. A direction without length counts as +y.
fn cone_radiance(cones: texture_2d_array<f32>, cone_sampler: sampler, direction: vec3<f32>, angle: f32) -> vec3<f32> {
    let last = f32(CONE_LAYERS - 1u);
    let layer = select(last, clamp(angle / CONE_ANGLE_STEP - 1.0, 0.0, last), is_finite(angle));
    let begin = min(u32(layer), CONE_LAYERS - 2u);
    let coordinates = octahedral_coordinates(direction, textureDimensions(cones).x);
    let narrow = textureSampleLevel(cones, cone_sampler, coordinates, begin, 0.0).rgb;
    let wide = textureSampleLevel(cones, cone_sampler, coordinates, begin + 1u, 0.0).rgb;
    return mix(narrow, wide, layer - f32(begin));
}

/// L_p of Eq. 3.7: irradiance over pi of a surface that faces `direction` (any length), nothing hidden; linear RGB.
/// That of the normal is what ambient occlusion multiplies, that of the bent normal what bent normals do (Eq. 3.8).
fn preconvolved_radiance(cones: texture_2d_array<f32>, cone_sampler: sampler, direction: vec3<f32>) -> vec3<f32> {
    let coordinates = octahedral_coordinates(direction, textureDimensions(cones).x);
    return textureSampleLevel(cones, cone_sampler, coordinates, CONE_LAYERS - 1u, 0.0).rgb;
}

/// The factor <N, n> of Eq. 3.10, 0..1: cosine between the bent normal and the normal. Both are normalised here, for N comes
/// with the length of a mean; 0 where one has no length.
fn geometric_term(bent_normal: vec3<f32>, normal: vec3<f32>) -> f32 {
    let squares = dot(bent_normal, bent_normal) * dot(normal, normal);
    if !is_finite(squares) || squares < 1e-30 {
        return 0.0;
    }
    return clamp(dot(bent_normal, normal) * inverseSqrt(squares), 0.0, 1.0);
}
