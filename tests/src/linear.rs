// SPDX-License-Identifier: MIT OR Apache-2.0
//! The little linear algebra that the references need, in f64.

use std::ops::{Add, Mul, Neg, Sub};

/// A vector or point of three dimensions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vec3 {
    /// First component.
    pub x: f64,
    /// Second component.
    pub y: f64,
    /// Third component.
    pub z: f64,
}

impl Vec3 {
    /// The vector of these components.
    #[must_use]
    pub const fn new(x: f64, y: f64, z: f64) -> Self {
        Self { x, y, z }
    }

    /// The inner product.
    #[must_use]
    pub fn dot(self, other: Self) -> f64 {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// The cross product.
    #[must_use]
    pub fn cross(self, other: Self) -> Self {
        Self::new(
            self.y * other.z - self.z * other.y,
            self.z * other.x - self.x * other.z,
            self.x * other.y - self.y * other.x,
        )
    }

    /// The Euclidean length.
    #[must_use]
    pub fn length(self) -> f64 {
        self.dot(self).sqrt()
    }

    /// The unit vector of the same direction. A null vector gives NaN.
    #[must_use]
    pub fn normalised(self) -> Self {
        self * self.length().recip()
    }

    /// The part at right angles to the unit vector `axis`.
    #[must_use]
    pub fn without(self, axis: Self) -> Self {
        self - axis * self.dot(axis)
    }

    /// The components in order.
    #[must_use]
    pub const fn to_array(self) -> [f64; 3] {
        [self.x, self.y, self.z]
    }
}

impl Add for Vec3 {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y, self.z + other.z)
    }
}

impl Sub for Vec3 {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y, self.z - other.z)
    }
}

impl Mul<f64> for Vec3 {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self::new(self.x * factor, self.y * factor, self.z * factor)
    }
}

impl Neg for Vec3 {
    type Output = Self;
    fn neg(self) -> Self {
        self * -1.0
    }
}

impl From<[f64; 3]> for Vec3 {
    fn from([x, y, z]: [f64; 3]) -> Self {
        Self::new(x, y, z)
    }
}

impl From<[f32; 3]> for Vec3 {
    fn from(v: [f32; 3]) -> Self {
        Self::from(v.map(f64::from))
    }
}

/// A matrix of four rows and columns that acts on column vectors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mat4 {
    /// The columns: `columns[c][r]` is the entry of row `r` and column `c`.
    pub columns: [[f64; 4]; 4],
}

impl Mat4 {
    /// The matrix of these rows.
    #[must_use]
    pub fn from_rows(rows: [[f64; 4]; 4]) -> Self {
        let mut columns = [[0.0; 4]; 4];
        for (r, row) in rows.iter().enumerate() {
            for (c, &entry) in row.iter().enumerate() {
                columns[c][r] = entry;
            }
        }
        Self { columns }
    }

    /// One row, 0 to 3.
    #[must_use]
    pub fn row(&self, r: usize) -> [f64; 4] {
        self.columns.map(|column| column[r])
    }

    /// The first three entries of a row.
    #[must_use]
    pub fn row3(&self, r: usize) -> Vec3 {
        let [x, y, z, _] = self.row(r);
        Vec3::new(x, y, z)
    }

    /// The matrix times a homogeneous column vector.
    #[must_use]
    pub fn apply(&self, v: [f64; 4]) -> [f64; 4] {
        let mut out = [0.0; 4];
        for (column, factor) in self.columns.iter().zip(v) {
            for (sum, entry) in out.iter_mut().zip(column) {
                *sum += entry * factor;
            }
        }
        out
    }

    /// The matrix times a point (fourth component 1).
    #[must_use]
    pub fn apply_point(&self, p: Vec3) -> [f64; 4] {
        self.apply([p.x, p.y, p.z, 1.0])
    }

    /// The matrix times a direction (fourth component 0).
    #[must_use]
    pub fn apply_direction(&self, d: Vec3) -> [f64; 4] {
        self.apply([d.x, d.y, d.z, 0.0])
    }

    /// The inverse by Gauss-Jordan elimination with partial pivoting; none for a singular matrix
    /// or one with entries that are not finite.
    #[must_use]
    pub fn inverse(&self) -> Option<Self> {
        let mut left = [0, 1, 2, 3].map(|r| self.row(r));
        let mut right = [[0.0; 4]; 4];
        for (i, row) in right.iter_mut().enumerate() {
            row[i] = 1.0;
        }
        for c in 0..4 {
            let pivot = (c..4).max_by(|&i, &j| left[i][c].abs().total_cmp(&left[j][c].abs()))?;
            left.swap(c, pivot);
            right.swap(c, pivot);
            let scale = left[c][c].recip();
            if !scale.is_finite() {
                return None;
            }
            for k in 0..4 {
                left[c][k] *= scale;
                right[c][k] *= scale;
            }
            let (left_pivot, right_pivot) = (left[c], right[c]);
            for r in (0..4).filter(|&r| r != c) {
                let factor = left[r][c];
                for k in 0..4 {
                    left[r][k] -= factor * left_pivot[k];
                    right[r][k] -= factor * right_pivot[k];
                }
            }
        }
        right.iter().flatten().all(|entry| entry.is_finite()).then(|| Self::from_rows(right))
    }
}

impl Mul for Mat4 {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self { columns: other.columns.map(|column| self.apply(column)) }
    }
}

impl From<[[f64; 4]; 4]> for Mat4 {
    fn from(columns: [[f64; 4]; 4]) -> Self {
        Self { columns }
    }
}

impl From<[f64; 16]> for Mat4 {
    /// From column-major entries.
    fn from(m: [f64; 16]) -> Self {
        let column = |c: usize| [m[4 * c], m[4 * c + 1], m[4 * c + 2], m[4 * c + 3]];
        Self { columns: [column(0), column(1), column(2), column(3)] }
    }
}

impl From<[f32; 16]> for Mat4 {
    /// From column-major entries.
    fn from(m: [f32; 16]) -> Self {
        Self::from(m.map(f64::from))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_times_matrix_is_identity() {
        let m = Mat4::from([
            0.0, 2.0, -1.0, 0.5, 3.0, 0.0, 1.0, 0.0, 1.0, 1.0, 4.0, -1.0, 7.0, -3.0, 2.0, 0.0_f64,
        ]);
        let product = m.inverse().expect("regular") * m;
        for (c, column) in product.columns.iter().enumerate() {
            for (r, entry) in column.iter().enumerate() {
                let expected = if r == c { 1.0 } else { 0.0 };
                assert!((entry - expected).abs() < 1e-14);
            }
        }
        assert!(Mat4::from([0.0_f64; 16]).inverse().is_none());
    }

    #[test]
    fn cross_is_right_handed() {
        let x = Vec3::new(1.0, 0.0, 0.0);
        let y = Vec3::new(0.0, 1.0, 0.0);
        assert_eq!(x.cross(y), Vec3::new(0.0, 0.0, 1.0));
    }
}
