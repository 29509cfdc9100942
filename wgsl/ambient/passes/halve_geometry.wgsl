// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Depth and normals of half the size: of each four pixels the nearest and the farthest in turn.
// source: none; a mean of depths lies on no surface, so one of the four is taken with its normal.
// note: Dispatch over the halved picture, whose sides are half as long, rounded up. Near and far alternate like the squares of a chessboard,
// note: so that either side of every edge is found within two pixels.
// note: A halved pixel's middle is the corner that the four share: cameras take half the viewport. Its depth is that of the chosen pixel's tangent
// note: plane there, or else flat floors would be rough.
// binding camera: the camera of the whole picture: which depths are near.
// binding depth: depth buffer, a depth format or r32float.
// binding normals: unit normals in the world, any float format.
// binding halved_depth: out, r32float.
// binding halved_normals: out, rgba16float.

#import airlight::core::camera::{Camera, ndc_from_pixel, view_ray}
#import airlight::core::finite::{finite_or, finite_or_rgb}
#import airlight::ambient::seen_surface::{seen_surface, seen_normal}

@group(#{GROUP}) @binding(0) var<uniform> camera: Camera;
@group(#{GROUP}) @binding(1) var depth: texture_2d<f32>;
@group(#{GROUP}) @binding(2) var normals: texture_2d<f32>;
@group(#{GROUP}) @binding(3) var halved_depth: texture_storage_2d<r32float, write>;
@group(#{GROUP}) @binding(4) var halved_normals: texture_storage_2d<rgba16float, write>;

/// Steepest slope of a tangent plane that is followed: cosine between the view ray and the normal.
const GRAZING: f32 = 0.05;

/// Depth of a pixel's tangent plane at a place of the picture in pixels; its own where that is nearly seen from the side.
fn depth_beside(pixel: vec2<u32>, found: f32, normal: vec3<f32>, place: vec2<f32>) -> f32 {
    let seen = seen_surface(camera, vec2<i32>(pixel), found);
    let ray = view_ray(camera, ndc_from_pixel(camera, place));
    let facing = dot(ray.direction, normal);
    let safe = select(facing, -1.0, abs(facing) < GRAZING);
    let point = ray.origin + ray.direction * (dot(seen.place - ray.origin, normal) / safe);
    let clip = camera.clip_from_world * vec4<f32>(point, 1.0);
    let kept = !seen.known || abs(facing) < GRAZING || clip.w <= 1e-20;
    let moved = clamp(clip.z / select(clip.w, 1.0, kept), 0.0, 1.0);
    // A surface never becomes the far plane.
    return select(moved, found, kept || moved == camera.far_depth);
}

@compute @workgroup_size(16, 8)
fn halve_geometry(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= textureDimensions(halved_depth)) {
        return;
    }
    let last = textureDimensions(depth) - 1u;
    let nearer = select(-1.0, 1.0, camera.near_depth > camera.far_depth);
    // Sign by which the greatest is looked for: the nearest on white squares.
    let sign = select(-nearer, nearer, ((id.x + id.y) & 1u) == 0u);
    var chosen = min(2u * id.xy, last);
    var best = finite_or(textureLoad(depth, chosen, 0).x, camera.far_depth);
    for (var index = 1u; index < 4u; index++) {
        let at = min(2u * id.xy + vec2<u32>(index & 1u, index >> 1u), last);
        let found = finite_or(textureLoad(depth, at, 0).x, camera.far_depth);
        let better = found * sign > best * sign;
        best = select(best, found, better);
        chosen = select(chosen, at, better);
    }
    let normal = finite_or_rgb(textureLoad(normals, min(chosen, textureDimensions(normals) - 1u), 0).xyz, 0.0);
    let moved = depth_beside(chosen, best, seen_normal(normal, vec3<f32>(0.0)), vec2<f32>(2u * id.xy) + 1.0);
    textureStore(halved_depth, id.xy, vec4<f32>(moved, 0.0, 0.0, 1.0));
    textureStore(halved_normals, id.xy, vec4<f32>(clamp(normal, vec3<f32>(-65504.0), vec3<f32>(65504.0)), 1.0));
}
