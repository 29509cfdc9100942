// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Resamples a standard shadow map into the projective map, for engines that do not draw it (pass project) and for orthographic cameras.
// source: thesis 4.4.2.
// note: Nearest texel: a blend of two depths is the depth of nothing. Blockers outside the view frustum are
// note: clamped into its guard band; light rays outside the shadow map, or without a blocker, store 1.
// note: Non-finite depths count as empty.
// binding light: the directional light and its shadow map's clip space.
// binding rows: the projective rows.
// binding shadow_map: depth of the standard shadow map, a depth format or r32float.
// binding rectified: out, depth 0..1, r32float; columns and rows of the projective map.

#import airlight::core::finite::finite_or
#import airlight::core::light::{Light, shadow_position}
#import airlight::scattering::projective::{ProjectiveRows, depth_from_blocker, light_ray_point, x_from_column}

@group(#{GROUP}) @binding(0) var<uniform> light: Light;
@group(#{GROUP}) @binding(5) var<uniform> rows: ProjectiveRows;
@group(#{GROUP}) @binding(3) var shadow_map: texture_2d<f32>;
@group(#{GROUP}) @binding(4) var rectified: texture_storage_2d<r32float, write>;

/// Texels a thread takes, a quarter of the row apart, so that neighbours in a workgroup stay neighbours.
const PER_THREAD: u32 = 4u;

@compute @workgroup_size(16, 8)
fn rectify_projective(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = textureDimensions(rectified);
    let columns = (size.x + PER_THREAD - 1u) / PER_THREAD;
    if id.x >= columns || id.y >= size.y {
        return;
    }
    let map_size = vec2<f32>(textureDimensions(shadow_map));
    // All that is affine along this row: position in the shadow map, and depth.
    let height = f32(size.y);
    let nearest = light_ray_point(rows, height, f32(id.y), rows.near);
    let farthest = light_ray_point(rows, height, f32(id.y), rows.bounds.w);
    let start = shadow_position(light, map_size, nearest);
    let stride = (shadow_position(light, map_size, farthest) - start) / (rows.bounds.w - rows.near);
    let metres = -dot(light.world_from_clip[2].xyz, rows.away);
    for (var part = 0u; part < PER_THREAD; part++) {
        let column = id.x + part * columns;
        if column >= size.x {
            break;
        }
        let step = f32(column) + 0.5;
        let x = x_from_column(rows, f32(size.x), step);
        let at = start + (x - rows.near) * stride;
        let inside = all(at.xy >= vec2<f32>(0.0)) && all(at.xy < map_size);
        let texel = vec2<u32>(clamp(at.xy, vec2<f32>(0.0), map_size - 1.0));
        let stored = finite_or(textureLoad(shadow_map, texel, 0).x, light.far_depth);
        // The point looked at lies at the height of the eye, so this is the blocker's height above it.
        let above = (stored - at.z) * metres;
        let depth = depth_from_blocker(rows, x, -above);
        let empty = !inside || stored == light.far_depth;
        textureStore(rectified, vec2<u32>(column, id.y), vec4<f32>(select(depth, 1.0, empty), 0.0, 0.0, 1.0));
    }
}
