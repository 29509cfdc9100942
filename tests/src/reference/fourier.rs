// SPDX-License-Identifier: MIT OR Apache-2.0
//! The Fourier series of the visibility step (user-guided stylization thesis, Eq. 4.7;
//! corrections in EQUATIONS.md, 1.1 to 1.4).
//!
//! `V(z_ray, z_stored) = 1/2 + sum over k = 1..M/2 of (2 / c_k) (cos(c_k z_ray) sin(c_k z_stored) −
//! sin(c_k z_ray) cos(c_k z_stored))`, `c_k = π (2k − 1)`. Entry `2k − 2` of basis and coefficients
//! is the sine of the stored depth, entry `2k − 1` its cosine. Depths are in [0, 1] and grow away
//! from the light; the series has its period's second jump where they differ by 1.

use std::f64::consts::PI;

/// What the coefficients are multiplied with against ringing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Window {
    /// Nothing: the plain truncated series.
    None,
    /// `sinc((2k − 1) / M)`, `sinc(x) = sin(πx) / (πx)`.
    Lanczos,
}

impl Window {
    /// The factor of frequency `k`, counted from 1, of `m` basis functions.
    #[must_use]
    pub fn factor(self, k: usize, m: usize) -> f64 {
        match self {
            Self::None => 1.0,
            Self::Lanczos => {
                let x = PI * (2 * k - 1) as f64 / m as f64;
                x.sin() / x
            }
        }
    }
}

/// The step itself: lit (1) if and only if `z_ray <= z_stored`, else 0.
#[must_use]
pub fn visibility(z_ray: f64, z_stored: f64) -> f64 {
    f64::from(u8::from(z_ray <= z_stored))
}

/// The `m` basis functions of a stored depth, each in [−1, 1].
///
/// # Panics
/// If `m` is odd.
#[must_use]
pub fn basis(m: usize, z_stored: f64) -> Vec<f64> {
    assert!(m.is_multiple_of(2), "{m} basis functions: the number must be even");
    (1..=m / 2)
        .flat_map(|k| {
            let angle = frequency(k) * z_stored;
            [angle.sin(), angle.cos()]
        })
        .collect()
}

/// The `m` coefficients of a view ray's depth.
///
/// # Panics
/// If `m` is odd.
#[must_use]
pub fn coefficients(m: usize, z_ray: f64, window: Window) -> Vec<f64> {
    assert!(m.is_multiple_of(2), "{m} basis functions: the number must be even");
    (1..=m / 2)
        .flat_map(|k| {
            let c = frequency(k);
            let scale = 2.0 / c * window.factor(k, m);
            [scale * (c * z_ray).cos(), -scale * (c * z_ray).sin()]
        })
        .collect()
}

/// The series' value, `1/2` and the inner product of coefficients and (mean) basis functions; not
/// clamped.
///
/// # Panics
/// If the lengths differ.
#[must_use]
pub fn evaluate(coefficients: &[f64], basis: &[f64]) -> f64 {
    assert_eq!(coefficients.len(), basis.len());
    0.5 + coefficients.iter().zip(basis).map(|(a, b)| a * b).sum::<f64>()
}

/// The series of one ray and one texel, not clamped.
#[must_use]
pub fn series(m: usize, z_ray: f64, z_stored: f64, window: Window) -> f64 {
    evaluate(&coefficients(m, z_ray, window), &basis(m, z_stored))
}

fn frequency(k: usize) -> f64 {
    PI * (2 * k - 1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean error of a plane at 0.5 over all rays.
    fn plane_error(m: usize, window: Window) -> f64 {
        let n = 20_000;
        let plane = basis(m, 0.5);
        (0..n)
            .map(|i| {
                let z = (f64::from(i) + 0.5) / f64::from(n);
                (evaluate(&coefficients(m, z, window), &plane) - visibility(z, 0.5)).abs()
            })
            .sum::<f64>()
            / f64::from(n)
    }

    #[test]
    fn plane_errors_are_those_of_the_table() {
        for (m, none, lanczos) in [
            (4, 0.1091, 0.1262),
            (8, 0.0660, 0.0643),
            (16, 0.0386, 0.0326),
            (32, 0.0221, 0.0164),
            (64, 0.0125, 0.0082),
            (128, 0.0069, 0.0041),
        ] {
            let found = plane_error(m, Window::None);
            assert!((found - none).abs() < 6e-5, "{m} plain: {found}");
            let found = plane_error(m, Window::Lanczos);
            assert!((found - lanczos).abs() < 6e-5, "{m} Lanczos: {found}");
        }
    }

    #[test]
    fn series_converges_to_the_step() {
        for (z_ray, z_stored) in [(0.2, 0.3), (0.3, 0.2), (0.05, 0.95), (0.95, 0.05)] {
            let error = series(8000, z_ray, z_stored, Window::None) - visibility(z_ray, z_stored);
            assert!(error.abs() < 1e-3, "{z_ray} {z_stored}: {error}");
        }
    }

    #[test]
    fn period_ends_where_depths_differ_by_one() {
        assert!((series(32, 0.0, 1.0, Window::None) - 0.5).abs() < 1e-12);
    }

    #[test]
    fn on_the_blocker_itself_is_one_half() {
        assert!((series(32, 0.37, 0.37, Window::Lanczos) - 0.5).abs() < 1e-12);
    }
}
