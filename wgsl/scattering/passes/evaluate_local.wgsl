// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: In-scattered radiance of every pixel around a spot or point light, from filtered bases, moments or rank queries.
// source: thesis 4.3.1 to 4.3.3, Eq. 4.6 and 4.9; V. Pegoraro and S. Parker, "An analytical solution to single scattering in homogeneous participating media" (2009).
// definition BASES: number M of bases, as in the filter; without RANK and MOMENTS.
// definition RANK: exact visibility by rank queries, bits of a depth as in `rank_weights`.
// definition WEIGHT_BITS: bits of a weight, as in `rank_weights`; with RANK.
// definition MOMENTS: visibility from what `filter_moments` stores.
// definition COLORS: 1 for the fall-off of a spot, 3 with LIGHT_TEXTURE, as in the filter.
// definition LIGHT_TEXTURE: a texture colours the light; with COLORS=3.
// definition SHADOW_ARRAY: EPIPOLE_MARCH goes through the shadow maps of several views.
// definition LANCZOS: window the coefficients against ringing; for M of 8 and more.
// definition EPIPOLE_MARCH: march where a ray covers fewer than 8 texels; blends until 16.
// definition AVERAGE: the bases are plain means, and so is that march.
// definition NEAREST: the nearest texel of the bases instead of a bilinear blend; no sampler.
// definition DEPTH_WARP: as in rectify.
// binding camera: the camera, perspective.
// binding light: the spot or point light and its shadow map's clip space.
// binding medium: the medium.
// binding frame: the frame of the slices.
// binding slices: their bounds, rgba32float, one texel a slice.
// binding depth: depth buffer of the picture, a depth format or r32float; non-finite values count as far.
// binding shadow_map: depth of the standard shadow map; only with EPIPOLE_MARCH, without SHADOW_ARRAY.
// binding shadow_maps: depth of the views, a layer each; only with EPIPOLE_MARCH and SHADOW_ARRAY.
// binding shadow_views: the views; only with EPIPOLE_MARCH and SHADOW_ARRAY.
// binding light_texture: linear RGB 0..1 over the whole shadow map; only with EPIPOLE_MARCH and LIGHT_TEXTURE.
// binding light_sampler: linear, clamped to the edge; only with EPIPOLE_MARCH and LIGHT_TEXTURE.
// binding bases: filtered bases, M/4 layers, or what the filter makes with COLORS, rgba8unorm or rgba16float; without RANK and MOMENTS.
// binding rank_cells: what `rank_weights` makes, rg32uint, with LIGHT_TEXTURE rgba32uint; with RANK only.
// binding rank_starts: the same, r32uint; with RANK only.
// binding rank_planes: the same, rgba32uint; with RANK only.
// binding rank_weights: the same, rgba32uint; with RANK only.
// binding rectified: the rectified map, of which only the size is read; with RANK only.
// binding moments: what `filter_moments` makes, rgba32uint, with COLORS an array; with MOMENTS only.
// binding bases_sampler: linear; clamp to edge in u, repeat in v; absent with NEAREST, RANK and MOMENTS.
// binding scattered: out of the compute entry point (the fragment entry point returns it), rgba16float: linear RGB radiance, and in alpha the mean visibility 0..1.

#import airlight::core::picture::picture_corner
#import airlight::scattering::evaluated_local::scattered_ray
#import airlight::scattering::scattered_ray::scattered_texel

@group(#{GROUP}) @binding(9) var scattered: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(16, 8)
fn evaluate_local(@builtin(global_invocation_id) id: vec3<u32>) {
    if all(id.xy < textureDimensions(scattered)) {
        textureStore(scattered, id.xy, scattered_texel(scattered_ray(id.xy)));
    }
}

@vertex
fn vertex_picture(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return picture_corner(index);
}

@fragment
fn fragment_evaluate_local(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return scattered_texel(scattered_ray(vec2<u32>(position.xy)));
}
