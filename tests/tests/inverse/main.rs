// SPDX-License-Identifier: MIT OR Apache-2.0
//! Volumes and lights found from pictures: projectors, their transposes and solvers on the GPU against f64.
//!
//! `--nocapture` prints what was measured.
#![allow(clippy::unwrap_used)]

#[path = "../support/gpu.rs"]
mod gpu;
#[path = "../support/projectors.rs"]
mod projectors;

mod bent;
mod light;
mod light_solver;
mod preparation;
mod projection;
mod scatter;
mod solver;
