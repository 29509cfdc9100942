// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::core::ray_depth
// summary: Distance along one view ray from depth-buffer values and back, for any camera, in a few operations each.
// source: homogeneous unprojection: on a view ray numerator and denominator of the distance are affine in the depth.
// note: Taken from the far plane on, where forward depth is densest, so that nothing cancels there.
// equation: distance(z) = (a + a' (z − far)) / (w + w' (z − far));  depth(t) = far + (t w − a) / (a' − t w')
// error: within the budgets of f32 that the test derives for each camera;
// error: test core/camera::depths_and_distances_on_a_ray_are_those_of_the_camera.
// parameter ndc: normalised device coordinates, -1..1.
// parameter depth: 0..1.
// parameter limit, distance: metres, from 0 up.

#import airlight::core::camera::{Camera, Ray, PERSPECTIVE}

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

/// Depth 0..1 of the point at `distance` metres along the ray, clamped to the near and the far plane.
fn depth_on_ray(ray: RayDepth, distance: f32) -> f32 {
    let slope = ray.along_slope - distance * ray.w_slope;
    let change = distance * ray.w - ray.along;
    // Division by zero only at the eye, which lies before the near plane.
    let depth = ray.far_depth + change / select(slope, 1.0, slope == 0.0);
    return select(clamp(depth, 0.0, 1.0), ray.near_depth, slope == 0.0);
}
