// SPDX-License-Identifier: MIT OR Apache-2.0
//! Single scattering on the GPU against the f64 references, closed forms and invariants.
//!
//! `--nocapture` prints what was measured.
#![allow(clippy::unwrap_used)]

#[path = "../support/gpu.rs"]
mod gpu;

mod any_input;
mod cases;
mod closed_forms;
mod figures;
mod frame;
mod invariants;
mod march;
mod methods;
mod rectified_map;
mod synthetic;
