// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Resamples a standard shadow map into the rectified map, where view rays run along rows at constant depth.
// source: thesis 4.4.1.
// note: Nearest texel: a blend of two depths is the depth of nothing. Blockers outside the bounds of a slice are
// note: clamped into its guard band; light rays outside the shadow map, or without a blocker, store 1.
// note: Non-finite depths count as empty.
// definition DEPTH_WARP: stretch depths near the light, see warped_depth.
// binding light: the directional light and its shadow map's clip space.
// binding frame: the frame of the slices.
// binding slices: their bounds, rgba32float, one texel a slice.
// binding shadow_map: depth of the standard shadow map, a depth format or r32float.
// binding rectified: out, depth 0..1, r32float; columns are radii, rows slices.

#import airlight::core::finite::finite_or
#import airlight::core::light::{Light, shadow_position}
#import airlight::scattering::rectify::{
    Frame, row_azimuth, azimuth_direction, slice_from_texel, depth_from_blocker, warped_depth
}

@group(#{GROUP}) @binding(0) var<uniform> light: Light;
@group(#{GROUP}) @binding(1) var<uniform> frame: Frame;
@group(#{GROUP}) @binding(2) var slices: texture_2d<f32>;
@group(#{GROUP}) @binding(3) var shadow_map: texture_2d<f32>;
@group(#{GROUP}) @binding(4) var rectified: texture_storage_2d<r32float, write>;

/// Texels a thread takes, a quarter of the row apart, so that neighbours in a workgroup stay neighbours.
const PER_THREAD: u32 = 4u;

@compute @workgroup_size(16, 8)
fn rectify(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = textureDimensions(rectified);
    let columns = (size.x + PER_THREAD - 1u) / PER_THREAD;
    if id.x >= columns || id.y >= size.y {
        return;
    }
    let slice = slice_from_texel(textureLoad(slices, vec2<u32>(id.y, 0u), 0));
    let radial = azimuth_direction(frame, row_azimuth(frame, f32(id.y)));
    let map_size = vec2<f32>(textureDimensions(shadow_map));

    // All that is affine in the radius along this row: position in the shadow map, and depth.
    let start = shadow_position(light, map_size, frame.eye);
    let stride = (shadow_position(light, map_size, frame.eye + slice.radius_max * radial) - start) / f32(size.x);
    // Metres towards the light for one unit of depth, negative for forward depth.
    let metres = dot(light.world_from_clip[2].xyz, frame.light);
    for (var part = 0u; part < PER_THREAD; part++) {
        let column = id.x + part * columns;
        if column >= size.x {
            break;
        }
        let step = f32(column) + 0.5;
        let at = start + step * stride;
        let inside = all(at.xy >= vec2<f32>(0.0)) && all(at.xy < map_size);
        let texel = vec2<u32>(clamp(at.xy, vec2<f32>(0.0), map_size - 1.0));
        let stored = finite_or(textureLoad(shadow_map, texel, 0).x, light.far_depth);
        // The point looked at lies at the height of the eye, so this is the blocker's height above it.
        let height = (stored - at.z) * metres;
        var depth = depth_from_blocker(slice, slice.radius_max * step / f32(size.x), height);
#ifdef DEPTH_WARP
        depth = warped_depth(depth);
#endif
        let empty = !inside || stored == light.far_depth;
        textureStore(rectified, vec2<u32>(column, id.y), vec4<f32>(select(depth, 1.0, empty), 0.0, 0.0, 1.0));
    }
}
