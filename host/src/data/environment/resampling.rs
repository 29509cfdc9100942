// SPDX-License-Identifier: MIT OR Apache-2.0
//! Maps of fewer texels, and radiance between texels.

use super::Environment;
use glam::{DVec3, Vec3};

impl Environment {
    /// The map of `size` texels with the same light: means over the texels' solid angles. Sides of 0 count as 1. 32 x 16 texels are
    /// what bent cones can follow.
    pub fn resized(&self, size: [u32; 2]) -> Self {
        let size = size.map(|side| side.max(1));
        let columns = parts(self.size[0], size[0], |share| share);
        let rows = parts(self.size[1], size[1], |share| -(std::f64::consts::PI * share).cos());
        let width = self.size[0] as usize;
        let texel = |row: &[(usize, f64)], column: &[(usize, f64)]| {
            let mut sum = DVec3::ZERO;
            for (y, high) in row {
                for (x, wide) in column {
                    sum += high * wide * self.texels[y * width + x].as_dvec3();
                }
            }
            sum.as_vec3()
        };
        let texels = rows.iter().flat_map(|row| columns.iter().map(|column| texel(row, column))).collect();
        Self { size, texels }
    }

    /// Radiance that comes from a direction, of any length, linear between the middles of texels: what a picture shows of the map.
    pub fn radiance_between(&self, direction: Vec3) -> Vec3 {
        let place = self.place(direction) - 0.5;
        let (first, part) = (place.floor(), place - place.floor());
        let [width, height] = self.size.map(i64::from);
        // The edges meet; beyond the poles there is nothing.
        let texel = |right: i64, below: i64| {
            let x = (first.x as i64 + right).rem_euclid(width);
            let y = (first.y as i64 + below).clamp(0, height - 1);
            self.texels[(y * width + x) as usize]
        };
        let [above, below] = [0, 1].map(|y| texel(0, y).lerp(texel(1, y), part.x));
        above.lerp(below, part.y)
    }
}

/// For each of `to` equal parts of 0..1 those of `from` equal parts that overlap it, with their share of its measure.
fn parts(from: u32, to: u32, measure: impl Fn(f64) -> f64) -> Vec<Vec<(usize, f64)>> {
    let edge = |place: u32, of: u32| f64::from(place) / f64::from(of);
    let part = |place: u32| {
        let (begin, end) = (edge(place, to), edge(place + 1, to));
        let whole = measure(end) - measure(begin);
        let shared = |other: u32| {
            let (low, high) = (edge(other, from).max(begin), edge(other + 1, from).min(end));
            (low < high).then(|| (other as usize, (measure(high) - measure(low)) / whole))
        };
        (0..from).filter_map(shared).collect()
    };
    (0..to).map(part).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use glam::Vec2;

    #[test]
    fn resized_maps_have_the_same_light() {
        let map =
            Environment::from_function([50, 25], |d| Vec3::new(1.0 + d.x, 2.0 + d.y, d.z * d.z)).unwrap();
        for size in [[32, 16], [1, 1], [7, 3], [100, 60]] {
            let resized = map.resized(size);
            assert_eq!(resized.size(), size);
            assert!(resized.integral().distance(map.integral()) < 1e-5, "{size:?}");
        }
        let same = map.resized(map.size());
        let worst = same.texels.iter().zip(&map.texels).map(|(a, b)| a.distance(*b));
        assert!(worst.fold(0.0, f32::max) < 1e-6);
        // Two rows of three, their weights by hand: sines of elevation 1, 1/2, -1/2, -1 and 1, 0, -1.
        let rows = [3.0, 6.0, 12.0].map(Vec3::splat).to_vec();
        let halves = Environment::new([1, 3], rows).unwrap().resized([1, 2]);
        assert!((halves.texels[0].x - 4.5).abs() < 1e-5 && (halves.texels[1].x - 9.0).abs() < 1e-5);
    }

    #[test]
    fn radiance_between_texels_is_linear_and_goes_round() {
        let texels = (0..8_u8).map(|value| Vec3::splat(f32::from(value))).collect();
        let map = Environment::new([4, 2], texels).unwrap();
        for ([x, y], expected) in [
            ([0.5, 0.5], 0.0),
            ([1.25, 0.5], 0.75),
            ([3.5, 1.5], 7.0),
            // Between the last column and the first.
            ([3.75, 0.5], 2.25),
            ([0.25, 1.5], 4.75),
            ([2.0, 1.0], 3.5),
            ([1.5, 0.2], 1.0),
        ] {
            let found = map.radiance_between(map.direction(Vec2::new(x, y)));
            assert!((found.x - expected).abs() < 1e-4, "{x}, {y}: {found}");
        }
        assert!(map.radiance_between(Vec3::NAN).is_finite());
    }
}
