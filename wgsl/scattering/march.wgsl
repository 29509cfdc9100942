// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::scattering::march
// summary: Visibility along a view ray step by step: the naive form, as fallback and as baseline.
// source: thesis 4.2.1 and 4.3.1, Eq. 4.4 and 4.8.
// note: Both marches run from the far end towards the eye by Horner's rule, sum = sum * q + V, with q the
// note: transmittance of one step: the weights of Eq. 4.8 then cost one multiplication and no exponential.
// equation: row: V̄ = (Σ_(i<⌊s⌋) q^i V_i + last) / ((1 − q^s) / (1 − q)), q = exp(−τ), by Horner's rule from the far end
// equation: shadow map: V̄ = Σ q^i [z_i ≤ stored_i] / Σ q^i
// error: the exact sum over the nearest row, in the mean 4e-4;
// error: test scattering/march::march_along_rows_is_the_exact_sum_over_the_nearest_row.
// error: a slab within 4.9e-4; test scattering/closed_forms::an_empty_shadow_map_lights_everything_and_a_slab_has_its_closed_form.
// parameter map: depths, r32float or a depth format.
// parameter row: of the map, from 0.
// parameter steps: how many, from 1 up.

#import airlight::core::finite::finite_or
#import airlight::core::light::{Light, shadow_position}
#import airlight::core::prefix_sum::{one_minus_exp, prefix_weight}

/// Most steps of a march by equal steps.
const MOST_MARCH_STEPS: u32 = 65536u;

/// Mean visibility over the first `texels` texels of a row of a rectified map, weighted by
/// transmittance. `depth`: of the ray, 0..1; `texels`: fractional, clamped to the width of the map;
/// `optical_step`: optical depth of the ray over one texel, zero for the plain mean.
fn march_row(map: texture_2d<f32>, row: u32, depth: f32, texels: f32, optical_step: f32) -> f32 {
    let size = textureDimensions(map);
    let covered = clamp(texels, 1e-3, f32(size.x));
    let whole = min(u32(covered), size.x - 1u);
    let part = covered - f32(whole);
    let ratio = exp(-optical_step);
    // Weights in units of the first texel's: 1, q, q^2 ...; the last texel counts in part.
    let scale = one_minus_exp(optical_step);
    let last = select(part, one_minus_exp(optical_step * part) / scale, scale > 1e-6);
    var sum = 0.0;
    if textureLoad(map, vec2<u32>(whole, row), 0).x >= depth {
        sum = last;
    }
    for (var left = whole; left > 0u; left--) {
        let lit = textureLoad(map, vec2<u32>(left - 1u, row), 0).x >= depth;
        sum = sum * ratio + select(0.0, 1.0, lit);
    }
    return clamp(sum / prefix_weight(optical_step, covered), 0.0, 1.0);
}

/// Plain mean visibility of a view ray over `steps` equal steps along a row of a rectified map: one
/// texture load a step and nothing else, the fastest march there is. `depth`: of the ray, 0..1;
/// `texels`: that the ray covers, fractional, clamped to the width of the map; `offset`: 0..1, where in
/// each step the sample lies.
fn march_row_steps(map: texture_2d<f32>, row: u32, depth: f32, texels: f32, steps: u32, offset: f32) -> f32 {
    let width = f32(textureDimensions(map).x);
    let taken = min(steps, MOST_MARCH_STEPS);
    let count = f32(max(taken, 1u));
    let stride = clamp(texels, 1e-3, width) / count;
    // The sum of strides is rounded at each step: the last sample stays inside the map.
    var at = clamp(offset * stride, 0.0, max(width - 0.05 - stride * (count - 1.0), 0.0));
    var lit = 0u;
    for (var done = 0u; done < taken; done++) {
        lit += select(0u, 1u, textureLoad(map, vec2<u32>(u32(at), row), 0).x >= depth);
        at += stride;
    }
    return f32(lit) / count;
}

/// Mean visibility of a view ray over `steps` equal steps through a standard shadow map, weighted by
/// transmittance. `origin`, `direction`: of the ray in the world; `distance`: its length in metres;
/// `extinction` in 1/m, zero for the plain mean; `offset`: 0..1, where in each step the sample lies.
/// Outside the map everything is lit.
fn march_shadow_map(
    map: texture_2d<f32>, light: Light, origin: vec3<f32>, direction: vec3<f32>,
    distance: f32, extinction: f32, steps: u32, offset: f32
) -> f32 {
    let size = vec2<f32>(textureDimensions(map));
    // A directional light's matrix is affine: the ray is a straight line in texels and depth.
    let first = shadow_position(light, size, origin);
    let last = shadow_position(light, size, origin + direction * distance);
    let taken = min(steps, MOST_MARCH_STEPS);
    let stride = (last - first) / f32(max(taken, 1u));
    // Depth must grow away from the light for the comparison.
    let facing = select(-1.0, 1.0, light.far_depth > 0.5);
    let ratio = exp(-extinction * distance / f32(max(taken, 1u)));
    var sum = 0.0;
    var total = 0.0;
    for (var left = taken; left > 0u; left--) {
        let at = first + stride * (f32(left) - 1.0 + offset);
        let inside = all(at.xy >= vec2<f32>(0.0)) && all(at.xy < size);
        let texel = vec2<u32>(clamp(at.xy, vec2<f32>(0.0), size - 1.0));
        let stored = finite_or(textureLoad(map, texel, 0).x, light.far_depth);
        let lit = !inside || stored == light.far_depth || at.z * facing <= stored * facing;
        sum = sum * ratio + select(0.0, 1.0, lit);
        total = total * ratio + 1.0;
    }
    return sum / max(total, 1.0);
}
