// SPDX-License-Identifier: MIT OR Apache-2.0
//! Fewer pixels, shifted samples, multisampled depth: each against f64.
//!
//! `--nocapture` prints what was measured.
#![allow(clippy::unwrap_used)]

#[path = "../support/gpu.rs"]
mod gpu;
#[path = "../support/probing.rs"]
mod probing;

mod cameras;
mod case;
mod jitter;
mod multisampled;
mod reduced;
mod upsampling;
