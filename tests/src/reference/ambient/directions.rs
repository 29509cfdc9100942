// SPDX-License-Identifier: MIT OR Apache-2.0
//! Directions that are spread evenly over a spherical cap.

use crate::linear::Vec3;
use std::f64::consts::TAU;

/// A Hammersley set in the unit square that any cap is filled with: the first coordinate says how much of the cap's solid
/// angle lies further in, the second (the radical inverse to base 2) the azimuth.
#[derive(Clone, Debug)]
pub struct Pattern {
    /// Share of the cap further in, (0, 1), and cosine and sine of the azimuth.
    places: Vec<[f64; 3]>,
}

impl Pattern {
    /// A pattern of `count` directions.
    ///
    /// # Panics
    /// If there are none.
    #[must_use]
    pub fn new(count: u32) -> Self {
        assert!(count > 0, "a pattern needs directions");
        let place = |i: u32| {
            let share = (f64::from(i) + 0.5) / f64::from(count);
            let (sine, cosine) = (TAU * radical_inverse(i)).sin_cos();
            [share, cosine, sine]
        };
        Self { places: (0..count).map(place).collect() }
    }

    /// Number of directions.
    #[must_use]
    pub fn count(&self) -> usize {
        self.places.len()
    }

    /// The directions in the cap of half angle `angle` (radians, (0, π]) about the unit vector `axis`, each with the cosine
    /// of its angle to the axis; all stand for the same solid angle. `turn` (radians) turns the pattern about the axis.
    pub fn cap(&self, axis: Vec3, angle: f64, turn: f64) -> impl Iterator<Item = (Vec3, f64)> {
        let [first, second] = frame(axis);
        let (sine, cosine) = turn.sin_cos();
        let (first, second) = (first * cosine + second * sine, second * cosine - first * sine);
        let depth = 2.0 * (0.5 * angle).sin().powi(2);
        self.places.iter().map(move |&[share, x, y]| {
            let below = share * depth;
            let radius = (below * (2.0 - below)).sqrt();
            (first * (radius * x) + second * (radius * y) + axis * (1.0 - below), 1.0 - below)
        })
    }
}

/// The binary digits of a number, mirrored at the point: [0, 1).
fn radical_inverse(i: u32) -> f64 {
    f64::from(i.reverse_bits()) / 4_294_967_296.0
}

/// Two unit vectors at right angles to the unit vector `axis` and to each other.
fn frame(axis: Vec3) -> [Vec3; 2] {
    let away = if axis.x.abs() < 0.7 { Vec3::new(1.0, 0.0, 0.0) } else { Vec3::new(0.0, 1.0, 0.0) };
    let first = away.without(axis).normalised();
    [first, axis.cross(first)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Means of 1, z and z² over caps are closed forms, and the mean direction is the axis.
    #[test]
    fn caps_are_filled_evenly() {
        let pattern = Pattern::new(4096);
        let axis = Vec3::new(0.48, -0.6, 0.64);
        for degrees in [5.0_f64, 30.0, 90.0, 180.0] {
            let angle = degrees.to_radians();
            let (mut sum, mut squares) = (Vec3::default(), 0.0);
            for (direction, cosine) in pattern.cap(axis, angle, 0.7) {
                assert!((direction.length() - 1.0).abs() < 1e-12);
                assert!((direction.dot(axis) - cosine).abs() < 1e-12 && cosine >= angle.cos());
                sum = sum + direction;
                squares += cosine * cosine;
            }
            let count = pattern.count() as f64;
            let c = angle.cos();
            assert!((sum.dot(axis) / count - 0.5 * (1.0 + c)).abs() < 1e-12, "{degrees}");
            assert!((squares / count - (1.0 + c + c * c) / 3.0).abs() < 1e-6, "{degrees}");
            assert!(sum.without(axis).length() / count < 2e-3 * angle.sin().max(0.1), "{degrees}");
        }
    }

    /// A turn of a quarter takes one side of the pattern to the next.
    #[test]
    fn a_turn_turns_about_the_axis() {
        let axis = Vec3::new(0.0, 1.0, 0.0);
        let pattern = Pattern::new(7);
        let turned = pattern.cap(axis, 1.2, std::f64::consts::FRAC_PI_2);
        for ((a, _), (b, _)) in pattern.cap(axis, 1.2, 0.0).zip(turned) {
            assert!((a.y - b.y).abs() < 1e-12 && (a.x * b.x + a.z * b.z).abs() < 1e-12);
        }
    }
}
