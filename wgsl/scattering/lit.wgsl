// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::scattering::lit
// summary: Callback: the light that reaches a point, and its mean over a view ray by marching, from a pass' bindings.
// source: thesis 2.4.4, Eq. 2.20; 4.2.1; C. Kulla and M. Fajardo, "Importance sampling techniques for path tracing in participating media" (2012).
// note: Unlike algorithm modules a callback holds bindings, those that passes share. An engine that keeps its shadow maps
// note: in another way replaces this file: only `lit_at` and `marched_visibility` read them.
// equation: mean = Σ w_i lit(x_i) / Σ w_i,  w_i = exp(−σ i Δ);  around a light: steps of equal angle, w_i = p(cos_i) exp(−σ path_i)
// error: marched pictures: visibility within 4.9e-4 of the closed form, radiance 1.5e-3;
// error: test scattering/closed_forms::an_empty_shadow_map_lights_everything_and_a_slab_has_its_closed_form.
// error: around a light within 1 % of the airlight integral; test scattering/local_lights::without_blockers_radiance_is_that_of_the_airlight_integral.
// parameter point: metres in the world.
// parameter origin, direction: of the view ray in the world, metres and unit vector.
// parameter distance: metres, from 0 up.
// parameter extinction: 1/m, from 0 up.
// parameter steps: how many, from 1 up.
// parameter offset: 0..1, where in each step the sample lies.
// parameter span: begin and end on the ray, metres.
// parameter g: mean cosine, -0.999..0.999.
// parameter away: metres, above 0.
// definition SHADOW_ARRAY: shadow maps of several views.
// definition LIGHT_TEXTURE: a texture colours the light.
// binding shadow_map: depth of the standard shadow map; without SHADOW_ARRAY.
// binding shadow_maps: depth of the views, a layer each; with SHADOW_ARRAY only.
// binding shadow_views: the views; with SHADOW_ARRAY only.
// binding light_texture: linear RGB 0..1 over the whole shadow map; with LIGHT_TEXTURE only.
// binding light_sampler: linear, clamped to the edge; with LIGHT_TEXTURE only.

#import airlight::core::light::{Light, direction_to_light, angular_falloff, light_texture_color}
#import airlight::core::phase::henyey_greenstein
#import airlight::core::shadow_views::{ShadowViews, view_position}
#import airlight::scattering::local_light::{
    local_ray, equal_angle, along_from_equal_angle, path_through_air, cosine_to_light
}
#import airlight::scattering::march::{march_shadow_map, MOST_MARCH_STEPS}
#import airlight::scattering::shadow_lookup::{shadow_in_map, shadow_in_view, lit_by_shadow}

#ifdef SHADOW_ARRAY
@group(#{GROUP}) @binding(6) var shadow_maps: texture_2d_array<f32>;
@group(#{GROUP}) @binding(10) var<uniform> shadow_views: ShadowViews;
#else
@group(#{GROUP}) @binding(6) var shadow_map: texture_2d<f32>;
#endif
#ifdef LIGHT_TEXTURE
@group(#{GROUP}) @binding(11) var light_texture: texture_2d<f32>;
@group(#{GROUP}) @binding(12) var light_sampler: sampler;
#endif

/// Visibility, 0 or 1, times fall-off and light texture at a point in the world, metres.
fn lit_at(light: Light, point: vec3<f32>) -> vec3<f32> {
#ifdef SHADOW_ARRAY
    let place = view_position(shadow_views, vec2<f32>(textureDimensions(shadow_maps)), point);
    let visibility = lit_by_shadow(shadow_in_view(shadow_maps, place, light.far_depth), light.far_depth);
#else
    let visibility = lit_by_shadow(shadow_in_map(shadow_map, light, point), light.far_depth);
#endif
    let lit = vec3<f32>(visibility * angular_falloff(light, direction_to_light(light, point)));
#ifdef LIGHT_TEXTURE
    return lit * light_texture_color(light, light_texture, light_sampler, point);
#else
    return lit;
#endif
}

#ifndef SHADOW_ARRAY
/// Mean visibility of a view ray of `distance` metres by marching one shadow map; faster than `marched_light`.
fn marched_visibility(
    light: Light, origin: vec3<f32>, direction: vec3<f32>, distance: f32, extinction: f32, steps: u32, offset: f32
) -> f32 {
    return march_shadow_map(shadow_map, light, origin, direction, distance, extinction, steps, offset);
}
#endif

/// Mean of `lit_at` over a view ray between two distances in metres, by equal steps, weighted by transmittance.
/// `extinction` in 1/m, 0 for the plain mean; `offset`: 0..1, where in each step the sample lies.
fn marched_light(
    light: Light, origin: vec3<f32>, direction: vec3<f32>, span: vec2<f32>, extinction: f32, steps: u32, offset: f32
) -> vec3<f32> {
    let taken = min(steps, MOST_MARCH_STEPS);
    let stride = (span.y - span.x) / f32(max(taken, 1u));
    var sum = vec3<f32>(0.0);
    var total = 0.0;
    for (var done = 0u; done < taken; done++) {
        let along = stride * (f32(done) + offset);
        let weight = exp(-min(extinction * stride * f32(done), 80.0));
        sum += weight * lit_at(light, origin + (span.x + along) * direction);
        total += weight;
    }
    return sum / max(total, 1.0);
}

/// Like `marched_light` for a light at a point, by steps of equal angle at the light, which the fall-off with distance
/// makes alike; weighted by the phase function of mean cosine `g` and by transmittance, unless `extinction` is zero.
/// `away`: metres from origin to light; `cosine`, `sine`: of the ray's angle to the light.
fn marched_local_light(
    light: Light, g: f32, origin: vec3<f32>, direction: vec3<f32>, away: f32, cosine: f32, sine: f32, span: vec2<f32>,
    extinction: f32, steps: u32, offset: f32
) -> vec3<f32> {
    let ray = local_ray(away, cosine, sine, light.radius);
    let taken = min(steps, MOST_MARCH_STEPS);
    let from_angle = equal_angle(ray, span.x);
    let stride = (equal_angle(ray, max(span.y, span.x)) - from_angle) / f32(max(taken, 1u));
    // Weights in units of the first step's: finite however deep the stretch lies.
    let first = path_through_air(ray, along_from_equal_angle(ray, from_angle + stride * offset));
    var sum = vec3<f32>(0.0);
    var total = 0.0;
    for (var done = 0u; done < taken; done++) {
        let along = along_from_equal_angle(ray, from_angle + stride * (f32(done) + offset));
        let phase = henyey_greenstein(cosine_to_light(ray, along), g);
        let air = exp(-clamp(extinction * (path_through_air(ray, along) - first), 0.0, 80.0));
        let weight = select(1.0, phase * air, extinction > 0.0);
        sum += weight * lit_at(light, origin + along * direction);
        total += weight;
    }
    return sum / max(total, 1e-30);
}
