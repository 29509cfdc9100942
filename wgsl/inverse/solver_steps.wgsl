// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::inverse::solver_steps
// summary: Steps of conjugate gradients between bounds, for least squares whose matrix is a rendering.
// source: thesis 7.4.1 and 7.4.2; the direction of Polak and Ribiere (1969); Shewchuk (1994).
// note: What is minimised is sum C (W a - o)^2 + l |L a|^2 + s |a|^2 + t |a - 1|^2: its half gradient is W'C(W a - o) + l L'L a + s a + t (a - 1),
// note: and it is subtracted; the thesis says "adding". Clamping breaks the recursion of the residual, which then stalls, so the gradient
// note: is computed anew in every iteration; a voxel at a bound to which the gradient pushes it is left out. Of Polak and Ribiere's factor only
// note: what is positive is taken: the direction starts afresh by itself where the set of those voxels changes much. Starting afresh at
// note: every change is slower where thousands of voxels come and go.
// note: Voxels that many rays meet go slower: one over the row sums of W'C W and the diagonals of the regularisers precondition the system.
// note: Each channel is a system of its own with its own lengths of steps.
// equation: minimise Σ C (W a − o)² + l |L a|² + s |a|² + t |a − 1|², low ≤ a ≤ high
// equation: r = −½ gradient, 0 at a bound it pushes against;  β = max(0, (<r, M r> − <r, M r₋>) / <r₋, M r₋>);  d = M r + β d₋
// equation: step = <r, d> / <d, A d>;  M: pace 1 / (row sum of W'C W + 42 l + s + t)
// error: solutions reach the least squares between bounds within 1e-9 of a descent;
// error: test inverse/solver::iterations_come_to_the_least_squares_between_bounds.
// parameter value: of a voxel, between the bounds.
// parameter gradient: half gradient of the misfit there.
// parameter sent: from 0 up.
// parameter descent, curvature: sums over all voxels.
// parameter before, product: sums over all voxels.

/// One volume that is solved for. 48 bytes.
struct SolverPart {
    /// Voxels along x, y and z.
    size: vec3<u32>,
    /// Where its sums begin, groups.
    first_group: u32,
    /// Weight of the squared Laplacian.
    laplacian: f32,
    /// Weight of the squared value.
    smallness: f32,
    /// Weight of the squared difference from 1.
    oneness: f32,
    /// Least value.
    low: f32,
    /// Greatest value.
    high: f32,
    /// Groups of all volumes that are solved for.
    groups: u32,
    /// Least of what a pace is one over.
    steepest: f32,
    reserved_a: u32,
}

/// Sums of groups, and where those of pictures begin. 16 bytes.
struct SolverSums {
    /// Groups of all volumes that are solved for: their sums come first, twice.
    groups: u32,
    /// First sum of a picture.
    first_picture: u32,
    /// Sums of pictures.
    pictures: u32,
    /// From 0.
    iteration: u32,
}

/// How far the solver goes, by channel. 48 bytes.
struct SolverScalars {
    /// What is kept of the direction before.
    kept: vec4<f32>,
    /// Length of the step along the direction.
    step: vec4<f32>,
    /// Square of the way downhill, times the pace.
    square: vec4<f32>,
}

/// How far a voxel goes for a slope: one over a bound of its share in the matrix. `sent`: what the weighed pictures of ones send back to it, the
/// row of W'C W summed up, which no eigenvalue of that matrix scaled by it exceeds.
fn pace_of(part: SolverPart, sent: f32) -> f32 {
    // 42 is on the diagonal of L'L where all six neighbours are solved for.
    return 1.0 / max(sent + 42.0 * part.laplacian + part.smallness + part.oneness, max(part.steepest, 1e-30));
}

/// What is left of a half gradient as the way downhill, at a value between its bounds.
fn downhill(part: SolverPart, value: f32, gradient: f32) -> f32 {
    let held = (value <= part.low && gradient > 0.0) || (value >= part.high && gradient < 0.0);
    return select(-gradient, 0.0, held);
}

/// Share of the direction before that the next one keeps. `square`: of the way downhill, times the pace; `product`: of it and the one before,
/// likewise; `before`: square of that one; `first`: whether there is none before.
fn kept_direction(square: f32, product: f32, before: f32, first: bool) -> f32 {
    let kept = max(square - product, 0.0) / max(before, 1e-30);
    // More than this says that the one before was no descent at all.
    return select(min(kept, 1e4), 0.0, first || before <= 0.0);
}

/// Length of a step along a direction. `descent`: product of the way downhill and the direction; `curvature`: of the direction, squared by the matrix.
fn step_length(descent: f32, curvature: f32) -> f32 {
    return select(0.0, descent / max(curvature, 1e-30), curvature > 0.0 && descent > 0.0);
}
