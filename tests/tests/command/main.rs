// SPDX-License-Identifier: MIT OR Apache-2.0
//! The command `airlight`: what it writes, and what it says to wrong use.
//!
//! `--nocapture` prints what was measured.
#![allow(clippy::unwrap_used)]

#[path = "../support/command.rs"]
mod command;
#[path = "../support/hall.rs"]
mod hall;
#[path = "../support/hall_runs.rs"]
mod hall_runs;
#[path = "../support/lumps.rs"]
mod lumps;
#[path = "../support/npy.rs"]
mod npy;
#[path = "../support/own_passes.rs"]
mod own_passes;
#[path = "../support/painted_views.rs"]
mod painted_views;
#[path = "../support/painting.rs"]
mod painting;
#[path = "../support/stylized.rs"]
mod stylized;

mod ambient;
mod inverse;
mod inverse_frames;
mod inverse_light;
mod inverse_refusals;
mod painterly;
mod painterly_refusals;
mod painterly_volumes;
mod run;
mod run_refusals;
mod scattering;
mod scattering_flags;
mod scattering_refusals;
mod shared;
mod splatting;
mod splatting_refusals;
mod stylize;
mod stylize_frames;
mod stylize_refusals;
mod transmittance;
mod transmittance_refusals;
