// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::transmittance::light_space
// summary: Places in a transmittance map: texels across the light, and the depth along it.
// source: core/light for the clip space of a directional light.
// note: The map covers the clip space of a directional light's shadow map, whichever way depth runs in it. Depth is
// note: 0 on the near side of the range, 1 on the far side; the range d in metres is known from the matrix, and only
// note: what builds a map needs it. For volumes the near and far sides may lean, so that the range is short for a medium
// note: that stands askew to the light; particles want them across the light. At every depth the medium before the range is not known, and counts as clear.
// equation: map depth = clip depth, or 1 − clip depth where it is reversed;  d = |world_from_clip · (0, 0, 1, 0)| metres
// error: transmittance is the same within 1e-4 whichever way depth runs;
// error: test transmittance/volumes::depth_may_run_either_way_and_places_outside_are_lit.
// parameter clip_depth: 0..1 in the light's clip space, or in the map.
// parameter size: columns and rows of the map, texels.
// parameter point: metres in the world.
// parameter texels: position in the map, texel i at i + 0.5.
// parameter depth: 0..1 over the range.

#import airlight::core::light::{Light, shadow_position, shadow_point}

/// A depth of the light's clip space as a depth of the map or back: 0 near, 1 far.
fn forward_depth(light: Light, clip_depth: f32) -> f32 {
    return select(1.0 - clip_depth, clip_depth, light.far_depth > 0.5);
}

/// Position in texels and depth 0..1 of a point in the world, metres; outside of the map beyond these ranges.
fn map_position(light: Light, size: vec2<f32>, point: vec3<f32>) -> vec3<f32> {
    let at = shadow_position(light, size, point);
    return vec3<f32>(at.xy, forward_depth(light, at.z));
}

/// The point in the world, metres, at a position in texels and a depth 0..1.
fn map_point(light: Light, size: vec2<f32>, texels: vec2<f32>, depth: f32) -> vec3<f32> {
    return shadow_point(light, size, texels, forward_depth(light, depth));
}

/// The range d of the map, metres: how far apart depths 0 and 1 are.
fn map_range(light: Light) -> f32 {
    return length(light.world_from_clip[2].xyz);
}

/// Texels to the metre, across and down the map, whose sides lie across the light.
fn texels_per_metre(light: Light, size: vec2<f32>) -> vec2<f32> {
    let across = vec2<f32>(length(light.world_from_clip[0].xyz), length(light.world_from_clip[1].xyz));
    return 0.5 * size / max(across, vec2<f32>(1e-12));
}
