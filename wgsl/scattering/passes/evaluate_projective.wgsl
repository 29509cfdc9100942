// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: In-scattered radiance of every pixel from filtered bases, moments or rank queries over projective rows, for cameras of any kind.
// source: thesis 4.3.1 and 4.3.3, Eq. 4.6 and 4.9, Listing 4.4.
// definition BASES: number M of bases, as in the filter; without RANK and MOMENTS.
// definition RANK: exact visibility by rank queries, bits of a depth as in `rank_weights`. Not with REGIONS.
// definition WEIGHT_BITS: bits of a weight, as in `rank_weights`; with RANK.
// definition MOMENTS: visibility from what `filter_moments` stores. Not with REGIONS.
// definition LANCZOS: window the coefficients against ringing; for M of 8 and more.
// definition AVERAGE: the bases are plain means.
// definition NEAREST: the nearest texel of the bases instead of a bilinear blend; no sampler.
// definition REGIONS: regions that the rows were filtered in, as in the filter; more than one costs more reads a pixel.
// definition NEAR_PLANE: rays, and the medium, begin at the near plane instead of the eye.
// binding camera: the camera, any.
// binding light: the directional light and its shadow map's clip space.
// binding medium: the medium.
// binding rows: the projective rows.
// binding depth: depth buffer of the picture, a depth format or r32float; non-finite values count as far.
// binding bases: filtered bases, M/4 layers, rgba8unorm or rgba16float; without RANK and MOMENTS.
// binding rank_cells: what `rank_weights` makes, rg32uint; with RANK only.
// binding rank_starts: the same, r32uint; with RANK only.
// binding rank_planes: the same, rgba32uint; with RANK only.
// binding rank_weights: the same, rgba32uint; with RANK only.
// binding rectified: the rectified map, of which only the size is read; with RANK only.
// binding moments: what `filter_moments` makes, rgba32uint; with MOMENTS only.
// binding bases_sampler: linear; clamp to edge in u, repeat in v; absent with NEAREST, RANK and MOMENTS.
// binding scattered: out of the compute entry point (the fragment entry point returns it), rgba16float: linear RGB radiance, and in alpha the mean visibility 0..1.

#import airlight::core::picture::picture_corner
#import airlight::scattering::evaluated_projective::scattered_ray
#import airlight::scattering::scattered_ray::scattered_texel

@group(#{GROUP}) @binding(9) var scattered: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(16, 8)
fn evaluate_projective(@builtin(global_invocation_id) id: vec3<u32>) {
    if all(id.xy < textureDimensions(scattered)) {
        textureStore(scattered, id.xy, scattered_texel(scattered_ray(id.xy)));
    }
}

@vertex
fn vertex_picture(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return picture_corner(index);
}

@fragment
fn fragment_evaluate_projective(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return scattered_texel(scattered_ray(vec2<u32>(position.xy)));
}
