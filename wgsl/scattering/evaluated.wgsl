// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::scattering::evaluated
// summary: Callback: what the air scatters into a pixel's view ray, from filtered bases, moments or rank queries over epipolar rows.
// source: thesis 4.3.1 and 4.3.3, Eq. 4.6 and 4.9, Listing 4.4.
// note: Texel i holds the mean over the texels 0 .. i, so that a ray of s texels is read at s - 1/2.
// note: Around the light's place in the picture (and its antipode's) rays cover only a few texels and the light
// note: would bleed through blockers: EPIPOLE_MARCH marches the standard shadow map wherever a ray covers few
// note: texels, very short rays included, blended in without a seam.
// note: A pass that makes more of a ray than its texel imports this instead of reading what was written.
// equation: L = albedo p(cos) L_e (1 − exp(−σ s)) V̄,  V̄ = Σ regions weight mean / Σ weight
// equation: near the epipole: mix(V̄, marched, 1 − smoothstep(8, 16, texels))
// error: a slab within 2/255 + 1e-3 of its closed form;
// error: test scattering/closed_forms::an_empty_shadow_map_lights_everything_and_a_slab_has_its_closed_form.
// error: average visibility on foliage within 0.005 by 32 bases;
// error: test scattering/figures::average_visibility_on_foliage_falls_with_the_bases_to_its_figure.
// parameter first, texels: texels of the row, fractional.
// parameter pixel: column and row of the picture, from 0.
// definition RANK: exact visibility by rank queries, bits of a depth as in `rank`. Not with REGIONS.
// definition COLORS: 3 with LIGHT_TEXTURE, as in the filter. Not with REGIONS or NEAR_PLANE.
// definition PER_POINT: EPIPOLE_MARCH looks up every step by itself; needed with COLORS or SHADOW_ARRAY.
// definition EPIPOLE_MARCH: march where a ray covers fewer than 8 texels; blends until 16.
// definition AVERAGE: the bases are plain means, and so is that march.
// definition REGIONS: regions that the rows were filtered in, as in the filter; more than one costs more reads a pixel.
// definition NEAR_PLANE: rays, and the medium, begin at the near plane instead of the eye.
// definition DEPTH_WARP: as in rectify.
// binding camera: the camera, perspective.
// binding light: the directional light and its shadow map's clip space.
// binding medium: the medium.
// binding frame: the frame of the slices.
// binding slices: their bounds, rgba32float, one texel a slice.
// binding depth: depth buffer of the picture, a depth format or r32float; non-finite values count as far.

#import airlight::core::camera::{Camera, perspective_ray, ndc_from_pixel}
#import airlight::core::finite::finite_or
#import airlight::core::light::Light
#import airlight::core::prefix_sum::prefix_weight
#ifdef EPIPOLE_MARCH
#import airlight::scattering::lit::{marched_light, marched_visibility}
#endif
#import airlight::scattering::prefiltered::{Prefix, map_size, prefix_visibility, prefix_colors}
#import airlight::scattering::rectify::{
    Frame, epipolar_ray, nearest_row, slice_from_texel, greatest_sine, depth_from_ray, warped_depth
}
#import airlight::scattering::rows::{RowRay, stretch_begin, region_of, region_begin}
#import airlight::scattering::scattered_ray::{ScatteredRay, FARTHEST}
#import airlight::scattering::single_scatter::{Medium, in_scattered}

@group(#{GROUP}) @binding(0) var<uniform> camera: Camera;
@group(#{GROUP}) @binding(1) var<uniform> light: Light;
@group(#{GROUP}) @binding(2) var<uniform> medium: Medium;
@group(#{GROUP}) @binding(3) var<uniform> frame: Frame;
@group(#{GROUP}) @binding(4) var slices: texture_2d<f32>;
@group(#{GROUP}) @binding(5) var depth: texture_2d<f32>;

#ifdef REGIONS
const ROW_REGIONS: u32 = u32(#{REGIONS});
#else
const ROW_REGIONS: u32 = 1u;
#endif

/// Rays that cover fewer texels are marched.
const EPIPOLE_TEXELS: f32 = 8.0;
/// Steps of that march.
const EPIPOLE_STEPS: u32 = 96u;

/// Optical depths of a texel.
struct Steps {
    /// Of the ray itself.
    ray: f32,
    /// By which what was stored is weighted.
    stored: f32,
}

/// The stretch of a ray up to `texels` in the region of its row that begins at texel `first`.
fn prefix(ray: RowRay, first: f32, texels: f32, steps: Steps) -> Prefix {
    return Prefix(ray.row, frame.wraps, first, texels, steps.ray, steps.stored);
}

#ifndef COLORS
/// Mean visibility of a ray over its stretch of the row.
fn mean_visibility(ray: RowRay, steps: Steps) -> f32 {
#ifdef RANK
    let mean_step = steps.ray;
#else
    // Prefix means are weighted by the reference ray; the regions are put together by the ray itself.
    let mean_step = steps.stored;
#endif
    let width = map_size().x;
    let first = region_of(ray.begin, width, ROW_REGIONS);
    let last = region_of(ray.end, width, ROW_REGIONS);
    var sum = 0.0;
    var total = 0.0;
    for (var region = first; region <= last; region++) {
        let start = f32(region_begin(region, width, ROW_REGIONS));
        let from_texel = max(ray.begin, start);
        let to_texel = min(ray.end, f32(region_begin(region + 1u, width, ROW_REGIONS)));
        var mean = prefix_visibility(prefix(ray, start, to_texel, steps), ray.depth);
#ifdef NEAR_PLANE
        if from_texel > start {
            let whole = prefix_weight(mean_step, to_texel - start);
            let before = prefix_weight(mean_step, from_texel - start);
            let skipped = prefix_visibility(prefix(ray, start, from_texel, steps), ray.depth);
            let part = mean * whole - skipped * before;
            mean = clamp(part / max(whole - before, 1e-6 * whole), 0.0, 1.0);
        }
#endif
        // In units of the stretch's first texel: finite however deep the stretch lies.
        let weight = exp(-steps.ray * (from_texel - ray.begin)) * prefix_weight(steps.ray, to_texel - from_texel);
        sum += mean * weight;
        total += weight;
    }
    return select(0.0, sum / total, total > 0.0);
}
#endif

/// What is scattered into the view ray of `pixel`.
fn scattered_ray(pixel: vec2<u32>) -> ScatteredRay {
    let ndc = ndc_from_pixel(camera, vec2<f32>(pixel) + 0.5);
    let surface = clamp(finite_or(textureLoad(depth, pixel, 0).x, camera.far_depth), 0.0, 1.0);
    let ray = epipolar_ray(frame, ndc, surface, medium.distance_limit);
    // The bounds of the nearest slice: those of the next one differ by far less than the series resolves.
    let slice = slice_from_texel(textureLoad(slices, vec2<u32>(nearest_row(frame, ray.row), 0u), 0));
    let width = f32(map_size().x);
    let texels = clamp(width * ray.distance * ray.sine / slice.radius_max, 0.0, width);
    var row_ray = RowRay(ray.row, 0.0, texels, depth_from_ray(slice, ray));
#ifdef DEPTH_WARP
    row_ray.depth = warped_depth(row_ray.depth);
#endif
#ifdef NEAR_PLANE
    let near = epipolar_ray(frame, ndc, camera.near_depth, ray.distance).distance;
    row_ray.begin = stretch_begin(width * near * ray.sine / slice.radius_max, texels);
#else
    let near = 0.0;
#endif
#ifdef AVERAGE
    let extinction = 0.0;
#else
    let extinction = medium.extinction;
#endif
    // Optical depth of a texel of a ray at right angles to the light.
    let across = extinction * slice.radius_max / width;
#ifdef RANK
    let steps = Steps(across / max(ray.sine, 1e-6), across / greatest_sine(slice));
#else
    let steps = Steps(across / max(ray.sine, 1e-6), across / slice.reference);
#endif
#ifdef COLORS
    var visibility = prefix_colors(prefix(row_ray, 0.0, texels, steps), row_ray.depth);
#else ifdef REGIONS
    var visibility = mean_visibility(row_ray, steps);
#else ifdef NEAR_PLANE
    var visibility = mean_visibility(row_ray, steps);
#else
    var visibility = prefix_visibility(prefix(row_ray, 0.0, texels, steps), row_ray.depth);
#endif
#ifndef COLORS
    visibility = clamp(visibility, 0.0, 1.0);
#endif

#ifdef EPIPOLE_MARCH
    let near_epipole = 1.0 - smoothstep(EPIPOLE_TEXELS, 2.0 * EPIPOLE_TEXELS, texels);
    let samples = select(0u, EPIPOLE_STEPS, near_epipole > 0.0);
    let direction = perspective_ray(camera, ndc).direction;
#ifdef PER_POINT
    let marched = marched_light(light, camera.eye, direction, vec2<f32>(near, ray.distance), extinction, samples, 0.5);
#else
    let marched = vec3<f32>(marched_visibility(
        light, camera.eye + near * direction, direction, ray.distance - near, extinction, samples, 0.5
    ));
#endif
#ifdef COLORS
    visibility = mix(visibility, marched, near_epipole);
#else
    visibility = mix(visibility, marched.x, near_epipole);
#endif
#endif

#ifdef COLORS
    let radiance = visibility * in_scattered(medium, light.radiance, ray.cosine, ray.distance - near, 1.0);
    let mean = dot(visibility, vec3<f32>(1.0 / 3.0));
#else
    let radiance = in_scattered(medium, light.radiance, ray.cosine, ray.distance - near, visibility);
    let mean = visibility;
#endif
    let distance = epipolar_ray(frame, ndc, surface, FARTHEST).distance;
    return ScatteredRay(min(radiance, vec3<f32>(65504.0)), mean, ndc, distance, ray.cosine);
}
