// SPDX-License-Identifier: MIT OR Apache-2.0
//! Environment maps as directional lights, importance-sampled (Klehm, "User-Guided Scene Stylization using Efficient Rendering
//! Techniques", 2015, section 2.4.3): the set of lights of its Eq. 2.18.

use super::{Environment, EnvironmentLight};
use crate::data::Random;
use glam::{DVec3, Vec2, Vec3};

impl Environment {
    /// At most `count` directional lights that stand for the map; none where it is black.
    ///
    /// They are spread by luminance times solid angle, on a shifted Hammersley set in the marginal distribution of rows and the
    /// conditional ones of columns. Each has the colour of its texel and the share of the luminance that it stands for, the same for all; then each channel
    /// is scaled so that together they have the irradiance of the map, [`Environment::integral`]: exactly, unless a channel is in no texel that
    /// was met. The same `seed` gives the same lights.
    pub fn sample_lights(&self, count: u32, seed: u64) -> Vec<EnvironmentLight> {
        let width = self.size[0] as usize;
        let mut rows = Vec::with_capacity(self.size[1] as usize);
        for (y, texels) in self.texels.chunks_exact(width).enumerate() {
            let solid_angle = self.texel_solid_angle(y as u32);
            rows.push(Distribution::of(texels.iter().map(|texel| solid_angle * luminance(*texel))));
        }
        let marginal = Distribution::of(rows.iter().map(Distribution::total));
        let total = marginal.total();
        if total <= 0.0 {
            return Vec::new();
        }
        let mut random = Random::new(seed);
        let (scramble, shift) = (random.next_u32(), f64::from(random.next_u32()) / 2.0_f64.powi(32));
        let mut lights: Vec<EnvironmentLight> = (0..count)
            .map(|light| {
                let across = (f64::from(light) + shift) / f64::from(count);
                let down = (f64::from(light.reverse_bits() ^ scramble) + 0.5) / 2.0_f64.powi(32);
                // Columns of neighbouring rows are much alike, so that each coordinate of the set spreads on its own.
                let (y, part_down) = marginal.sample(down);
                let (x, part_across) = rows[y].sample(across);
                // Evenly in solid angle, which is even in the sine of the elevation.
                let (top, bottom) = (self.sine(y as u32), self.sine(y as u32 + 1));
                let sine = top + (bottom - top) * part_down;
                let row = (1.0 - sine.clamp(-1.0, 1.0).asin() / std::f64::consts::FRAC_PI_2) * 0.5;
                let place =
                    Vec2::new((x as f64 + part_across) as f32, (row * f64::from(self.size[1])) as f32);
                let texel = self.texels[y * width + x];
                let share = total / (f64::from(count) * luminance(texel));
                EnvironmentLight {
                    direction: self.direction(place),
                    irradiance: (share * texel.as_dvec3()).as_vec3(),
                }
            })
            .collect();
        let sum: DVec3 = lights.iter().map(|light| light.irradiance.as_dvec3()).sum();
        let scale = DVec3::select(sum.cmpgt(DVec3::ZERO), self.integral() / sum, DVec3::ONE);
        lights.iter_mut().for_each(|light| light.irradiance *= scale.as_vec3());
        lights
    }
}

/// Relative luminance of linear RGB (ITU-R BT.709).
pub(super) fn luminance(color: Vec3) -> f64 {
    color.as_dvec3().dot(DVec3::new(0.2126, 0.7152, 0.0722))
}

/// A step function that is sampled by the inverse of its integral.
struct Distribution {
    /// Integral up to the beginning of each step, and up to the end.
    sums: Vec<f64>,
}

impl Distribution {
    fn of(weights: impl Iterator<Item = f64>) -> Self {
        let mut sums = vec![0.0];
        let mut sum = 0.0;
        for weight in weights {
            sum += weight;
            sums.push(sum);
        }
        Self { sums }
    }

    fn total(&self) -> f64 {
        self.sums.last().copied().unwrap_or(0.0)
    }

    /// The step at a share 0..1 of the integral, never one of weight 0, and the place in it, 0..1. The integral must be positive.
    fn sample(&self, share: f64) -> (usize, f64) {
        let sum = share * self.total();
        let mut step = self.sums.partition_point(|begin| *begin <= sum).saturating_sub(1);
        step = step.min(self.sums.len().saturating_sub(2));
        while step > 0 && self.sums[step + 1] <= self.sums[step] {
            step -= 1;
        }
        let (begin, end) = (self.sums[step], self.sums[step + 1]);
        (step, ((sum - begin) / (end - begin)).clamp(0.0, 1.0))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn sum(lights: &[EnvironmentLight]) -> DVec3 {
        lights.iter().map(|light| light.irradiance.as_dvec3()).sum()
    }

    #[test]
    fn a_constant_map_gives_its_radiance_times_the_sphere_from_everywhere() {
        let radiance = Vec3::new(0.5, 2.0, 7.0);
        let map = Environment::from_function([32, 16], |_| radiance).unwrap();
        for seed in 0..5 {
            let lights = map.sample_lights(256, seed);
            assert_eq!((lights.len(), &lights), (256, &map.sample_lights(256, seed)));
            assert_ne!(lights, map.sample_lights(256, seed + 1));
            let relative = (sum(&lights) / (4.0 * PI * radiance.as_dvec3()) - 1.0).abs().max_element();
            assert!(relative < 1e-6, "{relative}");
            // As many lights in each of 32 parts of equal solid angle: 8, and no more than 3 beside.
            let mut parts = [0_u32; 32];
            for EnvironmentLight { direction, .. } in lights {
                assert!(direction.is_normalized());
                let around = (direction.x.atan2(direction.z) / std::f32::consts::TAU).rem_euclid(1.0);
                let part = ((around * 8.0) as usize).min(7) + 8 * ((2.0 + 2.0 * direction.y) as usize).min(3);
                parts[part] += 1;
            }
            assert!(parts.iter().all(|count| (5..=11).contains(count)), "{parts:?}");
            // The mean direction is nowhere: of random lights its length would be about 1 / sqrt(256).
            let mean: Vec3 = map.sample_lights(256, seed).iter().map(|light| light.direction / 256.0).sum();
            assert!(mean.length() < 0.02, "{mean}");
        }
    }

    /// A spot of a hundredth of a per cent of the sphere, as bright as all the rest together is, nine times over.
    #[test]
    fn lights_gather_in_a_bright_spot() {
        let towards = Vec3::new(0.3, 0.8, -0.5).normalize();
        let mut map = Environment::from_function([128, 64], |_| Vec3::ONE).unwrap();
        let place = map.place(towards);
        let (x, y) = (place.x as usize, place.y as usize);
        let solid_angle = map.texel_solid_angle(y as u32);
        map.texels[y * 128 + x] = Vec3::splat((9.0 * (4.0 * PI - solid_angle) / solid_angle) as f32);
        let lights = map.sample_lights(200, 3);
        let near = lights.iter().filter(|light| light.direction.dot(towards) > 0.997).count();
        assert!((178..=182).contains(&near), "{near}");
        let expected = map.integral();
        assert!((sum(&lights) / expected - 1.0).abs().max_element() < 1e-6);
    }

    #[test]
    fn sums_are_those_of_the_map_and_so_is_where_they_come_from() {
        let sky = |direction: Vec3| {
            let warm =
                Vec3::new(40.0, 20.0, 4.0) * direction.dot(Vec3::new(0.6, 0.48, 0.64)).max(0.0).powi(60);
            warm + Vec3::new(0.1, 0.3, 0.9) * (0.2 + direction.y.max(0.0)) + Vec3::X * direction.z.max(0.0)
        };
        let map = Environment::from_function([96, 48], sky).unwrap();
        let integral = map.integral();
        let weights = DVec3::new(0.2126, 0.7152, 0.0722);
        for count in [16, 64, 1024] {
            for seed in 0..4 {
                let lights = map.sample_lights(count, seed);
                let relative = (sum(&lights) / integral - 1.0).abs().max_element();
                assert!(relative < 1e-6, "{count} lights: {relative}");
                // All stand for about as much.
                let mean = integral.dot(weights) / f64::from(count);
                for light in lights {
                    let share = luminance(light.irradiance) / mean;
                    assert!((0.6..1.4).contains(&share), "{count} lights: {share}");
                }
            }
        }
        // The flux through the plane across an axis, of each channel.
        for axis in [Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Z] {
            let through = |direction: Vec3| f64::from(direction.dot(axis).max(0.0));
            let seen = |direction: Vec3| sky(direction) * through(direction) as f32;
            let exact = Environment::from_function([384, 192], seen).unwrap().integral();
            let lights = map.sample_lights(1024, 1).into_iter();
            let sampled: DVec3 =
                lights.map(|light| through(light.direction) * light.irradiance.as_dvec3()).sum();
            assert!((sampled / exact - 1.0).abs().max_element() < 0.03, "{axis}: {sampled} of {exact}");
        }
    }

    #[test]
    fn dark_texels_have_no_light_and_black_maps_none_at_all() {
        let black = Environment::from_function([4, 2], |_| Vec3::ZERO).unwrap();
        assert!(black.sample_lights(16, 0).is_empty());
        let half =
            Environment::from_function([64, 32], |d| if d.x > 0.0 { Vec3::Z } else { Vec3::ZERO }).unwrap();
        for seed in 0..20 {
            let lights = half.sample_lights(33, seed);
            assert_eq!(lights.len(), 33);
            assert!(lights.iter().all(|light| light.direction.x > -1e-6 && light.irradiance.is_finite()));
        }
        assert!(half.sample_lights(0, 0).is_empty());
    }
}
