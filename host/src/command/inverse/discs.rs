// SPDX-License-Identifier: MIT OR Apache-2.0
//! Light from all around that is solved for: discs at infinity, each of one radiance.

use super::light::Illumination;
use super::options::DiscFlags;
use crate::Lighting;
use crate::data::{DiscLights, Environment, EnvironmentError, disc_lights};
use glam::Vec3;
use serde_json::{Value, json};

/// Discs where no number is asked for.
const DISCS: u32 = 64;
/// Directional lights that all discs together have, as far as each has at least one and at most eight.
const LIGHTS: u32 = 128;
/// Width and height of the map of them.
const MAP: [u32; 2] = [256, 128];

/// Discs of light, and how bright they are.
#[derive(Clone, Debug, PartialEq)]
pub struct LitDiscs {
    /// Where they are.
    pub discs: DiscLights,
    /// Linear RGB radiance of each.
    pub radiance: Vec<Vec3>,
}

impl LitDiscs {
    /// What is nearest to a light: its directional lights spread over the discs that shine from there; spots and point lights are
    /// left out.
    pub fn near(flags: &DiscFlags, light: &Illumination) -> Self {
        let discs = disc_lights(flags.lights.unwrap_or(DISCS), flags.upper);
        let count = discs.directions().len();
        let mut radiance = vec![Vec3::ZERO; count];
        match light {
            Illumination::Ambient(even) => radiance.fill(*even),
            Illumination::Discs(own) if own.discs == discs => radiance.clone_from(&own.radiance),
            Illumination::Discs(own) => spread(&discs, &own.lights(), &mut radiance),
            Illumination::Lights(lights) => spread(&discs, lights, &mut radiance),
        }
        Self { discs, radiance }
    }

    /// Directional lights of each disc, for a radiance of 1.
    pub fn groups(&self) -> Vec<Vec<Lighting>> {
        let count = self.discs.directions().len();
        let each = (LIGHTS / (count as u32).max(1)).clamp(1, 8);
        let lights = |disc| self.discs.lights(disc, each).into_iter().map(Lighting::from).collect();
        (0..count).map(lights).collect()
    }

    /// Directional lights of all discs that are not black.
    pub fn lights(&self) -> Vec<Lighting> {
        let bright = self.groups().into_iter().zip(&self.radiance);
        let bright = bright.filter(|(_, own)| own.max_element() > 0.0);
        bright.flat_map(|(lights, own)| lights.into_iter().map(|light| times(light, *own))).collect()
    }

    /// The map of them.
    ///
    /// # Errors
    /// [`EnvironmentError`].
    pub fn environment(&self) -> Result<Environment, EnvironmentError> {
        self.discs.environment_of(&self.radiance, MAP)
    }

    /// For `report.json`.
    pub fn json(&self) -> Value {
        let discs = self.discs.directions().iter().zip(&self.radiance);
        let discs =
            discs.map(|(towards, own)| json!({ "towards": towards.to_array(), "radiance": own.to_array() }));
        json!({ "radius_degrees": self.discs.radius().to_degrees(), "discs": discs.collect::<Vec<_>>() })
    }
}

fn times(light: Lighting, factor: Vec3) -> Lighting {
    let mut light = light;
    match &mut light {
        Lighting::Directional { radiance: colour, .. }
        | Lighting::Spot { intensity: colour, .. }
        | Lighting::Point { intensity: colour, .. } => *colour *= factor,
    }
    light
}

/// Adds lights to discs so that all together have their irradiance.
fn spread(discs: &DiscLights, lights: &[Lighting], radiance: &mut [Vec3]) {
    for light in lights {
        let Lighting::Directional { towards, radiance: irradiance } = light else { continue };
        let towards = towards.normalize_or_zero();
        let shares: Vec<f32> = (0..radiance.len()).map(|disc| discs.basis(disc, towards)).collect();
        let sum: f32 = shares.iter().sum();
        if sum > 0.0 {
            for (own, share) in radiance.iter_mut().zip(shares) {
                *own += *irradiance * (share / (sum * discs.solid_angle()));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn discs_have_the_irradiance_of_what_they_stand_for() {
        let flags = DiscFlags { lights: Some(32), upper: false, light_strategy: None };
        let sum = |lights: &[Lighting]| -> Vec3 {
            let own = |light: &Lighting| match light {
                Lighting::Directional { radiance, .. } => *radiance,
                _ => Vec3::NAN,
            };
            lights.iter().map(own).sum()
        };
        let lights =
            [Vec3::X, Vec3::new(0.2, 3.0, -0.4)].map(|towards| Lighting::directional(towards, towards.abs()));
        let near = LitDiscs::near(&flags, &Illumination::Lights(lights.to_vec()));
        assert!((sum(&near.lights()) - sum(&lights)).abs().max_element() < 1e-4, "{near:?}");
        assert!(near.lights().len() < 4 * 32, "some are black");
        assert_eq!(LitDiscs::near(&flags, &Illumination::Discs(near.clone())), near);
        let even = LitDiscs::near(&flags, &Illumination::Ambient(Vec3::new(1.0, 2.0, 3.0)));
        let all = 4.0 * std::f32::consts::PI * Vec3::new(1.0, 2.0, 3.0);
        assert!((sum(&even.lights()) / all - 1.0).abs().max_element() < 0.01, "{}", sum(&even.lights()));
        // Below the horizon there is none.
        let upper = DiscFlags { upper: true, ..flags };
        let below = Illumination::Lights(vec![Lighting::directional(Vec3::NEG_Y, Vec3::ONE)]);
        assert!(LitDiscs::near(&upper, &below).lights().is_empty());
    }
}
