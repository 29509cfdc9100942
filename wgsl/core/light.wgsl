// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::core::light
// summary: A light, its fall-off and texture, and the clip space of its standard shadow map.
// source: thesis 4.2.1; a point source seen through a cone and softened by its radius.
// note: The matrix of a directional light is affine, that of a spot a perspective projection from its position.
// note: Kinds are told apart by values, not branches: some drivers compile a shader anew for every value of a uniform
// note: that a branch depends on.
// equation: falloff = angular(ω) / (d² + radius²);  angular = u² (3 − 2u),  u = (cos − cos_outer) / (cos_inner − cos_outer), cut to 0..1
// equation: texel = ((x / w · ½ + ½) width, (½ − y / w · ½) height), depth = z / w
// error: places within 5e-7 of the map, 1e-6 back; test core/light::points_go_to_the_shadow_map_and_back.
// error: direction within 4e-5, angular fall-off 2e-6 of its steepness, the whole 4e-6;
// error: test core/light::light_falls_off_by_cones_and_inverse_squares.
// error: metres of a texel within 1e-6 relative; test core/light::texels_are_as_wide_as_what_they_hold.
// parameter clip: homogeneous clip coordinates of the map.
// parameter texels: position in texels, (0, 0) the top left corner.
// parameter depth: 0..1, in the map's convention.
// parameter point: metres in the world.
// parameter size: columns and rows of the map, texels.

#import airlight::core::finite::finite_or_rgb

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

/// Unit vector from `point`, metres in the world, TOWARDS the light; zero where a light at a point is right there.
fn direction_to_light(light: Light, point: vec3<f32>) -> vec3<f32> {
    let between = light.position - point;
    let local = between * inverseSqrt(max(dot(between, between), 1e-30));
    return select(local, light.direction, light.kind == DIRECTIONAL);
}

/// Angular fall-off, 0..1, along the light ray with the unit vector `towards` TOWARDS the light: of a spot 1 inside
/// the inner cone, 0 outside the outer one, smooth between; of every other light 1.
fn angular_falloff(light: Light, towards: vec3<f32>) -> f32 {
    // Not smoothstep: WGSL leaves it open what that is between two equal edges.
    let above = dot(towards, light.direction) - light.spot_cosines.y;
    let unit = clamp(above / max(light.spot_cosines.x - light.spot_cosines.y, 1e-6), 0.0, 1.0);
    return select(1.0, unit * unit * (3.0 - 2.0 * unit), light.kind == SPOT);
}

/// What `radiance` is multiplied by to give the irradiance at normal incidence of `point`, metres in the world, in clear
/// air without blockers: 1 for a directional light, else `angular_falloff` over the square of the distance in 1/m^2,
/// softened by the light's radius.
fn light_falloff(light: Light, point: vec3<f32>) -> f32 {
    let between = light.position - point;
    let square = dot(between, between) + light.radius * light.radius;
    let local = angular_falloff(light, direction_to_light(light, point)) / max(square, 1e-12);
    return select(local, 1.0, light.kind == DIRECTIONAL);
}

/// Position in texels of a map, and depth, of a point in the clip space of that map; a point at or behind the light
/// (w <= 0) is carried outside the map. `size`: of the map in texels.
fn texels_from_clip(clip: vec4<f32>, size: vec2<f32>) -> vec3<f32> {
    let before = clip.w > 0.0;
    let ndc = clip.xyz / select(1.0, clip.w, before);
    return select(vec3<f32>(-size, 0.0), vec3<f32>((ndc.xy * vec2<f32>(0.5, -0.5) + 0.5) * size, ndc.z), before);
}

/// The point in the world, metres, at a position in texels and a depth 0..1 of a map with the matrix
/// `world_from_clip`. `size`: of the map in texels.
fn point_from_texels(world_from_clip: mat4x4<f32>, size: vec2<f32>, texels: vec2<f32>, depth: f32) -> vec3<f32> {
    let ndc = (texels / size) * vec2<f32>(2.0, -2.0) + vec2<f32>(-1.0, 1.0);
    let point = world_from_clip * vec4<f32>(ndc, depth, 1.0);
    return point.xyz / max(point.w, 1e-12);
}

/// Position in texels of the shadow map, and depth, of a point in the world, metres; a point behind a spot is carried
/// outside the map. `size`: of the map in texels.
fn shadow_position(light: Light, size: vec2<f32>, point: vec3<f32>) -> vec3<f32> {
    return texels_from_clip(light.clip_from_world * vec4<f32>(point, 1.0), size);
}

/// The point in the world, metres, at a position in texels and a depth 0..1 of the shadow map.
fn shadow_point(light: Light, size: vec2<f32>, texels: vec2<f32>, depth: f32) -> vec3<f32> {
    return point_from_texels(light.world_from_clip, size, texels, depth);
}

/// Side of a texel of a map with the matrix `clip_from_world` where it holds `point`, metres across the light. `width`: of the map in
/// texels.
fn metres_of_texel(clip_from_world: mat4x4<f32>, width: f32, point: vec3<f32>) -> f32 {
    let growth = max((clip_from_world * vec4<f32>(point, 1.0)).w, 0.0);
    let across = vec3<f32>(clip_from_world[0].x, clip_from_world[1].x, clip_from_world[2].x);
    return 2.0 * growth / max(width * length(across), 1e-30);
}

/// What a light texture (gobo) lets through, linear RGB 0..1, towards `point`, metres in the world. `map`: any float
/// format that filters, stretched over the whole shadow map; `map_sampler`: linear, clamped to the edge. Outside it a
/// directional light goes by unhindered and a spot is dark. Non-finite texels are dark.
fn light_texture_color(
    light: Light, map: texture_2d<f32>, map_sampler: sampler, point: vec3<f32>
) -> vec3<f32> {
    let uv = shadow_position(light, vec2<f32>(1.0), point).xy;
    let inside = all(uv >= vec2<f32>(0.0)) && all(uv <= vec2<f32>(1.0));
    let outside = select(0.0, 1.0, light.kind == DIRECTIONAL);
    let color = finite_or_rgb(textureSampleLevel(map, map_sampler, uv, 0.0).rgb, 0.0);
    return select(vec3<f32>(outside), clamp(color, vec3<f32>(0.0), vec3<f32>(1.0)), inside);
}
