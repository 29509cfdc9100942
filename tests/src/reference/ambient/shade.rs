// SPDX-License-Identifier: MIT OR Apache-2.0
//! A white Lambertian surface in an environment: what it sends out, and what ambient occlusion, bent normals and bent cones
//! make of that.

use super::directions::Pattern;
use super::environment::{Environment, Normalisation, Rgb};
use super::visibility::{Angle, Sample, Statistics};
use crate::linear::Vec3;

/// The truth, by Monte Carlo: (1/π) ∫ L V ⟨n, ω⟩ dω (Eq. 2.4 for the albedo 1), from samples that are even in solid angle
/// over the hemisphere about the unit vector `normal`.
#[must_use]
pub fn outgoing(environment: &Environment, normal: Vec3, samples: &[Sample]) -> Rgb {
    let mut sum = [0.0; 3];
    for sample in samples.iter().filter(|sample| sample.visibility > 0.0) {
        let weight = sample.visibility * sample.direction.dot(normal);
        let radiance = environment.radiance(sample.direction);
        sum = [0, 1, 2].map(|c| sum[c] + weight * radiance[c]);
    }
    sum.map(|c| 2.0 * c / samples.len() as f64)
}

/// What the mean radiance of a map, a bent normal or a cone is multiplied with.
///
/// Let A be the uniform and K the cosine-weighted share that is open, N of length R and unit direction N̂ the bent normal. In
/// constant light L the truth is K L, and every mean radiance is L: L_p, and L_c with t = 1 / sin² α. So K is the factor
/// that is exact in constant light whatever hides the sky, for all three methods; for an open plane A = K = 1.
///
/// Eq. 3.10 multiplies the light of a cone with A ⟨N̂, n⟩ instead. For a sky that is open in a cap of half angle α above the
/// horizon A = 1 − cos α but K = sin² α ⟨N̂, n⟩: with t = 1 / sin² α the product is too dark by 1 + cos α, up to a half. With the
/// printed t = 1 / (1 − cos α) the same cap is exact, for L_c then is L (1 + cos α): the two slips of the thesis cancel,
/// as long as α is the angle of the cap. Eq. 3.6 gives less than that.
///
/// K needs no sums of its own: K = 2 A ⟨N, n⟩ = 2 A R ⟨N̂, n⟩ for every visibility (see [`Statistics`]), which is Eq. 3.10 with
/// the bent normal at twice its length rather than normalised. It holds ⟨N̂, n⟩ already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Brightness {
    /// As Eq. 3.8 and 3.10 have it: A, for cones A ⟨N̂, n⟩, and t = 1 / sin² α.
    Uniform,
    /// As [`Self::Uniform`], but cones with the printed t = 1 / (1 − cos α).
    Printed,
    /// K for all, and t = 1 / sin² α.
    Cosine,
}

/// What the three methods make of a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Approximations {
    /// Ambient occlusion: L_p in the direction of the normal (Eq. 2.5).
    pub occlusion: Rgb,
    /// Bent normals: L_p in the direction of the bent normal (Eq. 3.8).
    pub normals: Rgb,
    /// Bent cones: L_c in the direction of the bent normal (Eq. 3.9 and 3.10).
    pub cones: Rgb,
}

/// The approximations of [`outgoing`] from the statistics of a point with a unit normal, each light integral over the
/// directions of `pattern`.
#[must_use]
pub fn approximations(
    environment: &Environment,
    normal: Vec3,
    statistics: &Statistics,
    angle: Angle,
    brightness: Brightness,
    pattern: &Pattern,
) -> Approximations {
    let bent = statistics.direction;
    let (share, cone_share, t) = match brightness {
        Brightness::Cosine => (statistics.open_cosine, statistics.open_cosine, Normalisation::Projected),
        Brightness::Uniform | Brightness::Printed => {
            let t = match brightness {
                Brightness::Printed => Normalisation::Printed,
                _ => Normalisation::Projected,
            };
            (statistics.open, statistics.open * bent.dot(normal), t)
        }
    };
    let scaled = |light: Rgb, factor: f64| light.map(|c| factor * c);
    let cone = environment.cone(bent, statistics.angle(angle), t, pattern);
    Approximations {
        occlusion: scaled(environment.irradiance(normal, pattern), share),
        normals: scaled(environment.irradiance(bent, pattern), share),
        cones: scaled(cone, cone_share),
    }
}
