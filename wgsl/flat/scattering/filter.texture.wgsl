// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: scattering/filter, permutation texture (BASES=32 BASES_PER_THREAD=8 COLORS=3 LIGHT_TEXTURE)
// summary: Turns the rectified map into Fourier bases and filters them along its rows by a weighted running mean.
// source: thesis 4.3.1 to 4.3.3, Eq. 4.6 to 4.9, Listings 4.1 to 4.3.
// note: One thread takes one row and BASES_PER_THREAD bases, four of them a vector.
// note: Blockers are moved away from the light by about half the width of the series' edge (surface_bias), which
// note: the thesis does not do: otherwise lit surfaces shade the ends of their own rays.
// note: Depths outside 0..1 are clamped, non-finite ones count as unblocked.
// note: A light's angular fall-off and texture belong to its light rays, that is to columns: with COLORS each column
// note: enters the means times its fall-off, and so does the constant 1/2 of the series, whose mean is one layer more.
// definition BASES: number M of bases, a multiple of 4 from 4 to 128.
// definition BASES_PER_THREAD: bases a thread filters, a multiple of 4.
// definition COLORS: 1 for the fall-off of a spot, 3 with LIGHT_TEXTURE; that many times M bases, and one layer more.
// definition LIGHT_TEXTURE: a texture colours the light; with COLORS=3.
// binding medium: the medium; absent with AVERAGE.
// binding slices: bounds of the slices, rgba32float; absent with PROJECTIVE, and with AVERAGE unless with COLORS.
// binding rectified: the rectified map, depth 0..1.
// binding bases: out, M/4 layers of the filtered bases; -1..1 is stored as 0..1. With COLORS the layers of each colour, and a layer of the mean fall-off, 0..1.
// binding light: the light; with LOCAL or COLORS only.
// binding frame: the frame of the slices; with LOCAL or COLORS only.
// binding light_texture: linear RGB 0..1 over the whole shadow map, any float format that filters; with LIGHT_TEXTURE only.
// binding light_sampler: linear, clamped to the edge; with LIGHT_TEXTURE only.

// ---- airlight::core::finite ----
// summary: Replaces NaN and infinities in data that comes from outside.
// source: IEEE 754 binary32: all exponent bits set means NaN or infinity.

/// True if `x` is neither NaN nor infinite.
fn is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u;
}

/// `x` where it is finite, `fallback` elsewhere.
fn finite_or(x: f32, fallback: f32) -> f32 {
    return select(fallback, x, is_finite(x));
}

/// Like `finite_or`, each component by itself.
fn finite_or_rgb(x: vec3<f32>, fallback: f32) -> vec3<f32> {
    return vec3<f32>(finite_or(x.x, fallback), finite_or(x.y, fallback), finite_or(x.z, fallback));
}

// ---- airlight::core::fourier_basis ----
// summary: Visibility as a Fourier series of the depth difference, four bases at a time.
// source: thesis 4.3.1, Eq. 4.7, after Annen et al., "Convolution shadow maps" (2007).

const PI: f32 = 3.141592653589793;

/// Part of the depth range at either end that is kept free of view rays.
const GUARD: f32 = 0.05;

/// What is added to the depth of a blocker before its bases are taken, up to 1: about half the width
/// of the softened edge. Without it a lit surface shades the end of every ray that meets it, because
/// the series is 1/2, not 1, at the depth of the blocker itself. `bases`: M.
fn surface_bias(bases: u32) -> f32 {
    return min(0.6 / f32(bases), 0.8 * GUARD);
}

/// Four bases and the rotation that leads to the next four.
struct Series {
    /// sin, cos of the first frequency, sin, cos of the second.
    basis: vec4<f32>,
    /// sin and cos of 4 pi z, the angle from one group to the next.
    turn: vec2<f32>,
}

/// (sin, cos) of pi times `half_turns`, exact reduction for large arguments.
fn sine_cosine(half_turns: f32) -> vec2<f32> {
    let angle = PI * (half_turns - 2.0 * round(0.5 * half_turns));
    return vec2<f32>(sin(angle), cos(angle));
}

/// (sin, cos) of the sum of two angles given by (sin, cos).
fn rotate(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    return vec2<f32>(a.x * b.y + a.y * b.x, a.y * b.y - a.x * b.x);
}

/// The bases of `group` at depth `z`, 0..1, ready to step on.
fn series_at(z: f32, group: u32) -> Series {
    let first = sine_cosine(f32(4u * group + 1u) * z);
    let double = sine_cosine(2.0 * z);
    return Series(vec4<f32>(first, rotate(first, double)), rotate(double, double));
}

/// The next group, by a rotation instead of new sines. The error grows by about 1e-7 a step.
fn series_next(series: Series) -> Series {
    return Series(
        vec4<f32>(rotate(series.basis.xy, series.turn), rotate(series.basis.zw, series.turn)),
        series.turn
    );
}

/// Bases -1..1 to the range 0..1 in which textures store them.
fn stored_from_basis(basis: vec4<f32>) -> vec4<f32> {
    return 0.5 + 0.5 * basis;
}

// ---- airlight::core::light ----
// summary: A light, its fall-off and texture, and the clip space of its standard shadow map.
// source: thesis 4.2.1; a point source seen through a cone and softened by its radius.

/// A light at infinity: all light rays are parallel.
const DIRECTIONAL: u32 = 0u;

/// A light and its standard shadow map. 192 bytes.
struct Light {
    /// World to the shadow map's clip space; affine for a directional light, unused with an array of shadow maps.
    clip_from_world: mat4x4<f32>,
    /// Its inverse.
    world_from_clip: mat4x4<f32>,
    /// Unit vector TOWARDS a directional light; of a spot, the reverse of the axis along which it shines.
    direction: vec3<f32>,
    /// Depth of an empty texel of the shadow map, farthest from the light: 1 forward, 0 reversed.
    far_depth: f32,
    /// Linear RGB: for a directional light the irradiance at normal incidence; for one at a point its radiant
    /// intensity, the irradiance at a distance of one metre.
    radiance: vec3<f32>,
    /// DIRECTIONAL, SPOT or POINT.
    kind: u32,
    /// Where a spot or point light is, metres.
    position: vec3<f32>,
    /// Radius of a spot or point light, metres, positive: nearer to it the fall-off with distance stops.
    radius: f32,
    /// Cosines of the half angles inside which a spot shines fully, and outside which not at all.
    spot_cosines: vec2<f32>,
    reserved_a: f32,
    reserved_b: f32,
}

/// Position in texels of a map, and depth, of a point in the clip space of that map; a point at or behind the light
/// (w <= 0) is carried outside the map. `size`: of the map in texels.
fn texels_from_clip(clip: vec4<f32>, size: vec2<f32>) -> vec3<f32> {
    let before = clip.w > 0.0;
    let ndc = clip.xyz / select(1.0, clip.w, before);
    return select(vec3<f32>(-size, 0.0), vec3<f32>((ndc.xy * vec2<f32>(0.5, -0.5) + 0.5) * size, ndc.z), before);
}

/// Position in texels of the shadow map, and depth, of a point in the world, metres; a point behind a spot is carried
/// outside the map. `size`: of the map in texels.
fn shadow_position(light: Light, size: vec2<f32>, point: vec3<f32>) -> vec3<f32> {
    return texels_from_clip(light.clip_from_world * vec4<f32>(point, 1.0), size);
}

/// What a light texture (gobo) lets through, linear RGB 0..1, towards `point`, metres in the world. `map`: any float
/// format that filters, stretched over the whole shadow map; `map_sampler`: linear, clamped to the edge. Outside it a
/// directional light goes by unhindered and a spot is dark. Non-finite texels are dark.
fn light_texture_color(
    light: Light, map: texture_2d<f32>, map_sampler: sampler, point: vec3<f32>
) -> vec3<f32> {
    let uv = shadow_position(light, vec2<f32>(1.0), point).xy;
    let inside = all(uv >= vec2<f32>(0.0)) && all(uv <= vec2<f32>(1.0));
    let outside = select(0.0, 1.0, light.kind == DIRECTIONAL);
    let color = finite_or_rgb(textureSampleLevel(map, map_sampler, uv, 0.0).rgb, 0.0);
    return select(vec3<f32>(outside), clamp(color, vec3<f32>(0.0), vec3<f32>(1.0)), inside);
}

// ---- airlight::core::prefix_sum ----
// summary: Running weighted mean along a row: the prefix sum that filters basis textures.
// source: thesis 4.3.3, Listings 4.1 and 4.2.

/// Weights of one row: each is `ratio` times the one before it.
struct RowWeights {
    /// Weight of the current texel.
    weight: f32,
    /// Sum of the weights up to and with it.
    total: f32,
    /// From a texel to the next, 0..1.
    ratio: f32,
}

/// `mean` with `value` taken in at the current texel's weight.
fn running_mean(mean: vec4<f32>, value: vec4<f32>, weights: RowWeights) -> vec4<f32> {
    return mean + (value - mean) * (weights.weight / weights.total);
}

// ---- airlight::scattering::rectify ----
// summary: Epipolar coordinates around a directional light: rows are slices, columns radii, depth the angle to the light.
// source: thesis 4.4.1, after Baran et al., "A hierarchical volumetric shadow algorithm" (2010); Eq. 4.12.

/// Axes around the light, the range of the slices, and the view rays in these axes. 128 bytes.
struct Frame {
    /// Unit vector TOWARDS the light.
    light: vec3<f32>,
    /// Azimuth of row 0, radians.
    azimuth_min: f32,
    /// Unit vector of azimuth 0.
    axis_a: vec3<f32>,
    /// Rows per radian of azimuth.
    rows_per_radian: f32,
    /// Unit vector of azimuth pi / 2.
    axis_b: vec3<f32>,
    /// Number of rows.
    rows: f32,
    /// Position of the eye, where all slices meet.
    eye: vec3<f32>,
    /// 1 where the rows go round the full circle and wrap, 0 elsewhere.
    wraps: f32,
    /// The view ray through ndc, times (x, y, 1): its part towards the light. Any length, the same for all four.
    ray_light: vec3<f32>,
    reserved_a: f32,
    /// Its part along axis_a.
    ray_a: vec3<f32>,
    reserved_b: f32,
    /// Its part along axis_b.
    ray_b: vec3<f32>,
    reserved_c: f32,
    /// Times (x, y, depth, 1): what its length is divided by for the distance of the surface at that depth.
    ray_scale: vec4<f32>,
}

/// Bounds of one slice.
struct Slice {
    /// Least angle to the light of its view rays, radians.
    angle_min: f32,
    /// Greatest angle to the light of its view rays, radians.
    angle_max: f32,
    /// Radius in metres at the right end of its row.
    radius_max: f32,
    /// k of the reference ray, the bisectrix: sine of its angle to the light.
    reference: f32,
}

/// Azimuth of the middle of `row`, radians.
fn row_azimuth(frame: Frame, row: f32) -> f32 {
    return frame.azimuth_min + row / max(frame.rows_per_radian, 1e-6);
}

/// Unit vector at right angles to the light in the half-plane of `azimuth`.
fn azimuth_direction(frame: Frame, azimuth: f32) -> vec3<f32> {
    return cos(azimuth) * frame.axis_a + sin(azimuth) * frame.axis_b;
}

/// What `slice_texel` did, undone.
fn slice_from_texel(texel: vec4<f32>) -> Slice {
    return Slice(texel.x, texel.y, texel.z, texel.w);
}

// ---- airlight::scattering::rows ----
// summary: Where a view ray lies in a rectified map, and how the means of a row's regions are put together.
// source: thesis 4.3.3 (regions), 4.4.2 (near plane).

/// First texel of a region; of the region after the last, the width.
fn region_begin(region: u32, width: u32, regions: u32) -> u32 {
    return (region * width + regions - 1u) / regions;
}

// ---- airlight::scattering::single_scatter ----
// summary: Single scattering of a directional light in a homogeneous medium, given the visibility along a ray.
// source: thesis 4.2.1, Eq. 4.1 and 4.2; 4.3.2, Eq. 4.8 and 4.9; Listing 4.4.

/// A homogeneous medium. 32 bytes.
struct Medium {
    /// Single-scattering albedo, 0..1 for each colour.
    albedo: vec3<f32>,
    /// Extinction coefficient in 1/m, not negative; zero is a clear picture.
    extinction: f32,
    /// Mean cosine of the Henyey-Greenstein phase function, -0.999..0.999.
    g: f32,
    /// Rays end here if they meet nothing nearer, metres, positive.
    distance_limit: f32,
    reserved_a: f32,
    reserved_b: f32,
}

// ---- airlight::scattering::column_weights ----
// summary: Callback: what the columns of a row weigh in the means over it, and the light's fall-off on them.
// source: thesis 4.3.2, Eq. 4.8 and 4.12; 4.4.2.

@group(0) @binding(1) var slices: texture_2d<f32>;
@group(0) @binding(0) var<uniform> medium: Medium;
@group(0) @binding(4) var<uniform> light: Light;
@group(0) @binding(5) var<uniform> frame: Frame;
@group(0) @binding(6) var light_texture: texture_2d<f32>;
@group(0) @binding(7) var light_sampler: sampler;

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

/// The column `column` of a row of a map of `size` texels, weighed from the column `first` of it on.
fn weighted_column(row: u32, size: vec2<u32>, first: u32, column: u32) -> WeightedColumn {
    let texel = textureLoad(slices, vec2<u32>(row, 0u), 0);
    let slice = slice_from_texel(texel);
    let optical_step = max(medium.extinction * slice.radius_max / (f32(size.x) * slice.reference), 0.0);
    let weight = exp(-optical_step * f32(column - first));
    return WeightedColumn(row, column, weight, 1.0, 0.0, 0.0, exp(-optical_step), texel);
}

/// The column after `current`.
fn next_column(current: WeightedColumn, size: vec2<u32>) -> WeightedColumn {
    var next = current;
    next.column += 1u;
    next.weight = current.weight * current.factor;
    return next;
}

/// Fall-off and texture of the light ray of `row` at `unit`, 0..1 along the row, for each colour 0..1.
fn falloff_of_column(row: u32, unit: f32) -> vec3<f32> {
    let texel = textureLoad(slices, vec2<u32>(row, 0u), 0);
    let radial = azimuth_direction(frame, row_azimuth(frame, f32(row)));
    let falloff = vec3<f32>(1.0);
    let point = frame.eye + unit * slice_from_texel(texel).radius_max * radial;
    return falloff * light_texture_color(light, light_texture, light_sampler, point);
}

// ---- scattering/filter ----

@group(0) @binding(2) var rectified: texture_2d<f32>;
@group(0) @binding(3) var bases: texture_storage_2d_array<rgba8unorm, write>;

const LAYERS: u32 = u32(32) / 4u;
const ROW_REGIONS: u32 = 1u;
const PER_THREAD: u32 = u32(8) / 4u;
const COLOR_COUNT: u32 = u32(3);

@compute @workgroup_size(32)
fn filter_rows(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = textureDimensions(rectified);
    let row = id.x;
    let first = id.y * PER_THREAD;
    if row >= min(size.y, textureDimensions(bases).y) || first >= LAYERS || id.z >= ROW_REGIONS {
        return;
    }
    let begin = region_begin(id.z, size.x, ROW_REGIONS);
    var at_column = weighted_column(row, size, begin, begin);
    var total = 0.0;
    var means = array<vec4<f32>, PER_THREAD * COLOR_COUNT>();
    var mean_falloff = vec4<f32>(0.0);
    let end = region_begin(id.z + 1u, size.x, ROW_REGIONS);
    for (var column = begin; column < end; column++) {
        total += at_column.weight;
        let weights = RowWeights(at_column.weight, total, 1.0);
        let depth = clamp(finite_or(textureLoad(rectified, vec2<u32>(column, row), 0).x, 1.0), 0.0, 1.0);
        let blocker = min(depth + surface_bias(4u * LAYERS), 1.0);
        let falloff = falloff_of_column(row, (f32(column) + 0.5) / f32(size.x));
        mean_falloff = running_mean(mean_falloff, vec4<f32>(falloff, 1.0), weights);
        if first == 0u {
            textureStore(bases, vec2<u32>(column, row), COLOR_COUNT * LAYERS, mean_falloff);
        }
        var series = series_at(blocker, first);
        for (var group = 0u; group < PER_THREAD; group++) {
            for (var color = 0u; color < COLOR_COUNT; color++) {
                let at = group * COLOR_COUNT + color;
                means[at] = running_mean(means[at], series.basis * falloff[color], weights);
                if first + group < LAYERS {
                    let layer = color * LAYERS + first + group;
                    textureStore(bases, vec2<u32>(column, row), layer, stored_from_basis(means[at]));
                }
            }
            series = series_next(series);
        }
        at_column = next_column(at_column, size);
    }
}
