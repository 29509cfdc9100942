// SPDX-License-Identifier: MIT OR Apache-2.0
//! Exact visibility of view rays over a rectified map.

use super::slice::{GUARD, Rectification};
use crate::linear::Vec3;

/// The two means of visibility along a view ray.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Visibility {
    /// Mean over the distance, [0, 1] (thesis Eq. 4.3).
    pub average: f64,
    /// Mean with transmittance as weight, [0, 1] (thesis Eq. 4.8, normalised).
    pub weighted: f64,
}

/// Where and how a view ray runs in a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RowEnd {
    /// Depth of the ray in the row, [0, 1].
    pub z: f64,
    /// Texels that the ray has passed, with a fraction; at most the row is used.
    pub s: f64,
    /// Optical thickness of the ray's part over one texel: extinction times `Δ / sin(theta)`.
    pub optical: f64,
}

/// Exact visibility over one row: texel `i` is lit if and only if `z <= row[i]`, the last one
/// counts with the fraction that the ray covers. Weights by recurrence. A ray of no length sees
/// the first texel.
///
/// # Panics
/// For an empty row.
#[must_use]
pub fn row_visibility<T: Copy + Into<f64>>(row: &[T], end: RowEnd) -> Visibility {
    let s = end.s.min(row.len() as f64);
    let whole = s as usize;
    let part = s - whole as f64;
    let lit = |i: usize| f64::from(u8::from(end.z <= row[i].into()));
    if whole == 0 {
        return Visibility { average: lit(0), weighted: lit(0) };
    }
    let step = (-end.optical).exp();
    let (mut weight, mut count, mut sum, mut weights) = (1.0, 0.0, 0.0, 0.0);
    for &stored in &row[..whole] {
        let lit = f64::from(u8::from(end.z <= stored.into()));
        count += lit;
        sum += weight * lit;
        weights += weight;
        weight *= step;
    }
    if part > 0.0 {
        count += part * lit(whole);
        let share =
            if end.optical == 0.0 { part } else { (-part * end.optical).exp_m1() / (-end.optical).exp_m1() };
        sum += weight * share * lit(whole);
        weights += weight * share;
    }
    Visibility { average: count / s, weighted: sum / weights }
}

/// The same by the definition: `w_i = e^(−σ t_i) − e^(−σ t_(i + 1))` of every texel's two edges,
/// over `1 − e^(−σ t_s)`. Slower, and fit only for optical thicknesses over the ray that are not
/// small against 1; it holds [`row_visibility`] to the equation.
///
/// # Panics
/// For an empty row.
#[must_use]
pub fn row_visibility_direct<T: Copy + Into<f64>>(row: &[T], end: RowEnd) -> Visibility {
    let s = end.s.min(row.len() as f64);
    let transmittance = |texels: f64| (-end.optical * texels).exp();
    let (mut length, mut weight) = (0.0, 0.0);
    for (i, &stored) in row.iter().enumerate() {
        let (from, to) = ((i as f64).min(s), (i as f64 + 1.0).min(s));
        if end.z <= stored.into() {
            length += to - from;
            weight += transmittance(from) - transmittance(to);
        }
    }
    Visibility { average: length / s, weighted: weight / (1.0 - transmittance(s)) }
}

impl Rectification {
    /// Where a view ray of a unit direction and a length (metres) runs in row `j`, in a medium of
    /// an extinction (1/m).
    #[must_use]
    pub fn row_end(&self, j: usize, direction: Vec3, distance: f64, extinction: f64) -> RowEnd {
        let slice = &self.slices[j];
        let ray = self.frame.polar_direction(direction);
        let texel = slice.texel(self.width);
        // r of a unit direction is sin(theta).
        let optical = if extinction == 0.0 { 0.0 } else { extinction * texel / ray.r };
        let s = if ray.r == 0.0 { 0.0 } else { distance * ray.r / texel };
        RowEnd { z: slice.depth(ray.theta).clamp(GUARD[0], GUARD[1]), s, optical }
    }

    /// Exact visibility of a view ray of a unit direction and a length (metres) over a rectified
    /// map (row-major, row 0 first), interpolated between the two rows about its azimuth.
    ///
    /// # Panics
    /// If the map has not `width` times the number of slices values.
    #[must_use]
    pub fn visibility<T: Copy + Into<f64>>(
        &self,
        map: &[T],
        direction: Vec3,
        distance: f64,
        extinction: f64,
    ) -> Visibility {
        assert_eq!(map.len(), self.width * self.slices.len(), "size of the rectified map");
        let (first, second, share) = self.rows(self.frame.polar_direction(direction).phi);
        let at = |j: usize| {
            let row = &map[j * self.width..(j + 1) * self.width];
            row_visibility(row, self.row_end(j, direction, distance, extinction))
        };
        let (a, b) = (at(first), at(second));
        Visibility {
            average: a.average * (1.0 - share) + b.average * share,
            weighted: a.weighted * (1.0 - share) + b.weighted * share,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(i: usize) -> f64 {
        ((i as f64 * 12.9898).sin() * 43_758.545_3).fract().abs()
    }

    #[test]
    fn all_lit_is_one_and_all_dark_is_zero() {
        for optical in [0.0, 1e-9, 0.01, 50.0, f64::INFINITY] {
            for s in [0.0, 0.3, 1.0, 7.6, 16.0, 20.0] {
                let end = RowEnd { z: 0.5, s, optical };
                let lit = row_visibility(&[1.0_f32; 16], end);
                assert!((lit.average - 1.0).abs() < 1e-14 && (lit.weighted - 1.0).abs() < 1e-14);
                let dark = row_visibility(&[0.2_f64; 16], end);
                assert_eq!(dark, Visibility::default());
            }
        }
    }

    #[test]
    fn ray_at_the_blocker_is_lit() {
        let end = RowEnd { z: 0.25, s: 1.0, optical: 0.1 };
        assert_eq!(row_visibility(&[0.25_f32], end).average, 1.0);
    }

    #[test]
    fn half_plane_has_its_closed_form() {
        // Lit up to texel 40, dark from there on.
        let row: Vec<f32> = (0..100).map(|i| if i < 40 { 1.0 } else { 0.1 }).collect();
        for (s, optical) in [(100.0, 0.02), (63.7, 0.3), (40.0, 1e-8), (20.5, 0.1), (90.0, 1e-14)] {
            let found = row_visibility(&row, RowEnd { z: 0.5, s, optical });
            let lit = s.min(40.0);
            assert!((found.average - lit / s).abs() < 1e-14);
            let expected = (-optical * lit).exp_m1() / (-optical * s).exp_m1();
            assert!((found.weighted - expected).abs() < 1e-12, "{s} {optical}");
        }
    }

    #[test]
    fn recurrence_is_the_definition() {
        let row: Vec<f64> = (0..1024).map(noise).collect();
        for (s, optical) in [(1024.0, 0.001), (700.3, 0.02), (5.5, 0.1), (1000.9, 2.0)] {
            let end = RowEnd { z: 0.4, s, optical };
            let (fast, direct) = (row_visibility(&row, end), row_visibility_direct(&row, end));
            assert!((fast.average - direct.average).abs() < 1e-12);
            assert!((fast.weighted - direct.weighted).abs() < 1e-11);
        }
    }

    #[test]
    fn without_a_medium_both_means_agree() {
        let row: Vec<f64> = (0..256).map(noise).collect();
        for optical in [0.0, 1e-13] {
            let found = row_visibility(&row, RowEnd { z: 0.6, s: 200.7, optical });
            assert!((found.average - found.weighted).abs() < 1e-9);
        }
    }
}
