// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::stylize::tf_diffuse
// summary: Colours of a few constraints spread over a square: Laplace's equation by multigrid, in parts.
// source: thesis 6.2.2; orthogonal aggregation: Trottenberg, Oosterlee and Schueller, "Multigrid" (2001), 2.8 and A.4.
// note: Constraints at single points are ill posed in two dimensions: between grids of 33 and 257 texels the result drifts like the
// note: logarithm of the resolution. Constraints are discs of a fixed radius; the border reflects. Premultiplied RGBA is diffused:
// note: between opaque red and transparent blue lies half-transparent red, and with straight alpha it would be purple.
// note: Texel i solves sum_j w_ij (u_j - u_i) = f_i over its neighbours. A cell of the next level is 2 x 2 cells of this one,
// note: free where any of them is; couplings of its edges are half the sums (an edge twice as far away), and those to fixed
// note: cells the whole sums. The correction is 0 in fixed cells. All levels lie in one buffer, one after the other.
// equation: Δu = 0, u given in discs;  relaxed: u ← u + ω ((Σ w_j u_j + f) / Σ w_j − u);  residual: f + Σ w_j u_j − u Σ w_j
// equation: prolonged: (9 own + 3 beside + 3 below + diagonal) / 16
// error: within 1/255 of the converged solution; test stylize/transfer/diffusion::diffusion_is_within_a_step_of_the_converged_solution.
// parameter texel: column and row.
// parameter size: texels a side, from 1 up.
// parameter position: 0..1 in x and y.
// parameter value, source: premultiplied linear RGBA.
// parameter pull: values of the neighbours times couplings.
// parameter stiffness: sum of all couplings, from 0 up.
// parameter relaxation: 1..2.
// parameter own, beside, below, diagonal: corrections of cells of the next level.

/// A colour at a place. 32 bytes.
struct Constraint {
    /// Premultiplied linear RGBA.
    color: vec4<f32>,
    /// Its position, 0..1 in x to the right and y downwards.
    position: vec2<f32>,
    /// The pixel of the picture whose ray gives the position, or negative where that is given.
    pixel: vec2<f32>,
}

/// A level of the multigrid. 32 bytes.
struct DiffusionLevel {
    /// Cells a side, at least 1.
    size: u32,
    /// Index of its first cell.
    first: u32,
    /// Cells a side of the next, coarser one: half of `size`, rounded up.
    coarse_size: u32,
    /// Index of the next one's first cell.
    coarse_first: u32,
    /// Which cells are smoothed: those whose x + y is even (0) or odd (1).
    parity: u32,
    /// Number of constraints, at least 1.
    count: u32,
    /// Radius of a constraint's disc, in units of the square's side.
    radius: f32,
    reserved: f32,
}

/// Position 0..1 of the centre of a texel of a square of `size` texels a side.
fn texel_centre(texel: vec2<u32>, size: u32) -> vec2<f32> {
    return (vec2<f32>(texel) + 0.5) / f32(size);
}

/// The texel of a square of `size` texels a side that holds `position`.
fn texel_at(position: vec2<f32>, size: u32) -> vec2<u32> {
    return vec2<u32>(clamp(position * f32(size), vec2<f32>(0.0), vec2<f32>(f32(size - 1u))));
}

/// A cell's value that solves its own equation, taken further by the factor `relaxation`, 1..2 (1: Gauss-Seidel). `pull`: values
/// of the neighbours times couplings; `stiffness`: the sum of all couplings.
fn relaxed(value: vec4<f32>, pull: vec4<f32>, stiffness: f32, source: vec4<f32>, relaxation: f32) -> vec4<f32> {
    let solved = (pull + source) / max(stiffness, 1e-20);
    return select(value, mix(value, solved, relaxation), stiffness > 0.0);
}

/// What is left of a cell's equation.
fn residual(value: vec4<f32>, pull: vec4<f32>, stiffness: f32, source: vec4<f32>) -> vec4<f32> {
    return source + pull - stiffness * value;
}

/// The correction of a cell by bilinear interpolation of four cells of the next level: its own, the nearest beside it in x and
/// in y, and the one diagonally.
fn prolonged(own: vec4<f32>, beside: vec4<f32>, below: vec4<f32>, diagonal: vec4<f32>) -> vec4<f32> {
    return (9.0 * own + 3.0 * beside + 3.0 * below + diagonal) / 16.0;
}
