// SPDX-License-Identifier: MIT OR Apache-2.0
//! Six moments of a rectified map on the GPU: bounds and reads against the f64 reference, the filter against prefix
//! means, and the error that six moments leave on scenes.
//!
//! `--nocapture` prints what was measured.
#![allow(clippy::unwrap_used)]

#[path = "../support/gpu.rs"]
mod gpu;
#[path = "../support/probing.rs"]
mod probing;

mod bounds;
mod filter;
mod pictures;
