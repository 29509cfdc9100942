// SPDX-License-Identifier: MIT OR Apache-2.0
//! Stylized light: shadow maps and the light in the air that follows them, on the GPU against f64.
//!
//! `--nocapture` prints what was measured.
#![allow(clippy::unwrap_used)]

#[path = "../support/gpu.rs"]
mod gpu;
#[path = "../support/holes.rs"]
mod holes;
#[path = "../support/probing.rs"]
mod probing;
#[path = "../support/shadow_maps.rs"]
mod shadow_maps;
#[path = "../support/wild_function.rs"]
mod wild_function;

mod epipolar_dilate;
mod morphology;
mod perlin_holes;
mod shadow_maps_and_light;
mod stylized_shadows;
mod transfer;
