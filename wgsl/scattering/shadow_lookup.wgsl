// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::scattering::shadow_lookup
// summary: Blocker and visibility of a single light ray, in one shadow map or in an array of views, of any light.
// source: L. Williams, "Casting curved shadows on curved surfaces" (1978).
// note: Nearest texel. The blocker is the point of the light ray itself at the stored depth, also where the texel is
// note: wide. Outside every map, and where nothing is stored, there is none; non-finite depths count as empty.
// equation: lit ⇔ nothing is stored, or depth ≤ stored (reversed: ≥)
// error: one cascade shows what a single map does, but for 1 in 500 texels; test scattering/local_lights_directional::one_cascade_is_the_single_map.
// error: depths that are not finite count as empty; test scattering/any_input::depths_that_are_not_finite_count_as_empty_and_far.
// parameter map: depths, a depth format or r32float.
// parameter maps: depths, a layer a view.
// parameter point: metres in the world.
// parameter far_depth: of an empty texel: 1 forward, 0 reversed.

#import airlight::core::finite::finite_or
#import airlight::core::light::{Light, shadow_position}
#import airlight::core::shadow_views::{ViewPosition, point_at_depth}

/// A texel of a shadow map, on the way from a point in the world.
struct Shadow {
    /// Depth of the point itself.
    depth: f32,
    /// Depth of the blocker, 0..1; that of an empty texel where there is none.
    stored: f32,
    /// 1 where there is a blocker on this light ray, nearer to the light or not, else 0.
    blocked: u32,
}

/// The shadow map's texel on the light ray through `point`, metres in the world. `map`: a depth format or r32float.
fn shadow_in_map(map: texture_2d<f32>, light: Light, point: vec3<f32>) -> Shadow {
    let size = vec2<f32>(textureDimensions(map));
    let at = shadow_position(light, size, point);
    let inside = all(at.xy >= vec2<f32>(0.0)) && all(at.xy < size);
    let texel = vec2<u32>(clamp(at.xy, vec2<f32>(0.0), size - 1.0));
    let stored = clamp(finite_or(textureLoad(map, texel, 0).x, light.far_depth), 0.0, 1.0);
    return Shadow(at.z, stored, select(0u, 1u, inside && stored != light.far_depth));
}

/// Like `shadow_in_map`, in the layer of an array that `place`, from `view_position`, names. `far_depth`: of an empty texel.
fn shadow_in_view(maps: texture_2d_array<f32>, place: ViewPosition, far_depth: f32) -> Shadow {
    let last = vec2<f32>(textureDimensions(maps)) - 1.0;
    let texel = vec2<u32>(clamp(place.at.xy, vec2<f32>(0.0), last));
    let stored = clamp(finite_or(textureLoad(maps, texel, place.view, 0).x, far_depth), 0.0, 1.0);
    return Shadow(place.at.z, stored, select(0u, place.inside, stored != far_depth));
}

/// 1 where the point is lit, else 0. `far_depth`: of an empty texel, 1 forward, 0 reversed.
fn lit_by_shadow(shadow: Shadow, far_depth: f32) -> f32 {
    // Depth must grow away from the light for the comparison.
    let facing = select(-1.0, 1.0, far_depth > 0.5);
    return select(0.0, 1.0, shadow.blocked == 0u || shadow.depth * facing <= shadow.stored * facing);
}

/// The blocker on the light ray through `point`, metres in the world, and 1 in w; w is 0 where there is none.
/// `clip_from_world`, `world_from_clip`: of the map that `shadow` was read from.
fn blocker_point(
    shadow: Shadow, clip_from_world: mat4x4<f32>, world_from_clip: mat4x4<f32>, point: vec3<f32>
) -> vec4<f32> {
    return vec4<f32>(point_at_depth(clip_from_world, world_from_clip, point, shadow.stored), f32(shadow.blocked));
}
