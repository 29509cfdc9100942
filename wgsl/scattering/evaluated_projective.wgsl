// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::scattering::evaluated_projective
// summary: Callback: what the air scatters into a pixel's view ray, from projective rows, for cameras of any kind.
// source: thesis 4.3.1 and 4.3.3, Eq. 4.6 and 4.9, Listing 4.4.
// note: Texel i of the bases holds the mean over the texels 0 .. i, so that a ray of s texels is read at s - 1/2.
// note: An orthographic camera needs NEAR_PLANE: its rays do not begin at the start of their rows.
// note: A pass that makes more of a ray than its texel imports this instead of reading what was written.
// equation: V̄ = Σ regions (mean(to) W(to) − mean(from) W(from)) / Σ W,  W(x) = (1 − exp(−σ x reach)) / σ
// error: rows lit up to a column: within 1.5e-3 in the mean, 0.01 at most;
// error: test scattering/projective/closed_form::a_row_lit_up_to_a_column_has_its_closed_form.
// error: pictures reach their figures; test scattering/projective/pictures::pictures_reach_their_figures.
// parameter first: texel at which a region begins.
// parameter reach: metres along the reference ray for one of X.
// parameter extinction: 1/m, from 0 up.
// parameter x: X, metres.
// parameter pixel: column and row of the picture, from 0.
// definition RANK: exact visibility by rank queries, bits of a depth as in `rank_weights`. Not with REGIONS.
// definition AVERAGE: the bases are plain means.
// definition REGIONS: regions that the rows were filtered in, as in the filter; more than one costs more reads a pixel.
// definition NEAR_PLANE: rays, and the medium, begin at the near plane instead of the eye.
// binding camera: the camera, any.
// binding light: the directional light and its shadow map's clip space.
// binding medium: the medium.
// binding rows: the projective rows.
// binding depth: depth buffer of the picture, a depth format or r32float; non-finite values count as far.

#import airlight::core::camera::{Camera, view_ray, ndc_from_pixel, distance_from_depth}
#import airlight::core::finite::finite_or
#import airlight::core::light::Light
#import airlight::scattering::prefiltered::{Prefix, map_size, prefix_visibility}
#import airlight::scattering::projective::{
    ProjectiveRows, ProjectiveRay, projective_ray, reference_reach, column_from_x, x_from_column, texel_begin,
    filtered_column, weighed_column, stretch_weight
}
#import airlight::scattering::rows::{RowRay, stretch_begin, region_of, region_begin}
#import airlight::scattering::scattered_ray::{ScatteredRay, FARTHEST}
#import airlight::scattering::single_scatter::{Medium, in_scattered}

@group(#{GROUP}) @binding(0) var<uniform> camera: Camera;
@group(#{GROUP}) @binding(1) var<uniform> light: Light;
@group(#{GROUP}) @binding(2) var<uniform> medium: Medium;
@group(#{GROUP}) @binding(10) var<uniform> rows: ProjectiveRows;
@group(#{GROUP}) @binding(5) var depth: texture_2d<f32>;

#ifdef REGIONS
const ROW_REGIONS: u32 = u32(#{REGIONS});
#else
const ROW_REGIONS: u32 = 1u;
#endif

/// The mean over a row from the texel `first`, where a region begins, up to `x` metres of X. `reach`: of the reference ray;
/// `extinction` in 1/m, 0 for plain means.
fn mean_up_to(ray: RowRay, first: u32, reach: f32, extinction: f32, x: f32) -> f32 {
    let width = f32(map_size().x);
#ifdef RANK
    let texels = weighed_column(rows, width, reach, extinction, x);
#else
    // A stretch is read half a texel before its end.
    let texels = filtered_column(rows, width, reach, extinction, first, x) + 0.5;
#endif
    return prefix_visibility(Prefix(ray.row, 0.0, f32(first), texels, 0.0, 0.0), ray.depth);
}

/// Mean visibility of a view ray between its ends. `row_ray`: the same in columns; `extinction` in 1/m, 0 for plain means.
fn projective_visibility(along: ProjectiveRay, row_ray: RowRay, extinction: f32) -> f32 {
    let size = map_size();
    let width = f32(size.x);
    let reach = reference_reach(rows, f32(size.y), row_ray.row);
    let first = region_of(row_ray.begin, size.x, ROW_REGIONS);
    let last = max(region_of(row_ray.end, size.x, ROW_REGIONS), first);
    var sum = 0.0;
    var total = 0.0;
    for (var region = first; region <= last; region++) {
        let column = region_begin(region, size.x, ROW_REGIONS);
        let start = texel_begin(rows, width, column);
        let from_x = max(along.begin, start);
        var to_x = max(along.end, from_x);
        if region < last {
            to_x = max(texel_begin(rows, width, region_begin(region + 1u, size.x, ROW_REGIONS)), from_x);
        }
        var mean = mean_up_to(row_ray, column, reach, extinction, to_x);
#ifdef NEAR_PLANE
        if from_x > start {
            let whole = stretch_weight(extinction, (to_x - start) * reach);
            let before = stretch_weight(extinction, (from_x - start) * reach);
            let skipped = mean_up_to(row_ray, column, reach, extinction, from_x);
            mean = clamp((mean * whole - skipped * before) / max(whole - before, 1e-6 * whole + 1e-30), 0.0, 1.0);
        }
#endif
        let begins = (from_x - along.begin) * along.reach;
        let weight = exp(-extinction * begins) * stretch_weight(extinction, (to_x - from_x) * along.reach);
        sum += mean * weight;
        total += weight;
    }
    // A ray of no length has no mean and scatters nothing.
    return select(0.0, sum / max(total, 1e-37), total > 1e-30);
}

/// What is scattered into the view ray of `pixel`.
fn scattered_ray(pixel: vec2<u32>) -> ScatteredRay {
    let ndc = ndc_from_pixel(camera, vec2<f32>(pixel) + 0.5);
    let surface = clamp(finite_or(textureLoad(depth, pixel, 0).x, camera.far_depth), 0.0, 1.0);
#ifdef AVERAGE
    let extinction = 0.0;
#else
    let extinction = medium.extinction;
#endif
    let width = f32(map_size().x);
    let ray = view_ray(camera, ndc);
    let distance = distance_from_depth(camera, ray, ndc, surface, medium.distance_limit);
    let cosine = dot(ray.direction, light.direction);
    var along = projective_ray(rows, f32(map_size().y), ray.origin, ray.direction, distance);
#ifdef NEAR_PLANE
    // An orthographic ray begins there anyway.
    let near = distance_from_depth(camera, ray, ndc, camera.near_depth, distance);
    along.begin += near / along.reach;
#else
    let near = 0.0;
#endif
    var row_ray = RowRay(
        along.row, column_from_x(rows, width, along.begin), column_from_x(rows, width, along.end), along.depth
    );
#ifdef NEAR_PLANE
    // Short stretches are widened towards the eye, as those of slices are.
    let widened = stretch_begin(row_ray.begin, row_ray.end);
    if widened < row_ray.begin {
        row_ray.begin = widened;
        along.begin = min(along.begin, x_from_column(rows, width, widened));
    }
#endif
    let visibility = clamp(projective_visibility(along, row_ray, extinction), 0.0, 1.0);
    let radiance = in_scattered(medium, light.radiance, cosine, distance - near, visibility);
    let to_surface = distance_from_depth(camera, ray, ndc, surface, FARTHEST);
    return ScatteredRay(min(radiance, vec3<f32>(65504.0)), visibility, ndc, to_surface, cosine);
}
