// SPDX-License-Identifier: MIT OR Apache-2.0
//! Transmittance along one light ray: exactly, and by each of the series and moments that a map may hold; and pictures of
//! media that it lights.
//!
//! Extinction is even in each of a list of stretches. Coefficients are numerical integrals, transmittance is marched, and series are
//! integrated numerically, so that nothing of the closed forms of the shaders is used.

mod moments;
mod picture;
mod profile;
mod series;

pub use moments::{power_transmittance, trigonometric_transmittance};
pub use picture::{Ball, Grid, View};
pub use profile::{Profile, Stretch};
pub use series::{Basis, Series};
