// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Dilation or erosion of a shadow map along view rays, texel by texel: as many reads as the kernel has texels.
// source: stylized scattering, Eq. 3; thesis Eq. 6.1.
// note: Nearest texel: a sample lies exactly on the line and takes the depth of the texel that it falls into. What it is extruded
// note: to lies on the view ray through the sample, and so behind it.
// note: For a closing, dispatch a dilation into an intermediate map, then the erosion with the reflected kernel.
// binding epipole: the eye in the map.
// binding kernel: width, direction and extremum.
// binding shadow_map: the original map, a depth format or r32float.
// binding source: what is morphed: the same, or an intermediate map, r32float: facing depths, unclamped.
// binding morphed: out, r32float: the map, or the intermediate one.

#import airlight::stylize::epipolar_dilate::{
    Epipole, EpipolarKernel, line_towards, least_distance, distance_after, carried_depth, blocker_from_stored,
    stored_from_blocker, kept_depth
}

@group(#{GROUP}) @binding(0) var<uniform> epipole: Epipole;
@group(#{GROUP}) @binding(1) var<uniform> kernel: EpipolarKernel;
@group(#{GROUP}) @binding(2) var shadow_map: texture_2d<f32>;
@group(#{GROUP}) @binding(3) var source: texture_2d<f32>;
@group(#{GROUP}) @binding(4) var morphed: texture_storage_2d<r32float, write>;

/// Facing depth of a texel of the source.
fn blocker_at(texel: vec2<u32>) -> f32 {
    let value = textureLoad(source, texel, 0).x;
    return select(value, blocker_from_stored(value, kernel.far_depth), kernel.first == 1u);
}

@compute @workgroup_size(16, 8)
fn epipolar_direct(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = textureDimensions(shadow_map);
    if any(id.xy >= size) {
        return;
    }
    let extent = vec2<f32>(size);
    let at = vec2<f32>(id.xy) + 0.5;
    let line = line_towards(epipole, at);
    let least = least_distance(epipole);
    let direction = select(1.0, -1.0, kernel.away == 1u);
    var extremum = kernel.sign * blocker_at(id.xy);
    // A texel at the epipole has no line.
    let reach = select(0u, min(kernel.reach, max(size.x, size.y)), line.distance > least);
    for (var step = 1u; step <= reach; step++) {
        let along = direction * f32(step);
        let sample = at + along * line.step;
        let distance = distance_after(epipole, line.distance, along);
        if any(sample < vec2<f32>(0.0)) || any(sample >= extent) || distance <= least {
            break;
        }
        let depth = carried_depth(epipole, kernel.far_depth, blocker_at(vec2<u32>(sample)), distance, along);
        extremum = min(extremum, kernel.sign * depth);
    }
    var result = kernel.sign * extremum;
    if kernel.finish == 1u {
        let original = blocker_from_stored(textureLoad(shadow_map, id.xy, 0).x, kernel.far_depth);
        result = stored_from_blocker(kept_depth(kernel, original, result), kernel.far_depth);
    }
    textureStore(morphed, id.xy, vec4<f32>(result, 0.0, 0.0, 0.0));
}
