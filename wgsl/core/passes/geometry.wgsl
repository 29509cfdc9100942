// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Draws meshes as a deferred renderer stores them: depth and normals, or depth and albedo.
// source: Saito and Takahashi, "Comprehensible rendering of 3-D shapes" (1990).
// note: Any camera: forward, reversed and infinite depth differ in the clear value and the comparison of the pipeline. Normals are towards
// note: the viewer's side of their triangle, and interpolated ones are left as they are on that side.
// binding camera: the camera, world in metres.

#import airlight::core::camera::{Camera, towards_viewer}

struct Varyings {
    @builtin(position) position: vec4<f32>,
    @location(0) world: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) albedo: vec3<f32>,
}

@group(#{GROUP}) @binding(0) var<uniform> camera: Camera;

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
