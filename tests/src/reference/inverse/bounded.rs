// SPDX-License-Identifier: MIT OR Apache-2.0
//! Least squares between bounds, exactly: which values are at a bound is found by freeing and fixing them one at a time, each
//! time with a direct solution (after Stark and Parker 1995, "Bounded-variable least squares").

use super::least_squares::{Dense, Normal, cholesky};

/// The values between 0 and `upper` (which may be infinite) for which f is least, for a positive definite system. None for
/// any other, or where rounding keeps the bounds undecided.
#[must_use]
pub fn bounded(normal: &Normal, upper: f64) -> Option<Vec<f64>> {
    if (0..normal.right.len()).any(|i| normal.matrix[i][i] <= 0.0) {
        return None;
    }
    decided(normal, upper, descended(normal, upper, 200))
}

/// Somewhere near the solution, by cyclic descent: every value in turn to where f is least.
fn descended(normal: &Normal, upper: f64, rounds: usize) -> Vec<f64> {
    let mut values = vec![0.0; normal.right.len()];
    for _ in 0..rounds {
        for i in 0..values.len() {
            let row = &normal.matrix[i];
            let product: f64 = row.iter().zip(&values).map(|(entry, value)| entry * value).sum();
            values[i] = (values[i] - (product - normal.right[i]) / row[i]).clamp(0.0, upper);
        }
    }
    values
}

/// The solution from any values between the bounds.
fn decided(normal: &Normal, upper: f64, mut values: Vec<f64>) -> Option<Vec<f64>> {
    let (matrix, n) = (&normal.matrix, normal.right.len());
    let mut free: Vec<bool> = values.iter().map(|&value| value > 0.0 && value < upper).collect();
    let scale = normal.right.iter().fold(f64::MIN_POSITIVE, |most, right| most.max(right.abs()));
    for _ in 0..20 * n + 20 {
        let wanted = solve_free(matrix, &normal.right, &values, &free)?;
        // As far towards the solution of the free values as the bounds allow; the one that stops it is fixed.
        let mut reach = 1.0;
        let mut stop = None;
        for i in (0..n).filter(|&i| wanted[i] < 0.0 || wanted[i] > upper) {
            let bound = if wanted[i] < 0.0 { 0.0 } else { upper };
            let share = (bound - values[i]) / (wanted[i] - values[i]);
            if share < reach {
                (reach, stop) = (share, Some((i, bound)));
            }
        }
        if let Some((fixed, bound)) = stop {
            for (value, wanted) in values.iter_mut().zip(&wanted) {
                *value = (*value + reach * (wanted - *value)).clamp(0.0, upper);
            }
            values[fixed] = bound;
            free[fixed] = false;
            continue;
        }
        values = wanted;
        let gradient = normal.gradient(&values);
        let drive = |i: usize| if values[i] > 0.0 { gradient[i] } else { -gradient[i] };
        let most = (0..n).filter(|&i| !free[i]).max_by(|&i, &j| drive(i).total_cmp(&drive(j)));
        match most {
            Some(i) if drive(i) > 1e-13 * scale => free[i] = true,
            _ => return Some(values),
        }
    }
    None
}

/// The free values for which f is least with the others as they are.
fn solve_free(matrix: &Dense, right: &[f64], values: &[f64], free: &[bool]) -> Option<Vec<f64>> {
    let numbers: Vec<usize> = (0..values.len()).filter(|&i| free[i]).collect();
    let sub = numbers.iter().map(|&i| numbers.iter().map(|&j| matrix[i][j]).collect()).collect();
    let rest: Vec<f64> = numbers
        .iter()
        .map(|&i| {
            let fixed = (0..values.len()).filter(|&j| !free[j]).map(|j| matrix[i][j] * values[j]);
            right[i] - fixed.sum::<f64>()
        })
        .collect();
    let solution = cholesky(&sub, &rest)?;
    let mut all = values.to_vec();
    for (&i, value) in numbers.iter().zip(solution) {
        all[i] = value;
    }
    Some(all)
}

/// By how much values between 0 and `upper` miss the conditions of Karush, Kuhn and Tucker, in units of the gradient: free
/// values have none, those at 0 none below 0, those at `upper` none above. Infinite for values out of bounds.
#[must_use]
pub fn kkt_violation(normal: &Normal, values: &[f64], upper: f64) -> f64 {
    let violation = |(&value, slope): (&f64, f64)| {
        if !(0.0..=upper).contains(&value) {
            f64::INFINITY
        } else if value == 0.0 {
            (-slope).max(0.0)
        } else if value == upper {
            slope.max(0.0)
        } else {
            slope.abs()
        }
    };
    values.iter().zip(normal.gradient(values)).map(violation).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests;
