// SPDX-License-Identifier: MIT OR Apache-2.0
//! Sheets of splats and polygons, their light, soft shadows and scattering, on the GPU against f64.
//!
//! `--nocapture` prints what was measured.
#![allow(clippy::unwrap_used)]

#[path = "../support/gpu.rs"]
mod gpu;
#[path = "../support/light_stack.rs"]
mod light_stack;
#[path = "../support/probing.rs"]
mod probing;
#[path = "../support/sheet_scene.rs"]
mod sheet_scene;
#[path = "../support/sheets.rs"]
mod sheets;
#[path = "../support/soft_light.rs"]
mod soft_light;

mod functions;
mod pictures;
mod polygons;
mod reference;
mod scattering;
mod slabs;
mod soft;
mod surfaces;
mod turning;
