// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Depth and normals of half the size: of each four pixels the nearest and the farthest in turn.
// source: none; a mean of depths lies on no surface, so one of the four is taken with its normal.
// note: Dispatch over the halved picture, whose sides are half as long, rounded up. Near and far alternate like the squares of a chessboard,
// note: so that either side of every edge is found within two pixels.
// note: A halved pixel's middle is the corner that the four share: cameras take half the viewport.
// binding camera: the camera of the whole picture: which depths are near.
// binding depth: depth buffer, a depth format or r32float.
// binding normals: unit normals in the world, any float format.
// binding halved_depth: out, r32float.
// binding halved_normals: out, rgba16float.

#import airlight::core::camera::Camera
#import airlight::core::finite::{finite_or, finite_or_rgb}

@group(#{GROUP}) @binding(0) var<uniform> camera: Camera;
@group(#{GROUP}) @binding(1) var depth: texture_2d<f32>;
@group(#{GROUP}) @binding(2) var normals: texture_2d<f32>;
@group(#{GROUP}) @binding(3) var halved_depth: texture_storage_2d<r32float, write>;
@group(#{GROUP}) @binding(4) var halved_normals: texture_storage_2d<rgba16float, write>;

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
    textureStore(halved_depth, id.xy, vec4<f32>(best, 0.0, 0.0, 1.0));
    textureStore(halved_normals, id.xy, vec4<f32>(clamp(normal, vec3<f32>(-65504.0), vec3<f32>(65504.0)), 1.0));
}
