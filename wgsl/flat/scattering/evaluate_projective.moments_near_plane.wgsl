// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: scattering/evaluate_projective, permutation moments_near_plane (MOMENTS NEAR_PLANE)
// summary: In-scattered radiance of every pixel from filtered bases, moments or rank queries over projective rows, for cameras of any kind.
// source: thesis 4.3.1 and 4.3.3, Eq. 4.6 and 4.9, Listing 4.4.
// definition MOMENTS: visibility from what `filter_moments` stores. Not with REGIONS.
// definition NEAR_PLANE: rays, and the medium, begin at the near plane instead of the eye.
// binding camera: the camera, any.
// binding light: the directional light and its shadow map's clip space.
// binding medium: the medium.
// binding rows: the projective rows.
// binding depth: depth buffer of the picture, a depth format or r32float; non-finite values count as far.
// binding moments: what `filter_moments` makes, rgba32uint; with MOMENTS only.
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

// ---- airlight::core::moment_bounds ----
// summary: Six moments of a distribution on -1..1, and the bounds that they give of its share beyond a place.
// source: Algorithm 1 of Peters et al., "Improved moment shadow maps for translucent occluders, soft shadows and single scattering" (2017).

/// Share of the density 1 / (pi sqrt(1 - z^2)) that is mixed in.
const MOMENT_BIAS: f32 = 1e-5;
/// Values below this break the factorisation off; the bias keeps those of real moments above it.
const LEAST_PIVOT: f32 = 0.1 * MOMENT_BIAS;
/// Roots farther away than this carry less than 1e-5.
const FARTHEST_ROOT: f32 = 8.0;

/// Means of the Chebyshev polynomials T_1 to T_6.
struct Moments {
    /// Of degree 1, 2 and 3, -1..1.
    low: vec3<f32>,
    /// Of degree 4, 5 and 6, -1..1.
    high: vec3<f32>,
}

/// G = L D L' and the first row of G.
struct Factors {
    /// Means of T_1, T_2, T_3, which is the first column of L.
    mean: vec3<f32>,
    /// The other entries of L: of rows 2 and 3 at column 1, and of row 3 at column 2.
    lower: vec3<f32>,
    /// 1 / D_1, 1 / D_2, 1 / D_3; D_0 is 1. Zero from where the factorisation breaks off.
    inverse: vec3<f32>,
}

/// T_1, T_2, T_3 at `z`.
fn chebyshev(z: f32) -> vec3<f32> {
    return vec3<f32>(z, 2.0 * z * z - 1.0, z * (4.0 * z * z - 3.0));
}

/// Moments of a mixture: `share` 0..1 of `b`, the rest of `a`.
fn mix_moments(a: Moments, b: Moments, share: f32) -> Moments {
    return Moments(mix(a.low, b.low, share), mix(a.high, b.high, share));
}

/// Factors of the matrix G of biased moments.
fn moment_factors(moments: Moments) -> Factors {
    let keep = 1.0 - MOMENT_BIAS;
    let low = keep * clamp(moments.low, vec3<f32>(-1.0), vec3<f32>(1.0));
    let high = keep * clamp(moments.high, vec3<f32>(-1.0), vec3<f32>(1.0));
    // Entries of G, less what the first column takes: rows and columns 1 to 3.
    let diagonal = 0.5 + 0.5 * vec3<f32>(low.y, high.x, high.z) - low * low;
    let side = 0.5 * vec3<f32>(low.x + low.z, low.y + high.x, low.x + high.y) - low.xxy * low.yzz;
    let inverse_a = select(0.0, 1.0 / max(diagonal.x, LEAST_PIVOT), diagonal.x > LEAST_PIVOT);
    let row_b = side.x * inverse_a;
    let row_c = side.y * inverse_a;
    let pivot_b = diagonal.y - row_b * side.x;
    let inverse_b = select(0.0, 1.0 / max(pivot_b, LEAST_PIVOT), pivot_b > LEAST_PIVOT && inverse_a > 0.0);
    let rest = side.z - row_b * side.y;
    let row_d = rest * inverse_b;
    let pivot_c = diagonal.z - row_c * side.y - row_d * rest;
    let inverse_c = select(0.0, 1.0 / max(pivot_c, LEAST_PIVOT), pivot_c > LEAST_PIVOT && inverse_b > 0.0);
    return Factors(low, vec3<f32>(row_b, row_c, row_d), vec3<f32>(inverse_a, inverse_b, inverse_c));
}

/// The orthogonal polynomials of degree 1, 2 and 3 at `z`; that of degree 0 is 1.
fn orthogonal_polynomials(factors: Factors, z: f32) -> vec3<f32> {
    let centred = chebyshev(z) - factors.mean;
    let second = centred.y - factors.lower.x * centred.x;
    let third = centred.z - factors.lower.y * centred.x - factors.lower.z * second;
    return vec3<f32>(centred.x, second, third);
}

/// The most that can lie where the orthogonal polynomials have these values: 1 / K, 0..1.
fn greatest_weight(factors: Factors, polynomials: vec3<f32>) -> f32 {
    return 1.0 / (1.0 + dot(polynomials * polynomials, factors.inverse));
}

/// cos(acos(x) / 3) for x from -1 to 1, and at most 3e-6 more: a polynomial in cos(acos(x) / 2).
fn cosine_of_third(x: f32) -> f32 {
    let half = sqrt(0.5 * x + 0.5);
    let last = 0.04763451 + half * (half * 0.00412080 - 0.01912183);
    return 0.5000028 + half * (0.57725041 + half * (half * last - 0.10988446));
}

/// One step of Newton's method from `root` towards a root of t^3 + a t^2 + b t + c, `coefficients` a, b, c.
fn newton_step(coefficients: vec3<f32>, root: f32) -> f32 {
    let slope = (3.0 * root + 2.0 * coefficients.x) * root + coefficients.y;
    let value = ((root + coefficients.x) * root + coefficients.y) * root + coefficients.z;
    return root - select(0.0, value / max(slope, 1e-30), slope > 1e-30);
}

/// The greatest root of t^3 + a t^2 + b t + c, `coefficients` a, b, c, of which all roots are real.
fn greatest_cubic_root(coefficients: vec3<f32>) -> f32 {
    let a = coefficients.x;
    let b = coefficients.y;
    let c = coefficients.z;
    // Roots -a/3 + 2 sqrt(p) cos: those of the cubic moved to have no square.
    let p = max(a * a - 3.0 * b, 0.0) / 9.0;
    let half_width = sqrt(p);
    let r = (a * (2.0 * a * a - 9.0 * b) + 27.0 * c) / 54.0;
    let cosine = cosine_of_third(clamp(-r / max(p * half_width, 1e-30), -1.0, 1.0));
    // From above, Newton's steps come nearer without passing it. They recover a root that is small next to the others.
    return newton_step(coefficients, newton_step(coefficients, 2.0 * half_width * cosine - a / 3.0));
}

/// Least and greatest share, 0..1, at or beyond `z`, -1..1, that are possible with these moments. Their difference is the
/// most that can lie at `z` itself.
fn share_bounds(moments: Moments, z: f32) -> vec2<f32> {
    let factors = moment_factors(moments);
    let at_ray = orthogonal_polynomials(factors, z);
    let own = greatest_weight(factors, at_ray);
    let changes = select(vec3<u32>(0u), vec3<u32>(1u), at_ray * vec3<f32>(1.0, at_ray.xy) < vec3<f32>(0.0));
    let above = changes.x + changes.y + changes.z;
    // G^-1 T(z): K(x, z) as a sum of T_0..T_3 at x, then its derivatives at x = z over K(z, z).
    let scaled = at_ray * factors.inverse;
    let third = scaled.z;
    let second = scaled.y - factors.lower.z * third;
    let first = scaled.x - factors.lower.x * second - factors.lower.y * third;
    let slope = first - 3.0 * third + z * (4.0 * second + 12.0 * z * third);
    let cubic = own * vec3<f32>(slope, 2.0 * second + 12.0 * z * third, 4.0 * third);
    // The root that lies alone on its side is the greatest in t, or the least, which is the greatest of the mirrored cubic.
    // Where all lie on the other side that root is negative, and no weight is alone.
    let side = select(-1.0, 1.0, above < 2u);
    let root = greatest_cubic_root(cubic * vec3<f32>(side, 1.0, side));
    let nearest = z + side / max(root, 1.0 / FARTHEST_ROOT);
    let weight = min(greatest_weight(factors, orthogonal_polynomials(factors, nearest)), 1.0 - own);
    let alone = select(0.0, weight, root > 1.0 / FARTHEST_ROOT);
    let upper = select(1.0 - alone, own + alone, above < 2u);
    return vec2<f32>(max(upper - own, 0.0), min(upper, 1.0));
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

/// Column between whose neighbours filtered bases are interpolated linearly for a ray that ends at `x` metres of X.
/// Texel i holds the mean from the left edge of texel `first`, where its region begins, up to the right edge of texel i;
/// between two edges the weighted sum grows with the weight and not with the column, so that the share of the next
/// texel is not the fraction of the column. `reach`: of the reference ray; `extinction` in 1/m, 0 for plain means.
/// The result is at least `first` + 0.5.
fn filtered_column(
    rows: ProjectiveRows, width: f32, reach: f32, extinction: f32, first: u32, x: f32
) -> f32 {
    let start = texel_begin(rows, width, first);
    // At the very end of a region the column is that of the next.
    let last = max(u32(max(ceil(column_from_x(rows, width, x)) - 1.0, 0.0)), first);
    let column = min(last, u32(width) - 1u);
    let before = stretch_weight(extinction, max(texel_begin(rows, width, column) - start, 0.0) * reach);
    let after = stretch_weight(extinction, max(texel_end(rows, width, column) - start, 0.0) * reach);
    let here = clamp(stretch_weight(extinction, max(x - start, 0.0) * reach), before, after);
    let texel = after - before;
    // Where transmittance is used up all means are alike.
    let share = select((here - before) * after / max(texel * here, 1e-37), 1.0, texel <= 1e-6 * after);
    return clamp(f32(column) - 0.5 + clamp(share, 0.0, 1.0), f32(first) + 0.5, width - 0.5);
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

/// Where the prefix mean over the texels before `texels` is read, in texels: texel i holds the mean over the texels
/// up to and with i, so that half a texel is taken off; at the start of the region that begins at `first` it stays inside.
fn prefix_column(texels: f32, first: f32) -> f32 {
    return max(texels - 0.5, first + 0.5);
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

// ---- airlight::scattering::visibility_moments ----
// summary: Mean visibility of a view ray from six filtered moments of the stored depths: bounds of the share beyond it.
// source: Peters et al., "Improved moment shadow maps for translucent occluders, soft shadows and single scattering" (2017).

/// Place of the estimate between the upper bound of visibility, 0, and the lower, 1.
const MOMENT_BLEND: f32 = 0.15;
/// View rays keep this far from the ends of the signed depths, in depth 0..1.
const MARGIN: f32 = 0.01;
/// Steps of a moment's 21 bits.
const STEPS: f32 = 2097151.0;

/// Depth 0..1 to -1..1. Blockers in the guard beyond every view ray are all the same.
fn signed_depth(depth: f32) -> f32 {
    return clamp((depth - 0.5) / (0.5 - GUARD + MARGIN), -1.0, 1.0);
}

/// What `pack_moments` did, undone. Any bits give moments in -1..1.
fn unpack_moments(texel: vec4<u32>) -> Moments {
    let first = texel & vec4<u32>(0x1fffffu);
    let rest = texel >> vec4<u32>(21u);
    let last = (rest.xz | (rest.yw << vec2<u32>(11u))) & vec2<u32>(0x1fffffu);
    let scale = 2.0 / STEPS;
    return Moments(
        vec3<f32>(first.xyz) * scale - 1.0,
        vec3<f32>(vec3<u32>(first.w, last)) * scale - 1.0
    );
}

/// Least and greatest share of stored depths at or beyond `depth`, both 0..1, that are possible with these moments.
fn moment_bounds(moments: Moments, depth: f32) -> vec2<f32> {
    return share_bounds(moments, signed_depth(depth));
}

/// Mean visibility 0..1 of a ray at `depth`, 0..1, over texels of which these are the moments.
fn moment_visibility(moments: Moments, depth: f32) -> f32 {
    let bounds = moment_bounds(moments, depth);
    return mix(bounds.y, bounds.x, MOMENT_BLEND);
}

/// The four texels of a bilinear read.
struct Around {
    /// First and second column.
    columns: vec2<u32>,
    /// First and second row.
    rows: vec2<u32>,
    /// Share of the second column and of the second row, 0..1.
    share: vec2<f32>,
}

/// The texels around `place` of a map of `size` texels. `place`: column in texels, texel i at i + 0.5, and row, row j at j;
/// outside of the map the nearest inside. `wraps`: the last row is followed by the first.
fn texels_around(size: vec2<u32>, place: vec2<f32>, wraps: bool) -> Around {
    let last = size - vec2<u32>(1u);
    let greatest = vec2<f32>(f32(last.x), select(f32(last.y), f32(size.y), wraps));
    let at = clamp(place - vec2<f32>(0.5, 0.0), vec2<f32>(0.0), greatest);
    let begin = min(vec2<u32>(at), vec2<u32>(last.x, size.y));
    let row = select(min(begin.y, last.y), begin.y % size.y, wraps);
    let next = select(min(begin.y + 1u, last.y), (begin.y + 1u) % size.y, wraps);
    return Around(vec2<u32>(begin.x, min(begin.x + 1u, last.x)), vec2<u32>(row, next), at - vec2<f32>(begin));
}

/// Mean visibility by a bilinear read. `place` and `wraps` as of `texels_around`.
fn moments_visibility(map: texture_2d<u32>, place: vec2<f32>, wraps: bool, depth: f32) -> f32 {
    let around = texels_around(textureDimensions(map), place, wraps);
    let here = mix_moments(
        unpack_moments(textureLoad(map, vec2<u32>(around.columns.x, around.rows.x), 0)),
        unpack_moments(textureLoad(map, vec2<u32>(around.columns.y, around.rows.x), 0)),
        around.share.x
    );
    let beside = mix_moments(
        unpack_moments(textureLoad(map, vec2<u32>(around.columns.x, around.rows.y), 0)),
        unpack_moments(textureLoad(map, vec2<u32>(around.columns.y, around.rows.y), 0)),
        around.share.x
    );
    return moment_visibility(mix_moments(here, beside, around.share.y), depth);
}

// ---- airlight::scattering::prefiltered ----
// summary: Callback: mean visibility of a stretch of a row, by whichever method the pass was built for.
// source: thesis 4.3.1 and 4.3.3, Eq. 4.6 and 4.9, Listing 4.4; visibility_rank and visibility_moments for the others.

@group(0) @binding(7) var moments: texture_2d<u32>;

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
    return textureDimensions(moments);
}

/// Mean visibility of a stretch at the depth of a ray, 0..1.
fn prefix_visibility(at: Prefix, depth: f32) -> f32 {
    let column = prefix_column(at.texels, at.first);
    return moments_visibility(moments, vec2<f32>(column, at.row), at.wraps > 0.0, depth);
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
    // A stretch is read half a texel before its end.
    let texels = filtered_column(rows, width, reach, extinction, first, x) + 0.5;
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
