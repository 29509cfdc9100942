// SPDX-License-Identifier: MIT OR Apache-2.0
//! The air.

use super::SettingsError;
use encase::ShaderType;
use glam::Vec3;

/// The uniform `Medium` of `scattering/single_scatter`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct Medium {
    /// Single-scattering albedo, 0..1.
    pub albedo: Vec3,
    /// Extinction, 1/m.
    pub extinction: f32,
    /// Mean cosine of the phase function.
    pub g: f32,
    /// Rays end here, metres.
    pub distance_limit: f32,
    /// Padding.
    pub reserved_a: f32,
    /// Padding.
    pub reserved_b: f32,
}

impl Medium {
    /// A checked medium.
    ///
    /// # Errors
    /// [`SettingsError::Medium`] for a value out of range or not finite.
    pub fn new(extinction: f32, albedo: Vec3, g: f32, distance_limit: f32) -> Result<Self, SettingsError> {
        let check = |name, value: f32, fits: bool, range| {
            if fits { Ok(()) } else { Err(SettingsError::Medium { name, value, range }) }
        };
        check("extinction", extinction, (0.0..=1e6).contains(&extinction), "from 0 to 1e6 per metre")?;
        for value in albedo.to_array() {
            check("albedo", value, (0.0..=1.0).contains(&value), "from 0 to 1")?;
        }
        check("g", g, (-0.999..=0.999).contains(&g), "from -0.999 to 0.999")?;
        let fits = distance_limit > 0.0 && distance_limit <= 1e7;
        check("distance limit", distance_limit, fits, "positive and at most 1e7 metres")?;
        Ok(Self { albedo, extinction, g, distance_limit, reserved_a: 0.0, reserved_b: 0.0 })
    }
}
