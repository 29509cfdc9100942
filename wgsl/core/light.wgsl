// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::core::light
// summary: A light and the clip space of its standard shadow map.
// source: thesis 4.2.1.

/// A light at infinity: all light rays are parallel.
const DIRECTIONAL: u32 = 0u;
/// A light at a point that shines into a cone.
const SPOT: u32 = 1u;
/// A light at a point that shines everywhere.
const POINT: u32 = 2u;

/// A light and its standard shadow map. 192 bytes.
struct Light {
    /// World to the shadow map's clip space; affine for a directional light, unused with an array of shadow maps.
    clip_from_world: mat4x4<f32>,
    /// Its inverse.
    world_from_clip: mat4x4<f32>,
    /// Unit vector TOWARDS a directional light; of a spot, the reverse of the axis along which it shines.
    direction: vec3<f32>,
    /// Depth of an empty texel of the shadow map, farthest from the light: 1 forward, 0 reversed.
    far_depth: f32,
    /// Linear RGB: for a directional light the irradiance at normal incidence; for one at a point its radiant
    /// intensity, the irradiance at a distance of one metre.
    radiance: vec3<f32>,
    /// DIRECTIONAL, SPOT or POINT.
    kind: u32,
    /// Where a spot or point light is, metres.
    position: vec3<f32>,
    /// Radius of a spot or point light, metres, positive: nearer to it the fall-off with distance stops.
    radius: f32,
    /// Cosines of the half angles inside which a spot shines fully, and outside which not at all.
    spot_cosines: vec2<f32>,
    reserved_a: f32,
    reserved_b: f32,
}

/// Position in texels of the shadow map, and depth, of a point in the world. `size`: of the map in texels.
fn shadow_position(light: Light, size: vec2<f32>, point: vec3<f32>) -> vec3<f32> {
    let clip = light.clip_from_world * vec4<f32>(point, 1.0);
    return vec3<f32>((clip.xy * vec2<f32>(0.5, -0.5) + 0.5) * size, clip.z);
}

/// The point in the world at a position in texels and a depth of the shadow map.
fn shadow_point(light: Light, size: vec2<f32>, texels: vec2<f32>, depth: f32) -> vec3<f32> {
    let ndc = (texels / size) * vec2<f32>(2.0, -2.0) + vec2<f32>(-1.0, 1.0);
    return (light.world_from_clip * vec4<f32>(ndc, depth, 1.0)).xyz;
}
