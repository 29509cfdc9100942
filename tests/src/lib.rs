// SPDX-License-Identifier: MIT OR Apache-2.0
//! Independent references for Airlight: brute force in f64, written from the papers' equations and
//! from `docs/src/rectification.md`, sharing nothing with the shaders; error measures and
//! statistics. Plain `std`, and one crate that finds the triangles along a ray: this library knows
//! neither the host nor the validator.
//!
//! World space is right-handed, y up, in metres; angles are in radians; extinction is in 1/m.

pub mod baselines;
#[cfg(doctest)]
mod book;
pub mod error;
pub mod linear;
pub mod media;
pub mod parallel;
pub mod reference;
pub mod statistics;
