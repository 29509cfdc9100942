// SPDX-License-Identifier: MIT OR Apache-2.0
//! Exact visibility of a stretch of a view ray over one row whose texels have any lengths.

use super::picture::{Picture, Scene, Start, ViewRay};
use super::slice::{GUARD, Rectification};
use super::visibility::Visibility;

/// A stretch of a view ray in a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Depth of the ray in the row, [0, 1].
    pub z: f64,
    /// Where it begins, metres along the ray.
    pub begin: f64,
    /// Where it ends, metres along the ray.
    pub end: f64,
    /// Extinction of the medium, 1/m.
    pub extinction: f64,
}

/// Both means of visibility over a stretch by the definition: texel `i` covers the distances from
/// `edges[i]` to `edges[i + 1]` (metres along the ray, not falling), is lit if and only if
/// `z <= row[i]`, and counts with what of it lies in the stretch; light taken between two distances
/// is `e^(−σ t) − e^(−σ t')`. What of the stretch lies beyond the row does not count. A stretch
/// without length sees the texel that it lies in.
///
/// # Panics
/// For an empty row, and if there is not one edge more than texels.
#[must_use]
pub fn stretch_visibility<T: Copy + Into<f64>>(row: &[T], edges: &[f64], stretch: Stretch) -> Visibility {
    assert!(!row.is_empty() && edges.len() == row.len() + 1, "edges of a row");
    let Stretch { z, begin, end, extinction } = stretch;
    let taken =
        |from: f64, to: f64| (-extinction * (from - begin)).exp() * -(-extinction * (to - from)).exp_m1();
    let (mut length, mut lit_length, mut weight, mut lit_weight) = (0.0, 0.0, 0.0, 0.0);
    for (i, &stored) in row.iter().enumerate() {
        let (from, to) = (edges[i].max(begin), edges[i + 1].min(end));
        if to <= from {
            continue;
        }
        let taken = taken(from, to);
        length += to - from;
        weight += taken;
        if z <= stored.into() {
            lit_length += to - from;
            lit_weight += taken;
        }
    }
    if length == 0.0 {
        let texel = edges[1..row.len()].iter().filter(|&&edge| edge <= begin).count();
        let lit = f64::from(u8::from(z <= row[texel].into()));
        return Visibility { average: lit, weighted: lit };
    }
    let average = lit_length / length;
    Visibility { average, weighted: if weight == 0.0 { average } else { lit_weight / weight } }
}

impl Rectification {
    /// Exact visibility of the part of a view ray in the medium over a rectified map (row-major),
    /// interpolated between the two rows about it. Unlike [`Self::visibility`] it may begin anywhere.
    ///
    /// # Panics
    /// If the map has not `width` times the number of slices values.
    #[must_use]
    pub fn visibility_of<T: Copy + Into<f64>>(
        &self,
        map: &[T],
        ray: &ViewRay,
        extinction: f64,
    ) -> Visibility {
        assert_eq!(map.len(), self.width * self.slices.len(), "size of the rectified map");
        let polar = self.frame.polar_direction(ray.direction);
        let (first, second, share) = self.rows(polar.phi);
        let at = |j: usize| {
            let slice = &self.slices[j];
            let metres = slice.texel(self.width) / polar.theta.sin();
            let edges: Vec<f64> = (0..=self.width).map(|i| i as f64 * metres).collect();
            let z = slice.depth(polar.theta).clamp(GUARD[0], GUARD[1]);
            let stretch = Stretch { z, begin: ray.begin, end: ray.end, extinction };
            stretch_visibility(&map[j * self.width..(j + 1) * self.width], &edges, stretch)
        };
        let (a, b) = (at(first), at(second));
        Visibility {
            average: a.average * (1.0 - share) + b.average * share,
            weighted: a.weighted * (1.0 - share) + b.weighted * share,
        }
    }
}

/// [`super::picture`] with a medium that may begin at the near plane.
///
/// # Panics
/// For a map or depth buffer of another size than stated, and a stride of 0.
#[must_use]
pub fn rectified_picture<T: Copy + Into<f64> + Sync>(
    scene: &Scene<'_>,
    rectification: &Rectification,
    map: &[T],
    start: Start,
    stride: usize,
) -> Picture {
    let extinction = scene.medium.extinction;
    scene.evaluate(stride, start, |ray| rectification.visibility_of(map, ray, extinction))
}

#[cfg(test)]
mod tests {
    use super::super::visibility::{RowEnd, row_visibility_direct};
    use super::*;

    #[test]
    fn equal_texels_from_the_start_give_the_row_visibility() {
        let row: Vec<f64> = (0..200).map(|i| (f64::from(i) * 12.9898).sin().abs()).collect();
        let edges: Vec<f64> = (0..=200).map(|i| 0.3 * f64::from(i)).collect();
        for (s, extinction) in [(200.0, 0.01), (77.3, 0.2), (0.4, 1.0)] {
            let stretch = Stretch { z: 0.6, begin: 0.0, end: 0.3 * s, extinction };
            let found = stretch_visibility(&row, &edges, stretch);
            let expected = row_visibility_direct(&row, RowEnd { z: 0.6, s, optical: 0.3 * extinction });
            assert!((found.average - expected.average).abs() < 1e-12);
            assert!((found.weighted - expected.weighted).abs() < 1e-10);
        }
    }

    #[test]
    fn a_later_beginning_is_the_difference_of_two_prefixes() {
        let row: Vec<f64> = (0..64).map(|i| (f64::from(i) * 3.7).sin().abs()).collect();
        let edges: Vec<f64> = (0..=64).map(|i| 0.2 * 1.05_f64.powi(i)).collect();
        let (begin, end, extinction) = (0.7, 3.3, 0.4);
        let mean = |begin: f64, end: f64| {
            stretch_visibility(&row, &edges, Stretch { z: 0.5, begin, end, extinction })
        };
        let start = edges[0];
        let weight = |end: f64| 1.0 - (-extinction * (end - start)).exp();
        let (from, to) = (mean(start, begin), mean(start, end));
        let expected =
            (weight(end) * to.weighted - weight(begin) * from.weighted) / (weight(end) - weight(begin));
        assert!((mean(begin, end).weighted - expected).abs() < 1e-12);
        let expected = ((end - start) * to.average - (begin - start) * from.average) / (end - begin);
        assert!((mean(begin, end).average - expected).abs() < 1e-12);
    }

    #[test]
    fn no_length_sees_its_texel() {
        let edges = [0.0, 1.0, 2.0, 3.0];
        let at = |begin: f64| {
            let stretch = Stretch { z: 0.5, begin, end: begin, extinction: 0.1 };
            stretch_visibility(&[0.9, 0.1, 0.9], &edges, stretch).weighted
        };
        assert_eq!([at(0.0), at(0.9), at(1.0), at(1.5), at(2.0), at(9.0)], [1.0, 1.0, 0.0, 0.0, 1.0, 1.0]);
    }
}
