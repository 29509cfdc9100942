// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: stylize/transfer, permutation pick_visible_depth_views (PICK SHADOW_ARRAY VISIBLE_DEPTH)
// summary: Scattered light of every pixel, of any method, as a transfer function has it; or where pixels lie in the function.
// source: stylized scattering, 4.2; thesis 6.2.2.
// note: The angle to a light at a point is that at the camera.
// note: Non-finite values of the scattered light count as 0, such depths as far.
// definition PICK: instead of a picture, constraints that name a pixel are given its position.
// definition VISIBLE_DEPTH: marches the shadow map for the mean distance of a ray's lit points.
// definition SHADOW_ARRAY: with VISIBLE_DEPTH, shadow maps of several views.
// binding camera: the camera, any.
// binding light: the light.
// binding transfer_function: what is looked up, and what is made of it.
// binding depth: depth buffer of the picture, a depth format or r32float.
// binding scattered: what a scattering method wrote: linear RGB radiance, and in alpha the mean visibility 0..1.
// binding shadow_maps: depth of the views, a layer each; with VISIBLE_DEPTH and SHADOW_ARRAY.
// binding shadow_views: the views; with VISIBLE_DEPTH and SHADOW_ARRAY.
// binding constraints: whose positions are written where they name a pixel; with PICK only.

// ---- airlight::core::arc_cosine ----
// summary: The angle whose cosine is given, as exact as its cosine.
// source: acos(x) = atan2(sqrt(1 - x^2), x), by which the WGSL specification bounds the error of acos.

/// Radians 0..pi; a cosine outside -1..1 counts as the nearer end.
fn arc_cosine(cosine: f32) -> f32 {
    let held = clamp(cosine, -1.0, 1.0);
    return atan2(sqrt((1.0 - held) * (1.0 + held)), held);
}

// ---- airlight::core::camera ----
// summary: View rays, distances and frustum planes from a camera's matrices, for any depth convention.
// source: homogeneous unprojection; planes after Gribb and Hartmann, "Fast extraction of viewing frustum planes" (2001).

/// Perspective projection: all view rays leave the eye.
const PERSPECTIVE: u32 = 0u;
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

/// Position in texels of a map, and depth, of a point in the clip space of that map; a point at or behind the light
/// (w <= 0) is carried outside the map. `size`: of the map in texels.
fn texels_from_clip(clip: vec4<f32>, size: vec2<f32>) -> vec3<f32> {
    let before = clip.w > 0.0;
    let ndc = clip.xyz / select(1.0, clip.w, before);
    return select(vec3<f32>(-size, 0.0), vec3<f32>((ndc.xy * vec2<f32>(0.5, -0.5) + 0.5) * size, ndc.z), before);
}

// ---- airlight::core::ray_depth ----
// summary: Distance along one view ray from depth-buffer values and back, for any camera, in a few operations each.
// source: homogeneous unprojection: on a view ray numerator and denominator of the distance are affine in the depth.

/// Distance over depth on one view ray: (along + along_slope x) / (w + w_slope x), x = depth - far_depth.
struct RayDepth {
    /// Homogeneous distance at the far plane, metres times w.
    along: f32,
    /// Its change per depth; 0 for a perspective camera.
    along_slope: f32,
    /// Homogeneous w at the far plane; 0 where that is at infinity.
    w: f32,
    /// Its change per depth; 0 for an orthographic camera.
    w_slope: f32,
    /// Clip depth of the far plane.
    far_depth: f32,
    /// Clip depth of the near plane.
    near_depth: f32,
}

/// What turns depths into distances on `ray`, the view ray through `ndc`.
fn ray_depth(camera: Camera, ray: Ray, ndc: vec2<f32>) -> RayDepth {
    let far = camera.world_from_clip * vec4<f32>(ndc, camera.far_depth, 1.0);
    let column = camera.world_from_clip[2];
    let along = dot(far.xyz - ray.origin * far.w, ray.direction);
    let slope = dot(column.xyz - ray.origin * column.w, ray.direction);
    // From the eye the product is the same at every depth: what is left of its slope is rounding.
    let perspective = camera.projection == PERSPECTIVE;
    return RayDepth(along, select(slope, 0.0, perspective), far.w, column.w, camera.far_depth, camera.near_depth);
}

/// Distance in metres along the ray at `depth`, 0..1; at most `limit`, which also stands for infinity.
fn distance_on_ray(ray: RayDepth, depth: f32, limit: f32) -> f32 {
    let beyond_far = depth - ray.far_depth;
    let along = ray.along + ray.along_slope * beyond_far;
    let w = ray.w + ray.w_slope * beyond_far;
    let beyond = along >= limit * w;
    return select(max(along / select(w, 1.0, beyond), 0.0), limit, beyond);
}

// ---- airlight::core::shadow_views ----
// summary: Several shadow maps of one light in an array: cascades of a directional light, faces around a point light.
// source: F. Zhang et al., "Parallel-split shadow maps for large-scale virtual environments" (2006); F. Crow (1977).

/// The views of an array of shadow maps. 784 bytes.
struct ShadowViews {
    /// World to the clip space of each view: affine for cascades, perspective for the faces around a point light.
    clip_from_world: array<mat4x4<f32>, 6>,
    /// Their inverses.
    world_from_clip: array<mat4x4<f32>, 6>,
    /// Number of views, 1..6; the matrices beyond are unused.
    count: u32,
    reserved_a: u32,
    reserved_b: u32,
    reserved_c: u32,
}

/// Where a light ray lies in an array of shadow maps.
struct ViewPosition {
    /// Position in texels of the layer (x right, y down), and depth; outside every view any finite value.
    at: vec3<f32>,
    /// Layer of the array, 0..5; 0 outside every view.
    view: u32,
    /// 1 where a view contains the light ray, else 0.
    inside: u32,
}

/// A position in clip space and its view, while views are tried in turn.
struct ClipInView {
    /// Clip space of the view.
    clip: vec4<f32>,
    /// The view, 0..5.
    view: u32,
    /// 1 where the view contains it, else 0.
    inside: u32,
}

/// True where `clip`, a position in a view's clip space, lies before the light and within the map.
fn view_contains(clip: vec4<f32>) -> bool {
    return clip.w > 0.0 && abs(clip.x) <= clip.w && abs(clip.y) <= clip.w;
}

/// `found`, unless it is outside and view `view` of `count` contains `point` (world, metres, w = 1).
fn or_in_view(found: ClipInView, view: u32, count: u32, clip_from_world: mat4x4<f32>, point: vec4<f32>) -> ClipInView {
    let clip = clip_from_world * point;
    let taken = found.inside == 0u && view < count && view_contains(clip);
    return ClipInView(
        select(found.clip, clip, taken), select(found.view, view, taken), select(found.inside, 1u, taken)
    );
}

/// The first view that contains the light ray through `point`, metres in the world, and its position in clip space.
fn clip_in_views(views: ShadowViews, point: vec3<f32>) -> ClipInView {
    let p = vec4<f32>(point, 1.0);
    var found = ClipInView(vec4<f32>(0.0, 0.0, 0.0, 1.0), 0u, 0u);
    found = or_in_view(found, 0u, views.count, views.clip_from_world[0], p);
    found = or_in_view(found, 1u, views.count, views.clip_from_world[1], p);
    found = or_in_view(found, 2u, views.count, views.clip_from_world[2], p);
    found = or_in_view(found, 3u, views.count, views.clip_from_world[3], p);
    found = or_in_view(found, 4u, views.count, views.clip_from_world[4], p);
    return or_in_view(found, 5u, views.count, views.clip_from_world[5], p);
}

/// Where the light ray through `point`, metres in the world, lies in the array, and the depth of the point there.
/// `size`: of a layer in texels. A local light's ray is found by any point on it, such as its position plus a direction.
fn view_position(views: ShadowViews, size: vec2<f32>, point: vec3<f32>) -> ViewPosition {
    let found = clip_in_views(views, point);
    return ViewPosition(texels_from_clip(found.clip, size), found.view, found.inside);
}

// ---- airlight::scattering::shadow_lookup ----
// summary: Blocker and visibility of a single light ray, in one shadow map or in an array of views, of any light.
// source: L. Williams, "Casting curved shadows on curved surfaces" (1978).

/// A texel of a shadow map, on the way from a point in the world.
struct Shadow {
    /// Depth of the point itself.
    depth: f32,
    /// Depth of the blocker, 0..1; that of an empty texel where there is none.
    stored: f32,
    /// 1 where there is a blocker on this light ray, nearer to the light or not, else 0.
    blocked: u32,
}

/// Like `shadow_in_map`, in the layer of an array that `place`, from `view_position`, names. `far_depth`: of an empty texel.
fn shadow_in_view(maps: texture_2d_array<f32>, place: ViewPosition, far_depth: f32) -> Shadow {
    let last = vec2<f32>(textureDimensions(maps)) - 1.0;
    let texel = vec2<u32>(clamp(place.at.xy, vec2<f32>(0.0), last));
    let stored = clamp(finite_or(textureLoad(maps, texel, place.view, 0).x, far_depth), 0.0, 1.0);
    return Shadow(place.at.z, stored, select(0u, place.inside, stored != far_depth));
}

/// 1 where the point is lit, else 0. `far_depth`: of an empty texel, 1 forward, 0 reversed.
fn lit_by_shadow(shadow: Shadow, far_depth: f32) -> f32 {
    // Depth must grow away from the light for the comparison.
    let facing = select(-1.0, 1.0, far_depth > 0.5);
    return select(0.0, 1.0, shadow.blocked == 0u || shadow.depth * facing <= shadow.stored * facing);
}

// ---- airlight::scattering::lit ----
// summary: Callback: the light that reaches a point, and its mean over a view ray by marching, from a pass' bindings.
// source: thesis 2.4.4, Eq. 2.20; 4.2.1; C. Kulla and M. Fajardo, "Importance sampling techniques for path tracing in participating media" (2012).

@group(0) @binding(6) var shadow_maps: texture_2d_array<f32>;
@group(0) @binding(10) var<uniform> shadow_views: ShadowViews;

/// Visibility, 0 or 1, times fall-off and light texture at a point in the world, metres.
fn lit_at(light: Light, point: vec3<f32>) -> vec3<f32> {
    let place = view_position(shadow_views, vec2<f32>(textureDimensions(shadow_maps)), point);
    let visibility = lit_by_shadow(shadow_in_view(shadow_maps, place, light.far_depth), light.far_depth);
    let lit = vec3<f32>(visibility * angular_falloff(light, direction_to_light(light, point)));
    return lit;
}

// ---- airlight::stylize::tf_diffuse ----
// summary: Colours of a few constraints spread over a square: Laplace's equation by multigrid, in parts.
// source: thesis 6.2.2; orthogonal aggregation: Trottenberg, Oosterlee and Schueller, "Multigrid" (2001), 2.8 and A.4.

/// A colour at a place. 32 bytes.
struct Constraint {
    /// Premultiplied linear RGBA.
    color: vec4<f32>,
    /// Its position, 0..1 in x to the right and y downwards.
    position: vec2<f32>,
    /// The pixel of the picture whose ray gives the position, or negative where that is given.
    pixel: vec2<f32>,
}

// ---- airlight::stylize::tf_lookup ----
// summary: Transfer functions: two properties of a view ray are looked up in a texture, which says what its light looks like.
// source: stylized scattering, 4.2; thesis 6.2.2; X-Toon, Barla, Thollot and Markosian (2006).

/// Property of a ray: its length, 0 at the eye and 1 at the depth limit and beyond.
const LINEAR_DEPTH: u32 = 1u;
/// Property of a ray: its angle to the direction towards the light, 0 looking at the light and 1 away from it.
const LIGHT_ANGLE: u32 = 2u;
/// Property of a ray: where the light lies in the picture as seen from its pixel; 0 to the right, 1/4 above, up to 1.
const PICTURE_ANGLE: u32 = 3u;
/// Property of a ray: mean distance of its lit points, as LINEAR_DEPTH.
const VISIBLE_DEPTH: u32 = 4u;

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

// ---- stylize/transfer ----

@group(0) @binding(0) var<uniform> camera: Camera;
@group(0) @binding(1) var<uniform> light: Light;
@group(0) @binding(2) var<uniform> transfer_function: TransferFunction;
@group(0) @binding(3) var depth: texture_2d<f32>;
@group(0) @binding(4) var scattered: texture_2d<f32>;
@group(0) @binding(5) var<storage, read_write> constraints: array<Constraint>;

/// Points of a ray at which the shadow map is looked up.
const STEPS: u32 = 96u;

/// Mean distance of the lit points of a ray of `distance` metres; half of that where nothing is lit.
fn visible_distance(origin: vec3<f32>, direction: vec3<f32>, distance: f32) -> f32 {
    var sum = 0.0;
    var lit = 0.0;
    for (var step = 0u; step < STEPS; step++) {
        let along = distance * (f32(step) + 0.5) / f32(STEPS);
        let weight = max(lit_at(light, origin + along * direction).x, 0.0);
        sum += weight * along;
        lit += weight;
    }
    return select(0.5 * distance, sum / max(lit, 1e-20), lit > 0.0);
}

/// What the function is asked about a pixel.
fn pixel_properties(pixel: vec2<u32>) -> RayProperties {
    let ndc = ndc_from_pixel(camera, vec2<f32>(pixel) + 0.5);
    let view = view_ray(camera, ndc);
    let surface = clamp(finite_or(textureLoad(depth, pixel, 0).x, camera.far_depth), 0.0, 1.0);
    // Every ray that reaches the limit looks the same to the function.
    let distance = distance_on_ray(ray_depth(camera, view, ndc), surface, clamp(transfer_function.depth_limit, 1e-6, 1e15));
    let visibility = clamp(finite_or(textureLoad(scattered, pixel, 0).a, 0.0), 0.0, 1.0);
    let cosine = dot(view.direction, direction_to_light(light, view.origin));
    var ray = RayProperties(visibility, distance, cosine, picture_angle(camera, light, ndc), 0.0);
    ray.visible_distance = visible_distance(view.origin, view.direction, distance);
    return ray;
}

@compute @workgroup_size(64)
fn pick(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&constraints) {
        return;
    }
    let pixel = constraints[id.x].pixel;
    if all(pixel >= vec2<f32>(0.0)) {
        let last = vec2<f32>(textureDimensions(scattered) - 1u);
        let ray = pixel_properties(vec2<u32>(min(pixel, last)));
        constraints[id.x].position = transfer_position(transfer_function, ray);
    }
}
