// SPDX-License-Identifier: MIT OR Apache-2.0
//! Bent normals and cones in screen space on the GPU: closed forms, f64 references and light.
//!
//! `--nocapture` prints what was measured.
#![allow(clippy::unwrap_used)]

#[path = "../support/competitors.rs"]
mod competitors;
#[path = "../support/cones.rs"]
mod cones;
#[path = "../support/gpu.rs"]
mod gpu;
#[path = "../support/probing.rs"]
mod probing;
#[path = "../support/seen.rs"]
mod seen;
#[path = "../support/standing.rs"]
mod standing;

mod closed_forms;
mod directional;
mod forms;
mod functions;
mod light;
mod occluders;
mod passes;
mod places;
mod shade;
mod shading;
