// SPDX-License-Identifier: MIT OR Apache-2.0
//! Single scattering on the GPU against the f64 references, closed forms and invariants.
//!
//! `--nocapture` prints what was measured.
#![allow(clippy::unwrap_used)]

#[path = "../support/given_weights.rs"]
mod given_weights;
#[path = "../support/gpu.rs"]
mod gpu;
#[path = "../support/lit_case.rs"]
mod lit_case;
#[path = "../support/probing.rs"]
mod probing;
#[path = "../support/rank_rows.rs"]
mod rank_rows;

mod any_input;
mod cases;
mod closed_forms;
mod figures;
mod frame;
mod functions;
mod invariants;
mod local_lights;
mod local_lights_directional;
mod local_lights_inputs;
mod march;
mod methods;
mod moments;
mod projective;
mod rank;
mod rectified_map;
mod resolution;
mod synthetic;
mod views;
mod wavelet;
