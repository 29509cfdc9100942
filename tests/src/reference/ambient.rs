// SPDX-License-Identifier: MIT OR Apache-2.0
//! Bent normals, bent cones and what is lit by them, traced: Klehm's thesis, chapter 3, with the corrections of
//! EQUATIONS.md, 11.
//!
//! Visibility comes from rays against the triangles themselves in f64, light from the map itself. Nothing is looked up in a
//! depth buffer or in a preconvolved map, so that nothing is shared with a method in screen space.

mod directions;
mod environment;
mod picture;
mod scene;
mod shade;
mod visibility;

pub use directions::Pattern;
pub use environment::{Environment, Normalisation, Rgb};
pub use picture::{Pixel, Settings, Surface, picture, surfaces};
pub use scene::{Hit, Scene, Triangle};
pub use shade::{Approximations, Brightness, approximations, outgoing};
pub use visibility::{Angle, Reach, Sample, Statistics, exact_angle, samples, thesis_angle, trace};

#[cfg(test)]
mod tests;
