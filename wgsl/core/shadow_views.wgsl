// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::core::shadow_views
// summary: Several shadow maps of one light in an array: cascades of a directional light, faces around a point light.
// source: F. Zhang et al., "Parallel-split shadow maps for large-scale virtual environments" (2006); F. Crow (1977).
// note: Layer = view. A light ray belongs to the first view that contains it; all layers share `light.far_depth`.
// note: The six tests are written out: an index that is not constant would copy the struct in every invocation.
// equation: view v contains a point ⇔ w > 0, |x| ≤ w, |y| ≤ w of clip_from_world[v] · point; the first v is taken
// error: places within 2e-5 of the map, points back 2e-6; test core/light::light_rays_find_their_view.
// parameter clip_from_world, world_from_clip: matrix of a view, and its inverse.
// parameter view, count: number of the view, and of all views, 1..6.
// parameter depth: 0..1, in the light's convention.
// parameter point: metres in the world.
// parameter clip: homogeneous clip coordinates of a view.

#import airlight::core::light::texels_from_clip

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
