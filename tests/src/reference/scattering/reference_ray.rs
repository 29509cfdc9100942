// SPDX-License-Identifier: MIT OR Apache-2.0
//! What the prefiltering stores, in f64, and what the choice of its reference ray costs: weights that
//! are common to a slice fit one of its rays only (thesis 4.3.2, EQUATIONS.md 1.8).

use super::slice::GUARD;
use super::stretch::{Stretch, stretch_visibility};
use crate::reference::fourier;
use crate::reference::prefix_sum::{running_mean, transmittance_weights};

/// Which ray of a slice the weights of the prefiltering are made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReferenceRay {
    /// The geometric mean of least and greatest `k`: it minimises the greatest ratio (thesis Eq. 4.12).
    Optimum,
    /// The ray in the middle of the slice.
    Bisectrix,
}

impl ReferenceRay {
    /// `k = sin(theta)` of the reference ray between two angles from the light (radians), from `k`s that
    /// are at least 0.1.
    #[must_use]
    pub fn k(self, theta_min: f64, theta_max: f64) -> f64 {
        let [least, greatest] = bounds(theta_min, theta_max);
        match self {
            Self::Optimum => (least * greatest).sqrt(),
            Self::Bisectrix => (0.5 * (theta_min + theta_max)).sin().max(0.1),
        }
    }

    /// The greatest ratio, at least 1, by which the texels of a ray between two angles (radians) are
    /// longer or shorter than those of this reference ray (EQUATIONS.md 1.8, `E`).
    #[must_use]
    pub fn greatest_ratio(self, theta_min: f64, theta_max: f64) -> f64 {
        let [least, greatest] = bounds(theta_min, theta_max);
        let k = self.k(theta_min, theta_max);
        (k / least).max(greatest / k)
    }
}

/// Least and greatest `sin(theta)` between two angles, at least 0.1, by sampling.
fn bounds(theta_min: f64, theta_max: f64) -> [f64; 2] {
    (0..=4096).fold([f64::INFINITY, 0.1], |[least, greatest], i| {
        let k = (theta_min + (theta_max - theta_min) * f64::from(i) / 4096.0).sin().max(0.1);
        [least.min(k), greatest.max(k)]
    })
}

/// What the prefiltering stores of a row: after texel `i`, the weighted means of the `m` basis functions
/// of the texels 0 to `i`.
///
/// # Panics
/// If there are not as many weights as texels, or `m` is odd.
#[must_use]
pub fn filtered_bases<T: Copy + Into<f64>>(row: &[T], weights: &[f64], m: usize) -> Vec<Vec<f64>> {
    let bases: Vec<Vec<f64>> = row.iter().map(|&stored| fourier::basis(m, stored.into())).collect();
    let means: Vec<Vec<f64>> = (0..m)
        .map(|k| running_mean(&bases.iter().map(|basis| basis[k]).collect::<Vec<_>>(), weights))
        .collect();
    (0..row.len()).map(|i| means.iter().map(|mean| mean[i]).collect()).collect()
}

/// The same without the truncation of the series: after texel `i`, the weighted mean of the visibility
/// of a ray of the depth `z` over the texels 0 to `i`.
///
/// # Panics
/// If there are not as many weights as texels.
#[must_use]
pub fn filtered_visibility<T: Copy + Into<f64>>(row: &[T], weights: &[f64], z: f64) -> Vec<f64> {
    let lit: Vec<f64> = row.iter().map(|&stored| f64::from(u8::from(z <= stored.into()))).collect();
    running_mean(&lit, weights)
}

/// A slice for [`reference_ray_error`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fan {
    /// Least angle from the light of its rays, radians.
    pub theta_min: f64,
    /// Greatest angle, radians.
    pub theta_max: f64,
    /// Radius that its row covers, metres.
    pub r_max: f64,
    /// Extinction of the medium, 1/m, positive.
    pub extinction: f64,
}

/// What the weights of a reference ray cost.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ReferenceRayError {
    /// Greatest error of the radiance, relative to that of an unshadowed ray without end.
    pub greatest: f64,
    /// Root mean square of that error.
    pub rms: f64,
}

/// The error of the radiance of `rays` rays evenly over a fan, each at 64 lengths up to the end of the
/// row, from weights that belong to the reference ray: the ray's own `1 − e^(−σ t)` times the filtered
/// visibility, against the ray's own weights.
///
/// # Panics
/// For an empty row.
#[must_use]
pub fn reference_ray_error<T: Copy + Into<f64>>(
    row: &[T],
    fan: &Fan,
    reference: ReferenceRay,
    rays: usize,
) -> ReferenceRayError {
    const LENGTHS: usize = 64;
    let texel = fan.r_max / row.len() as f64;
    let optical = fan.extinction * texel / reference.k(fan.theta_min, fan.theta_max);
    let weights = transmittance_weights(row.len(), optical);
    let (mut greatest, mut squares) = (0.0_f64, 0.0);
    for ray in 0..rays {
        let unit = (ray as f64 + 0.5) / rays as f64;
        let theta = fan.theta_min + (fan.theta_max - fan.theta_min) * unit;
        let z = GUARD[0] + (GUARD[1] - GUARD[0]) * unit;
        let filtered = filtered_visibility(row, &weights, z);
        let edges: Vec<f64> = (0..=row.len()).map(|i| i as f64 * texel / theta.sin()).collect();
        for length in 1..=LENGTHS {
            let texels = (row.len() * length).div_ceil(LENGTHS);
            let end = edges[texels];
            let stretch = Stretch { z, begin: 0.0, end, extinction: fan.extinction };
            let exact = stretch_visibility(row, &edges, stretch).weighted;
            let taken = -(-fan.extinction * end).exp_m1();
            let error = taken * (filtered[texels - 1] - exact).abs();
            greatest = greatest.max(error);
            squares += error * error;
        }
    }
    ReferenceRayError { greatest, rms: (squares / (rays * LENGTHS) as f64).sqrt() }
}

#[cfg(test)]
mod tests {
    use super::super::test_scenes::Random;
    use super::*;
    use crate::reference::fourier::{Window, coefficients, evaluate};
    use std::f64::consts::PI;

    /// Angles from the light of a fan given by its angles from the plane at right angles to the light.
    fn fan(from: f64, to: f64) -> (f64, f64) {
        (0.5 * PI - to.to_radians(), 0.5 * PI - from.to_radians())
    }

    #[test]
    fn optimum_has_the_least_greatest_ratio() {
        // EQUATIONS.md 1.8.
        for (from, to, optimum, bisectrix) in [
            (0.0, 30.0, 1.075, 1.115),
            (0.0, 60.0, 1.414, 1.732),
            (0.0, 80.0, 2.40, 4.41),
            (40.0, 80.0, 2.10, 2.88),
        ] {
            let (theta_min, theta_max) = fan(from, to);
            let [a, b] = [ReferenceRay::Optimum, ReferenceRay::Bisectrix]
                .map(|reference| reference.greatest_ratio(theta_min, theta_max));
            assert!((a - optimum).abs() < 5e-3 && (b - bisectrix).abs() < 5e-3, "{from} {to}: {a} {b}");
            assert!(a <= b);
        }
    }

    #[test]
    fn error_of_the_reference_ray_grows_with_the_fan() {
        let mut random = Random(51);
        let row: Vec<f64> = (0..512).map(|_| random.unit()).collect();
        // A wall of light between two shades, where the weights matter most.
        let wall: Vec<f64> = (0..512).map(|i| if (60..200).contains(&i) { 1.0 } else { 0.0 }).collect();
        let mut before = 0.0;
        for (from, to) in [(0.0, 30.0), (0.0, 60.0), (40.0, 80.0)] {
            let (theta_min, theta_max) = fan(from, to);
            let fan = Fan { theta_min, theta_max, r_max: 40.0, extinction: 0.05 };
            let error = |row: &[f64], reference| reference_ray_error(row, &fan, reference, 32);
            for (name, row) in [("random", &row), ("wall", &wall)] {
                let [a, b] = [ReferenceRay::Optimum, ReferenceRay::Bisectrix].map(|r| error(row, r));
                println!(
                    "fan {from}-{to}, {name} row: optimum max {:.4} rms {:.4}, bisectrix max {:.4} rms {:.4}",
                    a.greatest, a.rms, b.greatest, b.rms
                );
                if name == "wall" {
                    assert!(a.greatest <= b.greatest, "{a:?} {b:?}");
                }
            }
            let widest = error(&wall, ReferenceRay::Optimum).greatest;
            assert!(widest > before, "{widest} {before}");
            before = widest;
            // The reference ray itself has none.
            let theta = ReferenceRay::Optimum.k(theta_min, theta_max).asin();
            let alone = Fan { theta_min: theta - 1e-9, theta_max: theta + 1e-9, ..fan };
            let none = reference_ray_error(&wall, &alone, ReferenceRay::Optimum, 3);
            assert!(none.greatest < 1e-8, "{none:?}");
        }
    }

    #[test]
    fn many_filtered_bases_give_the_filtered_visibility() {
        let mut random = Random(52);
        let row: Vec<f64> = (0..256).map(|_| random.unit()).collect();
        let weights = transmittance_weights(256, 0.01);
        let bases = filtered_bases(&row, &weights, 512);
        let mut error = 0.0;
        for i in 0..40 {
            let z = 0.05 + 0.9 * (f64::from(i) + 0.5) / 40.0;
            let series = evaluate(&coefficients(512, z, Window::None), &bases[255]);
            error += (series - filtered_visibility(&row, &weights, z)[255]).abs() / 40.0;
        }
        assert!(error < 2e-3, "{error}");
    }
}
