// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::core::camera
// summary: View rays, distances and frustum planes from a camera's matrices, for any depth convention.
// source: homogeneous unprojection; planes after Gribb and Hartmann, "Fast extraction of viewing frustum planes" (2001).
// note: right-handed world, y up, metres; clip depth 0..1. Forward and reversed depth differ only in
// note: `near_depth` and `far_depth`; an infinite far plane unprojects to a point with w = 0.
// equation: ndc = (2 x / width − 1, 1 − 2 y / height);  P(z) = world_from_clip · (ndc, z, 1)
// equation: ray: eye + t normalize(P(far).xyz − eye P(far).w);  orthographic: from P(near) along P(far) − P(near)
// equation: distance(z) = dot(P(z).xyz − origin P(z).w, direction) / P(z).w
// equation: side planes: row 4 ± row 1 (left, right) and row 4 ± row 2 (bottom, top) of clip_from_world
// error: rays, distances and planes within the budgets of f32 that the test derives for each camera;
// error: test core/camera::rays_distances_and_planes_of_perspective_cameras.
// error: orthographic rays within 1e-6 of the size of the scene; test core/camera::orthographic_cameras_look_along_parallel_rays.
// parameter pixel: pixels, (0, 0) the top left corner, (0.5, 0.5) the middle of the first.
// parameter ndc: normalised device coordinates, -1..1 in the picture, y up.
// parameter depth: value of the depth buffer, 0..1, in the camera's convention.
// parameter limit: metres, positive.
// parameter matrix: any matrix.
// parameter side: 0..3.

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

/// The view ray through `ndc` of a perspective camera.
fn perspective_ray(camera: Camera, ndc: vec2<f32>) -> Ray {
    let far = camera.world_from_clip * vec4<f32>(ndc, camera.far_depth, 1.0);
    // With w = 0 (infinite far plane) far.xyz is the direction itself.
    return Ray(camera.eye, normalize(far.xyz - camera.eye * far.w));
}

/// Vector from `point`, metres in the world, TOWARDS the viewer, of any length: to the eye, or against the parallel
/// rays of an orthographic camera.
fn towards_viewer(camera: Camera, point: vec3<f32>) -> vec3<f32> {
    let parallel = camera.world_from_clip[2].xyz * (camera.near_depth - camera.far_depth);
    return select(camera.eye - point, parallel, camera.projection == ORTHOGRAPHIC);
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

/// Like `distance_from_depth` for a perspective camera, and cheaper: on a view ray the vector from the
/// eye, times the homogeneous w, is the same at every depth.
fn perspective_distance(camera: Camera, ndc: vec2<f32>, depth: f32, limit: f32) -> f32 {
    let far = camera.world_from_clip * vec4<f32>(ndc, camera.far_depth, 1.0);
    let along = length(far.xyz - camera.eye * far.w);
    let w = dot(matrix_row(camera.world_from_clip, 3u), vec4<f32>(ndc, depth, 1.0));
    let beyond = along >= limit * w;
    return select(along / select(w, 1.0, beyond), limit, beyond);
}

/// Row `index` of a matrix, as a vector.
fn matrix_row(matrix: mat4x4<f32>, index: u32) -> vec4<f32> {
    return vec4<f32>(matrix[0][index], matrix[1][index], matrix[2][index], matrix[3][index]);
}

/// Unit inward normal of a side plane of a perspective frustum: 0 left, 1 right, 2 bottom, 3 top.
fn side_normal(camera: Camera, side: u32) -> vec3<f32> {
    let axis = matrix_row(camera.clip_from_world, side >> 1u).xyz;
    let w = matrix_row(camera.clip_from_world, 3u).xyz;
    return normalize(w + select(axis, -axis, (side & 1u) == 1u));
}

/// Unit direction in which a perspective camera looks, at right angles to the picture plane.
fn forward_direction(camera: Camera) -> vec3<f32> {
    return normalize(matrix_row(camera.clip_from_world, 3u).xyz);
}

/// Distance of the far plane along `forward_direction` in metres, at most `limit`.
fn far_plane_distance(camera: Camera, limit: f32) -> f32 {
    let forward = forward_direction(camera);
    let point = camera.world_from_clip * vec4<f32>(0.0, 0.0, camera.far_depth, 1.0);
    let along = dot(point.xyz - camera.eye * point.w, forward);
    let beyond = along >= limit * point.w;
    return select(max(along / select(point.w, 1.0, beyond), 0.0), limit, beyond);
}
