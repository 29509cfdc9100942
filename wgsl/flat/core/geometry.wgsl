// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: core/geometry, permutation default
// summary: Draws meshes as a deferred renderer stores them: depth and normals, or depth and albedo.
// source: Saito and Takahashi, "Comprehensible rendering of 3-D shapes" (1990).
// note: Any camera: forward, reversed and infinite depth differ in the clear value and the comparison of the pipeline. Normals are towards
// note: the viewer's side of their triangle, and interpolated ones are left as they are on that side.
// binding camera: the camera, world in metres.

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

/// Vector from `point`, metres in the world, TOWARDS the viewer, of any length: to the eye, or against the parallel
/// rays of an orthographic camera.
fn towards_viewer(camera: Camera, point: vec3<f32>) -> vec3<f32> {
    let parallel = camera.world_from_clip[2].xyz * (camera.near_depth - camera.far_depth);
    return select(camera.eye - point, parallel, camera.projection == ORTHOGRAPHIC);
}

// ---- core/geometry ----

struct Varyings {
    @builtin(position) position: vec4<f32>,
    @location(0) world: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) albedo: vec3<f32>,
}

@group(0) @binding(0) var<uniform> camera: Camera;

@vertex
fn vertex_geometry(
    @location(0) position: vec3<f32>, @location(1) normal: vec3<f32>, @location(2) albedo: vec3<f32>
) -> Varyings {
    return Varyings(camera.clip_from_world * vec4<f32>(position, 1.0), position, normal, albedo);
}

/// Unit normal in the world, on the side of the triangle that is seen; alpha is 1.
@fragment
fn fragment_normal(varyings: Varyings) -> @location(0) vec4<f32> {
    let across = cross(dpdx(varyings.world), dpdy(varyings.world));
    let size = length(varyings.normal);
    let triangle = across / max(length(across), 1e-30);
    let smooth_normal = select(triangle, varyings.normal / max(size, 1e-20), size > 1e-6);
    let viewer = towards_viewer(camera, varyings.world);
    let seen = select(-triangle, triangle, dot(triangle, viewer) >= 0.0);
    return vec4<f32>(select(-smooth_normal, smooth_normal, dot(smooth_normal, seen) >= 0.0), 1.0);
}

/// Linear RGB albedo, 0..1; alpha is 1.
@fragment
fn fragment_albedo(varyings: Varyings) -> @location(0) vec4<f32> {
    return vec4<f32>(clamp(varyings.albedo, vec3<f32>(0.0), vec3<f32>(1.0)), 1.0);
}
