// SPDX-License-Identifier: MIT OR Apache-2.0
//! Transfer functions against f64: diffusion, layers, the place of a ray, what is made of a colour; and picks, key frames and
//! files that move from scene to scene.
//!
//! `--nocapture` prints what was measured.
#![allow(clippy::unwrap_used)]

#[path = "../support/gpu.rs"]
mod gpu;
#[path = "../support/probing.rs"]
mod probing;
#[path = "../support/wild_function.rs"]
mod wild_function;

mod baking;
mod diffusion;
mod key_frames;
mod layers;
mod marched;
mod picks;
mod restyling;
mod synthetic;
