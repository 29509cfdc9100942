// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: In-scattered radiance of every pixel from the filtered bases: a dot product, whatever the scene.
// source: thesis 4.3.1 and 4.3.3, Eq. 4.6 and 4.9, Listing 4.4.
// note: Texel i holds the mean over the texels 0 .. i, so that a ray of s texels is read at s - 1/2.
// note: Around the light's place in the picture (and its antipode's) rays cover only a few texels and the light
// note: would bleed through blockers: EPIPOLE_MARCH marches the standard shadow map wherever a ray covers few
// note: texels, very short rays included, blended in without a seam.
// note: A ray of an orthographic camera begins inside its projective row: what lies before is subtracted, which amplifies
// note: the rounding of the bases where it outweighs the ray. Store them as rgba16float there.
// definition BASES: number M of bases, as in the filter.
// definition PROJECTIVE: projective rows instead of epipolar slices.
// definition LANCZOS: window the coefficients against ringing; for M of 8 and more.
// definition EPIPOLE_MARCH: march where a ray covers fewer than 8 texels; blends until 16.
// definition AVERAGE: the bases are plain means, and so is that march.
// binding camera: the camera, perspective; with PROJECTIVE any.
// binding light: the directional light and its shadow map's clip space.
// binding medium: the medium.
// binding frame: the frame of the slices; absent with PROJECTIVE.
// binding slices: their bounds, rgba32float, one texel a slice; absent with PROJECTIVE.
// binding rows: the projective rows; with PROJECTIVE only.
// binding depth: depth buffer of the picture, a depth format or r32float; non-finite values count as far.
// binding shadow_map: depth of the standard shadow map; only with EPIPOLE_MARCH.
// binding bases: filtered bases, M/4 layers, rgba8unorm or rgba16float.
// binding bases_sampler: linear; clamp to edge in u, repeat in v.
// binding scattered: out of the compute entry point (the fragment entry point returns it), rgba16float: linear RGB radiance, and in alpha the mean visibility 0..1.

#import airlight::core::camera::{
    Camera, view_ray, perspective_ray, ndc_from_pixel, distance_from_depth, perspective_distance
}
#import airlight::core::finite::finite_or
#import airlight::core::fourier_basis::{
    series_first, series_next, coefficients, coefficients_lanczos, basis_from_stored
}
#import airlight::core::light::Light
#import airlight::scattering::march::march_shadow_map
#import airlight::scattering::projective::{
    ProjectiveRows, PERSPECTIVE, projective_ray, reference_reach, column_from_x, filtered_column, weight_until
}
#import airlight::scattering::rectify::{
    Frame, epipolar_ray, nearest_row, slice_from_texel, depth_from_ray
}
#import airlight::scattering::single_scatter::{Medium, in_scattered}

@group(#{GROUP}) @binding(0) var<uniform> camera: Camera;
@group(#{GROUP}) @binding(1) var<uniform> light: Light;
@group(#{GROUP}) @binding(2) var<uniform> medium: Medium;
#ifdef PROJECTIVE
@group(#{GROUP}) @binding(10) var<uniform> rows: ProjectiveRows;
#else
@group(#{GROUP}) @binding(3) var<uniform> frame: Frame;
@group(#{GROUP}) @binding(4) var slices: texture_2d<f32>;
#endif
@group(#{GROUP}) @binding(5) var depth: texture_2d<f32>;
#ifdef EPIPOLE_MARCH
@group(#{GROUP}) @binding(6) var shadow_map: texture_2d<f32>;
#endif
@group(#{GROUP}) @binding(7) var bases: texture_2d_array<f32>;
@group(#{GROUP}) @binding(8) var bases_sampler: sampler;
@group(#{GROUP}) @binding(9) var scattered: texture_storage_2d<rgba16float, write>;

const LAYERS: u32 = u32(#{BASES}) / 4u;

/// Rays that cover fewer texels are marched.
const EPIPOLE_TEXELS: f32 = 8.0;
/// Steps of that march.
const EPIPOLE_STEPS: u32 = 96u;

/// Mean visibility by the filtered bases at `at`, in texture coordinates, for a ray of this depth; not clamped.
fn filtered_visibility(at: vec2<f32>, depth_of_ray: f32) -> f32 {
    var series = series_first(depth_of_ray);
#ifdef LANCZOS
    var window = series_first(1.0 / f32(4u * LAYERS));
#endif
    var visibility = 0.5;
    for (var layer = 0u; layer < LAYERS; layer++) {
        let filtered = basis_from_stored(textureSampleLevel(bases, bases_sampler, at, layer, 0.0));
#ifdef LANCZOS
        visibility += dot(coefficients_lanczos(series, window, layer, 4u * LAYERS), filtered);
        window = series_next(window);
#else
        visibility += dot(coefficients(series, layer), filtered);
#endif
        series = series_next(series);
    }
    return visibility;
}

/// Radiance, and mean visibility in alpha, of a pixel.
fn pixel_light(pixel: vec2<u32>) -> vec4<f32> {
    let ndc = ndc_from_pixel(camera, vec2<f32>(pixel) + 0.5);
    let surface = clamp(finite_or(textureLoad(depth, pixel, 0).x, camera.far_depth), 0.0, 1.0);
    let size = vec2<f32>(textureDimensions(bases).xy);
#ifdef AVERAGE
    let extinction = 0.0;
#else
    let extinction = medium.extinction;
#endif
#ifdef PROJECTIVE
    let ray = view_ray(camera, ndc);
    let distance = distance_from_depth(camera, ray, ndc, surface, medium.distance_limit);
    let along = projective_ray(rows, size.y, ray.origin, ray.direction, distance);
    let texels = column_from_x(rows, size.x, along.end) - column_from_x(rows, size.x, along.begin);
    let reach = reference_reach(rows, size.y, along.row);
    let row_coordinate = (along.row + 0.5) / size.y;
    let end = filtered_column(rows, size.x, reach, extinction, along.end) / size.x;
    var visibility = filtered_visibility(vec2<f32>(end, row_coordinate), along.depth);
    if rows.projection != PERSPECTIVE {
        let begin = filtered_column(rows, size.x, reach, extinction, along.begin) / size.x;
        let before = filtered_visibility(vec2<f32>(begin, row_coordinate), along.depth);
        let weight_before = weight_until(rows, reach, extinction, along.begin);
        let weight = weight_until(rows, reach, extinction, along.end);
        let left = max(weight - weight_before, 1e-5 * weight);
        visibility = clamp(visibility, 0.0, 1.0);
        visibility += (visibility - clamp(before, 0.0, 1.0)) * weight_before / max(left, 1e-30);
    }
#else
    let ray = perspective_ray(camera, ndc);
    let distance = perspective_distance(camera, ndc, surface, medium.distance_limit);

    let epipolar = epipolar_ray(frame, ray.direction);
    // The bounds of the nearest slice: those of the next one differ by far less than the series resolves.
    let row = nearest_row(frame, epipolar.row);
    let slice = slice_from_texel(textureLoad(slices, vec2<u32>(row, 0u), 0));
    let texels = clamp(size.x * distance * epipolar.sine / slice.radius_max, 0.0, size.x);
    let at = vec2<f32>(max(texels - 0.5, 0.5), epipolar.row + 0.5) / size;
    var visibility = filtered_visibility(at, depth_from_ray(slice, epipolar));
#endif
    visibility = clamp(visibility, 0.0, 1.0);

#ifdef EPIPOLE_MARCH
    let near_epipole = 1.0 - smoothstep(EPIPOLE_TEXELS, 2.0 * EPIPOLE_TEXELS, texels);
    let steps = select(0u, EPIPOLE_STEPS, near_epipole > 0.0);
    let marched = march_shadow_map(
        shadow_map, light, ray.origin, ray.direction, distance, extinction, steps, 0.5
    );
    visibility = mix(visibility, marched, near_epipole);
#endif

    let cosine = dot(ray.direction, light.direction);
    let radiance = in_scattered(medium, light.radiance, cosine, distance, visibility);
    return vec4<f32>(min(radiance, vec3<f32>(65504.0)), visibility);
}

@compute @workgroup_size(16, 8)
fn evaluate(@builtin(global_invocation_id) id: vec3<u32>) {
    if all(id.xy < textureDimensions(scattered)) {
        textureStore(scattered, id.xy, pixel_light(id.xy));
    }
}

/// One triangle over the whole picture.
@vertex
fn vertex_picture(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return vec4<f32>(vec2<f32>(f32(index & 1u), f32(index >> 1u)) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn fragment_evaluate(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return pixel_light(vec2<u32>(position.xy));
}
