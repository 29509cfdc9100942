// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::scattering::column_weights
// summary: Callback: what the columns of a row weigh in the means over it, and the light's fall-off on them.
// source: thesis 4.3.2, Eq. 4.8 and 4.12; 4.4.2.
// note: Unlike algorithm modules a callback holds bindings, those that passes share: the filters of Fourier bases and of
// note: moments and the rank structure weigh columns alike. A light's angular fall-off and texture belong to its light rays, that is to
// note: columns.
// equation: slices: w_i = exp(−τ i), τ = σ radius_max / (width k);  around a light: transmittance times phase, over columns linear in the light angle
// equation: projective: w_i = T(x_i) (1 − exp(−σ Δ_i)) / σ
// error: prefix means with weights and fall-offs within 1e-4; test scattering/moments/weights::filter_takes_weights_and_fall_offs.
// parameter row: of the map, from 0.
// parameter size: columns and rows of the map.
// parameter first: column from which weights count, up to `column`.
// parameter column: of the map, from 0.
// parameter width: columns of the map.
// parameter unit: 0..1 along the row.
// definition AVERAGE: all columns of slices, and all metres of projective rows, weigh alike.
// definition LOCAL: rows around a spot or point light.
// definition PROJECTIVE: projective rows, whose texels differ in length. Not with LOCAL or COLORS.
// definition COLORS: 1 for the fall-off of a spot, 3 with LIGHT_TEXTURE.
// definition LIGHT_TEXTURE: a texture colours the light; with COLORS=3.
// binding medium: the medium; absent with AVERAGE.
// binding slices: bounds of the slices, rgba32float; absent with PROJECTIVE, and with AVERAGE unless with COLORS.
// binding rows: the projective rows; with PROJECTIVE only.
// binding light: the light; with LOCAL or COLORS only.
// binding frame: the frame of the slices; with LOCAL or COLORS only.
// binding light_texture: linear RGB 0..1 over the whole shadow map, any float format that filters; with LIGHT_TEXTURE only.
// binding light_sampler: linear, clamped to the edge; with LIGHT_TEXTURE only.

#import airlight::core::light::{Light, angular_falloff, light_texture_color}
#import airlight::scattering::local_light::{
    local_slice_from_texel, light_angle_of_column, light_ray_direction, column_weight, distance_to_light
}
#import airlight::scattering::projective::{
    ProjectiveRows, reference_reach, texel_begin, texel_end, stretch_weight
}
#import airlight::scattering::rectify::{Frame, slice_from_texel, row_azimuth, azimuth_direction}
#import airlight::scattering::single_scatter::Medium

#ifdef PROJECTIVE
@group(#{GROUP}) @binding(8) var<uniform> rows: ProjectiveRows;
#else ifndef AVERAGE
@group(#{GROUP}) @binding(1) var slices: texture_2d<f32>;
#else ifdef COLORS
@group(#{GROUP}) @binding(1) var slices: texture_2d<f32>;
#endif
#ifndef AVERAGE
@group(#{GROUP}) @binding(0) var<uniform> medium: Medium;
#endif
#ifdef COLORS
@group(#{GROUP}) @binding(4) var<uniform> light: Light;
@group(#{GROUP}) @binding(5) var<uniform> frame: Frame;
#ifdef LIGHT_TEXTURE
@group(#{GROUP}) @binding(6) var light_texture: texture_2d<f32>;
@group(#{GROUP}) @binding(7) var light_sampler: sampler;
#endif
#else ifdef LOCAL
@group(#{GROUP}) @binding(4) var<uniform> light: Light;
@group(#{GROUP}) @binding(5) var<uniform> frame: Frame;
#endif

/// A column of a row, from which one steps to the next.
struct WeightedColumn {
    /// Its row.
    row: u32,
    /// Its number.
    column: u32,
    /// Its weight, not negative: of slices in units of that of the first column; of projective rows in metres, times the
    /// transmittance from the first column on.
    weight: f32,
    /// Transmittance at its left edge from the first column on; of projective rows only.
    through: f32,
    /// Its length on the reference ray, metres; of projective rows only.
    metres: f32,
    /// X of its right edge, metres; of projective rows only.
    edge: f32,
    /// Metres along the reference ray for one of X; of slices, transmittance from a column to the next; around a light
    /// the metres from it to the eye.
    factor: f32,
    /// The slice's texel.
    slice: vec4<f32>,
}

#ifdef PROJECTIVE
/// Extinction that weighs, 1/m.
fn weighing_extinction() -> f32 {
#ifdef AVERAGE
    return 0.0;
#else
    return medium.extinction;
#endif
}
#endif

/// The column `column` of a row of a map of `size` texels, weighed from the column `first` of it on.
fn weighted_column(row: u32, size: vec2<u32>, first: u32, column: u32) -> WeightedColumn {
#ifdef PROJECTIVE
    let width = f32(size.x);
    let reach = reference_reach(rows, f32(size.y), f32(row));
    let begin = texel_begin(rows, width, column);
    let end = texel_end(rows, width, column);
    let before = (begin - texel_begin(rows, width, first)) * reach;
    let through = exp(-weighing_extinction() * before);
    let metres = (end - begin) * reach;
    let weight = through * stretch_weight(weighing_extinction(), metres);
    return WeightedColumn(row, column, weight, through, metres, end, reach, vec4<f32>(0.0));
#else ifdef AVERAGE
    return WeightedColumn(row, column, 1.0, 1.0, 0.0, 0.0, 1.0, vec4<f32>(0.0));
#else ifdef LOCAL
    let texel = textureLoad(slices, vec2<u32>(row, 0u), 0);
    let away = distance_to_light(frame, light.position);
    let weight = local_weight(texel, away, column, size.x);
    return WeightedColumn(row, column, weight, 1.0, 0.0, 0.0, away, texel);
#else
    let texel = textureLoad(slices, vec2<u32>(row, 0u), 0);
    let slice = slice_from_texel(texel);
    let optical_step = max(medium.extinction * slice.radius_max / (f32(size.x) * slice.reference), 0.0);
    let weight = exp(-optical_step * f32(column - first));
    return WeightedColumn(row, column, weight, 1.0, 0.0, 0.0, exp(-optical_step), texel);
#endif
}

/// The column after `current`.
fn next_column(current: WeightedColumn, size: vec2<u32>) -> WeightedColumn {
    var next = current;
    next.column += 1u;
#ifdef PROJECTIVE
    next.edge = texel_end(rows, f32(size.x), next.column);
    next.through = current.through * exp(-weighing_extinction() * current.metres);
    next.metres = (next.edge - current.edge) * current.factor;
    next.weight = next.through * stretch_weight(weighing_extinction(), next.metres);
#else ifndef AVERAGE
#ifdef LOCAL
    next.weight = local_weight(current.slice, current.factor, next.column, size.x);
#else
    next.weight = current.weight * current.factor;
#endif
#endif
    return next;
}

#ifdef LOCAL
#ifndef AVERAGE
/// Weight of a column of a row around a light. `texel`: of the slice; `away`: of the light from the eye, metres.
fn local_weight(texel: vec4<f32>, away: f32, column: u32, width: u32) -> f32 {
    let slice = local_slice_from_texel(texel);
    return column_weight(slice, away, light_angle_of_column(slice, (f32(column) + 0.5) / f32(width)), medium);
}
#endif
#endif

#ifdef COLORS
/// Fall-off and texture of the light ray of `row` at `unit`, 0..1 along the row, for each colour 0..1.
fn falloff_of_column(row: u32, unit: f32) -> vec3<f32> {
    let texel = textureLoad(slices, vec2<u32>(row, 0u), 0);
    let radial = azimuth_direction(frame, row_azimuth(frame, f32(row)));
#ifdef LOCAL
    let direction = light_ray_direction(frame, radial, light_angle_of_column(local_slice_from_texel(texel), unit));
    let falloff = vec3<f32>(angular_falloff(light, -direction));
    let point = light.position + direction;
#else
    let falloff = vec3<f32>(1.0);
    let point = frame.eye + unit * slice_from_texel(texel).radius_max * radial;
#endif
#ifdef LIGHT_TEXTURE
    return falloff * light_texture_color(light, light_texture, light_sampler, point);
#else
    return falloff;
#endif
}
#endif
