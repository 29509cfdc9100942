// SPDX-License-Identifier: MIT OR Apache-2.0
//! The functions of the core modules, evaluated on the GPU and held to their f64 references within a stated error budget, and
//! passes of `core` that sort and find bricks.
//!
//! `--nocapture` prints what was measured.
#![allow(clippy::unwrap_used)]

#[path = "../support/gpu.rs"]
mod gpu;
#[path = "../support/probing.rs"]
mod probing;

mod bricks;
mod camera;
mod cosine;
mod coverage;
mod directions;
mod fourier;
mod jitter;
mod light;
mod noise;
mod scans;
mod sort;
mod textures;
mod values;
