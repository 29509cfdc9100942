// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: scattering/rectify, permutation point (LOCAL SHADOW_ARRAY)
// summary: Resamples a standard shadow map into the rectified map, where view rays run along rows at constant depth.
// source: thesis 4.4.1.
// note: Nearest texel: a blend of two depths is the depth of nothing. Blockers outside the bounds of a slice are
// note: clamped into its guard band; light rays outside the shadow map, or without a blocker, store 1.
// note: Non-finite depths count as empty.
// note: The blocker on a light ray is the point of that ray at the stored depth, also where the texel is wide.
// definition LOCAL: a spot or point light; columns are light angles.
// definition SHADOW_ARRAY: shadow maps of several views: cascades of a directional light, faces around a point light.
// binding light: the light, directional without LOCAL, and its shadow map's clip space.
// binding frame: the frame of the slices.
// binding slices: their bounds, rgba32float, one texel a slice.
// binding shadow_maps: depth of the views, a layer each, a depth format or r32float; with SHADOW_ARRAY only.
// binding shadow_views: the views; a light ray belongs to the first that contains it; with SHADOW_ARRAY only.
// binding rectified: out, depth 0..1, r32float; columns are radii, with LOCAL light angles, rows slices.

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

// ---- airlight::core::fourier_basis ----
// summary: Visibility as a Fourier series of the depth difference, four bases at a time.
// source: thesis 4.3.1, Eq. 4.7, after Annen et al., "Convolution shadow maps" (2007).

/// Part of the depth range at either end that is kept free of view rays.
const GUARD: f32 = 0.05;

/// Depth in the guarded range. `unit`: depth over the bounds of the view rays, where rays lie in
/// 0..1 and blockers may lie outside; the result is clamped to 0..1.
fn guarded(unit: f32) -> f32 {
    return clamp(GUARD + (1.0 - 2.0 * GUARD) * unit, 0.0, 1.0);
}

// ---- airlight::core::light ----
// summary: A light, its fall-off and texture, and the clip space of its standard shadow map.
// source: thesis 4.2.1; a point source seen through a cone and softened by its radius.

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

/// Position in texels of a map, and depth, of a point in the clip space of that map; a point at or behind the light
/// (w <= 0) is carried outside the map. `size`: of the map in texels.
fn texels_from_clip(clip: vec4<f32>, size: vec2<f32>) -> vec3<f32> {
    let before = clip.w > 0.0;
    let ndc = clip.xyz / select(1.0, clip.w, before);
    return select(vec3<f32>(-size, 0.0), vec3<f32>((ndc.xy * vec2<f32>(0.5, -0.5) + 0.5) * size, ndc.z), before);
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

/// The point in the world, metres, of depth 0..1 on the light ray through `point`, seen by `view`: with a depth that was
/// read from the array, the blocker. `clip_from_world`, `world_from_clip`: of that view.
fn point_at_depth(
    clip_from_world: mat4x4<f32>, world_from_clip: mat4x4<f32>, point: vec3<f32>, depth: f32
) -> vec3<f32> {
    let clip = clip_from_world * vec4<f32>(point, 1.0);
    let ndc = clip.xy / select(1.0, clip.w, clip.w > 0.0);
    let at = world_from_clip * vec4<f32>(ndc, depth, 1.0);
    return at.xyz / max(at.w, 1e-12);
}

// ---- airlight::scattering::rectify ----
// summary: Epipolar coordinates around a directional light: rows are slices, columns radii, depth the angle to the light.
// source: thesis 4.4.1, after Baran et al., "A hierarchical volumetric shadow algorithm" (2010); Eq. 4.12.

/// Slices are at least this wide in theta, radians.
const LEAST_WIDTH: f32 = 1e-3;

/// Axes around the light, the range of the slices, and the view rays in these axes. 128 bytes.
struct Frame {
    /// Unit vector TOWARDS the light.
    light: vec3<f32>,
    /// Azimuth of row 0, radians.
    azimuth_min: f32,
    /// Unit vector of azimuth 0.
    axis_a: vec3<f32>,
    /// Rows per radian of azimuth.
    rows_per_radian: f32,
    /// Unit vector of azimuth pi / 2.
    axis_b: vec3<f32>,
    /// Number of rows.
    rows: f32,
    /// Position of the eye, where all slices meet.
    eye: vec3<f32>,
    /// 1 where the rows go round the full circle and wrap, 0 elsewhere.
    wraps: f32,
    /// The view ray through ndc, times (x, y, 1): its part towards the light. Any length, the same for all four.
    ray_light: vec3<f32>,
    reserved_a: f32,
    /// Its part along axis_a.
    ray_a: vec3<f32>,
    reserved_b: f32,
    /// Its part along axis_b.
    ray_b: vec3<f32>,
    reserved_c: f32,
    /// Times (x, y, depth, 1): what its length is divided by for the distance of the surface at that depth.
    ray_scale: vec4<f32>,
}

/// Bounds of one slice.
struct Slice {
    /// Least angle to the light of its view rays, radians.
    angle_min: f32,
    /// Greatest angle to the light of its view rays, radians.
    angle_max: f32,
    /// Radius in metres at the right end of its row.
    radius_max: f32,
    /// k of the reference ray, the bisectrix: sine of its angle to the light.
    reference: f32,
}

/// Azimuth of the middle of `row`, radians.
fn row_azimuth(frame: Frame, row: f32) -> f32 {
    return frame.azimuth_min + row / max(frame.rows_per_radian, 1e-6);
}

/// Unit vector at right angles to the light in the half-plane of `azimuth`.
fn azimuth_direction(frame: Frame, azimuth: f32) -> vec3<f32> {
    return cos(azimuth) * frame.axis_a + sin(azimuth) * frame.axis_b;
}

/// Depth 0..1 in the rectified map of an angle to the light: view rays of the slice lie in
/// GUARD .. 1 - GUARD, blockers beyond its bounds are clamped into the guard.
fn depth_from_angle(slice: Slice, angle: f32) -> f32 {
    return guarded((angle - slice.angle_min) / max(slice.angle_max - slice.angle_min, 0.1 * LEAST_WIDTH));
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

/// The blocker on the light ray through `point`, metres in the world, and 1 in w; w is 0 where there is none.
/// `clip_from_world`, `world_from_clip`: of the map that `shadow` was read from.
fn blocker_point(
    shadow: Shadow, clip_from_world: mat4x4<f32>, world_from_clip: mat4x4<f32>, point: vec3<f32>
) -> vec4<f32> {
    return vec4<f32>(point_at_depth(clip_from_world, world_from_clip, point, shadow.stored), f32(shadow.blocked));
}

// ---- airlight::scattering::local_light ----
// summary: Epipolar rows around a light at a point, spot or point light, and the light that air scatters along a view ray.
// source: thesis 4.3.2 ("other light sources") and 4.4.1; W. Pegoraro and S. Parker, "An analytical solution to single scattering in homogeneous participating media" (2009); C. Kulla and M. Fajardo (2012) for equal angles.

/// An eye nearer to the light than this, metres, has no direction to it.
const LEAST_DISTANCE: f32 = 1e-4;

/// Bounds of one slice around a light at a point.
struct LocalSlice {
    /// Least angle to the light of its view rays, radians.
    angle_min: f32,
    /// Greatest angle to the light of its view rays, radians.
    angle_max: f32,
    /// Light angle at the left end of its row, radians.
    light_angle_min: f32,
    /// Light angle at the right end of its row, radians.
    light_angle_max: f32,
}

/// Distance in metres of a light at `position` from the eye of `frame`, which looks towards it.
fn distance_to_light(frame: Frame, position: vec3<f32>) -> f32 {
    return max(dot(position - frame.eye, frame.light), LEAST_DISTANCE);
}

/// Angle at the eye, 0..pi, from the direction to the light, of the point `along` metres along a light ray. `away`: of
/// the light from the eye, metres; `at_light`: its light angle.
fn angle_from_light_ray(away: f32, at_light: f32, along: f32) -> f32 {
    return atan2(max(along * sin(at_light), 1e-30), away - along * cos(at_light));
}

/// Unit vector along a light ray, away from the light. `radial`: unit vector of its half-plane, at right angles to the
/// direction to the light; `at_light`: its light angle.
fn light_ray_direction(frame: Frame, radial: vec3<f32>, at_light: f32) -> vec3<f32> {
    return sin(at_light) * radial - cos(at_light) * frame.light;
}

/// What `local_slice_texel` did, undone.
fn local_slice_from_texel(texel: vec4<f32>) -> LocalSlice {
    return LocalSlice(texel.x, texel.y, texel.z, texel.w);
}

/// The bounds of the view rays alone, for `depth_from_angle` and `depth_from_ray`.
fn ray_bounds(slice: LocalSlice) -> Slice {
    return Slice(slice.angle_min, slice.angle_max, 1.0, 1.0);
}

/// Light angle of a position along a row, radians. `unit`: 0..1 over the columns.
fn light_angle_of_column(slice: LocalSlice, unit: f32) -> f32 {
    return mix(slice.light_angle_min, slice.light_angle_max, unit);
}

// ---- scattering/rectify ----

@group(0) @binding(0) var<uniform> light: Light;
@group(0) @binding(1) var<uniform> frame: Frame;
@group(0) @binding(2) var slices: texture_2d<f32>;
@group(0) @binding(3) var shadow_maps: texture_2d_array<f32>;
@group(0) @binding(5) var<uniform> shadow_views: ShadowViews;
@group(0) @binding(4) var rectified: texture_storage_2d<r32float, write>;

/// Texels a thread takes, a quarter of the row apart, so that neighbours in a workgroup stay neighbours.
const PER_THREAD: u32 = 4u;

/// Depth of the blocker on the light ray of `row` at `unit`, 0..1 along the row.
fn depth_of_light_ray(row: u32, unit: f32) -> f32 {
    let slice = local_slice_from_texel(textureLoad(slices, vec2<u32>(row, 0u), 0));
    let radial = azimuth_direction(frame, row_azimuth(frame, f32(row)));
    let at_light = light_angle_of_column(slice, unit);
    let direction = light_ray_direction(frame, radial, at_light);
    let blocker = blocker_on_ray(light.position + direction);
    let along = clamp(dot(blocker.xyz - light.position, direction), 0.0, 1e15);
    let angle = angle_from_light_ray(distance_to_light(frame, light.position), at_light, along);
    return select(1.0, depth_from_angle(ray_bounds(slice), angle), blocker.w > 0.0);
}

/// The blocker on the light ray through `point` in the world, metres, and 1 in w; w is 0 where there is none.
fn blocker_on_ray(point: vec3<f32>) -> vec4<f32> {
    let place = view_position(shadow_views, vec2<f32>(textureDimensions(shadow_maps)), point);
    let shadow = shadow_in_view(shadow_maps, place, light.far_depth);
    return blocker_point(
        shadow, shadow_views.clip_from_world[place.view], shadow_views.world_from_clip[place.view], point
    );
}

@compute @workgroup_size(16, 8)
fn rectify(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = textureDimensions(rectified);
    let columns = (size.x + PER_THREAD - 1u) / PER_THREAD;
    if id.x >= columns || id.y >= size.y {
        return;
    }

    for (var part = 0u; part < PER_THREAD; part++) {
        let column = id.x + part * columns;
        if column >= size.x {
            break;
        }
        let step = f32(column) + 0.5;
        var depth = depth_of_light_ray(id.y, step / f32(size.x));
        textureStore(rectified, vec2<u32>(column, id.y), vec4<f32>(depth, 0.0, 0.0, 1.0));
    }
}
