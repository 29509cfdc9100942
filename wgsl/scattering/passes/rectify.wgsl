// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Resamples a standard shadow map into the rectified map, where view rays run along rows at constant depth.
// source: thesis 4.4.1.
// note: Nearest texel: a blend of two depths is the depth of nothing. Blockers outside the bounds of a slice are
// note: clamped into its guard band; light rays outside the shadow map, or without a blocker, store 1.
// note: Non-finite depths count as empty.
// binding light: the directional light and its shadow map's clip space.
// binding frame: the frame of the slices.
// binding slices: their bounds, rgba32float, one texel a slice.
// binding shadow_map: depth of the standard shadow map, a depth format or r32float.
// binding rectified: out, depth 0..1, r32float; columns are radii, rows slices.

#import airlight::core::finite::finite_or
#import airlight::core::light::{Light, shadow_position, shadow_point}
#import airlight::scattering::rectify::{
    Frame, row_azimuth, slice_from_texel, light_ray_point, depth_from_blocker
}

@group(#{GROUP}) @binding(0) var<uniform> light: Light;
@group(#{GROUP}) @binding(1) var<uniform> frame: Frame;
@group(#{GROUP}) @binding(2) var slices: texture_2d<f32>;
@group(#{GROUP}) @binding(3) var shadow_map: texture_2d<f32>;
@group(#{GROUP}) @binding(4) var rectified: texture_storage_2d<r32float, write>;

@compute @workgroup_size(16, 8)
fn rectify(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = textureDimensions(rectified);
    if any(id.xy >= size) {
        return;
    }
    let slice = slice_from_texel(textureLoad(slices, vec2<u32>(id.y, 0u), 0));
    let radius = slice.radius_max * (f32(id.x) + 0.5) / f32(size.x);
    let point = light_ray_point(frame, row_azimuth(frame, f32(id.y)), radius);

    let map_size = vec2<f32>(textureDimensions(shadow_map));
    let at = shadow_position(light, map_size, point);
    let inside = all(at.xy >= vec2<f32>(0.0)) && all(at.xy < map_size);
    let texel = vec2<u32>(clamp(at.xy, vec2<f32>(0.0), map_size - 1.0));
    let stored = finite_or(textureLoad(shadow_map, texel, 0).x, light.far_depth);
    let blocker = shadow_point(light, map_size, at.xy, stored);
    let depth = depth_from_blocker(frame, slice, radius, blocker);
    let empty = !inside || stored == light.far_depth;
    textureStore(rectified, id.xy, vec4<f32>(select(depth, 1.0, empty), 0.0, 0.0, 1.0));
}
