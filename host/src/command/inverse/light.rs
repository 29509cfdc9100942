// SPDX-License-Identifier: MIT OR Apache-2.0
//! What light the medium has to scatter.

use super::field::{Field, reduced};
use crate::inverse::{Channels, InverseError, LightPasses};
use crate::{Gpu, Lighting, Texture};
use glam::{Mat4, Vec3};

/// Where light comes from.
pub enum Illumination {
    /// The same from all around, of which the medium takes nothing away: linear RGB radiance.
    Ambient(Vec3),
    /// Lights, whose way goes through the medium.
    Lights(Vec<Lighting>),
}

impl Illumination {
    /// The radiance that an albedo of 1 scatters towards the eye, in the box of a volume; the phase function is isotropic. `extinction`: 1/m.
    ///
    /// # Errors
    /// [`InverseError`].
    pub fn scattered(
        &self,
        gpu: &Gpu,
        (passes, channels): (&LightPasses, Channels),
        (extinction, place): (&Texture, Mat4),
    ) -> Result<Texture, InverseError> {
        match self {
            Self::Ambient(radiance) => {
                Ok(Field::constant(reduced(*radiance, channels)).texture(gpu, channels)?)
            }
            Self::Lights(lights) => {
                let lights: Vec<Lighting> =
                    lights.iter().map(|light| as_channels(*light, channels)).collect();
                passes.scattered(gpu, extinction, place, extinction.size(), &lights, None)
            }
        }
    }
}

/// A light whose colour is what the channels have of it.
fn as_channels(light: Lighting, channels: Channels) -> Lighting {
    let mut light = light;
    match &mut light {
        Lighting::Directional { radiance: colour, .. }
        | Lighting::Spot { intensity: colour, .. }
        | Lighting::Point { intensity: colour, .. } => *colour = reduced(*colour, channels),
    }
    light
}
