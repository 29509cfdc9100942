// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::scattering::projective
// summary: Projective rows around a directional light: view rays run along rows at constant depth after one matrix.
// source: thesis 4.4.2; weights after 4.3.2, Eq. 4.8.
// note: In the axes (along, across, away) a point relative to the eye has the coordinates X, Y, Z: light rays keep X and
// note: Y, view rays keep Y / X and Z / X. Rows are Y / X, depth is Z / X, columns run with -1 / X, so that all is one
// note: projective matrix. An orthographic camera has Y and Z - tilt X instead, and columns run with X.
// note: The thesis takes the ranges of rows and depth from the coordinates of the frustum's corners: it must be their
// note: slopes. It says that the distance grows by a constant factor from texel to texel (its w' in 4.4.2): that is
// note: false, edges lie where X is n f / (f - u (f - n)), and weights come from the distances of those edges, here.
// note: Unweighted means need the lengths of the texels for the same reason.
// note: One such row gives nearly all texels to the nearest metres: up to four splits with bounds in geometric progression
// note: share the columns.
// equation: row: Y / X, depth: Z / X, columns: u = (x − n) / (f − n) · f / x in each split;  orthographic: Y, Z − tilt X, x
// equation: W(s) = (1 − exp(−σ s)) / σ;  share of a texel: (W(x) − W(begin)) W(end) / ((W(end) − W(begin)) W(x))
// error: places and rays within the budgets of f32 that the test derives;
// error: test scattering/projective/geometry::shader_places_points_and_rays_as_the_reference_does.
// error: marched rows within 0.004 of the exact sums; test scattering/projective/pictures::marched_rows_are_the_exact_sums.
// parameter width: columns of the map.
// parameter height: rows of the map.
// parameter row: of the map, row j at j.
// parameter column: of the map, from 0.
// parameter point: metres in the world.
// parameter x, z: X and Z, metres.
// parameter map: depths, r32float.
// parameter split: 0..3.
// parameter reach: metres along the reference ray for one of X.
// parameter distance: metres, from 0 up.
// parameter metres: from 0 up.

#import airlight::core::fourier_basis::{GUARD, guarded}
#import airlight::core::prefix_sum::one_minus_exp

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

/// What slopes are divided by: X in perspective, 1 for an orthographic camera. `x`: X in metres.
fn projective_divisor(rows: ProjectiveRows, x: f32) -> f32 {
    return select(1.0, max(x, 1e-6 * rows.bounds.w), rows.projection == PERSPECTIVE);
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

/// Column, row (row j at the value j) and depth of a point in the world. `size`: of the map in texels. Neither row nor
/// depth is clamped: outside of the map's rows nothing is known, and blockers may lie at any depth.
fn rectified_position(rows: ProjectiveRows, size: vec2<f32>, point: vec3<f32>) -> vec3<f32> {
    let offset = point - rows.origin;
    let x = dot(offset, rows.along);
    let divisor = projective_divisor(rows, x);
    let row = (dot(offset, rows.across) / divisor - rows.row_min) / rows.row_span * size.y - 0.5;
    let unit = depth_unit(rows, x, dot(offset, rows.away));
    return vec3<f32>(column_from_x(rows, size.x, x), row, GUARD + (1.0 - 2.0 * GUARD) * unit);
}

/// Depth over the bounds of the view rays, 0..1 for these, of the point at X and Z in metres.
fn depth_unit(rows: ProjectiveRows, x: f32, z: f32) -> f32 {
    return ((z - rows.tilt * x) / projective_divisor(rows, x) - rows.depth_min) / rows.depth_span;
}

/// Depth 0..1 in the map of a blocker at X and Z in metres: in front of all view rays or behind them it is clamped
/// into the guard.
fn depth_from_blocker(rows: ProjectiveRows, x: f32, z: f32) -> f32 {
    return guarded(depth_unit(rows, x, z));
}

/// The point on the light ray in the middle of a texel that lies at Z = 0, the height of the eye. `x`: X in metres.
fn light_ray_point(rows: ProjectiveRows, height: f32, row: f32, x: f32) -> vec3<f32> {
    let y = row_slope(rows, height, row) * projective_divisor(rows, x);
    return rows.origin + rows.along * x + rows.across * y;
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

/// Mean visibility of a view ray over `row` of a rectified map, weighted by transmittance: the exact sum over its
/// texels. `extinction` in 1/m, 0 for the plain mean.
fn march_projective_row(
    map: texture_2d<f32>, rows: ProjectiveRows, row: u32, ray: ProjectiveRay, extinction: f32
) -> f32 {
    let size = textureDimensions(map);
    let width = f32(size.x);
    let first = min(u32(column_from_x(rows, width, ray.begin)), size.x - 1u);
    let last = max(min(u32(column_from_x(rows, width, ray.end)), size.x - 1u), first);
    var from_x = ray.begin;
    var through = 1.0;
    var sum = 0.0;
    var total = 0.0;
    var lit = false;
    for (var column = first; column <= last; column++) {
        lit = textureLoad(map, vec2<u32>(column, row), 0).x >= ray.depth;
        let inner = clamp(texel_end(rows, width, column), from_x, max(ray.end, from_x));
        let to_x = select(inner, max(ray.end, from_x), column == last);
        let metres = (to_x - from_x) * ray.reach;
        let weight = through * stretch_weight(extinction, metres);
        sum += select(0.0, weight, lit);
        total += weight;
        through *= exp(-extinction * metres);
        from_x = to_x;
    }
    // A ray of no length sees its texel.
    return select(clamp(sum / max(total, 1e-37), 0.0, 1.0), select(0.0, 1.0, lit), total < 1e-30);
}
