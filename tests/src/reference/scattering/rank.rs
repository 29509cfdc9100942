// SPDX-License-Identifier: MIT OR Apache-2.0
//! Visibility over a row whose depths are rounded to whole steps: every texel is looked at.

use super::visibility::Visibility;

/// Stretches that are shorter see the first texel, texels.
const SHORTEST: f64 = 1e-3;

/// A depth as a whole number of the `2^bits - 1` steps from 0 to 1: clamped and rounded. What is not finite counts as 1.
#[must_use]
pub fn depth_step(depth: f64, bits: u32) -> u32 {
    let steps = f64::from(2_u32.pow(bits) - 1);
    if !depth.is_finite() {
        return steps as u32;
    }
    (depth.clamp(0.0, 1.0) * steps).round() as u32
}

/// A row of depths in steps.
#[derive(Clone, Debug, PartialEq)]
pub struct SteppedRow {
    steps: Vec<u32>,
    bits: u32,
}

impl SteppedRow {
    /// The row in steps of `bits` bits.
    ///
    /// # Panics
    /// For an empty row.
    #[must_use]
    pub fn new<T: Copy + Into<f64>>(row: &[T], bits: u32) -> Self {
        assert!(!row.is_empty(), "an empty row");
        Self { steps: row.iter().map(|&depth| depth_step(depth.into(), bits)).collect(), bits }
    }

    /// What of the first `texels` texels a query covers: whole texels, and the part of the next.
    fn covered(&self, texels: f64) -> (usize, f64) {
        let texels = texels.min(self.steps.len() as f64);
        if texels < SHORTEST {
            return (1, 0.0);
        }
        (texels.floor() as usize, texels.fract())
    }

    /// How many of the first `texels` texels are lit for a ray of a depth, a texel that is covered in part by that part;
    /// and how many are covered.
    #[must_use]
    pub fn lit_texels(&self, texels: f64, depth: f64) -> (f64, f64) {
        let ray = depth_step(depth, self.bits);
        let (whole, part) = self.covered(texels);
        let lit = self.steps[..whole].iter().filter(|&&stored| ray <= stored).count() as f64;
        let last = if part > 0.0 && ray <= self.steps[whole] { part } else { 0.0 };
        (lit + last, whole as f64 + part)
    }

    /// Like `lit_texels` with a weight for each texel: how much of it is lit, and how much is covered. A stretch too short to
    /// cover anything sees the whole first texel.
    ///
    /// # Panics
    /// Where there are fewer weights than texels.
    #[must_use]
    pub fn lit_weight(&self, texels: f64, depth: f64, weights: &[f64]) -> (f64, f64) {
        assert!(weights.len() >= self.steps.len(), "{} weights", weights.len());
        let ray = depth_step(depth, self.bits);
        let (whole, part) = self.covered(texels);
        let (mut lit, mut covered) = (0.0, 0.0);
        for (i, &stored) in self.steps.iter().enumerate() {
            let share = if i < whole {
                1.0
            } else if i == whole {
                part
            } else {
                0.0
            };
            covered += share * weights[i];
            if ray <= stored {
                lit += share * weights[i];
            }
        }
        (lit, covered)
    }

    /// The columns in the order of their steps, those of equal steps in their own order.
    #[must_use]
    pub fn sorted_columns(&self) -> Vec<usize> {
        let mut columns: Vec<usize> = (0..self.steps.len()).collect();
        columns.sort_by_key(|&column| (self.steps[column], column));
        columns
    }

    /// Mean visibility of the first `texels` texels for a ray of a depth: plain, and weighted by the light that is taken
    /// in each texel, `e^(-a i) - e^(-a (i + 1))` with `a` the optical depth of a texel.
    #[must_use]
    pub fn visibility(&self, texels: f64, depth: f64, optical_step: f64) -> Visibility {
        let ray = depth_step(depth, self.bits);
        let (whole, part) = self.covered(texels);
        let (lit, covered) = self.lit_texels(texels, depth);
        if optical_step == 0.0 {
            return Visibility { average: lit / covered, weighted: lit / covered };
        }
        let taken =
            |from: f64, length: f64| (-optical_step * from).exp() * -(-optical_step * length).exp_m1();
        let (mut sum, mut total) = (0.0, 0.0);
        for (i, &stored) in self.steps.iter().enumerate().take(whole + 1) {
            let length = if i < whole { 1.0 } else { part };
            let weight = taken(i as f64, length);
            total += weight;
            if ray <= stored {
                sum += weight;
            }
        }
        Visibility { average: lit / covered, weighted: sum / total }
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_scenes::Random;
    use super::super::visibility::{RowEnd, row_visibility_direct};
    use super::*;

    #[test]
    fn steps_are_rounded_clamped_and_lit_where_nothing_is_known() {
        assert_eq!([0.0, 1.0, -3.0, 7.0].map(|depth| depth_step(depth, 8)), [0, 255, 0, 255]);
        assert_eq!([f64::NAN, f64::INFINITY, f64::NEG_INFINITY].map(|d| depth_step(d, 12)), [4095; 3]);
        assert_eq!([0.49, 0.51, 1.49, 1.51].map(|steps| depth_step(steps / 1023.0, 10)), [0, 1, 1, 2]);
        assert!((0..1024).all(|step| depth_step(f64::from(step) / 1023.0, 10) == step));
    }

    #[test]
    fn equal_steps_are_lit() {
        let row = SteppedRow::new(&[100.4 / 255.0, 99.6 / 255.0, 99.4 / 255.0, 101.0 / 255.0], 8);
        for depth in [99.6, 100.0, 100.4] {
            assert_eq!(row.lit_texels(4.0, depth / 255.0), (3.0, 4.0));
        }
    }

    #[test]
    fn a_step_in_the_row_has_its_closed_form() {
        // 20 dark texels, then 30 lit ones.
        let row: Vec<f64> = (0..50).map(|i| if i < 20 { 0.2 } else { 0.8 }).collect();
        let row = SteppedRow::new(&row, 10);
        for texels in [0.5_f64, 1.0, 19.9, 20.0, 20.25, 37.5, 50.0] {
            let lit = (texels - 20.0).max(0.0);
            assert_eq!(row.lit_texels(texels, 0.5), (lit, texels));
            for optical_step in [0.0, 1e-7, 0.01, 0.7] {
                let found = row.visibility(texels, 0.5, optical_step);
                let dark = |t: f64| (-optical_step * t).exp_m1();
                let expected = if optical_step == 0.0 {
                    lit / texels
                } else {
                    1.0 - dark(texels.min(20.0)) / dark(texels)
                };
                assert!((found.average - lit / texels).abs() < 1e-12);
                assert!((found.weighted - expected).abs() < 1e-9, "{texels}, {optical_step}: {found:?}");
            }
        }
    }

    #[test]
    fn equal_weights_count_and_others_weigh() {
        let row = SteppedRow::new(&[0.8, 0.2, 0.8, 0.2], 12);
        for texels in [0.5, 1.0, 2.25, 3.0, 4.0] {
            assert_eq!(row.lit_weight(texels, 0.5, &[1.0; 4]), row.lit_texels(texels, 0.5));
        }
        let weights = [1.0, 10.0, 100.0, 1000.0];
        assert_eq!(row.lit_weight(2.5, 0.5, &weights), (51.0, 61.0));
        assert_eq!(row.lit_weight(4.0, 0.9, &weights), (0.0, 1111.0));
        assert_eq!(row.sorted_columns(), [1, 3, 0, 2]);
    }

    #[test]
    fn the_shortest_stretch_sees_a_texel_and_the_longest_the_row() {
        let row = SteppedRow::new(&[0.2, 0.8], 12);
        for texels in [0.0, 1e-9, 9.9e-4, 0.3, 1.0] {
            assert_eq!(row.visibility(texels, 0.1, 0.1), Visibility { average: 1.0, weighted: 1.0 });
            assert_eq!(row.visibility(texels, 0.5, 0.1), Visibility { average: 0.0, weighted: 0.0 });
        }
        assert_eq!(row.visibility(2.0, 0.5, 0.1), row.visibility(1e9, 0.5, 0.1));
        assert_eq!(row.lit_texels(2.5, 0.5), (1.0, 2.0));
    }

    #[test]
    fn depths_between_steps_apart_from_the_ray_give_the_row_visibility() {
        let mut random = Random(77);
        // Stored depths at whole steps of 12 bits, rays halfway between two.
        let row: Vec<f64> = (0..300).map(|_| (random.unit() * 4095.0).floor() / 4095.0).collect();
        let stepped = SteppedRow::new(&row, 12);
        for _ in 0..500 {
            let z = ((random.unit() * 4094.0).floor() + 0.499) / 4095.0;
            let (s, optical) = (random.between(0.5, 300.0), random.between(1e-3, 0.2));
            // The ray is rounded down: texels of that step itself are lit for it but not for the unrounded.
            let raised: Vec<f64> = row.iter().map(|v| v + 0.4999 / 4095.0).collect();
            let expected = row_visibility_direct(&raised, RowEnd { z, s, optical });
            let found = stepped.visibility(s, z, optical);
            assert!((found.average - expected.average).abs() < 1e-11);
            assert!((found.weighted - expected.weighted).abs() < 1e-11);
        }
    }
}
