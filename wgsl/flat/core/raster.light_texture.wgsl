// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: core/raster, permutation light_texture (LIGHT_TEXTURE)
// summary: Draws meshes: shadow maps from the light, a lit picture with depth from the camera, a sky behind it.
// source: Lambert's cosine law; percentage-closer filtering, Reeves et al. (1987).
// note: Any camera: forward, reversed and infinite depth differ in the clear value and the comparison of the pipeline.
// note: With several samples a pixel is lit once. Light reaches surfaces through clear air.
// definition LIGHT_TEXTURE: a texture colours the light.
// binding camera: the camera, world in metres.
// binding light: the light and its shadow map's clip space.
// binding sky: linear RGB radiance of the sky and the ground.
// binding shadow_map: depth of the standard shadow map, depth32float; of a directional light or a spot.
// binding shadow_sampler: comparison sampler, less-equal for forward depth.
// binding light_texture: linear RGB 0..1 over the whole shadow map of a directional light or a spot, any float format that filters; with LIGHT_TEXTURE only.
// binding light_sampler: linear, clamped to the edge; with LIGHT_TEXTURE only.

// ---- airlight::core::camera ----
// summary: View rays, distances and frustum planes from a camera's matrices, for any depth convention.
// source: homogeneous unprojection; planes after Gribb and Hartmann, "Fast extraction of viewing frustum planes" (2001).

/// Orthographic projection: view rays are parallel and leave the near plane.
const ORTHOGRAPHIC: u32 = 1u;

/// A camera, as an engine hands it over. 160 bytes.
struct Camera {
    /// View-projection matrix, world to clip.
    clip_from_world: mat4x4<f32>,
    /// Its inverse, clip to world.
    world_from_clip: mat4x4<f32>,
    /// Position of the eye in the world, metres; unused by an orthographic camera.
    eye: vec3<f32>,
    /// Clip depth of the near plane: 0 forward, 1 reversed.
    near_depth: f32,
    /// Width and height of the picture in pixels.
    viewport: vec2<f32>,
    /// Clip depth of the far plane: 1 forward, 0 reversed.
    far_depth: f32,
    /// PERSPECTIVE or ORTHOGRAPHIC.
    projection: u32,
}

/// A view ray: world-space origin in metres, unit direction.
struct Ray {
    /// Where it starts in the world, metres.
    origin: vec3<f32>,
    /// Unit vector, away from the eye.
    direction: vec3<f32>,
}

/// Normalised device coordinates of a position in pixels: (0, 0) is the top left corner of the picture.
fn ndc_from_pixel(camera: Camera, pixel: vec2<f32>) -> vec2<f32> {
    return vec2<f32>(2.0, -2.0) * pixel / camera.viewport + vec2<f32>(-1.0, 1.0);
}

/// The view ray through `ndc`, of any camera.
fn view_ray(camera: Camera, ndc: vec2<f32>) -> Ray {
    // Values, not branches: some drivers compile a shader anew for every value of a uniform that a branch depends on.
    let parallel = camera.projection == ORTHOGRAPHIC;
    let far = camera.world_from_clip * vec4<f32>(ndc, camera.far_depth, 1.0);
    let near = camera.world_from_clip * vec4<f32>(ndc, camera.near_depth, 1.0);
    let origin = select(camera.eye, near.xyz / select(1.0, near.w, parallel), parallel);
    // With w = 0 (infinite far plane) far.xyz is the direction itself.
    return Ray(origin, normalize(far.xyz - select(camera.eye * far.w, near.xyz, parallel)));
}

/// Vector from `point`, metres in the world, TOWARDS the viewer, of any length: to the eye, or against the parallel
/// rays of an orthographic camera.
fn towards_viewer(camera: Camera, point: vec3<f32>) -> vec3<f32> {
    let parallel = camera.world_from_clip[2].xyz * (camera.near_depth - camera.far_depth);
    return select(camera.eye - point, parallel, camera.projection == ORTHOGRAPHIC);
}

// ---- airlight::core::finite ----
// summary: Replaces NaN and infinities in data that comes from outside.
// source: IEEE 754 binary32: all exponent bits set means NaN or infinity.

/// True if `x` is neither NaN nor infinite.
fn is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u;
}

/// `x` where it is finite, `fallback` elsewhere.
fn finite_or(x: f32, fallback: f32) -> f32 {
    return select(fallback, x, is_finite(x));
}

/// Like `finite_or`, each component by itself.
fn finite_or_rgb(x: vec3<f32>, fallback: f32) -> vec3<f32> {
    return vec3<f32>(finite_or(x.x, fallback), finite_or(x.y, fallback), finite_or(x.z, fallback));
}

// ---- airlight::core::light ----
// summary: A light, its fall-off and texture, and the clip space of its standard shadow map.
// source: thesis 4.2.1; a point source seen through a cone and softened by its radius.

/// A light at infinity: all light rays are parallel.
const DIRECTIONAL: u32 = 0u;
/// A light at a point that shines into a cone.
const SPOT: u32 = 1u;

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

/// Position in texels of the shadow map, and depth, of a point in the world, metres; a point behind a spot is carried
/// outside the map. `size`: of the map in texels.
fn shadow_position(light: Light, size: vec2<f32>, point: vec3<f32>) -> vec3<f32> {
    return texels_from_clip(light.clip_from_world * vec4<f32>(point, 1.0), size);
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

// ---- core/raster ----

/// Radiance of the surroundings, linear RGB. 48 bytes.
struct Sky {
    /// Straight up.
    zenith: vec3<f32>,
    reserved_a: f32,
    /// At the horizon.
    horizon: vec3<f32>,
    reserved_b: f32,
    /// From below, onto surfaces that face down.
    ground: vec3<f32>,
    reserved_c: f32,
}

struct Varyings {
    @builtin(position) position: vec4<f32>,
    @location(0) world: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) albedo: vec3<f32>,
}

@group(0) @binding(0) var<uniform> camera: Camera;
@group(0) @binding(1) var<uniform> light: Light;
@group(0) @binding(2) var<uniform> sky: Sky;
@group(0) @binding(4) var shadow_sampler: sampler_comparison;
@group(0) @binding(3) var shadow_map: texture_depth_2d;
@group(0) @binding(6) var light_texture: texture_2d<f32>;
@group(0) @binding(7) var light_sampler: sampler;

@vertex
fn vertex_shadow(@location(0) position: vec3<f32>) -> @builtin(position) vec4<f32> {
    return light.clip_from_world * vec4<f32>(position, 1.0);
}

@vertex
fn vertex_surface(
    @location(0) position: vec3<f32>, @location(1) normal: vec3<f32>, @location(2) albedo: vec3<f32>
) -> Varyings {
    return Varyings(camera.clip_from_world * vec4<f32>(position, 1.0), position, normal, albedo);
}

/// Clip position of a surface point, moved off the surface by the footprint of the filter, which hides the staircase of
/// the map. `clip_from_world`: of the map; `width`: of the map in texels.
fn shadow_clip(clip_from_world: mat4x4<f32>, width: f32, point: vec3<f32>, normal: vec3<f32>) -> vec4<f32> {
    // Of a light at a point it grows towards the corners of a wide view.
    let wider = select(1.5, 1.0, light.kind == DIRECTIONAL);
    let texel = wider * metres_of_texel(clip_from_world, width, point);
    let towards = direction_to_light(light, point);
    return clip_from_world * vec4<f32>(point + normal * (1.5 * texel) + towards * texel, 1.0);
}

/// Lit fraction of a surface point, 0..1, over 3x3 texels.
fn surface_visibility(point: vec3<f32>, normal: vec3<f32>) -> f32 {
    let size = vec2<f32>(textureDimensions(shadow_map));
    let at = texels_from_clip(shadow_clip(light.clip_from_world, size.x, point, normal), size);
    let inside = all(at.xy >= vec2<f32>(0.0)) && all(at.xy <= size);
    var lit = 0.0;
    for (var tap = 0; tap < 9; tap++) {
        let offset = vec2<f32>(f32(tap % 3 - 1), f32(tap / 3 - 1));
        lit += textureSampleCompareLevel(shadow_map, shadow_sampler, (at.xy + offset) / size, at.z);
    }
    return select(1.0, lit / 9.0, inside);
}

@fragment
fn fragment_surface(varyings: Varyings) -> @location(0) vec4<f32> {
    // Both faces are lit, since leaves and terrain are single sheets: the normal is turned to the side of the
    // triangle that is seen. The interpolated normal alone would flip at silhouettes.
    let triangle = cross(dpdx(varyings.world), dpdy(varyings.world));
    let seen = select(-triangle, triangle, dot(triangle, towards_viewer(camera, varyings.world)) >= 0.0);
    let unit = varyings.normal / max(length(varyings.normal), 1e-6);
    let normal = select(-unit, unit, dot(unit, seen) >= 0.0);
    let cosine = max(dot(normal, direction_to_light(light, varyings.world)), 0.0);
    let visibility = surface_visibility(varyings.world, normal);
    var irradiance = light.radiance * (cosine * visibility * light_falloff(light, varyings.world));
    irradiance *= light_texture_color(light, light_texture, light_sampler, varyings.world);
    let up = 0.5 + 0.5 * normal.y;
    let ambient = mix(sky.ground, 0.5 * (sky.zenith + sky.horizon), up);
    // Outgoing radiance of a Lambertian surface: albedo / pi times irradiance; that of the sky is pi times its radiance.
    return vec4<f32>(min(varyings.albedo * (irradiance / 3.141592653589793 + ambient), vec3<f32>(65504.0)), 1.0);
}

/// One triangle over the whole picture, at the far plane.
@vertex
fn vertex_background(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    let corner = vec2<f32>(f32(index & 1u), f32(index >> 1u)) * 4.0 - 1.0;
    return vec4<f32>(corner, camera.far_depth, 1.0);
}

@fragment
fn fragment_background(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let direction = view_ray(camera, ndc_from_pixel(camera, position.xy)).direction;
    let up = direction.y;
    let above = mix(sky.horizon, sky.zenith, sqrt(clamp(up, 0.0, 1.0)));
    let below = mix(sky.horizon, sky.ground, smoothstep(0.0, 0.12, -up));
    return vec4<f32>(select(below, above, up >= 0.0), 1.0);
}
