// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Bent normals and openness of the whole picture from those of half its size, not over edges of depth and normals.
// source: Kopf et al., "Joint bilateral upsampling" (2007); thesis 3.4 for the difference to normals.
// note: Dispatch over the whole picture. Of the four halved pixels around a pixel each counts by its bilinear weight and by how much it is of the
// note: same surface; where none is, all count a little. What is interpolated is the difference to half the normal.
// binding camera: the camera of the whole picture.
// binding halved_camera: the camera with half the viewport.
// binding blur: how alike pixels are; its axis and number of taps do not count.
// binding depth: depth buffer of the whole picture, a depth format or r32float.
// binding normals: its unit normals in the world, any float format.
// binding halved_depth: of ambient/halve_geometry.
// binding halved_normals: of ambient/halve_geometry.
// binding bent: of half the size, of ambient/occlude or ambient/blur_bent.
// binding whole: out, rgba16float, like `bent`.

#import airlight::core::camera::Camera
#import airlight::ambient::bent_blur::{BentBlur, edge_weight, mean_from_difference}
#import airlight::ambient::seen_surface::{seen_surface, seen_normal}

@group(#{GROUP}) @binding(0) var<uniform> camera: Camera;
@group(#{GROUP}) @binding(1) var<uniform> halved_camera: Camera;
@group(#{GROUP}) @binding(2) var<uniform> blur: BentBlur;
@group(#{GROUP}) @binding(3) var depth: texture_2d<f32>;
@group(#{GROUP}) @binding(4) var normals: texture_2d<f32>;
@group(#{GROUP}) @binding(5) var halved_depth: texture_2d<f32>;
@group(#{GROUP}) @binding(6) var halved_normals: texture_2d<f32>;
@group(#{GROUP}) @binding(7) var bent: texture_2d<f32>;
@group(#{GROUP}) @binding(8) var whole: texture_storage_2d<rgba16float, write>;

/// Least weight of a pixel that is not of the surface, so that there always is a mean.
const STRANGER: f32 = 1e-4;

@compute @workgroup_size(16, 8)
fn upsample_bent(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= textureDimensions(whole)) {
        return;
    }
    let own = vec2<i32>(min(id.xy, textureDimensions(depth) - 1u));
    let here = seen_surface(camera, own, textureLoad(depth, own, 0).x);
    let last_normal = vec2<i32>(textureDimensions(normals)) - 1;
    let normal = seen_normal(textureLoad(normals, min(own, last_normal), 0).xyz, vec3<f32>(0.0));
    let last = vec2<i32>(textureDimensions(halved_depth)) - 1;
    let at = 0.5 * (vec2<f32>(own) + 0.5) - 0.5;
    let first = vec2<i32>(floor(at));
    let part = at - floor(at);
    var sum = vec4<f32>(0.0);
    var weights = 0.0;
    for (var index = 0; index < 4; index++) {
        let corner = vec2<i32>(index & 1, index >> 1u);
        let other = clamp(first + corner, vec2<i32>(0), last);
        let there = seen_surface(halved_camera, other, textureLoad(halved_depth, other, 0).x);
        let facing = seen_normal(textureLoad(halved_normals, other, 0).xyz, vec3<f32>(0.0));
        let near = select(vec2<f32>(1.0) - part, part, corner == vec2<i32>(1));
        let alike = edge_weight(blur, here.place, normal, there.place, facing);
        let weight = select(0.0, near.x * near.y * max(alike, STRANGER), there.known && here.known);
        let value = textureLoad(bent, other, 0);
        sum += weight * vec4<f32>(value.xyz - 0.5 * facing, value.w);
        weights += weight;
    }
    let nothing = weights <= 0.0;
    let mean = sum / select(weights, 1.0, nothing);
    let found = vec4<f32>(mean_from_difference(mean.xyz, normal), mean.w);
    // What no halved pixel sees is open.
    let open = select(vec3<f32>(0.0), 0.5 * normal, here.known);
    textureStore(whole, id.xy, select(found, vec4<f32>(open, 1.0), nothing));
}
