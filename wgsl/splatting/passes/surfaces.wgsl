// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Polygons as sheets need them: how high each surface lies along the sheets' normal, its colour and its normal.
// source: Zhang and Crawfis, 4.1, steps 1 and 2.
// note: Drawn with a depth buffer of any convention: fragment_height into r32float, with the eye's camera and with the light's, cleared to
// note: NO_SURFACE; fragment_albedo and fragment_normal into rgba16float with the eye's. fragment_exit_height draws only what turns its
// note: back to the light: where each light ray leaves the first solid. An engine with a depth buffer has the
// note: heights from it: `height_of` the point.
// binding camera: the eye's camera or the light's.
// binding sheets: the sheets; for heights only.

#import airlight::core::camera::{Camera, towards_viewer}
#import airlight::splatting::sheets::{Sheets, height_of}

@group(#{GROUP}) @binding(0) var<uniform> camera: Camera;
@group(#{GROUP}) @binding(1) var<uniform> sheets: Sheets;

struct Surface {
    @builtin(position) clip: vec4<f32>,
    /// Metres.
    @location(0) world: vec3<f32>,
    @location(1) normal: vec3<f32>,
    /// Linear RGB.
    @location(2) albedo: vec3<f32>,
}

@vertex
fn vertex_surface(
    @location(0) position: vec3<f32>, @location(1) normal: vec3<f32>, @location(2) albedo: vec3<f32>
) -> Surface {
    return Surface(camera.clip_from_world * vec4<f32>(position, 1.0), position, normal, albedo);
}

@fragment
fn fragment_height(surface: Surface) -> @location(0) vec4<f32> {
    return vec4<f32>(height_of(sheets, surface.world), 0.0, 0.0, 1.0);
}

@fragment
fn fragment_exit_height(surface: Surface) -> @location(0) vec4<f32> {
    // By the normal and not by the order of corners: meshes of both orders are drawn.
    if dot(surface.normal, towards_viewer(camera, surface.world)) >= 0.0 {
        discard;
    }
    return vec4<f32>(height_of(sheets, surface.world), 0.0, 0.0, 1.0);
}

@fragment
fn fragment_albedo(surface: Surface) -> @location(0) vec4<f32> {
    return vec4<f32>(clamp(surface.albedo, vec3<f32>(0.0), vec3<f32>(1.0)), 1.0);
}

@fragment
fn fragment_normal(surface: Surface) -> @location(0) vec4<f32> {
    // Both faces are lit: the normal is turned to the side of the triangle that is seen. The interpolated normal alone
    // would flip at silhouettes.
    let triangle = cross(dpdx(surface.world), dpdy(surface.world));
    let seen = select(-triangle, triangle, dot(triangle, towards_viewer(camera, surface.world)) >= 0.0);
    let unit = surface.normal / max(length(surface.normal), 1e-6);
    return vec4<f32>(select(-unit, unit, dot(unit, seen) >= 0.0), 1.0);
}
