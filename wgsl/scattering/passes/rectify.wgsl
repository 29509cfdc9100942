// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Resamples a standard shadow map into the rectified map, where view rays run along rows at constant depth.
// source: thesis 4.4.1.
// note: Nearest texel: a blend of two depths is the depth of nothing. Blockers outside the bounds of a slice are
// note: clamped into its guard band; light rays outside the shadow map, or without a blocker, store 1.
// note: Non-finite depths count as empty.
// note: The blocker on a light ray is the point of that ray at the stored depth, also where the texel is wide.
// definition LOCAL: a spot or point light; columns are light angles.
// definition DEPTH_WARP: stretch depths near the light, see warped_depth.
// definition SHADOW_ARRAY: shadow maps of several views: cascades of a directional light, faces around a point light.
// binding light: the light, directional without LOCAL, and its shadow map's clip space.
// binding frame: the frame of the slices.
// binding slices: their bounds, rgba32float, one texel a slice.
// binding shadow_map: depth of the standard shadow map, a depth format or r32float; without SHADOW_ARRAY.
// binding shadow_maps: depth of the views, a layer each, a depth format or r32float; with SHADOW_ARRAY only.
// binding shadow_views: the views; a light ray belongs to the first that contains it; with SHADOW_ARRAY only.
// binding rectified: out, depth 0..1, r32float; columns are radii, with LOCAL light angles, rows slices.

#import airlight::core::finite::finite_or
#import airlight::core::light::{Light, shadow_position}
#import airlight::core::shadow_views::{ShadowViews, view_position}
#import airlight::scattering::local_light::{
    distance_to_light, local_slice_from_texel, ray_bounds, light_angle_of_column, light_ray_direction,
    angle_from_light_ray
}
#import airlight::scattering::rectify::{
    Frame, row_azimuth, azimuth_direction, slice_from_texel, depth_from_blocker, depth_from_angle,
    warped_depth
}
#import airlight::scattering::shadow_lookup::{shadow_in_map, shadow_in_view, blocker_point}

@group(#{GROUP}) @binding(0) var<uniform> light: Light;
@group(#{GROUP}) @binding(1) var<uniform> frame: Frame;
@group(#{GROUP}) @binding(2) var slices: texture_2d<f32>;
#ifdef SHADOW_ARRAY
@group(#{GROUP}) @binding(3) var shadow_maps: texture_2d_array<f32>;
@group(#{GROUP}) @binding(5) var<uniform> shadow_views: ShadowViews;
#else
@group(#{GROUP}) @binding(3) var shadow_map: texture_2d<f32>;
#endif
@group(#{GROUP}) @binding(4) var rectified: texture_storage_2d<r32float, write>;

/// Texels a thread takes, a quarter of the row apart, so that neighbours in a workgroup stay neighbours.
const PER_THREAD: u32 = 4u;

#ifdef LOCAL
/// Depth of the blocker on the light ray of `row` at `unit`, 0..1 along the row.
fn depth_of_light_ray(row: u32, unit: f32) -> f32 {
    let slice = local_slice_from_texel(textureLoad(slices, vec2<u32>(row, 0u), 0));
    let radial = azimuth_direction(frame, row_azimuth(frame, f32(row)));
    let at_light = light_angle_of_column(slice, unit);
    let direction = light_ray_direction(frame, radial, at_light);
    let blocker = blocker_on_ray(light.position + direction);
    let along = clamp(dot(blocker.xyz - light.position, direction), 0.0, 1e15);
    let angle = angle_from_light_ray(distance_to_light(frame, light.position), at_light, along);
    return select(1.0, depth_from_angle(ray_bounds(slice), angle), blocker.w > 0.0);
}
#else ifdef SHADOW_ARRAY
/// Depth of the blocker on the light ray of `row` at `unit`, 0..1 along the row.
fn depth_of_light_ray(row: u32, unit: f32) -> f32 {
    let slice = slice_from_texel(textureLoad(slices, vec2<u32>(row, 0u), 0));
    let radius = unit * slice.radius_max;
    let blocker = blocker_on_ray(frame.eye + radius * azimuth_direction(frame, row_azimuth(frame, f32(row))));
    let height = dot(blocker.xyz - frame.eye, frame.light);
    return select(1.0, depth_from_blocker(slice, radius, height), blocker.w > 0.0);
}
#endif

#ifdef SHADOW_ARRAY
/// The blocker on the light ray through `point` in the world, metres, and 1 in w; w is 0 where there is none.
fn blocker_on_ray(point: vec3<f32>) -> vec4<f32> {
    let place = view_position(shadow_views, vec2<f32>(textureDimensions(shadow_maps)), point);
    let shadow = shadow_in_view(shadow_maps, place, light.far_depth);
    return blocker_point(
        shadow, shadow_views.clip_from_world[place.view], shadow_views.world_from_clip[place.view], point
    );
}
#else ifdef LOCAL
/// The blocker on the light ray through `point` in the world, metres, and 1 in w; w is 0 where there is none.
fn blocker_on_ray(point: vec3<f32>) -> vec4<f32> {
    let shadow = shadow_in_map(shadow_map, light, point);
    return blocker_point(shadow, light.clip_from_world, light.world_from_clip, point);
}
#endif

@compute @workgroup_size(16, 8)
fn rectify(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = textureDimensions(rectified);
    let columns = (size.x + PER_THREAD - 1u) / PER_THREAD;
    if id.x >= columns || id.y >= size.y {
        return;
    }
#ifndef LOCAL
#ifndef SHADOW_ARRAY
    let slice = slice_from_texel(textureLoad(slices, vec2<u32>(id.y, 0u), 0));
    let radial = azimuth_direction(frame, row_azimuth(frame, f32(id.y)));
    let map_size = vec2<f32>(textureDimensions(shadow_map));

    // All that is affine in the radius along this row: position in the shadow map, and depth.
    let start = shadow_position(light, map_size, frame.eye);
    let stride = (shadow_position(light, map_size, frame.eye + slice.radius_max * radial) - start) / f32(size.x);
    // Metres towards the light for one unit of depth, negative for forward depth.
    let metres = dot(light.world_from_clip[2].xyz, frame.light);
#endif
#endif
    for (var part = 0u; part < PER_THREAD; part++) {
        let column = id.x + part * columns;
        if column >= size.x {
            break;
        }
        let step = f32(column) + 0.5;
#ifdef LOCAL
        var depth = depth_of_light_ray(id.y, step / f32(size.x));
#else ifdef SHADOW_ARRAY
        var depth = depth_of_light_ray(id.y, step / f32(size.x));
#else
        let at = start + step * stride;
        let inside = all(at.xy >= vec2<f32>(0.0)) && all(at.xy < map_size);
        let texel = vec2<u32>(clamp(at.xy, vec2<f32>(0.0), map_size - 1.0));
        let stored = finite_or(textureLoad(shadow_map, texel, 0).x, light.far_depth);
        // The point looked at lies at the height of the eye, so this is the blocker's height above it.
        let height = (stored - at.z) * metres;
        let found = depth_from_blocker(slice, slice.radius_max * step / f32(size.x), height);
        let empty = !inside || stored == light.far_depth;
        var depth = select(found, 1.0, empty);
#endif
#ifdef DEPTH_WARP
        depth = warped_depth(depth);
#endif
        textureStore(rectified, vec2<u32>(column, id.y), vec4<f32>(depth, 0.0, 0.0, 1.0));
    }
}
