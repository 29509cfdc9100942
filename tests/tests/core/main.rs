// SPDX-License-Identifier: MIT OR Apache-2.0
//! The functions of the core modules, evaluated on the GPU and held to their f64 references within a
//! stated error budget: which test holds which; values and colours, jitter; and scans of any length.
//! `core_camera.rs`, `core_light.rs` and `core_fourier.rs` hold the others.
//!
//! `--nocapture` prints the measured errors next to the budgets.
#![allow(clippy::unwrap_used)]

#[path = "../support/gpu.rs"]
mod gpu;
#[path = "../support/probing.rs"]
mod probing;

mod coverage;
mod directions;
mod jitter;
mod scans;
mod textures;
mod values;
