// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: From epipolar lines back to the shadow map: each texel takes the line that passes next to its centre.
// source: stylized scattering, Eq. 3, with every epipolar line as a row.
// note: That line is at most half a texel away, and is read exactly at the texel's step. A dilation or closing never removes
// note: what the original map has, an erosion or opening never adds to it.
// binding epipole: the eye in the map.
// binding kernel: depth convention and what is kept of the original.
// binding shadow_map: the original map, a depth format or r32float.
// binding lines: the lines after the pass sliding_extremum, r32float.
// binding morphed: out, r32float: the map.

#import airlight::stylize::epipolar_dilate::{
    Epipole, EpipolarKernel, epipolar_row, row_place, row_through, steps_along, depth_in_row, blocker_from_stored,
    stored_from_blocker, kept_depth
}

@group(#{GROUP}) @binding(0) var<uniform> epipole: Epipole;
@group(#{GROUP}) @binding(1) var<uniform> kernel: EpipolarKernel;
@group(#{GROUP}) @binding(2) var shadow_map: texture_2d<f32>;
@group(#{GROUP}) @binding(3) var lines: texture_2d<f32>;
@group(#{GROUP}) @binding(4) var morphed: texture_storage_2d<r32float, write>;

@compute @workgroup_size(16, 8)
fn epipolar_return(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = textureDimensions(shadow_map);
    if any(id.xy >= size) {
        return;
    }
    let at = vec2<f32>(id.xy) + 0.5;
    let original = blocker_from_stored(textureLoad(shadow_map, id.xy, 0).x, kernel.far_depth);
    let row = epipolar_row(epipole, size, row_through(epipole, size, at));
    let along = steps_along(row, at);
    let stored = textureLoad(lines, row_place(size, row, min(along, max(row.length, 1u) - 1u)), 0).x;
    let result = depth_in_row(epipole, kernel.far_depth, row, stored, f32(along));
    // Texels at the epipole have no line.
    let kept = select(original, kept_depth(kernel, original, result), along < row.length);
    textureStore(morphed, id.xy, vec4<f32>(stored_from_blocker(kept, kernel.far_depth), 0.0, 0.0, 0.0));
}
