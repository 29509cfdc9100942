// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: scattering/march_light, permutation point (LOCAL SHADOW_ARRAY)
// summary: In-scattered radiance of every pixel by marching the shadow maps of any light: spot, point, cascades, light texture.
// source: thesis 2.4.4, Eq. 2.20; 4.2.1; C. Kulla and M. Fajardo, "Importance sampling techniques for path tracing in participating media" (2012).
// note: The naive form for every light; `march` is the fastest one for a directional light with one shadow map.
// note: Around a light at a point steps are equal angles at the light, which the fall-off with distance makes alike.
// definition LOCAL: a spot or point light.
// definition SHADOW_ARRAY: shadow maps of several views: cascades of a directional light, faces around a point light.
// binding camera: the camera, any.
// binding light: the light, directional without LOCAL.
// binding medium: the medium.
// binding depth: depth buffer of the picture, a depth format or r32float; non-finite values count as far.
// binding shadow_maps: depth of the views, a layer each; with SHADOW_ARRAY only.
// binding shadow_views: the views; with SHADOW_ARRAY only.
// binding parameters: number of steps.
// binding scattered: out of the compute entry point (the fragment entry point returns it), rgba16float: linear RGB radiance, and in alpha the mean visibility times fall-off 0..1.

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

/// Distance in metres along `ray`, the view ray through `ndc`, of the surface with the depth-buffer
/// value `depth`; at most `limit`, which also stands for points at infinity.
fn distance_from_depth(camera: Camera, ray: Ray, ndc: vec2<f32>, depth: f32, limit: f32) -> f32 {
    let point = camera.world_from_clip * vec4<f32>(ndc, depth, 1.0);
    let along = dot(point.xyz - ray.origin * point.w, ray.direction);
    // along / w, without dividing by a w that is zero or has rounded below it.
    let beyond = along >= limit * point.w;
    return select(max(along / select(point.w, 1.0, beyond), 0.0), limit, beyond);
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

// ---- airlight::core::phase ----
// summary: Phase functions, normalised to one over the sphere.
// source: thesis 2.4, Eq. 2.11 (Henyey and Greenstein 1941).

/// 1 / (4 pi), the value of the isotropic phase function, 1/sr.
const ISOTROPIC: f32 = 0.07957747154594767;

/// The Henyey-Greenstein phase function, 1/sr. `cosine`: of the scattering angle, -1..1;
/// `g`: mean cosine, clamped to -0.999..0.999, zero is isotropic.
fn henyey_greenstein(cosine: f32, g: f32) -> f32 {
    let mean = clamp(g, -0.999, 0.999);
    // (1 - g)^2 + 2 g (1 - cos) is 1 + g^2 - 2 g cos without the cancellation near the peak.
    let near = (1.0 - abs(mean)) * (1.0 - abs(mean));
    let turn = 1.0 - clamp(select(-cosine, cosine, mean >= 0.0), -1.0, 1.0);
    let inverse = inverseSqrt(near + 2.0 * abs(mean) * turn);
    return ISOTROPIC * (1.0 - mean * mean) * (inverse * inverse * inverse);
}

// ---- airlight::core::picture ----
// summary: One triangle over the whole picture, for passes in fragment form.
// source: the usual full-screen triangle.

/// Clip-space position of corner `index`, 0..2, of a triangle that covers the picture.
fn picture_corner(index: u32) -> vec4<f32> {
    return vec4<f32>(vec2<f32>(f32(index & 1u), f32(index >> 1u)) * 4.0 - 1.0, 0.0, 1.0);
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

// ---- airlight::scattering::march ----
// summary: Visibility along a view ray step by step: the naive form, as fallback and as baseline.
// source: thesis 4.2.1 and 4.3.1, Eq. 4.4 and 4.8.

/// Most steps of a march by equal steps.
const MOST_MARCH_STEPS: u32 = 65536u;

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

// ---- airlight::scattering::single_scatter ----
// summary: Single scattering of a directional light in a homogeneous medium, given the visibility along a ray.
// source: thesis 4.2.1, Eq. 4.1 and 4.2; 4.3.2, Eq. 4.8 and 4.9; Listing 4.4.

/// A homogeneous medium. 32 bytes.
struct Medium {
    /// Single-scattering albedo, 0..1 for each colour.
    albedo: vec3<f32>,
    /// Extinction coefficient in 1/m, not negative; zero is a clear picture.
    extinction: f32,
    /// Mean cosine of the Henyey-Greenstein phase function, -0.999..0.999.
    g: f32,
    /// Rays end here if they meet nothing nearer, metres, positive.
    distance_limit: f32,
    reserved_a: f32,
    reserved_b: f32,
}

// ---- airlight::scattering::local_light ----
// summary: Epipolar rows around a light at a point, spot or point light, and the light that air scatters along a view ray.
// source: thesis 4.3.2 ("other light sources") and 4.4.1; W. Pegoraro and S. Parker, "An analytical solution to single scattering in homogeneous participating media" (2009); C. Kulla and M. Fajardo (2012) for equal angles.

/// An eye nearer to the light than this, metres, has no direction to it.
const LEAST_DISTANCE: f32 = 1e-4;
/// Optical depth after which the airlight integral stops.
const DEEPEST: f32 = 10.0;
/// Nodes and weights of the Gauss-Legendre rule of 8 points, the positive half.
const NODES: vec4<f32> = vec4<f32>(0.1834346424956498, 0.525532409916329, 0.7966664774136267, 0.9602898564975363);
const WEIGHTS: vec4<f32> = vec4<f32>(0.362683783378362, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763);

/// The line of a view ray, as the light sees it.
struct LocalRay {
    /// Where along the ray it passes closest to the light, metres from the eye; negative where that lies behind.
    closest: f32,
    /// How close, metres.
    passing: f32,
    /// How close, softened by the radius of the light, metres, positive.
    softened: f32,
}

/// Unit vector from `eye` TOWARDS `position`, the light, metres in the world, and the distance in metres, at least
/// LEAST_DISTANCE; nearer than that the direction is `fallback`, a unit vector.
fn place_of_light(position: vec3<f32>, eye: vec3<f32>, fallback: vec3<f32>) -> vec4<f32> {
    let between = position - eye;
    let distance = length(between);
    let apart = distance >= LEAST_DISTANCE;
    return vec4<f32>(select(fallback, between / max(distance, LEAST_DISTANCE), apart), max(distance, LEAST_DISTANCE));
}

/// The line of a view ray as the light sees it. `away`: of the light from the eye, metres; `cosine`, `sine`: of the ray's
/// angle to the light; `radius`: of the light, metres.
fn local_ray(away: f32, cosine: f32, sine: f32, radius: f32) -> LocalRay {
    let passing = away * sine;
    // Somewhat above zero, for a ray through a light without radius.
    return LocalRay(away * cosine, passing, max(length(vec2<f32>(passing, radius)), 1e-6 * away));
}

/// Angle, -pi/2..pi/2, that grows along a view ray so that equal steps of it receive alike from the light in clear air.
/// `along`: metres along the ray.
fn equal_angle(ray: LocalRay, along: f32) -> f32 {
    return atan2(along - ray.closest, ray.softened);
}

/// Metres along the ray, not negative, of an `equal_angle`.
fn along_from_equal_angle(ray: LocalRay, angle: f32) -> f32 {
    return clamp(ray.closest + ray.softened * tan(angle), 0.0, 1e15);
}

/// Metres of air that light passes from the light to the point `along` metres along the ray, and from there to the eye.
fn path_through_air(ray: LocalRay, along: f32) -> f32 {
    return along + length(vec2<f32>(ray.passing, along - ray.closest));
}

/// Cosine of the scattering angle at the point `along` metres along the ray: the view direction times the direction
/// from there TOWARDS the light.
fn cosine_to_light(ray: LocalRay, along: f32) -> f32 {
    let left = ray.closest - along;
    return left / max(length(vec2<f32>(ray.passing, left)), 1e-12);
}

/// asinh of x >= 0, with a small relative error for small x, which the built-in function lacks.
fn area_sine(x: f32) -> f32 {
    let square = x * x;
    let series = x * (1.0 - square * (0.16666667 - square * (0.075 - square * 0.04464286)));
    return select(log(x + sqrt(square + 1.0)), series, x < 0.3);
}

/// What `area_sine` did, undone.
fn sine_of_area(x: f32) -> f32 {
    let square = x * x;
    let series = x * (1.0 + square * (0.16666667 + square * (0.008333333 + square * 0.00019841270)));
    return select(0.5 * (exp(x) - exp(-x)), series, x < 0.7);
}

/// The airlight integral on one side of the closest point. `side`: -1 before it, 1 beyond; `from_along`, `to_along`: metres from
/// the closest point, not negative, the first not greater than the second; `stretch`: the scale within which the integrand changes fast near zero.
fn airlight_side(
    ray: LocalRay, side: f32, from_along: f32, to_along: f32, stretch: f32, extinction: f32, g: f32
) -> f32 {
    let h = ray.softened;
    // What `equal_angle` lacks to pi/2 on that side; the span by itself, for a difference would lose its figures.
    let a = atan2(h, to_along) / stretch;
    let b = atan2(h, from_along) / stretch;
    let span = atan2(h * (to_along - from_along), h * h + from_along * to_along) / stretch;
    let first = area_sine(a);
    let half = 0.5 * area_sine(span * (a + b) / (b * sqrt(1.0 + a * a) + a * sqrt(1.0 + b * b)));
    let middle = first + half;
    var sum = 0.0;
    for (var pair = 0u; pair < 8u; pair++) {
        // An index into a constant vector would be a table in memory.
        let picked = select(vec4<f32>(0.0), vec4<f32>(1.0), vec4<u32>(0u, 1u, 2u, 3u) == vec4<u32>(pair >> 1u));
        let node = dot(NODES, picked);
        let at = middle + half * select(node, -node, (pair & 1u) == 0u);
        let growth = exp(at);
        let angle = max(stretch * sine_of_area(at), 1e-12);
        let along = clamp(ray.closest + side * h * cos(angle) / sin(angle), 0.0, 1e15);
        let phase = henyey_greenstein(cosine_to_light(ray, along), g);
        let air = exp(-min(extinction * path_through_air(ray, along), 200.0));
        sum += dot(WEIGHTS, picked) * phase * air * 0.5 * (growth + 1.0 / growth);
    }
    return sum * half * stretch;
}

/// The airlight integral: int p(cos) exp(-extinction (t + d)) / (d^2 + radius^2) dt from `from_along` to `to_along`
/// metres along a view ray, in 1/(m sr), with d the distance to the light. `extinction` in 1/m, not negative; `g`: mean cosine.
/// A fixed rule of 16 points: within 1e-3 for g from -0.75 to 0.9 on rays that pass the light at twice its radius or farther;
/// nearer, where the softening is a matter of taste, within 5e-2. Stretches below a thousandth of the distance to the
/// light lose figures in proportion.
fn airlight(ray: LocalRay, extinction: f32, g: f32, from_along: f32, to_along: f32) -> f32 {
    let start = from_along - ray.closest;
    let start_away = length(vec2<f32>(ray.passing, start));
    // Path at the start less that at the eye; the second form does not cancel before the closest point.
    let before = ray.passing * ray.passing / max(start_away - start, 1e-30);
    let path = select(before, start + start_away, start > 0.0) + DEEPEST / max(extinction, 1e-20);
    let deepest = 0.5 * (path - ray.passing * ray.passing / path);
    let end = max(min(to_along - ray.closest, deepest), start);

    let peak = clamp((1.0 - abs(g)) / sqrt(max(abs(g), 0.01)), 1e-3, 10.0);
    // Both sides always, an empty one for nothing: a branch here, or a loop of varying length, ends lavapipe of Mesa 22.3.
    let before_light = airlight_side(
        ray, -1.0, max(-end, 0.0), max(-start, 0.0), select(10.0, peak, g > 0.0), extinction, g
    );
    // Beyond the light the air dims over angles of about the optical depth of the closest distance.
    let stretch = min(max(extinction * ray.softened, 0.01), select(10.0, peak, g < 0.0));
    let beyond_light = airlight_side(ray, 1.0, max(start, 0.0), max(end, 0.0), stretch, extinction, g);
    return (before_light + beyond_light) / ray.softened;
}

/// Radiance scattered into a view ray. `intensity`: linear RGB radiant intensity of the light; `lit`: mean of visibility times
/// fall-off over the light angles of the stretch that `integral` was taken over, for each colour, 0..1.
fn local_in_scattered(medium: Medium, intensity: vec3<f32>, integral: f32, lit: vec3<f32>) -> vec3<f32> {
    return medium.albedo * intensity * lit * (medium.extinction * integral);
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

// ---- scattering/march_light ----

struct MarchParameters {
    /// Steps a ray, 1..65536.
    steps: u32,
    /// Where in each step the sample lies, 0..1.
    offset: f32,
    /// Unused here.
    frame: u32,
    reserved: u32,
}

@group(0) @binding(0) var<uniform> camera: Camera;
@group(0) @binding(1) var<uniform> light: Light;
@group(0) @binding(2) var<uniform> medium: Medium;
@group(0) @binding(5) var depth: texture_2d<f32>;
@group(0) @binding(8) var<uniform> parameters: MarchParameters;
@group(0) @binding(9) var scattered: texture_storage_2d<rgba16float, write>;
/// Radiance, and mean visibility times fall-off in alpha, of a pixel.
fn pixel_light(pixel: vec2<u32>) -> vec4<f32> {
    let ndc = ndc_from_pixel(camera, vec2<f32>(pixel) + 0.5);
    let surface = clamp(finite_or(textureLoad(depth, pixel, 0).x, camera.far_depth), 0.0, 1.0);
    let ray = view_ray(camera, ndc);
    let distance = distance_from_depth(camera, ray, ndc, surface, medium.distance_limit);
    let span = vec2<f32>(0.0, distance);
    let steps = max(parameters.steps, 1u);
    let extinction = medium.extinction;
    let place = place_of_light(light.position, ray.origin, ray.direction);
    let cosine = dot(ray.direction, place.xyz);
    let sine = length(cross(ray.direction, place.xyz));
    let lit = marched_local_light(
        light, medium.g, ray.origin, ray.direction, place.w, cosine, sine, span, extinction, steps, parameters.offset
    );
    let integral = airlight(local_ray(place.w, cosine, sine, light.radius), medium.extinction, medium.g, 0.0, distance);
    let radiance = local_in_scattered(medium, light.radiance, integral, lit);
    return vec4<f32>(min(radiance, vec3<f32>(65504.0)), dot(lit, vec3<f32>(1.0 / 3.0)));
}

@compute @workgroup_size(16, 8)
fn march_light(@builtin(global_invocation_id) id: vec3<u32>) {
    if all(id.xy < textureDimensions(scattered)) {
        textureStore(scattered, id.xy, pixel_light(id.xy));
    }
}

@vertex
fn vertex_picture(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return picture_corner(index);
}

@fragment
fn fragment_march(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return pixel_light(vec2<u32>(position.xy));
}
