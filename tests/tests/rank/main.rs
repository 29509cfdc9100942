// SPDX-License-Identifier: MIT OR Apache-2.0
//! The rank structure on the GPU: counts against brute force over the stepped map, weighted means against their proven
//! bound, pictures against the exact ones, and settings that are refused.
//!
//! `--nocapture` prints what was measured.
#![allow(clippy::unwrap_used)]

#[path = "../support/gpu.rs"]
mod gpu;
#[path = "../support/probing.rs"]
mod probing;
#[path = "../support/rank.rs"]
mod rank;

mod counts;
mod pictures;
mod weighted;
