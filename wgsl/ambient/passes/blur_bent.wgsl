// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Blurs bent normals and openness along one axis, not over edges of depth and normals.
// source: thesis 3.4; Laine et al., "Incremental instant radiosity" (2007) for the weights.
// note: Dispatch over the picture along x, then along y from what came out: with as many pixels as the sampling pattern is wide every pixel's set
// note: counts once. What is blurred is how bent normals differ from normals (thesis Fig. 3.6), so that details of normals stay; an open
// note: surface has a mean direction of half its normal.
// definition PLAIN: mean directions themselves are blurred: details are lost.
// definition OCCLUSION_ONLY: only openness.
// binding camera: the camera; its viewport is the size of `depth`.
// binding blur: along which axis and how far.
// binding depth: depth buffer, a depth format or r32float.
// binding normals: unit normals in the world, any float format.
// binding bent: of ambient/occlude.
// binding blurred: out, like `bent`.

#import airlight::core::camera::Camera
#import airlight::ambient::bent_blur::{BentBlur, MOST_TAPS, edge_weight, mean_from_difference}
#import airlight::ambient::seen_surface::{seen_surface, seen_normal}

@group(#{GROUP}) @binding(0) var<uniform> camera: Camera;
@group(#{GROUP}) @binding(1) var<uniform> blur: BentBlur;
@group(#{GROUP}) @binding(2) var depth: texture_2d<f32>;
@group(#{GROUP}) @binding(3) var normals: texture_2d<f32>;
@group(#{GROUP}) @binding(4) var bent: texture_2d<f32>;
#ifdef OCCLUSION_ONLY
@group(#{GROUP}) @binding(5) var blurred: texture_storage_2d<r32float, write>;
#else
@group(#{GROUP}) @binding(5) var blurred: texture_storage_2d<rgba16float, write>;
#endif

@compute @workgroup_size(16, 8)
fn blur_bent(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = vec2<i32>(textureDimensions(depth));
    let pixel = vec2<i32>(id.xy);
    if any(id.xy >= textureDimensions(blurred)) {
        return;
    }
    let own = min(pixel, size - 1);
    let last_normal = vec2<i32>(textureDimensions(normals)) - 1;
    let here = seen_surface(camera, own, textureLoad(depth, own, 0).x);
    let normal = seen_normal(textureLoad(normals, min(own, last_normal), 0).xyz, vec3<f32>(0.0));
    var sum = vec4<f32>(0.0);
    var weights = 0.0;
    let taps = min(blur.taps, MOST_TAPS);
    for (var tap = 0u; tap < taps; tap++) {
        let at = own + vec2<i32>(blur.axis) * (i32(tap) - i32(taps / 2u));
        let inside = all(at >= vec2<i32>(0)) && all(at < size);
        let other = clamp(at, vec2<i32>(0), size - 1);
        let there = seen_surface(camera, other, textureLoad(depth, other, 0).x);
        let facing = seen_normal(textureLoad(normals, min(other, last_normal), 0).xyz, vec3<f32>(0.0));
        let counts = inside && here.known && there.known;
        let weight = select(0.0, edge_weight(blur, here.place, normal, there.place, facing), counts);
#ifdef OCCLUSION_ONLY
        sum.w += weight * textureLoad(bent, other, 0).x;
#else
        let value = textureLoad(bent, other, 0);
#ifdef PLAIN
        sum += weight * value;
#else
        sum += weight * vec4<f32>(value.xyz - 0.5 * facing, value.w);
#endif
#endif
        weights += weight;
    }
    // A pixel always counts itself, but where nothing is seen.
    let nothing = weights <= 0.0;
    let mean = sum / select(weights, 1.0, nothing);
#ifdef OCCLUSION_ONLY
    textureStore(blurred, id.xy, vec4<f32>(select(mean.w, 1.0, nothing), 0.0, 0.0, 1.0));
#else
#ifdef PLAIN
    let whole = mean.xyz;
#else
    let whole = mean_from_difference(mean.xyz, normal);
#endif
    textureStore(blurred, id.xy, select(vec4<f32>(whole, mean.w), vec4<f32>(0.0, 0.0, 0.0, 1.0), nothing));
#endif
}
