// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Light shafts evaluated as a transfer function has them: the last pass of a prefiltered method and `transfer` in one.
// source: stylized scattering, 4.2; thesis 4.3.3, Listing 4.4; 6.2.2.
// note: What is looked up is not rounded to a texel between the two. The property VISIBLE_DEPTH is marched: functions that
// note: ask for it stay with the pass `transfer`; here it counts as 0.
// note: What few functions ask for has to be defined: computing it and taking another value costs more than all the rest.
// definition ANGLES: the properties LIGHT_ANGLE and PICTURE_ANGLE, which count as 0 without it.
// definition ANISOTROPIC: the phase function of Henyey and Greenstein, instead of which stands the constant one without it.
// definition LOCAL: rows around a spot or point light, as in `scattering/evaluate_local`.
// definition PROJECTIVE: projective rows, as in `scattering/evaluate_projective`. Not with LOCAL.
// definition BASES: number M of bases, as in the filter; without RANK and MOMENTS.
// definition RANK: exact visibility by rank queries, bits of a depth as in the pass that made their structure. Not with REGIONS.
// definition WEIGHT_BITS: bits of a weight, as in `rank_weights`; with RANK, where that made the structure.
// definition WAVELET: by the wavelet matrix of `wavelet`; with RANK and AVERAGE, without LOCAL and PROJECTIVE.
// definition MOMENTS: visibility from what `filter_moments` stores. Not with REGIONS.
// definition COLORS: 3 with LIGHT_TEXTURE, 1 for the fall-off of a spot without. Not with REGIONS, NEAR_PLANE or PROJECTIVE.
// definition LIGHT_TEXTURE: a texture colours the light; with COLORS=3.
// definition PER_POINT: EPIPOLE_MARCH looks up every step by itself; needed with COLORS or SHADOW_ARRAY, without LOCAL.
// definition SHADOW_ARRAY: EPIPOLE_MARCH goes through the shadow maps of several views.
// definition LANCZOS: window the coefficients against ringing; for M of 8 and more.
// definition EPIPOLE_MARCH: march where a ray covers fewer than 8 texels; blends until 16. Not with PROJECTIVE.
// definition AVERAGE: the bases are plain means, and so is that march.
// definition NEAREST: the nearest texel of the bases instead of a bilinear blend; no sampler.
// definition REGIONS: regions that the rows were filtered in, as in the filter; without LOCAL.
// definition NEAR_PLANE: rays, and the medium, begin at the near plane instead of the eye; without LOCAL.
// definition DEPTH_WARP: as in `scattering/rectify`; without PROJECTIVE.
// binding camera: the camera, perspective, with PROJECTIVE any.
// binding light: the light: with LOCAL a spot or point light, else directional.
// binding medium: the medium.
// binding frame: the frame of the slices; without PROJECTIVE.
// binding slices: their bounds, rgba32float, one texel a slice; without PROJECTIVE.
// binding rows: the projective rows; with PROJECTIVE only.
// binding depth: depth buffer of the picture, a depth format or r32float; non-finite values count as far.
// binding shadow_map: depth of the standard shadow map; only with EPIPOLE_MARCH, without SHADOW_ARRAY.
// binding shadow_maps: depth of the views, a layer each; only with EPIPOLE_MARCH and SHADOW_ARRAY.
// binding shadow_views: the views; only with EPIPOLE_MARCH and SHADOW_ARRAY.
// binding light_texture: linear RGB 0..1 over the whole shadow map; only with EPIPOLE_MARCH and LIGHT_TEXTURE.
// binding light_sampler: linear, clamped to the edge; only with EPIPOLE_MARCH and LIGHT_TEXTURE.
// binding bases: filtered bases, M/4 layers, or what the filter makes with COLORS, rgba8unorm or rgba16float; without RANK and MOMENTS.
// binding wavelet: what `wavelet` makes, rgba32uint; with WAVELET only.
// binding rank_cells: what `rank` or `rank_weights` makes, rg32uint, with LIGHT_TEXTURE rgba32uint; with RANK only, without WAVELET; so the next two.
// binding rank_starts: the same, r32uint.
// binding rank_planes: the same, rgba32uint.
// binding rank_weights: what `rank_weights` makes, rgba32uint; with RANK and WEIGHT_BITS only.
// binding rectified: the rectified map, of which only the size is read; with RANK only.
// binding moments: what `filter_moments` makes, rgba32uint, with COLORS an array; with MOMENTS only.
// binding bases_sampler: linear; clamp to edge in u, repeat in v; absent with NEAREST, RANK and MOMENTS.
// binding restyled: out of the compute entry point (the fragment entry point returns it), rgba16float: linear RGB radiance, and in alpha the mean visibility 0..1.
// binding transfer_function: what is looked up, and what is made of it.
// binding transfer_map: the function, premultiplied linear RGBA, any float format that filters.
// binding transfer_sampler: linear, clamped to the edge.

#import airlight::core::finite::{finite_or, finite_or_rgb}
#import airlight::core::phase::ISOTROPIC
#import airlight::core::picture::picture_corner
#ifdef LOCAL
#import airlight::scattering::evaluated_local::{camera, light, scattered_ray}
#else ifdef PROJECTIVE
#import airlight::scattering::evaluated_projective::{camera, light, scattered_ray}
#else
#import airlight::scattering::evaluated::{camera, light, scattered_ray}
#endif
#import airlight::scattering::scattered_ray::ScatteredRay
#import airlight::stylize::tf_lookup::{
    TransferFunction, RayProperties, picture_angle, transfer_position, transfer_lookup, transfer_phase, stylized
}

@group(#{GROUP}) @binding(9) var<uniform> transfer_function: TransferFunction;
@group(#{GROUP}) @binding(16) var transfer_map: texture_2d<f32>;
@group(#{GROUP}) @binding(17) var transfer_sampler: sampler;
@group(#{GROUP}) @binding(18) var restyled: texture_storage_2d<rgba16float, write>;

/// What the function is asked about a ray.
fn ray_properties(ray: ScatteredRay) -> RayProperties {
    let visibility = clamp(finite_or(ray.visibility, 0.0), 0.0, 1.0);
    var of_ray = RayProperties(visibility, ray.distance, 1.0, 0.0, 0.0);
#ifdef ANGLES
    of_ray.cosine = ray.cosine;
    of_ray.picture_angle = picture_angle(camera, light, ray.ndc);
#endif
    return of_ray;
}

/// Radiance, and mean visibility in alpha, of a pixel.
fn pixel_light(pixel: vec2<u32>) -> vec4<f32> {
    let ray = scattered_ray(pixel);
    let of_ray = ray_properties(ray);
    let color = transfer_lookup(transfer_map, transfer_sampler, transfer_position(transfer_function, of_ray));
    let radiance = clamp(finite_or_rgb(ray.radiance, 0.0), vec3<f32>(0.0), vec3<f32>(65504.0));
#ifdef ANISOTROPIC
    let phase = transfer_phase(transfer_function, ray.cosine);
#else
    let phase = ISOTROPIC;
#endif
    return vec4<f32>(stylized(transfer_function, color, radiance, light.radiance, phase), of_ray.visibility);
}

@compute @workgroup_size(16, 8)
fn evaluate(@builtin(global_invocation_id) id: vec3<u32>) {
    if all(id.xy < textureDimensions(restyled)) {
        textureStore(restyled, id.xy, pixel_light(id.xy));
    }
}

@vertex
fn vertex_picture(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return picture_corner(index);
}

@fragment
fn fragment_evaluate(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return pixel_light(vec2<u32>(position.xy));
}
