// SPDX-License-Identifier: MIT OR Apache-2.0
//! Extinction transmittance maps on the GPU against f64 references, closed forms and invariants.
//!
//! `--nocapture` prints what was measured.
#![allow(clippy::unwrap_used)]

#[path = "../support/gpu.rs"]
mod gpu;
#[path = "../support/media.rs"]
mod media;
#[path = "../support/probing.rs"]
mod probing;
#[path = "../support/rays.rs"]
mod rays;

mod bricks;
mod forms;
mod particle_pictures;
mod particles;
mod pictures;
mod volumes;
