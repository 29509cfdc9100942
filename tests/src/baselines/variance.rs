// SPDX-License-Identifier: MIT OR Apache-2.0
//! Variance and exponential variance shadow maps over the first texels of a row, in f64 from their
//! equations (Donnelly and Lauritzen 2006; Lauritzen and McCool 2008).
//!
//! Both bound the share of texels that a ray does not lie behind from above, by Chebyshev's
//! one-sided inequality: `P(Z >= z) <= var / (var + (z - mean)²)` for `z > mean`.

/// Exponents of the two warps of depth in [-1, 1]: the greatest usual ones for 32-bit floats.
pub const EXPONENTS: [f64; 2] = [40.0, 5.0];

/// Least variance of depth in [0, 1].
pub const LEAST_VARIANCE: f64 = 2e-5;

/// Least standard deviation of a warped depth, in units of the warp's slope at the ray.
pub const LEAST_DEVIATION: f64 = 1e-4;

/// Mean and variance, in two passes.
fn moments(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let count = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / count;
    (mean, values.map(|x| (x - mean).powi(2)).sum::<f64>() / count)
}

fn bound((mean, variance): (f64, f64), least: f64, x: f64) -> f64 {
    let variance = variance.max(least);
    if x <= mean { 1.0 } else { variance / (variance + (x - mean).powi(2)) }
}

/// Visibility of a ray of depth `z` over stored depths, by a variance shadow map.
#[must_use]
pub fn variance_visibility<T: Copy + Into<f64>>(depths: &[T], z: f64) -> f64 {
    bound(moments(depths.iter().map(|&depth| depth.into())), LEAST_VARIANCE, z)
}

/// Visibility of a ray of depth `z` over stored depths, by an exponential variance shadow map with
/// both warps.
#[must_use]
pub fn exponential_variance_visibility<T: Copy + Into<f64>>(depths: &[T], z: f64) -> f64 {
    let [up, down] = EXPONENTS;
    let warps: [(f64, &dyn Fn(f64) -> f64); 2] =
        [(up, &|z| (up * (2.0 * z - 1.0)).exp()), (down, &|z| -(-down * (2.0 * z - 1.0)).exp())];
    warps
        .into_iter()
        .map(|(exponent, warp)| {
            let least = (LEAST_DEVIATION * exponent * warp(z)).powi(2);
            bound(moments(depths.iter().map(|&depth| warp(depth.into()))), least, warp(z))
        })
        .fold(1.0, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(i: usize) -> f64 {
        ((i as f64 * 12.9898).sin() * 43_758.545_3).fract().abs()
    }

    #[test]
    fn neither_is_ever_below_the_exact_share() {
        for (seed, count) in [(1, 3), (50, 17), (900, 400)] {
            let depths: Vec<f64> = (0..count).map(|i| noise(seed + i).powi(1 + seed as i32 % 3)).collect();
            for step in 0..=100 {
                let z = f64::from(step) / 100.0;
                let exact = depths.iter().filter(|d| z <= **d).count() as f64 / count as f64;
                assert!(variance_visibility(&depths, z) >= exact - 1e-12);
                assert!(exponential_variance_visibility(&depths, z) >= exact - 1e-12);
            }
        }
    }

    #[test]
    fn the_bound_is_reached_by_two_depths_at_the_farther_one() {
        for share in [0.1, 0.5, 0.75] {
            let depths: Vec<f64> =
                (0..1000).map(|i| if f64::from(i) < 1000.0 * share { 0.3 } else { 0.8 }).collect();
            assert!((variance_visibility(&depths, 0.8) - (1.0 - share)).abs() < 1e-9);
            assert!((exponential_variance_visibility(&depths, 0.8) - (1.0 - share)).abs() < 1e-3);
        }
    }

    #[test]
    fn between_two_depths_light_bleeds_as_the_closed_form_says() {
        // Half at 0, half at 1, seen from 0.75: variance 1/4, and 1/4 beyond the mean.
        let found = variance_visibility(&[0.0, 1.0], 0.75);
        assert!((found - 0.25 / (0.25 + 0.0625)).abs() < 1e-12);
    }

    #[test]
    fn the_downward_warp_bounds_what_lies_at_the_mean() {
        // Half at 0.2, half at 0.8, seen from 0.5, their mean: a variance shadow map knows nothing there.
        let depths = [0.2, 0.8];
        assert_eq!(variance_visibility(&depths, 0.5), 1.0);
        let (near, far) = (3.0_f64.exp(), (-3.0_f64).exp());
        let (variance, beyond) = ((0.5 * (near - far)).powi(2), 0.5 * (near + far) - 1.0);
        let expected = variance / (variance + beyond * beyond);
        assert!((exponential_variance_visibility(&depths, 0.5) - expected).abs() < 1e-12);
    }
}
