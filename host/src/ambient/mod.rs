// SPDX-License-Identifier: MIT OR Apache-2.0
//! Bent normals and cones in screen space: Klehm's thesis, chapter 3.

mod light;

pub use light::{CONE_LAYERS, ConeLight, ConeLightBound, ConeLightError, ConeLightForm};
