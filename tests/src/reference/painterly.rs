// SPDX-License-Identifier: MIT OR Apache-2.0
//! Iso-surfaces of classified volumes: where view rays cross them, by dense sampling and bisection; gradients; motion in the
//! picture. Strokes on them.

mod iso_surface;
pub mod strokes;

pub use iso_surface::{Crossing, Solid, classify, marschner_lobb_gradient, motion, trilinear};
