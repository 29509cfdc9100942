// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: scattering/rank_weights, permutation spot_texture (COLORS=3 LIGHT_TEXTURE LOCAL RANK=12 WEIGHT_BITS=8)
// summary: The rank structure of every row of a rectified map whose columns have weights of their own.
// source: none; see scattering/visibility_rank_weights and docs/src/rank.md.
// note: One workgroup sorts a row by counting, in workgroup memory, and cuts the order of its texels into cells. Each thread
// note: owns a block of 32 columns, so that weights are added in the order of the columns, and need no atomics.
// note: Ranks are given out in the order of the columns, by one thread: sums of f32 are the same bits each time.
// note: Rows of more than 2048 columns are not taken: their order would not fit into workgroup memory.
// definition RANK: bits of a depth, 8 to 12.
// definition WEIGHT_BITS: bits of a weight, 8 or 16.
// definition LOCAL: rows around a spot or point light.
// definition COLORS: 1 for the fall-off of a spot, 3 with LIGHT_TEXTURE.
// definition LIGHT_TEXTURE: a texture colours the light; with COLORS=3.
// binding medium: the medium; absent with AVERAGE.
// binding slices: bounds of the slices, rgba32float; absent with PROJECTIVE, and with AVERAGE unless with COLORS.
// binding rectified: the rectified map, r32float or a depth format; non-finite values count as 1, lit.
// binding light: the light; with LOCAL or COLORS only.
// binding frame: the frame of the slices; with LOCAL or COLORS only.
// binding light_texture: linear RGB 0..1 over the whole shadow map, any float format that filters; with LIGHT_TEXTURE only.
// binding light_sampler: linear, clamped to the edge; with LIGHT_TEXTURE only.
// binding rank_cells: out, rg32uint, with LIGHT_TEXTURE rgba32uint: mask, and for each colour a weight in the bits of an f32; a texel for each chunk and block of 32, chunk times blocks plus block, a row each.
// binding rank_starts: out, r32uint: how many texels of a row have a smaller value, two of 16 bits a texel, a row each.
// binding rank_planes: out, rgba32uint: bit planes, four a layer, lowest first; one texel for 32 columns, a row each.
// binding rank_weights: out, rgba32uint: three layers of f32 in bits, steps of a block, weights left of it, steps of a chunk; then bit planes of weights, four a layer, lowest first, of the columns for each channel and of the ranks for each colour; one texel for 32 columns, or ranks, a row each.

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

// ---- airlight::core::light ----
// summary: A light, its fall-off and texture, and the clip space of its standard shadow map.
// source: thesis 4.2.1; a point source seen through a cone and softened by its radius.

/// A light at infinity: all light rays are parallel.
const DIRECTIONAL: u32 = 0u;
/// A light at a point that shines into a cone.
const SPOT: u32 = 1u;

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

/// Angular fall-off, 0..1, along the light ray with the unit vector `towards` TOWARDS the light: of a spot 1 inside
/// the inner cone, 0 outside the outer one, smooth between; of every other light 1.
fn angular_falloff(light: Light, towards: vec3<f32>) -> f32 {
    // Not smoothstep: WGSL leaves it open what that is between two equal edges.
    let above = dot(towards, light.direction) - light.spot_cosines.y;
    let unit = clamp(above / max(light.spot_cosines.x - light.spot_cosines.y, 1e-6), 0.0, 1.0);
    return select(1.0, unit * unit * (3.0 - 2.0 * unit), light.kind == SPOT);
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

// ---- airlight::core::phase ----
// summary: Phase functions, normalised to one over the sphere.
// source: thesis 2.4, Eq. 2.11 (Henyey and Greenstein 1941).

/// 1 / (4 pi), the value of the isotropic phase function, 1/sr.
const ISOTROPIC: f32 = 0.07957747154594767;

/// The Henyey-Greenstein phase function, 1/sr. `cosine`: of the scattering angle, -1..1;
/// `g`: mean cosine, clamped to -0.999..0.999, zero is isotropic.
fn henyey_greenstein(cosine: f32, g: f32) -> f32 {
    let mean = clamp(g, -0.999, 0.999);
    // (1 - g)^2 + 2 g (1 - cos) is 1 + g^2 - 2 g cos without the cancellation near the peak.
    let near = (1.0 - abs(mean)) * (1.0 - abs(mean));
    let turn = 1.0 - clamp(select(-cosine, cosine, mean >= 0.0), -1.0, 1.0);
    let inverse = inverseSqrt(near + 2.0 * abs(mean) * turn);
    return ISOTROPIC * (1.0 - mean * mean) * (inverse * inverse * inverse);
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

/// Azimuth of the middle of `row`, radians.
fn row_azimuth(frame: Frame, row: f32) -> f32 {
    return frame.azimuth_min + row / max(frame.rows_per_radian, 1e-6);
}

/// Unit vector at right angles to the light in the half-plane of `azimuth`.
fn azimuth_direction(frame: Frame, azimuth: f32) -> vec3<f32> {
    return cos(azimuth) * frame.axis_a + sin(azimuth) * frame.axis_b;
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

// ---- airlight::scattering::local_light ----
// summary: Epipolar rows around a light at a point, spot or point light, and the light that air scatters along a view ray.
// source: thesis 4.3.2 ("other light sources") and 4.4.1; W. Pegoraro and S. Parker, "An analytical solution to single scattering in homogeneous participating media" (2009); C. Kulla and M. Fajardo (2012) for equal angles.

const PI: f32 = 3.141592653589793;

/// An eye nearer to the light than this, metres, has no direction to it.
const LEAST_DISTANCE: f32 = 1e-4;

/// Bounds of one slice around a light at a point.
struct LocalSlice {
    /// Least angle to the light of its view rays, radians.
    angle_min: f32,
    /// Greatest angle to the light of its view rays, radians.
    angle_max: f32,
    /// Light angle at the left end of its row, radians.
    light_angle_min: f32,
    /// Light angle at the right end of its row, radians.
    light_angle_max: f32,
}

/// Distance in metres of a light at `position` from the eye of `frame`, which looks towards it.
fn distance_to_light(frame: Frame, position: vec3<f32>) -> f32 {
    return max(dot(position - frame.eye, frame.light), LEAST_DISTANCE);
}

/// Unit vector along a light ray, away from the light. `radial`: unit vector of its half-plane, at right angles to the
/// direction to the light; `at_light`: its light angle.
fn light_ray_direction(frame: Frame, radial: vec3<f32>, at_light: f32) -> vec3<f32> {
    return sin(at_light) * radial - cos(at_light) * frame.light;
}

/// What `local_slice_texel` did, undone.
fn local_slice_from_texel(texel: vec4<f32>) -> LocalSlice {
    return LocalSlice(texel.x, texel.y, texel.z, texel.w);
}

/// Light angle of a position along a row, radians. `unit`: 0..1 over the columns.
fn light_angle_of_column(slice: LocalSlice, unit: f32) -> f32 {
    return mix(slice.light_angle_min, slice.light_angle_max, unit);
}

/// Weight in the means of a row of the column with the light angle `at_light`, positive, 1 at the light angle 0: phase function
/// times transmittance on a ray between those of the slice that meet this light ray, nearer to the brighter ones: at the
/// geometric mean of their angles, cf. Eq. 4.12. `away`: of the light, metres.
fn column_weight(slice: LocalSlice, away: f32, at_light: f32, medium: Medium) -> f32 {
    let farthest = max(min(slice.angle_max, PI - at_light), slice.angle_min);
    let angle = sqrt(max(slice.angle_min, 0.1 * farthest) * farthest);
    // (sin alpha + sin theta) / sin(alpha + theta): what the light passes through, over the distance to the light.
    let path = cos(0.5 * (at_light - angle)) / max(cos(0.5 * (at_light + angle)), 1e-6);
    let air = exp(-min(medium.extinction * away * max(path - 1.0, 0.0), 12.0));
    let phase = henyey_greenstein(cos(angle + at_light), medium.g) / henyey_greenstein(cos(angle), medium.g);
    return air * phase;
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
    let away = distance_to_light(frame, light.position);
    let weight = local_weight(texel, away, column, size.x);
    return WeightedColumn(row, column, weight, 1.0, 0.0, 0.0, away, texel);
}

/// The column after `current`.
fn next_column(current: WeightedColumn, size: vec2<u32>) -> WeightedColumn {
    var next = current;
    next.column += 1u;
    next.weight = local_weight(current.slice, current.factor, next.column, size.x);
    return next;
}

/// Weight of a column of a row around a light. `texel`: of the slice; `away`: of the light from the eye, metres.
fn local_weight(texel: vec4<f32>, away: f32, column: u32, width: u32) -> f32 {
    let slice = local_slice_from_texel(texel);
    return column_weight(slice, away, light_angle_of_column(slice, (f32(column) + 0.5) / f32(width)), medium);
}

/// Fall-off and texture of the light ray of `row` at `unit`, 0..1 along the row, for each colour 0..1.
fn falloff_of_column(row: u32, unit: f32) -> vec3<f32> {
    let texel = textureLoad(slices, vec2<u32>(row, 0u), 0);
    let radial = azimuth_direction(frame, row_azimuth(frame, f32(row)));
    let direction = light_ray_direction(frame, radial, light_angle_of_column(local_slice_from_texel(texel), unit));
    let falloff = vec3<f32>(angular_falloff(light, -direction));
    let point = light.position + direction;
    return falloff * light_texture_color(light, light_texture, light_sampler, point);
}

// ---- airlight::scattering::visibility_rank ----
// summary: Exact mean visibility of a view ray: how many of the first texels of a row lie behind it, by one rank query.
// source: none; a rank structure over a permutation, cut into words: docs/src/rank.md explains it with a drawing.

/// A depth, clamped to 0..1, as a whole number of `bits` bits.
fn rank_value(depth: f32, bits: u32) -> u32 {
    return u32(clamp(depth, 0.0, 1.0) * f32((1u << bits) - 1u) + 0.5);
}

// ---- airlight::scattering::rank_sort ----
// summary: Callback: sorts a row of the rectified map by counting, in workgroup memory, for the passes that make rank structures.
// source: none; see scattering/visibility_rank and docs/src/rank.md.

@group(0) @binding(2) var rectified: texture_2d<f32>;
@group(0) @binding(9) var rank_starts: texture_storage_2d<r32uint, write>;
@group(0) @binding(10) var rank_planes: texture_storage_2d_array<rgba32uint, write>;

const BITS: u32 = u32(12);
/// Threads of a workgroup, which takes a row.
const THREADS: u32 = 64u;
/// Columns of the widest row.
const COLUMNS: u32 = 2048u;
/// Pairs of values.
const PAIRS: u32 = 1u << (BITS - 1u);
const PAIRS_PER_THREAD: u32 = PAIRS / THREADS;
/// Words of `counts`: pairs of values of 12 bits and, behind SUMS of them, the texels of each thread's values.
const COUNTS: u32 = 3072u;
const SUMS: u32 = 2048u;
const EIGHTS: u32 = THREADS / 8u;
/// Stands for the texel beyond the last of a row.
const NONE: u32 = 0xffffu;

/// How many texels have each value, then how many have a smaller one, two of 16 bits a word; after the sort it is the
/// pass' own.
var<workgroup> counts: array<atomic<u32>, COUNTS>;
/// Values of the texels, then their ranks, two of 16 bits a word.
var<workgroup> texels: array<u32, COLUMNS / 2u>;

/// Value of a texel, counted; NONE beyond the row.
fn counted_value(column: u32, row: u32, columns: u32) -> u32 {
    if column >= columns {
        return NONE;
    }
    let value = rank_value(finite_or(textureLoad(rectified, vec2<u32>(column, row), 0).x, 1.0), BITS);
    atomicAdd(&counts[value / 2u], 1u << (16u * (value & 1u)));
    return value;
}

/// The next rank of a value; NONE for NONE.
fn next_rank(value: u32) -> u32 {
    if value == NONE {
        return NONE;
    }
    let shift = 16u * (value & 1u);
    return (atomicAdd(&counts[value / 2u], 1u << shift) >> shift) & 0xffffu;
}

/// Sorts a row: writes starts and planes, and leaves the ranks in `texels`. `thread` of the workgroup; `rankers`: threads
/// that give out ranks; one alone gives those of equal values in the order of their columns. The caller waits for all
/// threads before it reads ranks of others.
fn sort_row(thread: u32, row: u32, columns: u32, rankers: u32) {
    let words = (columns + 1u) / 2u;
    let blocks = (columns + 31u) / 32u;
    for (var word = thread; word < words; word += THREADS) {
        let first = counted_value(2u * word, row, columns);
        texels[word] = first | (counted_value(2u * word + 1u, row, columns) << 16u);
    }
    workgroupBarrier();

    write_planes(thread, row, blocks);
    var sum = 0u;
    for (var pair = thread * PAIRS_PER_THREAD; pair < (thread + 1u) * PAIRS_PER_THREAD; pair++) {
        let both = atomicLoad(&counts[pair]);
        sum += (both & 0xffffu) + (both >> 16u);
    }
    atomicStore(&counts[SUMS + thread], sum);
    workgroupBarrier();
    // Sums of eight threads each, then what is before a thread of eights and of single ones.
    if thread < EIGHTS {
        var eight = 0u;
        for (var one = 0u; one < 8u; one++) {
            eight += atomicLoad(&counts[SUMS + 8u * thread + one]);
        }
        atomicStore(&counts[SUMS + THREADS + thread], eight);
    }
    workgroupBarrier();
    var start = 0u;
    for (var before = 0u; before < EIGHTS; before++) {
        start += select(0u, atomicLoad(&counts[SUMS + THREADS + before]), before < thread / 8u);
    }
    for (var before = 0u; before < 8u; before++) {
        start += select(0u, atomicLoad(&counts[SUMS + (thread & ~7u) + before]), before < (thread & 7u));
    }
    for (var pair = thread * PAIRS_PER_THREAD; pair < (thread + 1u) * PAIRS_PER_THREAD; pair++) {
        let both = atomicLoad(&counts[pair]);
        let packed = start | ((start + (both & 0xffffu)) << 16u);
        atomicStore(&counts[pair], packed);
        textureStore(rank_starts, vec2<u32>(pair, row), vec4<u32>(packed, 0u, 0u, 0u));
        start += (both & 0xffffu) + (both >> 16u);
    }
    workgroupBarrier();
    if thread < rankers {
        for (var word = thread; word < words; word += rankers) {
            let values = texels[word];
            let first = next_rank(values & 0xffffu);
            texels[word] = first | (next_rank(values >> 16u) << 16u);
        }
    }
}

/// Bit planes of the values of a block.
fn write_planes(block: u32, row: u32, blocks: u32) {
    if block >= blocks {
        return;
    }
    var low = vec4<u32>(0u);
    var middle = vec4<u32>(0u);
    var high = vec4<u32>(0u);
    // Columns beyond the row are never asked for.
    for (var column = 0u; column < 32u; column++) {
        let value = (texels[16u * block + column / 2u] >> (16u * (column & 1u))) & 0xffffu;
        let bits = vec4<u32>(value) >> vec4<u32>(0u, 1u, 2u, 3u);
        low |= (bits & vec4<u32>(1u)) << vec4<u32>(column);
        middle |= ((bits >> vec4<u32>(4u)) & vec4<u32>(1u)) << vec4<u32>(column);
        high |= ((bits >> vec4<u32>(8u)) & vec4<u32>(1u)) << vec4<u32>(column);
    }
    textureStore(rank_planes, vec2<u32>(block, row), 0u, low);
    textureStore(rank_planes, vec2<u32>(block, row), 1u, middle);
    if BITS > 8u {
        textureStore(rank_planes, vec2<u32>(block, row), 2u, high);
    }
}

// ---- airlight::scattering::visibility_rank_weights ----
// summary: Mean of visibility times fall-off of a view ray over columns that have weights of their own, by one rank query.
// source: none; a rank structure over a permutation whose points have weights: docs/src/rank.md explains it.

/// Layers of `weights` before its planes: the steps of the columns of a block, the weight left of a block, and the steps
/// of the ranks of a chunk. A component is a channel: colours, or the weight alone without these, and last the plain weight.
const WEIGHT_HEADS: u32 = 3u;

/// Channels for so many colours; 0 for the weight alone.
fn weight_channels(colors: u32) -> u32 {
    return colors + 1u;
}

/// First layer of the columns' planes of a channel.
fn column_layer(channel: u32, weight_bits: u32) -> u32 {
    return WEIGHT_HEADS + channel * (weight_bits / 4u);
}

/// First layer of the ranks' planes of a channel, which is not the plain weight next to colours.
fn rank_layer(channel: u32, colors: u32, weight_bits: u32) -> u32 {
    return WEIGHT_HEADS + (weight_channels(colors) + channel) * (weight_bits / 4u);
}

/// A weight in steps of which `greatest` is the last, of `bits` bits.
fn weight_steps(weight: f32, greatest: f32, bits: u32) -> u32 {
    let share = select(0.0, weight / greatest, greatest > 1e-37);
    return u32(clamp(share, 0.0, 1.0) * f32((1u << bits) - 1u) + 0.5);
}

// ---- scattering/rank_weights ----

@group(0) @binding(3) var rank_cells: texture_storage_2d<rgba32uint, write>;
@group(0) @binding(11) var rank_weights: texture_storage_2d_array<rgba32uint, write>;

/// Threads of the workgroup of a row.
const GROUP_THREADS: u32 = 64u;
/// Bits of a weight, and layers of their planes.
const WEIGHT_BITS: u32 = u32(8);
const LAYERS: u32 = WEIGHT_BITS / 4u;
/// Colours as the query counts them, those whose dark weight it asks for, and what is added.
const COLORS_ASKED: u32 = u32(3);
const COLOR_COUNT: u32 = COLORS_ASKED;
const CHANNELS: u32 = COLORS_ASKED + 1u;
/// Cells that are made at a time: first their masks in `counts` and, behind CELLS of them, the weights of each colour.
const CELLS: u32 = COUNTS / (COLOR_COUNT + 1u);
/// More than any sum of a row may be, over its columns.
const GREATEST_WEIGHT: f32 = 1e30;

/// Weights of the columns of the thread's block, channel after channel.
var<private> column_weights: array<f32, 32u * CHANNELS>;
/// What is to be stored as bit planes.
var<private> stored: array<f32, 32>;

/// The component of a channel: the plain weight is the last one.
fn component_of(channel: u32) -> vec4<bool> {
    let component = select(channel, 3u, COLORS_ASKED > 0u && channel == COLORS_ASKED);
    return vec4<u32>(0u, 1u, 2u, 3u) == vec4<u32>(component);
}

/// Rank of a column; NONE beyond the row.
fn rank_of(column: u32, columns: u32) -> u32 {
    let both = texels[min(column, COLUMNS - 1u) / 2u];
    return select(NONE, (both >> (16u * (column & 1u))) & 0xffffu, column < columns);
}

/// Writes `stored` as bit planes; gives the weight of a step.
fn write_weight_planes(place: vec2<u32>, layer: u32) -> f32 {
    var greatest = 0.0;
    for (var i = 0u; i < 32u; i++) {
        greatest = max(greatest, stored[i]);
    }
    var planes = array<vec4<u32>, LAYERS>();
    for (var i = 0u; i < 32u; i++) {
        let steps = weight_steps(stored[i], greatest, WEIGHT_BITS);
        for (var four = 0u; four < LAYERS; four++) {
            let bits = vec4<u32>(steps) >> (vec4<u32>(0u, 1u, 2u, 3u) + 4u * four);
            planes[four] |= (bits & vec4<u32>(1u)) << vec4<u32>(i);
        }
    }
    for (var four = 0u; four < LAYERS; four++) {
        textureStore(rank_weights, place, layer + four, planes[four]);
    }
    return greatest / f32((1u << WEIGHT_BITS) - 1u);
}

/// What the columns of a block weigh together, a component for each channel: it lies behind what `counts` holds of ranks.
fn block_sum(block: u32) -> vec4<f32> {
    let word = SUMS + 4u * block;
    return bitcast<vec4<f32>>(vec4<u32>(
        atomicLoad(&counts[word]), atomicLoad(&counts[word + 1u]), atomicLoad(&counts[word + 2u]),
        atomicLoad(&counts[word + 3u])
    ));
}

/// Weighs the columns of a block and adds them; writes their planes and steps.
fn weigh_block(block: u32, row: u32, size: vec2<u32>, columns: u32) {
    var sums = vec4<f32>(0.0);
    var at = weighted_column(row, size, 0u, 32u * block);
    for (var i = 0u; i < 32u; i++) {
        let finite = clamp(finite_or(at.weight, 0.0), 0.0, GREATEST_WEIGHT);
        let weight = select(0.0, finite, at.column < columns);
        let falloff = falloff_of_column(row, (f32(at.column) + 0.5) / f32(size.x));
        let weighted = weight * clamp(falloff, vec3<f32>(0.0), vec3<f32>(1.0));
        column_weights[i] = weighted.x;
        column_weights[32u + i] = weighted.y;
        column_weights[64u + i] = weighted.z;
        column_weights[32u * COLORS_ASKED + i] = weight;
        sums += vec4<f32>(weighted, weight);
        at = next_column(at, size);
    }
    for (var channel = 0u; channel < 4u; channel++) {
        atomicStore(&counts[SUMS + 4u * block + channel], bitcast<u32>(sums[channel]));
    }
    var steps = vec4<f32>(0.0);
    for (var channel = 0u; channel < CHANNELS; channel++) {
        for (var i = 0u; i < 32u; i++) {
            stored[i] = column_weights[32u * channel + i];
        }
        let step = write_weight_planes(vec2<u32>(block, row), column_layer(channel, WEIGHT_BITS));
        steps = select(steps, vec4<f32>(step), component_of(channel));
    }
    textureStore(rank_weights, vec2<u32>(block, row), 0u, bitcast<vec4<u32>>(steps));
}

@compute @workgroup_size(GROUP_THREADS)
fn rank_weighted_row(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let size = textureDimensions(rectified);
    let row = group.x;
    let columns = min(size.x, COLUMNS);
    let blocks = (columns + 31u) / 32u;
    if row >= size.y {
        return;
    }
    sort_row(thread, row, columns, 1u);
    if thread < blocks {
        weigh_block(thread, row, size, columns);
    }
    workgroupBarrier();
    if thread < blocks {
        var left = vec4<f32>(0.0);
        for (var before = 0u; before < THREADS; before++) {
            left += select(vec4<f32>(0.0), block_sum(before), before < thread);
        }
        textureStore(rank_weights, vec2<u32>(thread, row), 1u, bitcast<vec4<u32>>(left));
    }
    // Weights in the order of ranks, one colour after the other.
    var steps = vec4<f32>(0.0);
    for (var color = 0u; color < COLOR_COUNT; color++) {
        workgroupBarrier();
        if thread < blocks {
            for (var i = 0u; i < 32u; i++) {
                let rank = rank_of(32u * thread + i, columns);
                if rank < COUNTS {
                    atomicStore(&counts[rank], bitcast<u32>(column_weights[32u * color + i]));
                }
            }
        }
        workgroupBarrier();
        if thread < blocks {
            for (var i = 0u; i < 32u; i++) {
                let rank = 32u * thread + i;
                stored[i] = select(0.0, bitcast<f32>(atomicLoad(&counts[rank])), rank < columns);
            }
            let step = write_weight_planes(vec2<u32>(thread, row), rank_layer(color, COLORS_ASKED, WEIGHT_BITS));
            steps = select(steps, vec4<f32>(step), component_of(color));
        }
    }
    if thread < blocks {
        textureStore(rank_weights, vec2<u32>(thread, row), 2u, bitcast<vec4<u32>>(steps));
    }
    // As many chunks at a time as there is room for.
    let strip = CELLS / blocks;
    var base = vec3<f32>(0.0);
    for (var first = 0u; first < blocks; first += strip) {
        workgroupBarrier();
        for (var word = thread; word < COUNTS; word += THREADS) {
            atomicStore(&counts[word], 0u);
        }
        workgroupBarrier();
        if thread < blocks {
            for (var i = 0u; i < 32u; i++) {
                add_column(thread, i, columns, first, strip, blocks);
            }
        }
        workgroupBarrier();
        for (var chunk = thread; chunk < strip; chunk += THREADS) {
            sum_blocks(chunk * blocks, blocks);
        }
        workgroupBarrier();
        if thread < blocks {
            base = write_cells(thread, row, first, min(strip, blocks - first), blocks, base);
        }
    }
}

/// Adds column `i` of a block to its cell, if its chunk is one of `strip` from `first` on. Only the block's own thread
/// writes there.
fn add_column(block: u32, i: u32, columns: u32, first: u32, strip: u32, blocks: u32) {
    let rank = rank_of(32u * block + i, columns);
    // Chunks before the first wrap to great numbers, and NONE is beyond all.
    let chunk = rank / 32u - first;
    if chunk >= strip || rank == NONE {
        return;
    }
    let cell = min(chunk * blocks + block, CELLS - 1u);
    atomicOr(&counts[cell], 1u << (rank & 31u));
    for (var color = 0u; color < COLOR_COUNT; color++) {
        let word = (color + 1u) * CELLS + cell;
        let sum = bitcast<f32>(atomicLoad(&counts[word])) + column_weights[32u * color + i];
        atomicStore(&counts[word], bitcast<u32>(sum));
    }
}

/// Turns what is in each block of a chunk, from `begin` on, into what is left of the block.
fn sum_blocks(begin: u32, blocks: u32) {
    var mask = 0u;
    for (var cell = begin; cell < begin + blocks; cell++) {
        mask |= atomicExchange(&counts[cell], mask);
    }
    for (var color = 0u; color < COLOR_COUNT; color++) {
        var sum = 0.0;
        for (var cell = begin; cell < begin + blocks; cell++) {
            let word = (color + 1u) * CELLS + cell;
            sum += bitcast<f32>(atomicExchange(&counts[word], bitcast<u32>(sum)));
        }
    }
}

/// The cells of a block with `count` chunks from `first` on; gives the base after them, a component for each colour.
fn write_cells(block: u32, row: u32, first: u32, count: u32, blocks: u32, before: vec3<f32>) -> vec3<f32> {
    var base = before;
    for (var chunk = 0u; chunk < count; chunk++) {
        let cell = chunk * blocks + block;
        let texel = vec4<u32>(atomicLoad(&counts[cell]), bitcast<vec3<u32>>(base));
        textureStore(rank_cells, vec2<u32>(first * blocks + cell, row), texel);
        base.x += bitcast<f32>(atomicLoad(&counts[CELLS + cell]));
        base.y += bitcast<f32>(atomicLoad(&counts[2u * CELLS + cell]));
        base.z += bitcast<f32>(atomicLoad(&counts[3u * CELLS + cell]));
    }
    return base;
}
