// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: scattering/evaluate_projective, permutation rank_near_plane (NEAR_PLANE RANK=12 WEIGHT_BITS=16)
// summary: In-scattered radiance of every pixel from filtered bases, moments or rank queries over projective rows, for cameras of any kind.
// source: thesis 4.3.1 and 4.3.3, Eq. 4.6 and 4.9, Listing 4.4.
// definition RANK: exact visibility by rank queries, bits of a depth as in `rank_weights`. Not with REGIONS.
// definition WEIGHT_BITS: bits of a weight, as in `rank_weights`; with RANK.
// definition NEAR_PLANE: rays, and the medium, begin at the near plane instead of the eye.
// binding camera: the camera, any.
// binding light: the directional light and its shadow map's clip space.
// binding medium: the medium.
// binding rows: the projective rows.
// binding depth: depth buffer of the picture, a depth format or r32float; non-finite values count as far.
// binding rank_cells: what `rank_weights` makes, rg32uint; with RANK only.
// binding rank_starts: the same, r32uint; with RANK only.
// binding rank_planes: the same, rgba32uint; with RANK only.
// binding rank_weights: the same, rgba32uint; with RANK only.
// binding rectified: the rectified map, of which only the size is read; with RANK only.
// binding scattered: out of the compute entry point (the fragment entry point returns it), rgba16float: linear RGB radiance, and in alpha the mean visibility 0..1.

// ---- airlight::core::camera ----
// summary: View rays, distances and frustum planes from a camera's matrices, for any depth convention.
// source: homogeneous unprojection; planes after Gribb and Hartmann, "Fast extraction of viewing frustum planes" (2001).

/// Orthographic projection: view rays are parallel and leave the near plane.
const ORTHOGRAPHIC: u32 = 1u;

/// A camera, as an engine hands it over. 160 bytes.
struct Camera {
    /// View-projection matrix, world to clip.
    clip_from_world: mat4x4<f32>,
    /// Its inverse, clip to world.
    world_from_clip: mat4x4<f32>,
    /// Position of the eye in the world, metres; unused by an orthographic camera.
    eye: vec3<f32>,
    /// Clip depth of the near plane: 0 forward, 1 reversed.
    near_depth: f32,
    /// Width and height of the picture in pixels.
    viewport: vec2<f32>,
    /// Clip depth of the far plane: 1 forward, 0 reversed.
    far_depth: f32,
    /// PERSPECTIVE or ORTHOGRAPHIC.
    projection: u32,
}

/// A view ray: world-space origin in metres, unit direction.
struct Ray {
    /// Where it starts in the world, metres.
    origin: vec3<f32>,
    /// Unit vector, away from the eye.
    direction: vec3<f32>,
}

/// Normalised device coordinates of a position in pixels: (0, 0) is the top left corner of the picture.
fn ndc_from_pixel(camera: Camera, pixel: vec2<f32>) -> vec2<f32> {
    return vec2<f32>(2.0, -2.0) * pixel / camera.viewport + vec2<f32>(-1.0, 1.0);
}

/// The view ray through `ndc`, of any camera.
fn view_ray(camera: Camera, ndc: vec2<f32>) -> Ray {
    // Values, not branches: some drivers compile a shader anew for every value of a uniform that a branch depends on.
    let parallel = camera.projection == ORTHOGRAPHIC;
    let far = camera.world_from_clip * vec4<f32>(ndc, camera.far_depth, 1.0);
    let near = camera.world_from_clip * vec4<f32>(ndc, camera.near_depth, 1.0);
    let origin = select(camera.eye, near.xyz / select(1.0, near.w, parallel), parallel);
    // With w = 0 (infinite far plane) far.xyz is the direction itself.
    return Ray(origin, normalize(far.xyz - select(camera.eye * far.w, near.xyz, parallel)));
}

/// Distance in metres along `ray`, the view ray through `ndc`, of the surface with the depth-buffer
/// value `depth`; at most `limit`, which also stands for points at infinity.
fn distance_from_depth(camera: Camera, ray: Ray, ndc: vec2<f32>, depth: f32, limit: f32) -> f32 {
    let point = camera.world_from_clip * vec4<f32>(ndc, depth, 1.0);
    let along = dot(point.xyz - ray.origin * point.w, ray.direction);
    // along / w, without dividing by a w that is zero or has rounded below it.
    let beyond = along >= limit * point.w;
    return select(max(along / select(point.w, 1.0, beyond), 0.0), limit, beyond);
}

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

// ---- airlight::core::fourier_basis ----
// summary: Visibility as a Fourier series of the depth difference, four bases at a time.
// source: thesis 4.3.1, Eq. 4.7, after Annen et al., "Convolution shadow maps" (2007).

/// Part of the depth range at either end that is kept free of view rays.
const GUARD: f32 = 0.05;

/// Depth in the guarded range. `unit`: depth over the bounds of the view rays, where rays lie in
/// 0..1 and blockers may lie outside; the result is clamped to 0..1.
fn guarded(unit: f32) -> f32 {
    return clamp(GUARD + (1.0 - 2.0 * GUARD) * unit, 0.0, 1.0);
}

// ---- airlight::core::light ----
// summary: A light, its fall-off and texture, and the clip space of its standard shadow map.
// source: thesis 4.2.1; a point source seen through a cone and softened by its radius.

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

// ---- airlight::core::picture ----
// summary: One triangle over the whole picture, for passes in fragment form.
// source: the usual full-screen triangle.

/// Clip-space position of corner `index`, 0..2, of a triangle that covers the picture.
fn picture_corner(index: u32) -> vec4<f32> {
    return vec4<f32>(vec2<f32>(f32(index & 1u), f32(index >> 1u)) * 4.0 - 1.0, 0.0, 1.0);
}

// ---- airlight::core::prefix_sum ----
// summary: Running weighted mean along a row: the prefix sum that filters basis textures.
// source: thesis 4.3.3, Listings 4.1 and 4.2.

/// 1 - exp(-x) for x >= 0, without cancellation for small x. Relative error below 1e-6.
fn one_minus_exp(x: f32) -> f32 {
    const third: f32 = 1.0 / 3.0;
    const sixth: f32 = 1.0 / 6.0;
    let series = x * (1.0 - x * 0.5 * (1.0 - x * third * (1.0 - x * 0.25 * (1.0 - x * 0.2 * (1.0 - x * sixth)))));
    return select(1.0 - exp(-x), series, x < 0.3);
}

// ---- airlight::scattering::projective ----
// summary: Projective rows around a directional light: view rays run along rows at constant depth after one matrix.
// source: thesis 4.4.2; weights after 4.3.2, Eq. 4.8.

/// Perspective camera: rows and depth are slopes.
const PERSPECTIVE: u32 = 0u;

/// The rows of a camera and a light, made by the host. 96 bytes.
struct ProjectiveRows {
    /// The eye; of an orthographic camera the centre of its near plane. World, metres.
    origin: vec3<f32>,
    /// X at the left end of column 0, metres; positive in perspective.
    near: f32,
    /// Unit vector of X, at right angles to the light, along the middle of the view rays.
    along: vec3<f32>,
    /// Metres of Z that a view ray of an orthographic camera takes for one of X; 0 in perspective.
    tilt: f32,
    /// Unit vector of Y.
    across: vec3<f32>,
    /// Slope Y / X (orthographic: Y, metres) at the upper border of row 0.
    row_min: f32,
    /// Unit vector of Z, AWAY from the light.
    away: vec3<f32>,
    /// From there to the lower border of the last row, positive.
    row_span: f32,
    /// X at the right end of each split, metres, growing; the last one in use and all after it are the far end.
    bounds: vec4<f32>,
    /// Least slope Z / X (orthographic: Z - tilt X, metres) of view rays.
    depth_min: f32,
    /// Range of those, positive.
    depth_span: f32,
    /// Number of splits, 1..4.
    splits: u32,
    /// PERSPECTIVE, or 1 for orthographic.
    projection: u32,
}

/// A view ray in its row.
struct ProjectiveRay {
    /// Row, fractional; row j is at the value j.
    row: f32,
    /// Depth, GUARD .. 1 - GUARD, constant along the ray.
    depth: f32,
    /// X where the ray begins, metres; 0 in perspective.
    begin: f32,
    /// X where it ends, metres.
    end: f32,
    /// Metres along the ray for one of X.
    reach: f32,
}

/// X at the left end of `split`, metres.
fn split_begin(rows: ProjectiveRows, split: u32) -> f32 {
    return select(rows.bounds[max(split, 1u) - 1u], rows.near, split == 0u);
}

/// Column, 0..`width` and fractional, of the light rays at `x` metres; clamped to the map of `width` texels.
fn column_from_x(rows: ProjectiveRows, width: f32, x: f32) -> f32 {
    let inside = clamp(x, rows.near, rows.bounds.w);
    var split = 0u;
    for (var next = 1u; next < rows.splits; next++) {
        split = select(split, next, inside >= rows.bounds[next - 1u]);
    }
    let begin = split_begin(rows, split);
    let end = rows.bounds[split];
    let unit = (inside - begin) / (end - begin) * select(1.0, end / inside, rows.projection == PERSPECTIVE);
    return (f32(split) + clamp(unit, 0.0, 1.0)) * (width / f32(rows.splits));
}

/// X in metres of a fractional `column`, 0..`width`: what `column_from_x` did, undone.
fn x_from_column(rows: ProjectiveRows, width: f32, column: f32) -> f32 {
    let share = column * f32(rows.splits) / width;
    let split = min(u32(max(share, 0.0)), rows.splits - 1u);
    let unit = clamp(share - f32(split), 0.0, 1.0);
    let begin = split_begin(rows, split);
    let end = rows.bounds[split];
    let divided = begin * end / (end - unit * (end - begin));
    return select(begin + unit * (end - begin), divided, rows.projection == PERSPECTIVE);
}

/// X of the right edge of texel `column`, metres.
fn texel_end(rows: ProjectiveRows, width: f32, column: u32) -> f32 {
    return x_from_column(rows, width, f32(column) + 1.0);
}

/// X of the left edge of texel `column`, metres: in perspective texel 0 begins at the eye.
fn texel_begin(rows: ProjectiveRows, width: f32, column: u32) -> f32 {
    let at_eye = column == 0u && rows.projection == PERSPECTIVE;
    return select(x_from_column(rows, width, f32(column)), 0.0, at_eye);
}

/// Slope (orthographic: Y) in the middle of `row`, of `height` rows.
fn row_slope(rows: ProjectiveRows, height: f32, row: f32) -> f32 {
    return rows.row_min + rows.row_span * (row + 0.5) / height;
}

/// The view ray from `start` (in perspective the eye) in the unit `direction` over `distance` metres, in a map of
/// `height` rows.
fn projective_ray(
    rows: ProjectiveRows, height: f32, start: vec3<f32>, direction: vec3<f32>, distance: f32
) -> ProjectiveRay {
    let perspective = rows.projection == PERSPECTIVE;
    // The host refuses rays at right angles to X; what is left of them here is rounding.
    let cosine = max(dot(direction, rows.along), 1e-6);
    let offset = select(start - rows.origin, direction, perspective);
    let x = dot(offset, rows.along);
    let divisor = select(1.0, cosine, perspective);
    let slope = dot(offset, rows.across) / divisor;
    let row = (slope - rows.row_min) / rows.row_span * height - 0.5;
    let unit = ((dot(offset, rows.away) - rows.tilt * x) / divisor - rows.depth_min) / rows.depth_span;
    let begin = select(x, 0.0, perspective);
    return ProjectiveRay(
        clamp(row, 0.0, height - 1.0),
        clamp(guarded(unit), GUARD, 1.0 - GUARD),
        begin,
        begin + cosine * max(distance, 0.0),
        1.0 / cosine
    );
}

/// Metres along the reference ray of `row` for one of X: the bisectrix of the row's view rays that cross a texel fastest
/// and slowest, as for slices.
fn reference_reach(rows: ProjectiveRows, height: f32, row: f32) -> f32 {
    let slope = row_slope(rows, height, row);
    let depth_max = rows.depth_min + rows.depth_span;
    let side = sqrt(1.0 + slope * slope);
    let fastest = vec2<f32>(side, clamp(0.0, rows.depth_min, depth_max));
    let slowest = vec2<f32>(side, select(rows.depth_min, depth_max, abs(depth_max) > abs(rows.depth_min)));
    let middle = normalize(fastest) + normalize(slowest);
    let parallel = sqrt(1.0 + rows.tilt * rows.tilt);
    return select(parallel, side * length(middle) / middle.x, rows.projection == PERSPECTIVE);
}

/// Integral of transmittance over `metres` from where it is 1, metres: the weight of that stretch of a ray. `extinction`
/// in 1/m; 0 gives `metres`, the weight of a plain mean. Relative error below 1e-6.
fn stretch_weight(extinction: f32, metres: f32) -> f32 {
    let depth = extinction * metres;
    return select(one_minus_exp(depth) / max(extinction, 1e-30), metres * (1.0 - 0.5 * depth), depth < 1e-4);
}

/// Texels before `x` metres of X, and of the texel in which it lies the share of its weight: what a mean over whole
/// columns, of which the last counts in part, takes. Between two edges weight does not grow with the column. `reach`: of
/// the reference ray; `extinction` in 1/m, 0 for plain means.
fn weighed_column(rows: ProjectiveRows, width: f32, reach: f32, extinction: f32, x: f32) -> f32 {
    let column = u32(clamp(column_from_x(rows, width, x), 0.0, width - 1.0));
    let begin = texel_begin(rows, width, column);
    let whole = stretch_weight(extinction, max(texel_end(rows, width, column) - begin, 0.0) * reach);
    let here = stretch_weight(extinction, max(x - begin, 0.0) * reach);
    return f32(column) + clamp(here / max(whole, 1e-37), 0.0, 1.0);
}

// ---- airlight::scattering::rows ----
// summary: Where a view ray lies in a rectified map, and how the means of a row's regions are put together.
// source: thesis 4.3.3 (regions), 4.4.2 (near plane).

/// A view ray in a rectified map.
struct RowRay {
    /// Row, fractional; row j is at the value j.
    row: f32,
    /// Texels before the ray begins, fractional.
    begin: f32,
    /// Texels before the ray ends, fractional.
    end: f32,
    /// Depth of the ray, 0..1.
    depth: f32,
}

/// Stretches that do not begin at the row's start are at least this long, texels.
const LEAST_STRETCH: f32 = 4.0;

/// `begin` of a stretch, moved towards the eye where the stretch is short.
fn stretch_begin(begin: f32, end: f32) -> f32 {
    return clamp(min(begin, end - LEAST_STRETCH), 0.0, end);
}

/// The region of a row of `width` texels in `regions` regions that holds the `texels`-th texel.
fn region_of(texels: f32, width: u32, regions: u32) -> u32 {
    // A ray that ends at the border of two regions needs nothing of the second.
    let last = u32(max(ceil(texels) - 1.0, 0.0));
    return min(last * regions / width, regions - 1u);
}

/// First texel of a region; of the region after the last, the width.
fn region_begin(region: u32, width: u32, regions: u32) -> u32 {
    return (region * width + regions - 1u) / regions;
}

// ---- airlight::scattering::scattered_ray ----
// summary: What evaluating a pixel's view ray gives, and the texel that is kept of it.
// source: thesis 4.3.3, Listing 4.4.

/// What stands for infinity, metres.
const FARTHEST: f32 = 1e15;

/// A view ray and the light that the air scatters into it.
struct ScatteredRay {
    /// Linear RGB radiance at the eye, at most 65504.
    radiance: vec3<f32>,
    /// Mean visibility of the light along it, 0..1; where columns have a fall-off, the mean of that times visibility over the
    /// colours.
    visibility: f32,
    /// Where it passes through the picture.
    ndc: vec2<f32>,
    /// Its length in metres up to the surface, from the eye or the near plane of an orthographic camera, at most FARTHEST;
    /// the medium may end before.
    distance: f32,
    /// View direction times the unit vector at its origin towards the light, -1..1.
    cosine: f32,
}

/// What passes write of it: radiance, and in alpha the mean visibility.
fn scattered_texel(ray: ScatteredRay) -> vec4<f32> {
    return vec4<f32>(ray.radiance, ray.visibility);
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

/// Radiance scattered into a view ray. `visibility`: mean over the ray, weighted by transmittance or
/// plain, 0..1; `distance`: length of the ray in metres; `cosine`: view direction times direction
/// towards the light.
fn in_scattered(medium: Medium, light_radiance: vec3<f32>, cosine: f32, distance: f32, visibility: f32) -> vec3<f32> {
    let phase = henyey_greenstein(cosine, medium.g);
    return medium.albedo * light_radiance * (phase * one_minus_exp(medium.extinction * distance) * visibility);
}

// ---- airlight::scattering::visibility_rank ----
// summary: Exact mean visibility of a view ray: how many of the first texels of a row lie behind it, by one rank query.
// source: none; a rank structure over a permutation, cut into words: docs/src/rank.md explains it with a drawing.

/// Least stretch that is asked for, texels: shorter ones see their texel.
const LEAST_TEXELS: f32 = 1e-3;

/// A depth, clamped to 0..1, as a whole number of `bits` bits.
fn rank_value(depth: f32, bits: u32) -> u32 {
    return u32(clamp(depth, 0.0, 1.0) * f32((1u << bits) - 1u) + 0.5);
}

/// The lowest `count` bits, 0..32.
fn low_bits(count: u32) -> u32 {
    return select((1u << (count & 31u)) - 1u, 0xffffffffu, count >= 32u);
}

/// Four bit planes more of the comparison `value < limit` of 32 values at once, from the lowest plane up. `limit`: its
/// four bits lowest.
fn less_by_planes(less: u32, planes: vec4<u32>, limit: u32) -> u32 {
    var result = less;
    result = select(result & ~planes.x, result | ~planes.x, (limit & 1u) != 0u);
    result = select(result & ~planes.y, result | ~planes.y, (limit & 2u) != 0u);
    result = select(result & ~planes.z, result | ~planes.z, (limit & 4u) != 0u);
    return select(result & ~planes.w, result | ~planes.w, (limit & 8u) != 0u);
}

/// Where a query lies in the structure.
struct RankPlace {
    /// Texels that the ray covers, at least LEAST_TEXELS.
    covered: f32,
    /// Of the last of these, in which the ray ends.
    column: u32,
    /// What of it is covered, 0..1.
    part: f32,
    /// The cell: chunk times the number of blocks plus block.
    cell: u32,
    /// Ranks of the chunk that are below the ray, 0..32.
    ranks: u32,
    /// The columns of the block with a value below that of the ray, a bit each.
    less: u32,
}

/// The place of a query. `starts`: how many texels of a row have a smaller value, two values of 16 bits a texel;
/// `planes`: bit planes, four a layer, one texel a block; `columns` of the map; `texels`: fractional.
fn rank_place(
    starts: texture_2d<u32>, planes: texture_2d_array<u32>, bits: u32, columns: u32, row: u32, texels: f32, depth: f32
) -> RankPlace {
    let covered = clamp(texels, LEAST_TEXELS, f32(columns));
    let column = min(u32(covered), columns - 1u);
    let block = column / 32u;
    let value = rank_value(depth, bits);
    let pair = textureLoad(starts, vec2<u32>(value / 2u, row), 0).x;
    let start = (pair >> (16u * (value & 1u))) & 0xffffu;
    let blocks = (columns + 31u) / 32u;
    let chunk = min(start / 32u, blocks - 1u);
    var less = 0u;
    for (var layer = 0u; layer < (bits + 3u) / 4u; layer++) {
        less = less_by_planes(less, textureLoad(planes, vec2<u32>(block, row), layer, 0), value >> (4u * layer));
    }
    return RankPlace(
        covered, column, covered - f32(column), chunk * blocks + block, start - 32u * chunk, less
    );
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

/// Steps, summed, of the columns or ranks that are set in `which`, and `part` of those in `partly`: for two words at once.
/// `place`: the block, or chunk, and row; `layer`: the first of the planes.
fn weight_sums(
    weights: texture_2d_array<u32>, place: vec2<u32>, layer: u32, weight_bits: u32, which: vec2<u32>,
    partly: vec2<u32>, part: f32
) -> vec2<f32> {
    var whole = vec2<u32>(0u);
    var last = vec2<u32>(0u);
    for (var four = 0u; four < weight_bits / 4u; four++) {
        let planes = textureLoad(weights, place, layer + four, 0);
        let each = vec4<u32>(1u, 2u, 4u, 8u) << vec4<u32>(4u * four);
        whole.x += dot(countOneBits(planes & vec4<u32>(which.x)), each);
        whole.y += dot(countOneBits(planes & vec4<u32>(which.y)), each);
        last.x += dot(countOneBits(planes & vec4<u32>(partly.x)), each);
        last.y += dot(countOneBits(planes & vec4<u32>(partly.y)), each);
    }
    return vec2<f32>(whole) + part * vec2<f32>(last);
}

/// What of a row a query adds.
struct RankWords {
    /// Block and row.
    block: vec2<u32>,
    /// Chunk and row.
    chunk: vec2<u32>,
    /// Ranks of the chunk that are meant: left of the block, and dark.
    meant: u32,
    /// Columns of the block that are covered: those lit, and all.
    covered: vec2<u32>,
    /// The column in which the ray ends, the same.
    last: vec2<u32>,
    /// What of that is covered, 0..1.
    part: f32,
}

/// Steps of a channel: of the dark ranks of the chunk, and of the lit and of all columns of the block that are covered.
fn channel_steps(
    weights: texture_2d_array<u32>, words: RankWords, channel: u32, colors: u32, weight_bits: u32
) -> vec3<f32> {
    let ranks = weight_sums(
        weights, words.chunk, rank_layer(channel, colors, weight_bits), weight_bits, vec2<u32>(words.meant),
        vec2<u32>(0u), 0.0
    );
    let columns = weight_sums(
        weights, words.block, column_layer(channel, weight_bits), weight_bits, words.covered, words.last, words.part
    );
    return vec3<f32>(ranks.x, columns);
}

/// Mean of visibility times fall-off, for each of `colors` colours (0: the mean visibility, 1: the same for all), of the
/// first `texels` texels of `row` at the depth of a ray, 0..1. `cells`, `starts`, `planes` and `weights` are what the pass
/// `rank_weights` makes, for depths of `bits` bits and weights of `weight_bits` bits; `columns` of the map.
fn rank_means(
    cells: texture_2d<u32>, starts: texture_2d<u32>, planes: texture_2d_array<u32>, weights: texture_2d_array<u32>,
    bits: u32, weight_bits: u32, colors: u32, columns: u32, row: u32, texels: f32, depth: f32
) -> vec3<f32> {
    let at = rank_place(starts, planes, bits, columns, row, texels, depth);
    let cell = textureLoad(cells, vec2<u32>(at.cell, row), 0);
    let base = bitcast<vec3<f32>>(cell.yzw);
    let covered = low_bits(at.column & 31u);
    let last = 1u << (at.column & 31u);
    let words = RankWords(
        vec2<u32>(at.column / 32u, row),
        vec2<u32>(at.cell / ((columns + 31u) / 32u), row),
        cell.x & low_bits(at.ranks),
        vec2<u32>(covered & ~at.less, covered),
        vec2<u32>(last & ~at.less, last),
        at.part
    );
    let column_step = bitcast<vec4<f32>>(textureLoad(weights, words.block, 0u, 0));
    let left = bitcast<vec4<f32>>(textureLoad(weights, words.block, 1u, 0));
    let rank_step = bitcast<vec4<f32>>(textureLoad(weights, words.chunk, 2u, 0)).xyz;

    let first = channel_steps(weights, words, 0u, colors, weight_bits);
    var ranks = vec3<f32>(first.x);
    var lit = vec3<f32>(first.y);
    var total = left.x + column_step.x * first.z;
    if colors == 3u {
        let second = channel_steps(weights, words, 1u, colors, weight_bits);
        let third = channel_steps(weights, words, 2u, colors, weight_bits);
        ranks = vec3<f32>(first.x, second.x, third.x);
        lit = vec3<f32>(first.y, second.y, third.y);
    }
    if colors > 0u {
        // The plain weight is a channel of its own.
        let layer = column_layer(colors, weight_bits);
        let plain = weight_sums(weights, words.block, layer, weight_bits, words.covered, words.last, words.part);
        total = left.w + column_step.w * plain.y;
    }
    // Left of the block all but the dark, in it the lit.
    let each = left.xyz - (base + rank_step * ranks) + column_step.xyz * lit;
    let sum = select(vec3<f32>(each.x), each, colors == 3u);
    // Where all that is covered weighs next to nothing, the last texel stands for it.
    let seen = select(0.0, 1.0, colors == 0u && words.last.x != 0u);
    return select(vec3<f32>(seen), clamp(sum / max(total, 1e-35), vec3<f32>(0.0), vec3<f32>(1.0)), total > 1e-35);
}

// ---- airlight::scattering::prefiltered ----
// summary: Callback: mean visibility of a stretch of a row, by whichever method the pass was built for.
// source: thesis 4.3.1 and 4.3.3, Eq. 4.6 and 4.9, Listing 4.4; visibility_rank and visibility_moments for the others.

@group(0) @binding(7) var rank_cells: texture_2d<u32>;
@group(0) @binding(8) var rank_starts: texture_2d<u32>;
@group(0) @binding(13) var rank_planes: texture_2d_array<u32>;
@group(0) @binding(14) var rectified: texture_2d<f32>;
const RANK_BITS: u32 = u32(12);
@group(0) @binding(15) var rank_weights: texture_2d_array<u32>;
const BITS_OF_WEIGHTS: u32 = u32(16);
const RANK_COLORS: u32 = 0u;

/// The stretch of a row from the texel at which a region begins.
struct Prefix {
    /// Row, fractional; row j is at the value j.
    row: f32,
    /// 1 where the row after the last is the first, else 0.
    wraps: f32,
    /// First texel of the region.
    first: f32,
    /// Where the stretch ends, texels from the start of the row, fractional.
    texels: f32,
    /// Optical depth of a texel of the ray; 0 for plain means.
    optical_step: f32,
    /// By which what was stored is weighted: that of the reference ray, with RANK the least of the row.
    stored_step: f32,
}

/// Columns and rows of the rectified map.
fn map_size() -> vec2<u32> {
    return textureDimensions(rectified);
}

/// What the stretch in a whole `row` gives, 0..1: the mean visibility, or with COLORS that times fall-off, for each colour.
fn row_means(at: Prefix, row: u32, depth: f32) -> vec3<f32> {
    let columns = map_size().x;
    return rank_means(
        rank_cells, rank_starts, rank_planes, rank_weights, RANK_BITS, BITS_OF_WEIGHTS, RANK_COLORS, columns, row,
        at.texels, depth
    );
}

/// The means of the nearest row, or of the two about the stretch.
fn mixed_means(at: Prefix, depth: f32) -> vec3<f32> {
    let rows = map_size().y;
    let whole = min(u32(max(at.row, 0.0)), rows - 1u);
    let next = select(min(whole + 1u, rows - 1u), 0u, whole + 1u >= rows && at.wraps > 0.0);
    let share = clamp(at.row - f32(whole), 0.0, 1.0);
    return mix(row_means(at, whole, depth), row_means(at, next, depth), share);
}

/// Mean visibility of a stretch at the depth of a ray, 0..1.
fn prefix_visibility(at: Prefix, depth: f32) -> f32 {
    return mixed_means(at, depth).x;
}

// ---- airlight::scattering::evaluated_projective ----
// summary: Callback: what the air scatters into a pixel's view ray, from projective rows, for cameras of any kind.
// source: thesis 4.3.1 and 4.3.3, Eq. 4.6 and 4.9, Listing 4.4.

@group(0) @binding(0) var<uniform> camera: Camera;
@group(0) @binding(1) var<uniform> light: Light;
@group(0) @binding(2) var<uniform> medium: Medium;
@group(0) @binding(10) var<uniform> rows: ProjectiveRows;
@group(0) @binding(5) var depth: texture_2d<f32>;

const ROW_REGIONS: u32 = 1u;

/// The mean over a row from the texel `first`, where a region begins, up to `x` metres of X. `reach`: of the reference ray;
/// `extinction` in 1/m, 0 for plain means.
fn mean_up_to(ray: RowRay, first: u32, reach: f32, extinction: f32, x: f32) -> f32 {
    let width = f32(map_size().x);
    let texels = weighed_column(rows, width, reach, extinction, x);
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
        if from_x > start {
            let whole = stretch_weight(extinction, (to_x - start) * reach);
            let before = stretch_weight(extinction, (from_x - start) * reach);
            let skipped = mean_up_to(row_ray, column, reach, extinction, from_x);
            mean = clamp((mean * whole - skipped * before) / max(whole - before, 1e-6 * whole + 1e-30), 0.0, 1.0);
        }
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
    let extinction = medium.extinction;
    let width = f32(map_size().x);
    let ray = view_ray(camera, ndc);
    let distance = distance_from_depth(camera, ray, ndc, surface, medium.distance_limit);
    let cosine = dot(ray.direction, light.direction);
    var along = projective_ray(rows, f32(map_size().y), ray.origin, ray.direction, distance);
    // An orthographic ray begins there anyway.
    let near = distance_from_depth(camera, ray, ndc, camera.near_depth, distance);
    along.begin += near / along.reach;
    var row_ray = RowRay(
        along.row, column_from_x(rows, width, along.begin), column_from_x(rows, width, along.end), along.depth
    );
    // Short stretches are widened towards the eye, as those of slices are.
    let widened = stretch_begin(row_ray.begin, row_ray.end);
    if widened < row_ray.begin {
        row_ray.begin = widened;
        along.begin = min(along.begin, x_from_column(rows, width, widened));
    }
    let visibility = clamp(projective_visibility(along, row_ray, extinction), 0.0, 1.0);
    let radiance = in_scattered(medium, light.radiance, cosine, distance - near, visibility);
    let to_surface = distance_from_depth(camera, ray, ndc, surface, FARTHEST);
    return ScatteredRay(min(radiance, vec3<f32>(65504.0)), visibility, ndc, to_surface, cosine);
}

// ---- scattering/evaluate_projective ----

@group(0) @binding(9) var scattered: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(16, 8)
fn evaluate_projective(@builtin(global_invocation_id) id: vec3<u32>) {
    if all(id.xy < textureDimensions(scattered)) {
        textureStore(scattered, id.xy, scattered_texel(scattered_ray(id.xy)));
    }
}

@vertex
fn vertex_picture(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return picture_corner(index);
}

@fragment
fn fragment_evaluate_projective(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return scattered_texel(scattered_ray(vec2<u32>(position.xy)));
}
