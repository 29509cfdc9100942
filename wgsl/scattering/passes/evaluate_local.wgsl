// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: In-scattered radiance of every pixel around a spot or point light, from filtered bases, moments or rank queries.
// source: thesis 4.3.1 to 4.3.3, Eq. 4.6 and 4.9; V. Pegoraro and S. Parker, "An analytical solution to single scattering in homogeneous participating media" (2009).
// note: Texel i of the bases holds the mean over the texels 0 .. i, so that a ray of s texels is read at s - 1/2.
// note: Around the light's place in the picture (and its antipode's) rays cover only a few texels and the light
// note: would bleed through blockers: EPIPOLE_MARCH marches the standard shadow map wherever a ray covers few
// note: texels, very short rays included, blended in without a seam.
// note: Around a spot or point light the mean of visibility times fall-off is taken out of the airlight integral, as the
// note: mean visibility is in Eq. 4.2; the columns, linear in the angle at the light, hold the fall-off with distance.
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

#import airlight::core::camera::{Camera, perspective_ray, ndc_from_pixel}
#import airlight::core::finite::finite_or
#import airlight::core::light::Light
#import airlight::core::picture::picture_corner
#import airlight::scattering::local_light::{
    distance_to_light, local_slice_from_texel, ray_bounds, light_angle, columns_covered, distance_from_light_angle,
    local_ray, airlight, local_in_scattered
}
#ifdef EPIPOLE_MARCH
#import airlight::scattering::lit::marched_local_light
#endif
#import airlight::scattering::prefiltered::{Prefix, map_size, prefix_visibility, prefix_colors}
#import airlight::scattering::rectify::{
    Frame, epipolar_ray, nearest_row, depth_from_ray, warped_depth
}
#import airlight::scattering::rows::RowRay
#import airlight::scattering::single_scatter::Medium

@group(#{GROUP}) @binding(0) var<uniform> camera: Camera;
@group(#{GROUP}) @binding(1) var<uniform> light: Light;
@group(#{GROUP}) @binding(2) var<uniform> medium: Medium;
@group(#{GROUP}) @binding(3) var<uniform> frame: Frame;
@group(#{GROUP}) @binding(4) var slices: texture_2d<f32>;
@group(#{GROUP}) @binding(5) var depth: texture_2d<f32>;
@group(#{GROUP}) @binding(9) var scattered: texture_storage_2d<rgba16float, write>;

/// Rays that cover fewer texels are marched.
const EPIPOLE_TEXELS: f32 = 8.0;
/// Steps of that march.
const EPIPOLE_STEPS: u32 = 96u;

/// Radiance, and mean visibility in alpha, of a pixel.
fn pixel_light(pixel: vec2<u32>) -> vec4<f32> {
    let ndc = ndc_from_pixel(camera, vec2<f32>(pixel) + 0.5);
    let surface = clamp(finite_or(textureLoad(depth, pixel, 0).x, camera.far_depth), 0.0, 1.0);
    let ray = epipolar_ray(frame, ndc, surface, medium.distance_limit);
    let slice = local_slice_from_texel(textureLoad(slices, vec2<u32>(nearest_row(frame, ray.row), 0u), 0));
    let width = f32(map_size().x);
    let away = distance_to_light(frame, light.position);
    let texels = width * columns_covered(slice, light_angle(away, ray.cosine, ray.sine, ray.distance));
    var row_ray = RowRay(ray.row, 0.0, texels, depth_from_ray(ray_bounds(slice), ray));
#ifdef DEPTH_WARP
    row_ray.depth = warped_depth(row_ray.depth);
#endif
    let prefix = Prefix(ray.row, frame.wraps, 0.0, texels, 0.0, 0.0);
#ifdef COLORS
    var lit = prefix_colors(prefix, row_ray.depth);
#else
    var lit = vec3<f32>(clamp(prefix_visibility(prefix, row_ray.depth), 0.0, 1.0));
#endif
    // The stretch of the ray between the least and the greatest light angle of the slice.
    let span = vec2<f32>(
        distance_from_light_angle(away, ray.angle, slice.light_angle_min, ray.distance),
        distance_from_light_angle(away, ray.angle, slice.light_angle_max, ray.distance)
    );
#ifdef EPIPOLE_MARCH
#ifdef AVERAGE
    let extinction = 0.0;
#else
    let extinction = medium.extinction;
#endif
    let near_epipole = 1.0 - smoothstep(EPIPOLE_TEXELS, 2.0 * EPIPOLE_TEXELS, texels);
    // A ray that ends before it comes into the light has nothing to march.
    let steps = select(0u, EPIPOLE_STEPS, near_epipole > 0.0 && span.y > span.x);
    let direction = perspective_ray(camera, ndc).direction;
    let marched = marched_local_light(
        light, medium.g, camera.eye, direction, away, ray.cosine, ray.sine, span, extinction, steps, 0.5
    );
    lit = mix(lit, marched, near_epipole);
#endif
    let integral = airlight(
        local_ray(away, ray.cosine, ray.sine, light.radius), medium.extinction, medium.g, span.x, span.y
    );
    let radiance = local_in_scattered(medium, light.radiance, integral, lit);
    return vec4<f32>(min(radiance, vec3<f32>(65504.0)), dot(lit, vec3<f32>(1.0 / 3.0)));
}

@compute @workgroup_size(16, 8)
fn evaluate_local(@builtin(global_invocation_id) id: vec3<u32>) {
    if all(id.xy < textureDimensions(scattered)) {
        textureStore(scattered, id.xy, pixel_light(id.xy));
    }
}

@vertex
fn vertex_picture(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return picture_corner(index);
}

@fragment
fn fragment_evaluate_local(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return pixel_light(vec2<u32>(position.xy));
}
