// SPDX-License-Identifier: MIT OR Apache-2.0
//! Light that sheets scatter on and back: shares of cones, kernels, energy, the exact sum of all bounces, and that more scattering
//! is more light at every point.
//!
//! `--nocapture` prints what was measured.
#![allow(clippy::unwrap_used)]

#[path = "../support/gpu.rs"]
mod gpu;
#[path = "../support/light_stack.rs"]
mod light_stack;
#[path = "../support/probing.rs"]
mod probing;
#[path = "../support/sheets.rs"]
mod sheets;

mod kernels;
mod light;
mod pictures;
