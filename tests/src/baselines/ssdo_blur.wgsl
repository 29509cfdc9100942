// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Blurs gathered light along one axis, not over edges of depth and normals.
// source: thesis 3.4 and 3.5: a geometry-aware blur over the interleaved pattern.
// note: Taps and weights are those of ambient/blur_bent. Dispatch along x, then with SHADED along y.
// definition SHADED: the last axis: what comes out is the picture, times albedo.
// binding camera: the camera; its viewport is the size of `depth`.
// binding blur: along which axis and how far.
// binding depth: depth buffer, a depth format or r32float.
// binding normals: unit normals in the world, any float format.
// binding light: of baselines/ssdo, or blurred once.
// binding albedos: linear RGB albedo 0..1, any float format; with SHADED.
// binding blurred: out, rgba16float: linear RGB radiance; alpha 1 where there is a surface, else 0.

#import airlight::core::camera::Camera
#import airlight::ambient::bent_blur::{BentBlur, edge_weight}
#import airlight::ambient::seen_surface::{seen_surface, seen_normal}

@group(#{GROUP}) @binding(0) var<uniform> camera: Camera;
@group(#{GROUP}) @binding(1) var<uniform> blur: BentBlur;
@group(#{GROUP}) @binding(2) var depth: texture_2d<f32>;
@group(#{GROUP}) @binding(3) var normals: texture_2d<f32>;
@group(#{GROUP}) @binding(4) var light: texture_2d<f32>;
@group(#{GROUP}) @binding(5) var blurred: texture_storage_2d<rgba16float, write>;
#ifdef SHADED
@group(#{GROUP}) @binding(6) var albedos: texture_2d<f32>;
#endif

@compute @workgroup_size(16, 8)
fn ssdo_blur(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= textureDimensions(blurred)) {
        return;
    }
    let size = vec2<i32>(textureDimensions(depth));
    let own = min(vec2<i32>(id.xy), size - 1);
    let last_normal = vec2<i32>(textureDimensions(normals)) - 1;
    let here = seen_surface(camera, own, textureLoad(depth, own, 0).x);
    let normal = seen_normal(textureLoad(normals, min(own, last_normal), 0).xyz, vec3<f32>(0.0));
    var sum = vec3<f32>(0.0);
    var weights = 0.0;
    for (var tap = 0u; tap < blur.taps; tap++) {
        let at = own + vec2<i32>(blur.axis) * (i32(tap) - i32(blur.taps / 2u));
        let other = clamp(at, vec2<i32>(0), size - 1);
        let there = seen_surface(camera, other, textureLoad(depth, other, 0).x);
        let facing = seen_normal(textureLoad(normals, min(other, last_normal), 0).xyz, vec3<f32>(0.0));
        let counts = all(at == other) && here.known && there.known;
        let weight = select(0.0, edge_weight(blur, here.place, normal, there.place, facing), counts);
        sum += weight * textureLoad(light, other, 0).rgb;
        weights += weight;
    }
    var mean = sum / select(weights, 1.0, weights <= 0.0);
#ifdef SHADED
    mean *= textureLoad(albedos, min(own, vec2<i32>(textureDimensions(albedos)) - 1), 0).rgb;
#endif
    textureStore(blurred, id.xy, vec4<f32>(mean, select(0.0, 1.0, here.known)));
}
