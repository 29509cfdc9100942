// SPDX-License-Identifier: MIT OR Apache-2.0
//! Phase functions, in 1/sr, of `cos_angle` = view direction (camera to scene) · direction TOWARDS
//! the light: 1 looks at the light, which is forward scattering (EQUATIONS.md, 0).

use std::f64::consts::PI;

/// The isotropic phase function, `1 / 4π`.
#[must_use]
pub fn isotropic() -> f64 {
    0.25 / PI
}

/// Henyey and Greenstein's, `(1 − g²) / (4π (1 + g² − 2 g cos)^(3/2))`, for the mean cosine `g` in
/// (−1, 1) (thesis Eq. 2.11).
#[must_use]
pub fn henyey_greenstein(cos_angle: f64, g: f64) -> f64 {
    let base = 1.0 + g * g - 2.0 * g * cos_angle;
    0.25 / PI * (1.0 - g * g) / (base * base.sqrt())
}

/// The integral over the sphere of a function of the cosine of the polar angle, by Simpson's rule
/// over the angle with `2 n` intervals.
#[must_use]
pub fn sphere_integral(function: impl Fn(f64) -> f64, n: usize) -> f64 {
    let step = PI / (2 * n) as f64;
    let sum: f64 = (0..=2 * n)
        .map(|i| {
            let weight = match i {
                0 => 1.0,
                i if i == 2 * n => 1.0,
                i if i % 2 == 1 => 4.0,
                _ => 2.0,
            };
            let angle = i as f64 * step;
            weight * function(angle.cos()) * angle.sin()
        })
        .sum();
    2.0 * PI * sum * step / 3.0
}

/// The integral of a phase function over the sphere; 1 for a normalised one.
#[must_use]
pub fn norm(phase: impl Fn(f64) -> f64) -> f64 {
    sphere_integral(phase, QUADRATURE)
}

/// The mean cosine of a normalised phase function.
#[must_use]
pub fn mean_cosine(phase: impl Fn(f64) -> f64) -> f64 {
    sphere_integral(|cos| cos * phase(cos), QUADRATURE)
}

const QUADRATURE: usize = 20_000;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn henyey_greenstein_integrates_to_one_with_mean_cosine_g() {
        for g in [-0.95, -0.5, 0.0, 0.3, 0.76, 0.9, 0.99] {
            assert!((norm(|cos| henyey_greenstein(cos, g)) - 1.0).abs() < 1e-9, "{g}");
            assert!((mean_cosine(|cos| henyey_greenstein(cos, g)) - g).abs() < 1e-9, "{g}");
        }
    }

    #[test]
    fn isotropic_is_henyey_greenstein_without_preference() {
        assert!((henyey_greenstein(0.3, 0.0) - isotropic()).abs() < 1e-16);
        assert!((norm(|_| isotropic()) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn positive_g_prefers_looking_at_the_light() {
        assert!(henyey_greenstein(1.0, 0.7) > 50.0 * henyey_greenstein(-1.0, 0.7));
    }
}
