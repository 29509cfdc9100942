// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::stylize::tf_lookup
// summary: Transfer functions: two properties of a view ray are looked up in a texture, which says what its light looks like.
// source: stylized scattering, 4.2; thesis 6.2.2; X-Toon, Barla, Thollot and Markosian (2006).
// note: The function is a square texture of premultiplied linear RGBA, x to the right and y downwards, both 0..1; alpha says
// note: how much of the physically based light it replaces.
// note: The last property, the mean place of what is lit, costs a march where visibility was pre-filtered: callers that have
// note: no use for it leave it at zero.
// equation: properties: V̄;  s / limit;  θ / π;  fract(atan2(y, x) / 2π);  s̄ / limit, cut to 0..1
// equation: L' = L (1 − strength α) + strength brightness c tint;  tint: 4π p, E p or L by mode
// error: properties: visibility within 1e-6, depth 1e-4, angles 5e-4 and 1e-4;
// error: test stylize/transfer/restyling::rays_lie_where_their_properties_say.
// error: restyled light within 2e-3; test stylize/transfer/restyling::every_mode_makes_of_a_colour_what_it_should.
// parameter property: MEAN_VISIBILITY to VISIBLE_DEPTH.
// parameter ndc: normalised device coordinates, -1..1.
// parameter depth_limit: metres, above 0.
// parameter position: 0..1 in x and y.
// parameter map: premultiplied linear RGBA.
// parameter map_sampler: linear, clamped to the edge.
// parameter cosine: -1..1.
// parameter phase: 1/sr.
// parameter radiance, light_radiance: linear RGB, from 0 up.

#import airlight::core::arc_cosine::arc_cosine
#import airlight::core::camera::Camera
#import airlight::core::finite::{finite_or, finite_or_rgb}
#import airlight::core::light::{Light, DIRECTIONAL}
#import airlight::core::phase::{henyey_greenstein, ISOTROPIC}

/// Property of a ray: its mean visibility, 0..1.
const MEAN_VISIBILITY: u32 = 0u;
/// Property of a ray: its length, 0 at the eye and 1 at the depth limit and beyond.
const LINEAR_DEPTH: u32 = 1u;
/// Property of a ray: its angle to the direction towards the light, 0 looking at the light and 1 away from it.
const LIGHT_ANGLE: u32 = 2u;
/// Property of a ray: where the light lies in the picture as seen from its pixel; 0 to the right, 1/4 above, up to 1.
const PICTURE_ANGLE: u32 = 3u;
/// Property of a ray: mean distance of its lit points, as LINEAR_DEPTH.
const VISIBLE_DEPTH: u32 = 4u;

/// The function's colour stands for the scattered light.
const REPLACE: u32 = 0u;
/// The function's colour stands for albedo and visibility: it is multiplied by the light's radiance and the phase function.
const LIGHT: u32 = 1u;
/// The function's colour is multiplied by the scattered light.
const SCATTERING: u32 = 2u;

/// The phase function is the same in every direction.
const CONSTANT: u32 = 0u;
/// The phase function of Henyey and Greenstein.
const HENYEY_GREENSTEIN: u32 = 1u;

/// How a transfer function is read and what is made of it. 32 bytes.
struct TransferFunction {
    /// The property of the ray along x: MEAN_VISIBILITY, LINEAR_DEPTH, LIGHT_ANGLE, PICTURE_ANGLE or VISIBLE_DEPTH.
    across: u32,
    /// The property along y.
    down: u32,
    /// REPLACE, LIGHT or SCATTERING.
    mode: u32,
    /// CONSTANT or HENYEY_GREENSTEIN; the mode SCATTERING has that of the scattered light.
    phase: u32,
    /// Length of ray that counts as 1, metres, positive.
    depth_limit: f32,
    /// How much of it is shown, 0..1.
    strength: f32,
    /// Factor on the function's colours, not negative.
    brightness: f32,
    /// Mean cosine of the Henyey-Greenstein phase function, -0.999..0.999.
    g: f32,
}

/// Properties of a view ray.
struct RayProperties {
    /// Mean visibility, 0..1.
    visibility: f32,
    /// Length, metres.
    distance: f32,
    /// View direction times direction towards the light, -1..1.
    cosine: f32,
    /// Angle in the picture from its x axis to the direction towards the light, radians, counter-clockwise.
    picture_angle: f32,
    /// Mean distance of the lit points, metres.
    visible_distance: f32,
}

/// Angle in the picture from its x axis to the direction towards the light at `ndc`, radians, -pi..pi, counter-clockwise;
/// 0 right at the light. It does not jump where the light passes beside the camera.
fn picture_angle(camera: Camera, light: Light, ndc: vec2<f32>) -> f32 {
    let infinite = light.kind == DIRECTIONAL;
    let place = select(vec4<f32>(light.position, 1.0), vec4<f32>(light.direction, 0.0), infinite);
    let clip = camera.clip_from_world * place;
    let towards = (clip.xy - ndc * clip.w) * camera.viewport;
    let at_light = all(abs(towards) < vec2<f32>(1e-30));
    return atan2(select(towards.y, 0.0, at_light), select(towards.x, 1.0, at_light));
}

/// A property of a ray, 0..1. `depth_limit`: metres.
fn ray_property(property: u32, ray: RayProperties, depth_limit: f32) -> f32 {
    let limit = clamp(depth_limit, 1e-6, 1e15);
    let turns = ray.picture_angle * 0.15915494309189535;
    var value = ray.visibility;
    value = select(value, ray.distance / limit, property == LINEAR_DEPTH);
    value = select(value, arc_cosine(ray.cosine) * 0.3183098861837907, property == LIGHT_ANGLE);
    value = select(value, turns - floor(turns), property == PICTURE_ANGLE);
    value = select(value, ray.visible_distance / limit, property == VISIBLE_DEPTH);
    return clamp(finite_or(value, 0.0), 0.0, 1.0);
}

/// Where a ray lies in the function, 0..1 in x and y.
fn transfer_position(function: TransferFunction, ray: RayProperties) -> vec2<f32> {
    return vec2<f32>(
        ray_property(function.across, ray, function.depth_limit), ray_property(function.down, ray, function.depth_limit)
    );
}

/// The function at `position`, 0..1: premultiplied linear RGBA. `map`: any float format that filters; `map_sampler`:
/// linear, clamped to the edge. Non-finite texels are transparent.
fn transfer_lookup(map: texture_2d<f32>, map_sampler: sampler, position: vec2<f32>) -> vec4<f32> {
    let color = textureSampleLevel(map, map_sampler, clamp(position, vec2<f32>(0.0), vec2<f32>(1.0)), 0.0);
    let rgb = clamp(finite_or_rgb(color.rgb, 0.0), vec3<f32>(0.0), vec3<f32>(65504.0));
    return vec4<f32>(rgb, clamp(finite_or(color.a, 0.0), 0.0, 1.0));
}

/// The function's phase function, 1/sr. `cosine`: view direction times direction towards the light.
fn transfer_phase(function: TransferFunction, cosine: f32) -> f32 {
    return select(ISOTROPIC, henyey_greenstein(cosine, function.g), function.phase == HENYEY_GREENSTEIN);
}

/// Scattered light as the function has it: linear RGB radiance. `color`: of the function, premultiplied; `radiance`:
/// scattered into the ray; `light_radiance`: of the light; `phase`: what `transfer_phase` gives, 1/sr.
fn stylized(
    function: TransferFunction, color: vec4<f32>, radiance: vec3<f32>, light_radiance: vec3<f32>, phase: f32
) -> vec3<f32> {
    // A constant phase function leaves the colours of REPLACE as they are.
    var tint = vec3<f32>(phase / ISOTROPIC);
    tint = select(tint, clamp(light_radiance, vec3<f32>(0.0), vec3<f32>(1e15)) * phase, function.mode == LIGHT);
    tint = select(tint, radiance, function.mode == SCATTERING);
    let strength = clamp(function.strength, 0.0, 1.0);
    let kept = radiance * (1.0 - strength * color.a);
    let added = color.rgb * tint * (strength * clamp(function.brightness, 0.0, 65504.0));
    return clamp(kept + added, vec3<f32>(0.0), vec3<f32>(65504.0));
}
