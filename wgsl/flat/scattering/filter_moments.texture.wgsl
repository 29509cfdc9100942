// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: scattering/filter_moments, permutation texture (COLORS=3 LIGHT_TEXTURE)
// summary: Turns the rectified map into six moments and filters them along its rows by a weighted running mean.
// source: Peters et al., "Improved moment shadow maps" (JCGT 6(1), 2017); weights as in thesis 4.3.3, Eq. 4.8 and 4.9.
// note: One workgroup takes one row, each thread a stretch of it: the threads' sums are scanned, then every thread goes
// note: over its stretch again and writes. Sums of blocks of BLOCK texels keep f32 below the 21 bits of the storage.
// note: Texel i holds the mean over the texels 0 .. i. Depths outside 0..1 are clamped, non-finite ones count as unblocked.
// note: With COLORS each column enters the moments of a colour times its fall-off, and a layer more holds the mean fall-off.
// definition COLORS: 1 for the fall-off of a spot, 3 with LIGHT_TEXTURE; that many sets of moments, and one layer more.
// definition LIGHT_TEXTURE: a texture colours the light; with COLORS=3.
// binding medium: the medium; absent with AVERAGE.
// binding slices: bounds of the slices, rgba32float; absent with PROJECTIVE, and with AVERAGE unless with COLORS.
// binding rectified: the rectified map, depth 0..1.
// binding moments: out, six moments of 21 bits a texel, see scattering/visibility_moments. With COLORS an array: a layer of moments for each colour, and one of the mean fall-off of each, 0..1, in bits of f32.
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

/// Part of the depth range at either end that is kept free of view rays.
const GUARD: f32 = 0.05;

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

// ---- airlight::core::moment_bounds ----
// summary: Six moments of a distribution on -1..1, and the bounds that they give of its share beyond a place.
// source: Algorithm 1 of Peters et al., "Improved moment shadow maps for translucent occluders, soft shadows and single scattering" (2017).

/// Means of the Chebyshev polynomials T_1 to T_6.
struct Moments {
    /// Of degree 1, 2 and 3, -1..1.
    low: vec3<f32>,
    /// Of degree 4, 5 and 6, -1..1.
    high: vec3<f32>,
}

/// T_1, T_2, T_3 at `z`.
fn chebyshev(z: f32) -> vec3<f32> {
    return vec3<f32>(z, 2.0 * z * z - 1.0, z * (4.0 * z * z - 3.0));
}

/// Moments of a single place `z`, -1..1.
fn moments_at(z: f32) -> Moments {
    let low = chebyshev(z);
    let high = vec3<f32>(2.0 * low.y * low.y, 2.0 * low.y * low.z, 2.0 * low.z * low.z);
    return Moments(low, high - vec3<f32>(1.0, low.x, 1.0));
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

// ---- airlight::scattering::visibility_moments ----
// summary: Mean visibility of a view ray from six filtered moments of the stored depths: bounds of the share beyond it.
// source: Peters et al., "Improved moment shadow maps for translucent occluders, soft shadows and single scattering" (2017).

/// View rays keep this far from the ends of the signed depths, in depth 0..1.
const MARGIN: f32 = 0.01;
/// Steps of a moment's 21 bits.
const STEPS: f32 = 2097151.0;

/// Depth 0..1 to -1..1. Blockers in the guard beyond every view ray are all the same.
fn signed_depth(depth: f32) -> f32 {
    return clamp((depth - 0.5) / (0.5 - GUARD + MARGIN), -1.0, 1.0);
}

/// Moments of a single stored `depth`, 0..1.
fn moments_from_depth(depth: f32) -> Moments {
    return moments_at(signed_depth(depth));
}

/// Moments as one texel of an rgba32uint texture: the first four in the low 21 bits, the last two in what is left.
fn pack_moments(moments: Moments) -> vec4<u32> {
    let low = vec3<u32>(round(clamp(moments.low * 0.5 + 0.5, vec3<f32>(0.0), vec3<f32>(1.0)) * STEPS));
    let high = vec3<u32>(round(clamp(moments.high * 0.5 + 0.5, vec3<f32>(0.0), vec3<f32>(1.0)) * STEPS));
    return vec4<u32>(
        low.x | ((high.y & 0x7ffu) << 21u), low.y | ((high.y >> 11u) << 21u),
        low.z | ((high.z & 0x7ffu) << 21u), high.x | ((high.z >> 11u) << 21u)
    );
}

// ---- scattering/filter_moments ----

@group(0) @binding(2) var rectified: texture_2d<f32>;
@group(0) @binding(3) var moments: texture_storage_2d_array<rgba32uint, write>;
const SETS: u32 = u32(3);

const THREADS: u32 = 64u;
const BLOCK: u32 = 8u;
/// More than any weight may be, so that sums stay finite.
const GREATEST_WEIGHT: f32 = 1e30;
/// Less weight than this counts as none.
const LEAST_WEIGHT: f32 = 1e-35;

/// Sums of weighted moments.
struct MomentSum {
    /// Moments 1 to 3 times weight, and the weights.
    low: vec4<f32>,
    /// Moments 4 to 6 times weight.
    high: vec3<f32>,
}

/// Sums over columns.
struct RowSum {
    /// Moments, each colour weighted by its own fall-off too.
    sets: array<MomentSum, SETS>,
    /// Weights without fall-off.
    weight: f32,
}

var<workgroup> sums: array<RowSum, THREADS>;

/// `a` and `b` together.
fn add_sums(a: RowSum, b: RowSum) -> RowSum {
    var both = a;
    for (var color = 0u; color < SETS; color++) {
        both.sets[color].low += b.sets[color].low;
        both.sets[color].high += b.sets[color].high;
    }
    both.weight += b.weight;
    return both;
}

/// Moments of the texel of a column times its weight. `width`: of the row, texels.
fn weighted_moments(at: WeightedColumn, width: u32) -> RowSum {
    let depth = clamp(finite_or(textureLoad(rectified, vec2<u32>(at.column, at.row), 0).x, 1.0), 0.0, 1.0);
    let own = moments_from_depth(depth);
    let weight = clamp(finite_or(at.weight, 0.0), 0.0, GREATEST_WEIGHT);
    var sum = RowSum();
    let falloff = falloff_of_column(at.row, (f32(at.column) + 0.5) / f32(width));
    for (var color = 0u; color < SETS; color++) {
        let part = weight * clamp(falloff[color], 0.0, 1.0);
        sum.sets[color] = MomentSum(part * vec4<f32>(own.low, 1.0), part * own.high);
    }
    sum.weight = weight;
    return sum;
}

/// Writes the means that `sum` stands for.
fn write_means(sum: RowSum, column: u32, row: u32) {
    var falloff = vec4<f32>(1.0);
    for (var color = 0u; color < SETS; color++) {
        let own = sum.sets[color];
        let scale = 1.0 / max(own.low.w, LEAST_WEIGHT);
        let packed = pack_moments(Moments(scale * own.low.xyz, scale * own.high));
        textureStore(moments, vec2<u32>(column, row), color, packed);
        falloff[color] = clamp(own.low.w / max(sum.weight, LEAST_WEIGHT), 0.0, 1.0);
    }
    textureStore(moments, vec2<u32>(column, row), SETS, bitcast<vec4<u32>>(falloff));
}

@compute @workgroup_size(THREADS)
fn filter_moments(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let size = textureDimensions(rectified);
    let row = group.y;
    if row >= min(size.y, textureDimensions(moments).y) {
        return;
    }
    let length = (size.x + THREADS - 1u) / THREADS;
    let begin = min(thread * length, size.x);
    let end = min(begin + length, size.x);

    var total = RowSum();
    for (var first = begin; first < end; first += BLOCK) {
        var block = RowSum();
        var at = weighted_column(row, size, 0u, first);
        for (var column = first; column < min(first + BLOCK, end); column++) {
            block = add_sums(block, weighted_moments(at, size.x));
            at = next_column(at, size);
        }
        total = add_sums(total, block);
    }
    sums[thread] = total;
    for (var distance = 1u; distance < THREADS; distance *= 2u) {
        workgroupBarrier();
        var before = RowSum();
        if thread >= distance {
            before = sums[thread - distance];
        }
        workgroupBarrier();
        total = add_sums(before, total);
        sums[thread] = total;
    }
    workgroupBarrier();
    var before = RowSum();
    if thread > 0u {
        before = sums[thread - 1u];
    }

    for (var first = begin; first < end; first += BLOCK) {
        var block = RowSum();
        var at = weighted_column(row, size, 0u, first);
        for (var column = first; column < min(first + BLOCK, end); column++) {
            block = add_sums(block, weighted_moments(at, size.x));
            write_means(add_sums(before, block), column, row);
            at = next_column(at, size);
        }
        before = add_sums(before, block);
    }
}
