// SPDX-License-Identifier: MIT OR Apache-2.0
//! Truncated series over a range: of extinction, of which the integral gives optical depth, and of transmittance.

use super::Profile;
use std::f64::consts::{PI, SQRT_2};

/// Orthonormal functions over a range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Basis {
    /// 1, then √2 cos(j π x / d).
    Cosine,
    /// 1, then √2 cos(2 π k x / d) and √2 sin(2 π k x / d) for k from 1 on.
    Period,
}

impl Basis {
    /// Function number `j` at `unit`, 0..1 over the range.
    #[must_use]
    pub fn value(self, j: usize, unit: f64) -> f64 {
        match (self, j) {
            (_, 0) => 1.0,
            (Self::Cosine, _) => SQRT_2 * (j as f64 * PI * unit).cos(),
            (Self::Period, _) => {
                let angle = 2.0 * PI * j.div_ceil(2) as f64 * unit;
                SQRT_2 * if j % 2 == 1 { angle.cos() } else { angle.sin() }
            }
        }
    }
}

/// A truncated series.
#[derive(Clone, Debug)]
pub struct Series {
    basis: Basis,
    range: f64,
    /// One for each function: of extinction in 1/m, or of transmittance.
    pub coefficients: Vec<f64>,
}

impl Series {
    /// Of extinction.
    #[must_use]
    pub fn of_extinction(profile: &Profile, basis: Basis, count: usize) -> Self {
        let range = profile.range;
        let coefficient = |j: usize| profile.integral(|x| basis.value(j, x / range)) / range;
        Self { basis, range, coefficients: (0..count).map(coefficient).collect() }
    }

    /// Of transmittance, marched by `steps` steps.
    #[must_use]
    pub fn of_transmittance(profile: &Profile, basis: Basis, count: usize, steps: usize) -> Self {
        let range = profile.range;
        let step = range / steps as f64;
        let mut coefficients = vec![0.0; count];
        for i in 0..steps {
            let x = (i as f64 + 0.5) * step;
            let transmittance = profile.transmittance(x);
            for (j, coefficient) in coefficients.iter_mut().enumerate() {
                *coefficient += transmittance * basis.value(j, x / range) / steps as f64;
            }
        }
        Self { basis, range, coefficients }
    }

    /// With the Fejér window.
    #[must_use]
    pub fn windowed(&self) -> Self {
        let count = self.coefficients.len() as f64;
        let window = |(j, c): (usize, &f64)| c * (1.0 - j as f64 / count);
        Self { coefficients: self.coefficients.iter().enumerate().map(window).collect(), ..self.clone() }
    }

    /// The sum at `x` metres.
    #[must_use]
    pub fn value(&self, x: f64) -> f64 {
        let unit = x / self.range;
        self.coefficients.iter().enumerate().map(|(j, c)| c * self.basis.value(j, unit)).sum()
    }

    /// The integral of the sum from 0 to `x` metres: Simpson's rule.
    #[must_use]
    pub fn integral(&self, x: f64) -> f64 {
        const HALVES: usize = 200;
        let step = x / (2 * HALVES) as f64;
        let inner: f64 =
            (1..2 * HALVES).map(|i| self.value(i as f64 * step) * if i % 2 == 1 { 4.0 } else { 2.0 }).sum();
        (inner + self.value(0.0) + self.value(x)) * step / 3.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_bases_are_orthonormal() {
        for basis in [Basis::Cosine, Basis::Period] {
            for i in 0..8 {
                for j in 0..8 {
                    let mean: f64 = (0..1000)
                        .map(|k| (f64::from(k) + 0.5) / 1000.0)
                        .map(|x| basis.value(i, x) * basis.value(j, x))
                        .sum::<f64>()
                        / 1000.0;
                    assert!((mean - f64::from(u8::from(i == j))).abs() < 1e-12, "{basis:?} {i} {j}");
                }
            }
        }
    }
}
