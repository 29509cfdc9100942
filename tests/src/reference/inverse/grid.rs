// SPDX-License-Identifier: MIT OR Apache-2.0
//! Values in a box and the two bases that make a field of them.

use crate::linear::Vec3;

/// How a field comes from values; value i of n lies at (i + 0.5) / n of the box along each axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Basis {
    /// Straight between values along each axis; beyond the outermost values that of the nearest.
    Trilinear,
    /// The value of the voxel that a point lies in; outside the box that of the nearest.
    Box,
}

impl Basis {
    /// The basis functions of n values along one axis that are not 0 at a coordinate of the box, 0 to 1, and their
    /// values there.
    fn along(self, n: usize, unit: f64) -> Vec<(usize, f64)> {
        let last = n as f64 - 1.0;
        match self {
            Self::Trilinear => {
                let place = (unit * n as f64 - 0.5).clamp(0.0, last);
                let hat = |i: usize| (1.0 - (place - i as f64).abs()).max(0.0);
                (0..n).map(|i| (i, hat(i))).filter(|&(_, weight)| weight > 0.0).collect()
            }
            Self::Box => vec![((unit * n as f64).floor().clamp(0.0, last) as usize, 1.0)],
        }
    }

    /// The basis functions of a grid of a size (x fastest) that are not 0 at a point of the unit box, and their values
    /// there, which add up to 1.
    #[must_use]
    pub fn weights(self, size: [usize; 3], unit: Vec3) -> Vec<(usize, f64)> {
        let [xs, ys, zs] = [0, 1, 2].map(|axis| self.along(size[axis], unit.to_array()[axis]));
        let mut weights = Vec::new();
        for &(z, along_z) in &zs {
            for &(y, along_y) in &ys {
                for &(x, along_x) in &xs {
                    weights.push(((z * size[1] + y) * size[0] + x, along_x * along_y * along_z));
                }
            }
        }
        weights
    }
}

/// Values in the box.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Values along x, y and z; none 0.
    pub size: [usize; 3],
    /// x fastest, then y.
    pub values: Vec<f64>,
}

impl Grid {
    /// The same value everywhere.
    #[must_use]
    pub fn constant(size: [usize; 3], value: f64) -> Self {
        Self { size, values: vec![value; size.iter().product()] }
    }

    /// Values by their places in the unit box.
    #[must_use]
    pub fn from_fn(size: [usize; 3], value: impl Fn(Vec3) -> f64) -> Self {
        let places = (0..size.iter().product()).map(|index| place(size, index));
        Self { size, values: places.map(value).collect() }
    }

    /// The field at a point of the unit box.
    #[must_use]
    pub fn at(&self, basis: Basis, unit: Vec3) -> f64 {
        let weights = basis.weights(self.size, unit);
        weights.iter().map(|&(index, weight)| self.values[index] * weight).sum()
    }
}

/// Voxel of an index.
pub(super) fn voxel(size: [usize; 3], index: usize) -> [usize; 3] {
    [index % size[0], index / size[0] % size[1], index / (size[0] * size[1])]
}

/// Where in the unit box the value of an index lies.
pub(super) fn place(size: [usize; 3], index: usize) -> Vec3 {
    let voxel = voxel(size, index);
    Vec3::from([0, 1, 2].map(|axis| (voxel[axis] as f64 + 0.5) / size[axis] as f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: [usize; 3] = [5, 3, 4];

    fn points() -> impl Iterator<Item = Vec3> {
        let share = |i: u32, root: f64| (f64::from(i) * root).fract() * 1.2 - 0.1;
        (0..200).map(move |i| Vec3::new(share(i, 0.754_877), share(i, 0.569_84), share(i, 0.413_4)))
    }

    #[test]
    fn weights_add_up_to_one_and_values_are_met() {
        for basis in [Basis::Trilinear, Basis::Box] {
            for point in points() {
                let weights = basis.weights(SIZE, point);
                let sum: f64 = weights.iter().map(|&(_, weight)| weight).sum();
                assert!((sum - 1.0).abs() < 1e-14 && weights.iter().all(|&(_, weight)| weight > 0.0));
            }
            let grid = Grid { size: SIZE, values: (0..60).map(f64::from).collect() };
            for index in 0..60 {
                assert!((grid.at(basis, place(SIZE, index)) - index as f64).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn trilinear_repeats_products_of_straight_lines_and_ends_flat() {
        let field = |p: Vec3| (1.0 + 2.0 * p.x) * (3.0 - p.y) * (0.5 + 4.0 * p.z) + p.x - p.y;
        let grid = Grid::from_fn(SIZE, field);
        for point in points() {
            let inner = Vec3::from([0, 1, 2].map(|axis| {
                let half = 0.5 / SIZE[axis] as f64;
                point.to_array()[axis].clamp(half, 1.0 - half)
            }));
            assert!((grid.at(Basis::Trilinear, point) - field(inner)).abs() < 1e-13);
        }
    }

    #[test]
    fn boxes_are_constant_and_have_their_lower_borders() {
        let grid = Grid { size: [4, 1, 1], values: vec![1.0, 2.0, 3.0, 4.0] };
        let at = |x: f64| grid.at(Basis::Box, Vec3::new(x, 0.2, 0.9));
        assert_eq!(
            [-0.3, 0.0, 0.24, 0.25, 0.499, 0.5, 0.99, 1.0, 1.4].map(at),
            [1.0, 1.0, 1.0, 2.0, 2.0, 3.0, 4.0, 4.0, 4.0]
        );
    }
}
