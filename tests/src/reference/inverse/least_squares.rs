// SPDX-License-Identifier: MIT OR Apache-2.0
//! The least squares of a small problem as a dense system, and its solution by Cholesky's decomposition.
//!
//! The function is f(a) = 1/2 (Wa - o)^T C (Wa - o) + l_L/2 |La|^2 + l_0/2 |a|^2 + l_1/2 |a - 1|^2, whose gradient is 0 where
//! (W^T C W + l_L L^T L + (l_0 + l_1) I) a = W^T C o + l_1 1.

use super::grid::voxel;
use super::matrix::Matrix;

/// A square matrix, row after row.
pub type Dense = Vec<Vec<f64>>;

/// Weights of what is known of a part beforehand, as multiples of the mean of W^T C W 1 over the unknown values.
#[derive(Clone, Copy, Debug, Default)]
pub struct Regulariser {
    /// Of the squared Laplacian: smooth.
    pub laplacian: f64,
    /// Of the squared values: small.
    pub zero: f64,
    /// Of the squared differences to 1.
    pub one: f64,
}

/// What is asked for.
#[derive(Clone, Copy, Debug)]
pub struct Problem<'a> {
    /// W.
    pub matrix: &'a Matrix,
    /// o, one a pixel.
    pub targets: &'a [f64],
    /// The diagonal of C, one a pixel, not below 0.
    pub weights: &'a [f64],
    /// Which values are unknown; the others are 0 and no neighbours of anything.
    pub unknown: &'a [bool],
    /// One a part.
    pub regularisers: &'a [Regulariser],
}

/// Rows of the Laplacian of a grid: the sum of the differences to those of the 6 neighbours that are in the grid and
/// unknown. Rows of known values are empty.
#[must_use]
pub fn laplacian(size: [usize; 3], unknown: &[bool]) -> Vec<Vec<(usize, f64)>> {
    let strides = [1, size[0], size[0] * size[1]];
    let row = |index: usize| {
        let mut row = Vec::new();
        if !unknown[index] {
            return row;
        }
        for (axis, stride) in strides.into_iter().enumerate() {
            let at = voxel(size, index)[axis];
            if at > 0 && unknown[index - stride] {
                row.push((index - stride, 1.0));
            }
            if at + 1 < size[axis] && unknown[index + stride] {
                row.push((index + stride, 1.0));
            }
        }
        row.push((index, -(row.len() as f64)));
        row
    };
    (0..unknown.len()).map(row).collect()
}

/// The system of a problem in its unknown values alone.
#[derive(Clone, Debug)]
pub struct Normal {
    /// Symmetric, not indefinite.
    pub matrix: Dense,
    /// The right-hand side.
    pub right: Vec<f64>,
    /// The column of W of each unknown.
    pub columns: Vec<usize>,
    /// How many columns W has.
    pub total: usize,
    /// What regularisers are multiples of.
    pub scale: f64,
}

impl Problem<'_> {
    /// The mean of W^T C W 1 over the unknown values; 0 without any.
    #[must_use]
    pub fn scale(&self) -> f64 {
        let ones: Vec<f64> = self.unknown.iter().map(|&unknown| f64::from(u8::from(unknown))).collect();
        let pixels: Vec<f64> =
            self.matrix.apply(&ones).iter().zip(self.weights).map(|(pixel, weight)| pixel * weight).collect();
        let sums = self.matrix.apply_transposed(&pixels);
        let sum: f64 = sums.iter().zip(&ones).map(|(sum, one)| sum * one).sum();
        sum / ones.iter().sum::<f64>().max(1.0)
    }

    /// Each part's first column and its regulariser, in units of the function.
    fn regularised(&self) -> Vec<(usize, [usize; 3], Regulariser)> {
        let scale = self.scale();
        let mut first = 0;
        let mut parts = Vec::new();
        for (part, own) in self.matrix.parts.iter().zip(self.regularisers) {
            let [laplacian, zero, one] = [own.laplacian, own.zero, own.one].map(|weight| weight * scale);
            parts.push((first, part.size, Regulariser { laplacian, zero, one }));
            first += part.columns();
        }
        parts
    }

    /// f at all values, of which the known ones are 0.
    #[must_use]
    pub fn cost(&self, values: &[f64]) -> f64 {
        let mut sum = 0.0;
        for ((pixel, target), weight) in self.matrix.apply(values).iter().zip(self.targets).zip(self.weights)
        {
            sum += weight * (pixel - target).powi(2);
        }
        for (first, size, weights) in self.regularised() {
            let count: usize = size.iter().product();
            let (values, unknown) = (&values[first..first + count], &self.unknown[first..first + count]);
            for row in laplacian(size, unknown) {
                let difference: f64 = row.iter().map(|&(column, entry)| entry * values[column]).sum();
                sum += weights.laplacian * difference.powi(2);
            }
            for (value, _) in values.iter().zip(unknown).filter(|&(_, &unknown)| unknown) {
                sum += weights.zero * value.powi(2) + weights.one * (value - 1.0).powi(2);
            }
        }
        0.5 * sum
    }

    /// The dense system.
    #[must_use]
    pub fn normal(&self) -> Normal {
        let columns: Vec<usize> = (0..self.unknown.len()).filter(|&column| self.unknown[column]).collect();
        let mut number = vec![None; self.unknown.len()];
        for (i, &column) in columns.iter().enumerate() {
            number[column] = Some(i);
        }
        let mut matrix = vec![vec![0.0; columns.len()]; columns.len()];
        let mut right = vec![0.0; columns.len()];
        let mut add = |row: &[(usize, f64)], first: usize, weight: f64, target: f64| {
            for &(column, entry) in row {
                let Some(i) = number[first + column] else { continue };
                right[i] += weight * entry * target;
                for &(other, factor) in row {
                    if let Some(j) = number[first + other] {
                        matrix[i][j] += weight * entry * factor;
                    }
                }
            }
        };
        for ((row, &target), &weight) in self.matrix.rows.iter().zip(self.targets).zip(self.weights) {
            add(row, 0, weight, target);
        }
        for (first, size, weights) in self.regularised() {
            let count: usize = size.iter().product();
            for row in laplacian(size, &self.unknown[first..first + count]) {
                add(&row, first, weights.laplacian, 0.0);
            }
            for index in 0..count {
                add(&[(index, 1.0)], first, weights.zero, 0.0);
                add(&[(index, 1.0)], first, weights.one, 1.0);
            }
        }
        Normal { matrix, right, columns, total: self.unknown.len(), scale: self.scale() }
    }
}

impl Normal {
    /// All columns of W from the unknown values; 0 elsewhere.
    #[must_use]
    pub fn expand(&self, solution: &[f64]) -> Vec<f64> {
        let mut values = vec![0.0; self.total];
        for (&column, value) in self.columns.iter().zip(solution) {
            values[column] = *value;
        }
        values
    }

    /// The unknown values of all columns of W.
    #[must_use]
    pub fn restrict(&self, values: &[f64]) -> Vec<f64> {
        self.columns.iter().map(|&column| values[column]).collect()
    }

    /// The gradient of f: matrix times values less the right-hand side.
    #[must_use]
    pub fn gradient(&self, solution: &[f64]) -> Vec<f64> {
        let row =
            |row: &Vec<f64>| -> f64 { row.iter().zip(solution).map(|(entry, value)| entry * value).sum() };
        self.matrix.iter().zip(&self.right).map(|(entries, right)| row(entries) - right).collect()
    }

    /// The unbounded solution, of the unknown values; none where values do not follow from the pixels and nothing else is
    /// known of them.
    #[must_use]
    pub fn solve(&self) -> Option<Vec<f64>> {
        cholesky(&self.matrix, &self.right)
    }
}

/// The solution of a symmetric positive definite system; none for any other.
pub(super) fn cholesky(matrix: &Dense, right: &[f64]) -> Option<Vec<f64>> {
    let n = right.len();
    let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    let mut lower: Dense = vec![vec![0.0; n]; n];
    for i in 0..n {
        for j in 0..=i {
            let left = matrix[i][j] - dot(&lower[i][..j], &lower[j][..j]);
            lower[i][j] = if i == j {
                // Less is what rounding leaves of a singular matrix.
                if left <= 1e-14 * matrix[i][i] || !left.is_finite() {
                    return None;
                }
                left.sqrt()
            } else {
                left / lower[j][j]
            };
        }
    }
    let mut solution = right.to_vec();
    for i in 0..n {
        solution[i] = (solution[i] - dot(&lower[i][..i], &solution[..i])) / lower[i][i];
    }
    for i in (0..n).rev() {
        let later: f64 = (i + 1..n).map(|j| lower[j][i] * solution[j]).sum();
        solution[i] = (solution[i] - later) / lower[i][i];
    }
    Some(solution)
}

#[cfg(test)]
mod tests;
