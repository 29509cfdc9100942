// SPDX-License-Identifier: MIT OR Apache-2.0
//! Iso-surfaces of classified volumes: where view rays cross them, by dense sampling and bisection; gradients; motion in the
//! picture; how they bend. Strokes on them.

mod curvature;
mod iso_surface;
pub mod strokes;

pub use curvature::{Form, cubic_spline, eigen, in_other_coordinates, principal_curvatures, spline_jet};
pub use iso_surface::{Crossing, Solid, classify, marschner_lobb_gradient, motion, trilinear};
