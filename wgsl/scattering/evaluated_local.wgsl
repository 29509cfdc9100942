// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::scattering::evaluated_local
// summary: Callback: what the air scatters into a pixel's view ray around a spot or point light.
// source: thesis 4.3.1 to 4.3.3, Eq. 4.6 and 4.9; V. Pegoraro and S. Parker, "An analytical solution to single scattering in homogeneous participating media" (2009).
// note: Texel i of the bases holds the mean over the texels 0 .. i, so that a ray of s texels is read at s - 1/2.
// note: Around the light's place in the picture (and its antipode's) rays cover only a few texels and the light
// note: would bleed through blockers: EPIPOLE_MARCH marches the standard shadow map wherever a ray covers few
// note: texels, very short rays included, blended in without a seam.
// note: Around a spot or point light the mean of visibility times fall-off is taken out of the airlight integral, as the
// note: mean visibility is in Eq. 4.2; the columns, linear in the angle at the light, hold the fall-off with distance.
// note: A pass that makes more of a ray than its texel imports this instead of reading what was written.
// equation: L = albedo I σ ∫ p exp(−σ (t + d)) / (d² + r²) dt × mean of V × fall-off over the columns
// error: without blockers radiance within 3 % of the airlight integral;
// error: test scattering/local_lights::without_blockers_radiance_is_that_of_the_airlight_integral.
// parameter pixel: column and row of the picture, from 0.
// definition COLORS: 1 for the fall-off of a spot, 3 with LIGHT_TEXTURE, as in the filter.
// definition EPIPOLE_MARCH: march where a ray covers fewer than 8 texels; blends until 16.
// definition AVERAGE: the bases are plain means, and so is that march.
// definition DEPTH_WARP: as in rectify.
// binding camera: the camera, perspective.
// binding light: the spot or point light and its shadow map's clip space.
// binding medium: the medium.
// binding frame: the frame of the slices.
// binding slices: their bounds, rgba32float, one texel a slice.
// binding depth: depth buffer of the picture, a depth format or r32float; non-finite values count as far.

#import airlight::core::camera::{Camera, perspective_ray, ndc_from_pixel}
#import airlight::core::finite::finite_or
#import airlight::core::light::Light
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
#import airlight::scattering::scattered_ray::{ScatteredRay, FARTHEST}
#import airlight::scattering::single_scatter::Medium

@group(#{GROUP}) @binding(0) var<uniform> camera: Camera;
@group(#{GROUP}) @binding(1) var<uniform> light: Light;
@group(#{GROUP}) @binding(2) var<uniform> medium: Medium;
@group(#{GROUP}) @binding(3) var<uniform> frame: Frame;
@group(#{GROUP}) @binding(4) var slices: texture_2d<f32>;
@group(#{GROUP}) @binding(5) var depth: texture_2d<f32>;

/// Rays that cover fewer texels are marched.
const EPIPOLE_TEXELS: f32 = 8.0;
/// Steps of that march.
const EPIPOLE_STEPS: u32 = 96u;

/// What is scattered into the view ray of `pixel`.
fn scattered_ray(pixel: vec2<u32>) -> ScatteredRay {
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
    let mean = dot(lit, vec3<f32>(1.0 / 3.0));
    let distance = epipolar_ray(frame, ndc, surface, FARTHEST).distance;
    return ScatteredRay(min(radiance, vec3<f32>(65504.0)), mean, ndc, distance, ray.cosine);
}
