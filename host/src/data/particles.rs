// SPDX-License-Identifier: MIT OR Apache-2.0
//! Particles of a medium, and a generator of a burst of them.

use super::mesh::Bounds;
use super::random::Random;
use glam::Vec3;

/// A ball of even extinction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Particle {
    /// Of its middle, metres.
    pub position: Vec3,
    /// Metres, positive.
    pub radius: f32,
    /// 1/m, from 0 up.
    pub extinction: f32,
}

/// Particles in any order. They may be anything: what a map cannot take is dropped there, and counted.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Particles {
    /// All of them.
    pub list: Vec<Particle>,
}

impl Particles {
    /// The box around all finite particles, metres; none where there are none.
    pub fn bounds(&self) -> Option<Bounds> {
        self.balls().fold(None, |bounds: Option<Bounds>, (middle, radius)| {
            let (min, max) = (middle - radius, middle + radius);
            Some(bounds.map_or(Bounds { min, max }, |b| Bounds { min: b.min.min(min), max: b.max.max(max) }))
        })
    }

    /// Middles and radii of all finite particles, metres: what [`crate::core::Light::directional_around_balls`] fits a map to.
    pub fn balls(&self) -> impl Iterator<Item = (Vec3, f32)> {
        let finite = self.list.iter().filter(|p| p.position.is_finite() && p.radius.is_finite());
        finite.map(|particle| (particle.position, particle.radius))
    }

    /// As the shaders take them: 32 bytes each.
    pub fn bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(32 * self.list.len());
        for particle in &self.list {
            let [x, y, z] = particle.position.to_array();
            for value in [x, y, z, particle.radius, particle.extinction, 0.0, 0.0, 0.0] {
                bytes.extend(value.to_le_bytes());
            }
        }
        bytes
    }
}

/// An explosion of `count` particles within 2 m of the origin: a dense middle, and arms that thin out as their particles grow.
pub fn burst(count: usize, seed: u64) -> Particles {
    let mut random = Random::new(seed);
    let arms: Vec<Vec3> = (0..9).map(|_| random.direction()).collect();
    // So that the optical depth does not depend on the number of particles.
    let share = (20_000.0 / count.max(1) as f32).cbrt();
    let particle = |_| {
        let arm = arms[random.below(arms.len())];
        let reach = random.unit();
        let position = 1.8 * reach * arm + (0.15 + 0.3 * reach) * random.in_ball();
        let radius = share * random.range(0.02, 0.05) * (0.6 + reach);
        Particle { position, radius, extinction: 4.0 * (1.0 - 0.7 * reach) }
    };
    Particles { list: (0..count).map(particle).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bursts_repeat_within_their_radius() {
        let particles = burst(1000, 3);
        assert_eq!(particles, burst(1000, 3));
        assert_ne!(particles, burst(1000, 4));
        assert_eq!(particles.bytes().len(), 32_000);
        assert!(particles.list.iter().all(|p| p.position.length() < 2.5 && p.radius > 0.0));
        let bounds = particles.bounds().map(|b| b.max - b.min);
        assert!(bounds.is_some_and(|size| size.min_element() > 1.0));
        assert_eq!(burst(0, 1).bounds(), None);
    }
}
