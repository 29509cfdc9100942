// SPDX-License-Identifier: MIT OR Apache-2.0
//! Volumes and lights from pictures: the matrix W of single scattering row by row, its least squares by elimination, and
//! the light that scatters, after Klehm's thesis, chapter 7, with the corrections of EQUATIONS.md, 10.
//!
//! Every entry of W is written down and every solution is that of a dense system, so that nothing is shared with a method
//! that projects back and iterates. One channel at a time.

mod bounded;
mod grid;
mod least_squares;
mod light;
mod matrix;
mod ray;
mod steps;
mod targets;
mod unknown;

pub use bounded::{bounded, kkt_violation};
pub use grid::{Basis, Grid};
pub use least_squares::{Dense, Normal, Problem, Regulariser, laplacian};
pub use light::{
    DirectionalLight, LocalLight, light_columns, local_grid, scattered, scattered_grid, transmittance_to,
    transmittance_within,
};
pub use matrix::{Matrix, Medium, Part, Property, Weights};
pub use ray::{Ray, View, VolumeBox};
pub use steps::{Sample, Slices, bent, straight};
pub use targets::{ExtinctionTargets, Row};
pub use unknown::touched;

#[cfg(test)]
mod tests;
