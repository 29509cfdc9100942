// SPDX-License-Identifier: MIT OR Apache-2.0
//! Iso-surfaces, their curvature and the strokes on them, on the GPU against f64.
//!
//! `--nocapture` prints what was measured.
#![allow(clippy::unwrap_used)]

#[path = "../support/bending.rs"]
mod bending;
#[path = "../support/gpu.rs"]
mod gpu;
#[path = "../support/painted.rs"]
mod painted;
#[path = "../support/probing.rs"]
mod probing;
#[path = "../support/surfaces.rs"]
mod surfaces;
#[path = "../support/turning.rs"]
mod turning;

mod advect;
mod curvature;
mod curvature_functions;
mod edges;
mod iso_raycast;
mod picture;
mod skipping;
mod stroke_density;
mod stroke_functions;
mod stroke_life;
mod stroke_placement;
mod stroke_population;
mod strokes;
mod styles;
