// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::stylize::epipolar_dilate
// summary: Extrusion of blockers along view rays inside a shadow map, and its counterpart: depths carried along epipolar lines.
// source: stylized scattering, Eq. 3; thesis Eq. 6.1.
// note: The epipole is the eye in the map. It is given in homogeneous coordinates, as a projection leaves it: an eye at infinity
// note: (weight 0) makes parallel lines, one behind a spot light (weight below 0) lines that run from it.
// note: Kernels step by one texel of the axis along which a line is longer, so that every step is another texel, and distances
// note: are ratios of that axis. A kernel of k texels is the own one and the next k - 1.
// note: Eq. 3 carries the blocker of a sample along its view ray: z + (z - z_l) n / dis(s, l), n steps from the sample to the
// note: texel; this is the printed form, without its cancellation where the epipole is far.
// note: An empty sample extrudes nothing, also where the eye is farther from the light than the far plane: the printed
// note: equation would make blockers of empty texels there.
// note: Within a line, the depth that a blocker has once carried to the line's end orders blockers like (z - z_l) / dis(s, l)
// note: does, and does so for an epipole at infinity as well.
// equation: z' = z + (z − z_l) n / dis(s, l): depth z of a blocker n steps on, l the epipole  (Eq. 3)
// equation: closing = erosion of the dilation;  minima over the texels 0 .. k − 1 towards the epipole of carried depths
// error: the direct form is Equation 3, but for less than 1 % of texels that rounding decides;
// error: test stylize/epipolar_dilate/equation::the_direct_form_is_equation_3_everywhere.
// error: the rectified form within resampling of the direct one;
// error: test stylize/epipolar_dilate/equation::the_rectified_form_is_the_direct_one_within_resampling.
// parameter far_depth: depth of an empty texel: 1 forward, 0 reversed.
// parameter stored: depth of the shadow map, 0..1; not finite counts as empty.
// parameter depth: facing depth, or EMPTY.
// parameter distance: of the epipole in steps, times the absolute weight.
// parameter steps: texels along the longer axis.
// parameter at: position in the map, texels.
// parameter size: columns and rows of the map.
// parameter number: of the line.
// parameter side: 0 greatest x, 1 least x, 2 greatest y, 3 least y.
// parameter across: texels along the side.
// parameter along: steps from the beginning of the line.
// parameter original, result: facing depths.

#import airlight::core::finite::finite_or

/// The eye in a shadow map: a homogeneous point in texels and depth. 16 bytes.
struct Epipole {
    /// Position in the map, texels, times the weight; the first texel's centre is at (0.5, 0.5).
    position: vec2<f32>,
    /// Depth in the map's own convention, times the weight.
    depth: f32,
    /// 1 for an eye that the map can see, 0 for one at infinity (position and depth are then a direction), below 0 for one
    /// behind the light.
    weight: f32,
}

/// A step of morphology along epipolar lines. 32 bytes.
struct EpipolarKernel {
    /// Texels of the kernel besides the own one.
    reach: u32,
    /// 0 for the texels towards the epipole, 1 for the reflected kernel away from it.
    away: u32,
    /// 1 for minima, -1 for maxima.
    sign: f32,
    /// Depth of an empty texel: 1 forward, 0 reversed.
    far_depth: f32,
    /// 1 where the source is a shadow map, 0 where it is an intermediate map of facing depths.
    first: u32,
    /// 1 where the result is a shadow map again.
    finish: u32,
    /// With `finish`: 1 keeps the nearer of result and original to the light, -1 the farther.
    keep: f32,
    reserved: u32,
}

/// The line from a texel towards the epipole.
struct EpipolarLine {
    /// One step towards the epipole, texels: 1 along the longer axis.
    step: vec2<f32>,
    /// Distance of the epipole along that axis in texels, times the absolute weight.
    distance: f32,
}

/// A line of the map from one of its sides on: towards the eye, or for one behind the light away from it, which is towards the
/// place of the epipole in both cases.
struct EpipolarRow {
    /// Side at which it begins: 0 greatest x, 1 least x, 2 greatest y, 3 least y.
    side: u32,
    /// Texel of that side.
    index: u32,
    /// Where it begins: the centre of that texel, or the middle of its edge where the line is longer along the side.
    begin: vec2<f32>,
    /// One step, texels: 1 along the longer axis.
    step: vec2<f32>,
    /// Distance of the epipole at the beginning, as in EpipolarLine.
    distance: f32,
    /// Steps inside the map, the first texel counted.
    length: u32,
}

/// Facing depth of a texel without a blocker.
const EMPTY: f32 = 1e30;
/// Samples nearer to the epipole, in texels, cannot be told from it.
const LEAST_DISTANCE: f32 = 1e-3;

/// 1 where stored depth grows away from the light, else -1.
fn depth_facing(far_depth: f32) -> f32 {
    return select(-1.0, 1.0, far_depth > 0.5);
}

/// Facing depth of the far plane: facing depth grows away from the light, over an interval of length 1.
fn facing_far(far_depth: f32) -> f32 {
    return select(0.0, 1.0, far_depth > 0.5);
}

/// Facing depth of what a shadow map stores, EMPTY where that is no blocker.
fn blocker_from_stored(stored: f32, far_depth: f32) -> f32 {
    let depth = depth_facing(far_depth) * finite_or(stored, far_depth);
    let far = facing_far(far_depth);
    return select(max(depth, far - 1.0), EMPTY, depth >= far);
}

/// What a shadow map stores of a facing depth: beyond the far plane nothing, before the near plane the near plane.
fn stored_from_blocker(depth: f32, far_depth: f32) -> f32 {
    let far = facing_far(far_depth);
    return select(depth_facing(far_depth) * max(depth, far - 1.0), far_depth, depth >= far);
}

/// The line through `at`, in texels.
fn line_towards(epipole: Epipole, at: vec2<f32>) -> EpipolarLine {
    let towards = epipole.position - at * epipole.weight;
    let distance = max(abs(towards.x), abs(towards.y));
    return EpipolarLine(towards / max(distance, 1e-30), distance);
}

/// The least `distance` at which a sample is still told from the epipole.
fn least_distance(epipole: Epipole) -> f32 {
    return max(LEAST_DISTANCE * abs(epipole.weight), 1e-20);
}

/// `distance` after a number of steps towards the epipole.
fn distance_after(epipole: Epipole, distance: f32, steps: f32) -> f32 {
    return distance - epipole.weight * steps;
}

/// Facing depth of a blocker, carried along its view ray by a number of steps away from the epipole, negative towards it.
/// `distance`: of the blocker. EMPTY stays EMPTY.
fn carried_depth(epipole: Epipole, far_depth: f32, depth: f32, distance: f32, steps: f32) -> f32 {
    let above = depth * epipole.weight - depth_facing(far_depth) * epipole.depth;
    let carried = depth + above * (steps / max(distance, least_distance(epipole)));
    return select(clamp(carried, -1e29, 1e29), EMPTY, depth >= EMPTY);
}

/// 1 where rows run towards the eye, -1 where they run away from it.
fn row_sense(epipole: Epipole) -> f32 {
    return select(1.0, -1.0, epipole.weight < 0.0);
}

/// The line that begins at a texel of a side. `number`: side times the longer side of the map, plus the texel.
fn epipolar_row(epipole: Epipole, size: vec2<u32>, number: u32) -> EpipolarRow {
    let longer = max(size.x, size.y);
    let side = number / longer;
    let index = number % longer;
    let extent = vec2<f32>(size);
    let across = f32(index) + 0.5;
    // Steps fall onto the centres of texels along the longer axis of the line.
    let last = (side & 1u) == 0u;
    let centre = side_point(side, across, select(vec2<f32>(0.5), extent - 0.5, last));
    let slope = abs(line_towards(epipole, centre).step);
    let crossing = select(slope.x >= slope.y, slope.y >= slope.x, side >= 2u);
    let edge = side_point(side, across, select(vec2<f32>(0.0), extent, last));
    let begin = select(edge, centre, crossing);
    let line = line_towards(epipole, begin);
    let step = row_sense(epipole) * line.step;
    // Steps before the line leaves the map, and before it comes to the epipole.
    let room = select(begin, extent - begin, step > vec2<f32>(0.0)) / max(abs(step), vec2<f32>(1e-6));
    let least = least_distance(epipole);
    let free = (line.distance - least) / max(abs(epipole.weight), 1e-12);
    let steps = min(min(room.x, room.y), free);
    let exists = index < select(size.y, size.x, side >= 2u) && line.distance > least;
    let length = select(0u, u32(clamp(ceil(steps), 0.0, f32(longer))), exists);
    return EpipolarRow(side, index, begin, step, line.distance, length);
}

/// A point `across` along a side; `at` holds the side's coordinate.
fn side_point(side: u32, across: f32, at: vec2<f32>) -> vec2<f32> {
    return select(vec2<f32>(at.x, across), vec2<f32>(across, at.y), side >= 2u);
}

/// Where the texture of all lines, twice as wide and high as the longer side of the map, holds a step of a line.
fn row_place(size: vec2<u32>, row: EpipolarRow, along: u32) -> vec2<u32> {
    let longer = max(size.x, size.y);
    return vec2<u32>((row.side & 1u) * longer + along, (row.side >> 1u) * longer + row.index);
}

/// Number of the line that passes next to `at`, the centre of a texel: the one that begins where the line through `at` leaves
/// the map, going back against the direction of rows.
fn row_through(epipole: Epipole, size: vec2<u32>, at: vec2<f32>) -> u32 {
    let extent = vec2<f32>(size);
    let back = -row_sense(epipole) * line_towards(epipole, at).step;
    let forward = back > vec2<f32>(0.0);
    // Rows begin half a texel inside along their longer axis.
    let inset = select(vec2<f32>(0.0, 0.5), vec2<f32>(0.5, 0.0), abs(back.x) >= abs(back.y));
    let steps = (select(at, extent - at, forward) - inset) / max(abs(back), vec2<f32>(1e-6));
    let by_x = steps.x <= steps.y;
    let exit = at + min(steps.x, steps.y) * back;
    let along = select(exit.x, exit.y, by_x);
    let count = select(extent.x, extent.y, by_x);
    let side = select(select(3u, 2u, forward.y), select(1u, 0u, forward.x), by_x);
    return side * max(size.x, size.y) + u32(clamp(along, 0.0, count - 1.0));
}

/// How many steps from the beginning of a line the texel with the centre `at` is.
fn steps_along(row: EpipolarRow, at: vec2<f32>) -> u32 {
    let apart = abs(at - row.begin);
    return u32(select(apart.y, apart.x, abs(row.step.x) >= abs(row.step.y)) + 0.5);
}

/// Facing depth of a blocker `along` steps from the beginning of a line, carried there.
fn depth_at_row_end(epipole: Epipole, far_depth: f32, row: EpipolarRow, depth: f32, along: f32) -> f32 {
    let steps = row_sense(epipole) * along;
    return carried_depth(epipole, far_depth, depth, distance_after(epipole, row.distance, steps), steps);
}

/// The reverse of `depth_at_row_end`.
fn depth_in_row(epipole: Epipole, far_depth: f32, row: EpipolarRow, depth: f32, along: f32) -> f32 {
    return carried_depth(epipole, far_depth, depth, row.distance, -row_sense(epipole) * along);
}

/// Result of morphology at a texel whose blocker was at the facing depth `original`.
fn kept_depth(kernel: EpipolarKernel, original: f32, result: f32) -> f32 {
    return select(max(original, result), min(original, result), kernel.keep > 0.0);
}
