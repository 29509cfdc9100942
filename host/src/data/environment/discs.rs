// SPDX-License-Identifier: MIT OR Apache-2.0
//! Disc lights: basis functions of an environment, for light that is solved for (Klehm, "User-Guided Scene Stylization using
//! Efficient Rendering Techniques", 2015, sections 7.4.3 and 7.5). The fall-off is ours.

use super::{Environment, EnvironmentError, EnvironmentLight};
use glam::Vec3;
use std::f32::consts::{PI, TAU};

/// Radius of a disc over the distance of neighbours, were they hexagons: as narrow as a sum within 8 % of even allows.
const OVERLAP: f32 = 1.75;

/// Discs of light at infinity, all alike, spread evenly over the sphere or over its upper half. Their basis functions add up to
/// about 1: within 8 % from 16 discs on, of the upper half where the elevation is a radius or more. Below that they fall off, and discs at the horizon
/// reach beneath it.
#[derive(Debug, Clone, PartialEq)]
pub struct DiscLights {
    directions: Vec<Vec3>,
    cosine: f32,
    height: f32,
}

/// `count` discs, at least 1, on a spiral of golden angles (Fibonacci lattice): constant in solid angle, smooth from their middles to their rims.
pub fn disc_lights(count: u32, upper_hemisphere: bool) -> DiscLights {
    let count = count.max(1);
    let lowest = if upper_hemisphere { 0.0 } else { -1.0 };
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let directions = (0..count).map(|disc| {
        let y = 1.0 - (1.0 - lowest) * (f64::from(disc) + 0.5) / f64::from(count);
        let (sine, cosine) = (golden * f64::from(disc)).sin_cos();
        let across = (1.0 - y * y).max(0.0).sqrt();
        glam::DVec3::new(across * sine, y, across * cosine).as_vec3()
    });
    let covered = TAU * (1.0 - lowest as f32);
    let share = covered / count as f32;
    let radius = (OVERLAP * (share * 2.0 / 3.0_f32.sqrt()).sqrt()).min(PI);
    let cosine = radius.cos();
    DiscLights { directions: directions.collect(), cosine, height: share / (PI * (1.0 - cosine)) }
}

impl DiscLights {
    /// Unit vectors TOWARDS the middles of the discs.
    pub fn directions(&self) -> &[Vec3] {
        &self.directions
    }

    /// Angle from the middle of a disc to its rim, radians.
    pub fn radius(&self) -> f32 {
        self.cosine.acos()
    }

    /// The basis function of a disc in a direction of unit length: greatest in its middle, 0 from its rim on. 0 for a disc that there is not.
    pub fn basis(&self, disc: usize, direction: Vec3) -> f32 {
        let Some(middle) = self.directions.get(disc) else { return 0.0 };
        self.height * self.fall_off(middle.dot(direction))
    }

    /// The integral of a basis function over the sphere, steradians: what radiance of 1 makes irradiance.
    pub fn solid_angle(&self) -> f32 {
        // That of the smooth step is half of the cap.
        self.height * PI * (1.0 - self.cosine)
    }

    /// A disc of radiance 1 as `count` directional lights, evenly over its cap, whose irradiances add up to the integral of its
    /// basis function. One is in its middle. None for a disc that there is not.
    pub fn lights(&self, disc: usize, count: u32) -> Vec<EnvironmentLight> {
        let Some(middle) = self.directions.get(disc).copied() else { return Vec::new() };
        if count == 1 {
            return vec![EnvironmentLight { direction: middle, irradiance: Vec3::splat(self.solid_angle()) }];
        }
        let (right, up) = middle.any_orthonormal_pair();
        let golden = PI * (3.0 - 5.0_f32.sqrt());
        let mut lights = Vec::with_capacity(count as usize);
        let mut sum = 0.0;
        for place in 0..count {
            let along = 1.0 - (1.0 - self.cosine) * (place as f32 + 0.5) / count as f32;
            let (sine, cosine) = (golden * place as f32).sin_cos();
            let across = (1.0 - along * along).max(0.0).sqrt();
            let direction = (middle * along + across * (right * cosine + up * sine)).normalize();
            let irradiance = self.fall_off(along);
            sum += irradiance;
            lights.push(EnvironmentLight { direction, irradiance: Vec3::splat(irradiance) });
        }
        lights.iter_mut().for_each(|light| light.irradiance *= self.solid_angle() / sum);
        lights
    }

    /// The map of discs with a radiance each, linear RGB: the sum of basis functions times coefficients.
    ///
    /// # Errors
    /// [`EnvironmentError::Coefficients`]; [`EnvironmentError::Radiance`] where coefficients make negative or no radiance.
    pub fn environment_of(
        &self,
        coefficients: &[Vec3],
        size: [u32; 2],
    ) -> Result<Environment, EnvironmentError> {
        if coefficients.len() != self.directions.len() {
            let (lights, given) = (self.directions.len(), coefficients.len());
            return Err(EnvironmentError::Coefficients { lights, given });
        }
        Environment::from_function(size, |direction| {
            let discs = coefficients.iter().enumerate();
            discs.map(|(disc, radiance)| self.basis(disc, direction) * *radiance).sum()
        })
    }

    /// Smooth step from the rim (0) to the middle (1) in the cosine of the angle from it.
    fn fall_off(&self, cosine: f32) -> f32 {
        let part = ((cosine - self.cosine) / (1.0 - self.cosine)).clamp(0.0, 1.0);
        part * part * (3.0 - 2.0 * part)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::data::Random;

    const COUNTS: [u32; 5] = [16, 31, 64, 128, 256];

    #[test]
    fn discs_add_up_to_one_within_eight_per_cent() {
        let mut random = Random::new(2);
        for (count, upper) in COUNTS.into_iter().flat_map(|count| [(count, false), (count, true)]) {
            let discs = disc_lights(count, upper);
            assert_eq!(discs.directions().len(), count as usize);
            assert!(!upper || discs.directions().iter().all(|direction| direction.y > 0.0));
            let mut seen = 0;
            for direction in (0..4000).map(|_| random.direction()) {
                if upper && direction.y < discs.radius().sin() {
                    continue;
                }
                seen += 1;
                let sum: f32 = (0..count as usize).map(|disc| discs.basis(disc, direction)).sum();
                assert!((0.92..=1.08).contains(&sum), "{count} {upper}: {sum} at {direction}");
            }
            assert!(seen > 100);
        }
    }

    #[test]
    fn basis_functions_fall_smoothly_and_have_the_stated_integral() {
        for discs in [disc_lights(16, true), disc_lights(128, false), disc_lights(1, false)] {
            let middle = discs.directions()[0];
            let aside = middle.any_orthonormal_vector();
            let at = |share: f32| {
                let (sine, cosine) = (share * discs.radius()).sin_cos();
                discs.basis(0, middle * cosine + aside * sine)
            };
            for step in 0..50_u8 {
                let (near, far) = (at(f32::from(step) / 50.0), at(f32::from(step + 1) / 50.0));
                assert!(near > far - 1e-6 && near - far < 0.05 * at(0.0), "{near} {far}");
            }
            assert!(at(0.0) > 0.0 && at(1.0) < 1e-5 * at(0.0));
            let mut only = vec![Vec3::ZERO; discs.directions().len()];
            only[0] = Vec3::new(1.0, 2.0, 0.0);
            let map = discs.environment_of(&only, [512, 256]).unwrap();
            let relative = (map.integral().as_vec3() / (only[0] * discs.solid_angle())).truncate() - 1.0;
            assert!(relative.abs().max_element() < 2e-3, "{relative}");
        }
        assert_eq!(disc_lights(16, true).basis(16, Vec3::Y), 0.0);
    }

    #[test]
    fn a_disc_as_lights_has_its_irradiance_and_lies_in_its_cap() {
        let discs = disc_lights(32, true);
        for (disc, count) in [(0, 1), (7, 5), (31, 64)] {
            let lights = discs.lights(disc, count);
            assert_eq!(lights.len(), count as usize);
            let sum: Vec3 = lights.iter().map(|light| light.irradiance).sum();
            assert!((sum / discs.solid_angle() - 1.0).abs().max_element() < 1e-5);
            let middle = discs.directions()[disc];
            let rim = discs.radius().cos();
            assert!(lights.iter().all(|light| light.direction.dot(middle) >= rim - 1e-5));
            let mean: Vec3 = lights.iter().map(|light| light.direction * light.irradiance.x / sum.x).sum();
            assert!(mean.normalize().dot(middle) > 0.99, "{mean} {middle}");
        }
        assert!(discs.lights(32, 4).is_empty() && discs.lights(0, 0).is_empty());
    }

    #[test]
    fn maps_want_a_coefficient_a_disc_that_is_no_less_than_nothing() {
        let discs = disc_lights(16, false);
        let error = discs.environment_of(&[Vec3::ONE; 15], [8, 4]).unwrap_err();
        assert!(matches!(error, EnvironmentError::Coefficients { lights: 16, given: 15 }), "{error}");
        let error = discs.environment_of(&[Vec3::NEG_ONE; 16], [8, 4]).unwrap_err();
        assert!(matches!(error, EnvironmentError::Radiance { count: 32, .. }), "{error}");
        let map = discs.environment_of(&[Vec3::new(1.0, 0.0, 3.0); 16], [8, 4]).unwrap();
        assert!(map.texels().iter().all(|texel| (0.92..=1.08).contains(&texel.x) && texel.y == 0.0));
    }
}
