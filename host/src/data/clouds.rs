// SPDX-License-Identifier: MIT OR Apache-2.0
//! Volumes of extinction for scenes: a bank of clouds, and smoke that fills a room.

use super::random::{Random, fractal_noise, turbulence};
use super::volume::{Volume, filled};
use glam::Vec3;

/// Ellipsoids in a bank.
const CLOUDS: usize = 44;

/// A bank of low clouds of 16 x 4 x 16 m about the origin, seen from above or below: ellipsoids side by side, flat at their feet, their
/// surfaces disturbed by noise. After Gardner, "Visual simulation of clouds" (1985), and Ebert's hypertextures; a single such ellipsoid
/// is [`super::cloud`]. Empty towards the box; extinction 0 to 3 1/m.
pub fn cloud_bank(size: [u32; 3], seed: u64) -> Volume {
    let half = Vec3::new(8.0, 2.0, 8.0);
    let mut random = Random::new(seed);
    let clouds: Vec<(Vec3, Vec3)> = (0..CLOUDS)
        .map(|_| {
            let middle =
                Vec3::new(random.range(-6.6, 6.6), random.range(-1.0, -0.7), random.range(-6.6, 6.6));
            // Lower towards the edge of the bank.
            let edge = middle.with_y(0.0).length() / 9.4;
            let height = random.range(0.8, 2.1) * (1.0 - 0.6 * edge * edge);
            let width = random.range(1.1, 2.2);
            (middle, Vec3::new(width, height, width * random.range(0.7, 1.3)))
        })
        .collect();
    filled(size, -half, half, |unit| {
        let at = half * (2.0 * unit - 1.0);
        // How deep inside the nearest ellipsoid, in shares of its radii; neighbours grow together.
        let mut inside = -2.0_f32;
        for (middle, radii) in &clouds {
            let from = (at - *middle) / *radii;
            let flat = Vec3::new(from.x, if from.y < 0.0 { 3.0 * from.y } else { from.y }, from.z);
            inside = smooth_greatest(inside, 1.0 - flat.length(), 0.25);
        }
        if inside < -0.75 {
            return 0.0;
        }
        let detail = fractal_noise(seed.wrapping_add(77), 1.15 * at, 5);
        // Nothing touches the box.
        let fade = ((Vec3::ONE - (2.0 * unit - 1.0).abs()) * half / 0.4).min_element().clamp(0.0, 1.0);
        3.0 * (3.0 * (inside + 1.5 * (detail - 0.5))).clamp(0.0, 1.0) * fade
    })
}

/// The greater of two numbers, rounded where they are alike within `width`.
fn smooth_greatest(a: f32, b: f32, width: f32) -> f32 {
    let share = (0.5 + 0.5 * (b - a) / width).clamp(0.0, 1.0);
    a + (b - a) * share + width * share * (1.0 - share)
}

/// Smoke that fills a room of 4 x 3 x 4 m on the ground, in sheets and folds: Perlin's turbulence (Perlin and Hoffert, "Hypertexture",
/// 1989) bends layers of soot, thinner towards the ceiling. Extinction 0 to 1.2 1/m.
pub fn smoke(size: [u32; 3], seed: u64) -> Volume {
    let (min, max) = (Vec3::new(-2.0, 0.0, -2.0), Vec3::new(2.0, 3.0, 2.0));
    filled(size, min, max, |unit| {
        let at = min + (max - min) * unit;
        let fold = |lane: u64| turbulence(seed.wrapping_add(lane), 0.7 * at, 5) - 0.6;
        let bent = at + 0.9 * Vec3::new(fold(3), fold(17), fold(31));
        let layers = 0.5 + 0.5 * (2.6 * bent.y + 1.1 * bent.x).sin();
        let wisps = turbulence(seed.wrapping_add(101), 1.3 * bent, 4);
        let dense = (0.06 + 0.94 * layers * layers * layers) * (1.5 - 1.6 * wisps).clamp(0.0, 1.0);
        1.2 * dense.clamp(0.0, 1.0) * (1.0 - 0.55 * unit.y)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_repeat_and_stay_within_their_extinction() {
        for (make, size, most, share) in [
            (cloud_bank as fn([u32; 3], u64) -> Volume, [48, 12, 48], 3.0, 0.1..=0.7),
            (smoke, [24, 18, 24], 1.2, 0.5..=1.0),
        ] {
            let volume = make(size, 5);
            assert_eq!(volume, make(size, 5));
            assert_ne!(volume.values, make(size, 6).values);
            assert!(volume.values.iter().all(|value| (0.0..=most).contains(value)));
            let dense = volume.values.iter().filter(|value| **value > 0.05).count();
            let part = dense as f32 / volume.values.len() as f32;
            println!("{part} of {size:?}");
            assert!(share.contains(&part), "{part}");
        }
    }

    /// It has holes between its clouds, through which light falls, and clouds that are no one's neighbours alike.
    #[test]
    fn a_bank_has_gaps_and_smoke_has_none() {
        let column = |volume: &Volume, x: usize, z: usize| -> f32 {
            let [width, height, _] = volume.size.map(|side| side as usize);
            (0..height).map(|y| volume.values[(z * height + y) * width + x]).sum::<f32>() / height as f32
        };
        let bank = cloud_bank([64, 16, 64], 1);
        let columns: Vec<f32> =
            (4..60).flat_map(|z| (4..60).map(move |x| (x, z))).map(|(x, z)| column(&bank, x, z)).collect();
        let clear = columns.iter().filter(|value| **value < 0.01).count();
        let thick = columns.iter().filter(|value| **value > 0.5).count();
        println!("{clear} clear, {thick} thick of {}", columns.len());
        assert!(clear > 30 && thick > 900, "{clear} {thick}");
        let smoke = smoke([32, 24, 32], 1);
        for (x, z) in [(1, 1), (16, 16), (30, 5), (7, 28)] {
            assert!(column(&smoke, x, z) > 0.05);
        }
    }
}
