// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: splatting/surfaces, permutation default
// summary: Polygons as sheets need them: how high each surface lies along the sheets' normal, its colour and its normal.
// source: Zhang and Crawfis, 4.1, steps 1 and 2.
// note: Drawn with a depth buffer of any convention: fragment_height into r32float, with the eye's camera and with the light's, cleared to
// note: NO_SURFACE; fragment_albedo and fragment_normal into rgba16float with the eye's. fragment_exit_height draws only what turns its
// note: back to the light: where each light ray leaves the first solid. An engine with a depth buffer has the
// note: heights from it: `height_of` the point.
// binding camera: the eye's camera or the light's.
// binding sheets: the sheets; for heights only.

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

// ---- airlight::splatting::sheets ----
// summary: Sheets: slabs of equal thickness one behind the other along the half-way vector between eye and light.
// source: Zhang and Crawfis, "Light propagation for mixed polygonal and volumetric data using splatting", 4.1, Fig. 5.

/// All sheets of a picture. 32 bytes.
struct Sheets {
    /// Unit normal in the world, from the side of the light on.
    normal: vec3<f32>,
    /// Where the first sheet begins: dot(normal, point), metres.
    first: f32,
    /// Of every sheet, metres, positive.
    thickness: f32,
    /// How many there are.
    count: u32,
    /// Sheets that one splat reaches at most.
    span: u32,
    /// 1 where the sheet nearest to the light is nearest to the eye as well, 0 where it is the farthest.
    front_to_back: u32,
}

/// Where a point lies along the normal, metres from the world's origin.
fn height_of(sheets: Sheets, point: vec3<f32>) -> f32 {
    return dot(sheets.normal, point);
}

// ---- splatting/surfaces ----

@group(0) @binding(0) var<uniform> camera: Camera;
@group(0) @binding(1) var<uniform> sheets: Sheets;

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
