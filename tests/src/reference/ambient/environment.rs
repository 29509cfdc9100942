// SPDX-License-Identifier: MIT OR Apache-2.0
//! Light from far away, and its integrals over hemispheres and caps.
//!
//! A map is twice as wide as high. Its rows run from the zenith (+y) down to the nadir, its columns to the right as someone
//! inside sees them: the middle of the map is where −z is, +x lies a quarter of the width to the right of that, and the left
//! and the right edge meet at +z. Radiance is constant over a texel.

use super::directions::Pattern;
use crate::linear::Vec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Linear red, green and blue.
pub type Rgb = [f64; 3];

/// What makes the light in a cone comparable between angles: t of Eq. 3.9, α the half angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Normalisation {
    /// 1 / sin² α. The integral of the cosine over the cap is π sin² α, so that constant light gives the same for all angles.
    Projected,
    /// 1 / (1 − cos α), as printed: constant light L gives L (1 + cos α).
    Printed,
}

/// Radiance from infinity in all directions.
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    height: usize,
    texels: Vec<Rgb>,
}

impl Environment {
    /// A map of radiance with `height` rows of twice as many texels, the first row at the zenith.
    ///
    /// # Panics
    /// If the number of texels is another, or a texel is negative or not finite.
    #[must_use]
    pub fn new(height: usize, texels: Vec<Rgb>) -> Self {
        assert!(height > 0 && texels.len() == 2 * height * height, "a map is twice as wide as high");
        let possible = |texel: &Rgb| texel.iter().all(|c| c.is_finite() && *c >= 0.0);
        assert!(texels.iter().all(possible), "radiance is finite and not negative");
        Self { height, texels }
    }

    /// The map of a function of unit vectors, taken in the middle of each texel.
    ///
    /// # Panics
    /// As [`Self::new`] does.
    #[must_use]
    pub fn from_function(height: usize, radiance: impl Fn(Vec3) -> Rgb) -> Self {
        let texels = (0..2 * height * height).map(|i| {
            let (x, y) = (i % (2 * height), i / (2 * height));
            radiance(towards(height, x as f64 + 0.5, y as f64 + 0.5))
        });
        Self::new(height, texels.collect())
    }

    /// Number of rows; half the number of columns.
    #[must_use]
    pub fn height(&self) -> usize {
        self.height
    }

    /// Radiance, rows from the zenith.
    #[must_use]
    pub fn texels(&self) -> &[Rgb] {
        &self.texels
    }

    /// The unit vector towards a place of the map, in texels from its upper left corner.
    #[must_use]
    pub fn direction(&self, x: f64, y: f64) -> Vec3 {
        towards(self.height, x, y)
    }

    /// Radiance that comes from the unit vector `direction`.
    #[must_use]
    pub fn radiance(&self, direction: Vec3) -> Rgb {
        let width = 2 * self.height;
        let right_of_middle = direction.x.atan2(-direction.z) / TAU;
        let down = direction.y.clamp(-1.0, 1.0).acos() / PI;
        let x = ((right_of_middle + 0.5) * width as f64) as usize % width;
        let y = ((down * self.height as f64) as usize).min(self.height - 1);
        self.texels[y * width + x]
    }

    /// The map of fewer rows (or more) with the same light: means over the texels' solid angles. 16 rows give the 32x16
    /// texels that cones can follow.
    ///
    /// # Panics
    /// Without rows.
    #[must_use]
    pub fn resized(&self, height: usize) -> Self {
        assert!(height > 0, "a map has rows");
        // Weights of a texel's columns and rows: the parts of their width and of their height (the axis y) that overlap.
        let columns = overlaps(2 * self.height, 2 * height, |share| share);
        let rows = overlaps(self.height, height, |share| 0.5 * (1.0 - (PI * share).cos()));
        let mut texels = Vec::with_capacity(2 * height * height);
        for row in &rows {
            for column in &columns {
                let (mut sum, mut weights) = ([0.0; 3], 0.0);
                for &(y, high) in row {
                    for &(x, wide) in column {
                        let texel = self.texels[y * 2 * self.height + x];
                        sum = [0, 1, 2].map(|c| sum[c] + texel[c] * high * wide);
                        weights += high * wide;
                    }
                }
                texels.push(sum.map(|c| c / weights));
            }
        }
        Self::new(height, texels)
    }

    /// The integral over the sphere: radiance times steradians.
    #[must_use]
    pub fn integral(&self) -> Rgb {
        let width = 2 * self.height;
        let edge = |y: usize| (PI * y as f64 / self.height as f64).cos();
        let mut sum = [0.0; 3];
        for (i, texel) in self.texels.iter().enumerate() {
            let solid_angle = TAU / width as f64 * (edge(i / width) - edge(i / width + 1));
            sum = [0, 1, 2].map(|c| sum[c] + solid_angle * texel[c]);
        }
        sum
    }

    /// L_p of Eq. 3.7: irradiance over π of a surface that faces the unit vector `direction`, nothing hidden.
    #[must_use]
    pub fn irradiance(&self, direction: Vec3, pattern: &Pattern) -> Rgb {
        self.cone(direction, FRAC_PI_2, Normalisation::Projected, pattern)
    }

    /// L_c of Eq. 3.9: the part of the irradiance over π that comes from the cap of half angle `angle` (radians, [0, π/2])
    /// about the unit vector `direction`, normalised. The directions of the pattern fill the cap, whatever its size. A cap
    /// without an extent is its axis: there both normalisations have a limit.
    #[must_use]
    pub fn cone(&self, direction: Vec3, angle: f64, normalisation: Normalisation, pattern: &Pattern) -> Rgb {
        // 1 − cos α, without its cancellation.
        let depth = 2.0 * (0.5 * angle).sin().powi(2);
        let t = match normalisation {
            Normalisation::Projected => angle.sin().powi(2).recip(),
            Normalisation::Printed => depth.recip(),
        };
        if !t.is_finite() {
            let limit = if normalisation == Normalisation::Projected { 1.0 } else { 2.0 };
            return self.radiance(direction).map(|c| limit * c);
        }
        let mut sum = [0.0; 3];
        for (towards, cosine) in pattern.cap(direction, angle, 0.0) {
            let radiance = self.radiance(towards);
            sum = [0, 1, 2].map(|c| sum[c] + radiance[c] * cosine);
        }
        let solid_angle = TAU * depth / pattern.count() as f64;
        sum.map(|c| t / PI * solid_angle * c)
    }
}

fn towards(height: usize, x: f64, y: f64) -> Vec3 {
    let right_of_middle = TAU * (x / (2 * height) as f64 - 0.5);
    let down = PI * y / height as f64;
    let (sine, cosine) = right_of_middle.sin_cos();
    Vec3::new(down.sin() * sine, down.cos(), -down.sin() * cosine)
}

/// For each of `to` equal parts of a range those of `from` equal parts that overlap it, with the measure of what they
/// share; `measure(share)` is that of the first share of the range, increasing.
fn overlaps(from: usize, to: usize, measure: impl Fn(f64) -> f64) -> Vec<Vec<(usize, f64)>> {
    let before = |i: usize, count: usize| measure(i as f64 / count as f64);
    let part = |i: usize| {
        let (begin, end) = (before(i, to), before(i + 1, to));
        let shared = |j: usize| (before(j + 1, from).min(end) - before(j, from).max(begin)).max(0.0);
        (i * from / to..((i + 1) * from).div_ceil(to)).map(|j| (j, shared(j))).collect()
    };
    (0..to).map(part).collect()
}
