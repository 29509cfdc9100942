// SPDX-License-Identifier: MIT OR Apache-2.0
//! A small deterministic generator of random numbers (PCG-XSH-RR 64/32) and a hash of lattice points.

use glam::Vec3;

/// The PCG32 generator: the same seed gives the same numbers everywhere.
#[derive(Clone, Debug)]
pub struct Random {
    state: u64,
}

impl Random {
    const MULTIPLIER: u64 = 6_364_136_223_846_793_005;
    const INCREMENT: u64 = 1_442_695_040_888_963_407;

    /// A generator for `seed`.
    pub fn new(seed: u64) -> Self {
        let mut random = Self { state: seed.wrapping_add(Self::INCREMENT) };
        random.next_u32();
        random
    }

    /// The next 32 random bits.
    pub fn next_u32(&mut self) -> u32 {
        let old = self.state;
        self.state = old.wrapping_mul(Self::MULTIPLIER).wrapping_add(Self::INCREMENT);
        let shifted = (((old >> 18) ^ old) >> 27) as u32;
        shifted.rotate_right((old >> 59) as u32)
    }

    /// A number in 0..1, one excluded.
    pub fn unit(&mut self) -> f32 {
        (self.next_u32() >> 8) as f32 / 16_777_216.0
    }

    /// A number between `low` and `high`.
    pub fn range(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    /// An index below `count`; 0 where `count` is 0.
    pub fn below(&mut self, count: usize) -> usize {
        ((u64::from(self.next_u32()) * count as u64) >> 32) as usize
    }

    /// A point in the unit ball, uniformly.
    pub fn in_ball(&mut self) -> Vec3 {
        // One try misses with probability 0.48; the bound only makes the loop obviously finite.
        for _ in 0..64 {
            let point = Vec3::new(self.range(-1.0, 1.0), self.range(-1.0, 1.0), self.range(-1.0, 1.0));
            if point.length_squared() <= 1.0 {
                return point;
            }
        }
        Vec3::ZERO
    }

    /// A unit vector, uniformly.
    pub fn direction(&mut self) -> Vec3 {
        self.in_ball().try_normalize().unwrap_or(Vec3::Y)
    }
}

/// A number in 0..1 for a lattice point.
pub(super) fn lattice(seed: u64, x: i32, y: i32) -> f32 {
    let key = seed ^ (u64::from(x.cast_unsigned()) << 32 | u64::from(y.cast_unsigned()));
    // The finaliser of SplitMix64.
    let mut z = key.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^= z >> 31;
    (z >> 40) as f32 / 16_777_216.0
}

/// Value noise in 0..1 with continuous second derivatives.
pub(super) fn value_noise(seed: u64, x: f32, y: f32) -> f32 {
    let (fx, fy) = (x - x.floor(), y - y.floor());
    let (ix, iy) = (x.floor() as i32, y.floor() as i32);
    let smooth = |t: f32| t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    let corner = |dx: i32, dy: i32| lattice(seed, ix.wrapping_add(dx), iy.wrapping_add(dy));
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let (u, v) = (smooth(fx), smooth(fy));
    mix(mix(corner(0, 0), corner(1, 0), u), mix(corner(0, 1), corner(1, 1), u), v)
}

/// Value noise of three coordinates in 0..1, continuous with its first derivatives.
pub(super) fn value_noise_in_space(seed: u64, at: Vec3) -> f32 {
    let cell = at.floor();
    let part = at - cell;
    let fade = part * part * (Vec3::splat(3.0) - 2.0 * part);
    let mut sum = 0.0;
    for corner in 0..8 {
        let offset = [corner & 1, corner >> 1 & 1, corner >> 2 & 1];
        let [x, y, z] = std::array::from_fn(|axis| (cell[axis] as i32).wrapping_add(offset[axis]));
        let weight = |axis: usize| if offset[axis] == 1 { fade[axis] } else { 1.0 - fade[axis] };
        let layer = seed ^ u64::from(z.cast_unsigned()).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        sum += weight(0) * weight(1) * weight(2) * lattice(layer, x, y);
    }
    sum
}

/// Perlin's turbulence: octaves of the distance of that noise from its middle, each of half the strength and size of the one before, over
/// their greatest sum; creased where the noise passes through its middle.
pub(crate) fn turbulence(seed: u64, at: Vec3, octaves: u32) -> f32 {
    let (mut sum, mut most, mut strength, mut scale) = (0.0, 0.0, 1.0, 1.0);
    for octave in 0..octaves {
        let noise = value_noise_in_space(seed.wrapping_add(u64::from(octave)), scale * at);
        sum += strength * (2.0 * noise - 1.0).abs();
        most += strength;
        strength *= 0.5;
        scale *= 2.03;
    }
    sum / most.max(f32::MIN_POSITIVE)
}

/// Octaves of that noise, each of half the strength and size of the one before, over their greatest sum.
pub(crate) fn fractal_noise(seed: u64, at: Vec3, octaves: u32) -> f32 {
    let (mut sum, mut most, mut strength, mut scale) = (0.0, 0.0, 1.0, 1.0);
    for octave in 0..octaves {
        sum += strength * value_noise_in_space(seed.wrapping_add(u64::from(octave)), scale * at);
        most += strength;
        strength *= 0.5;
        scale *= 2.03;
    }
    if most > 0.0 { sum / most } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_and_the_range_are_right() {
        let mut random = Random::new(7);
        let count = 100_000;
        let mut sum = 0.0f64;
        for _ in 0..count {
            let value = random.unit();
            assert!((0.0..1.0).contains(&value));
            sum += f64::from(value);
        }
        // Five standard deviations of the mean of uniform numbers.
        let bound = 5.0 / (12.0 * f64::from(count)).sqrt();
        assert!((sum / f64::from(count) - 0.5).abs() < bound);
    }

    #[test]
    fn seeds_differ_and_repeat() {
        let draw = |seed| {
            let mut random = Random::new(seed);
            [random.next_u32(), random.next_u32()]
        };
        assert_eq!(draw(1), draw(1));
        assert_ne!(draw(1), draw(2));
        assert_eq!(Random::new(3).below(0), 0);
    }

    #[test]
    fn noise_is_bounded_and_continuous() {
        for i in 0..1000 {
            let x = i as f32 * 0.37 - 150.0;
            let value = value_noise(5, x, x * 0.5);
            assert!((0.0..=1.0).contains(&value));
            assert!((value_noise(5, x + 1e-3, x * 0.5) - value).abs() < 0.01);
        }
    }
}
