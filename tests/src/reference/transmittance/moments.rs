// SPDX-License-Identifier: MIT OR Apache-2.0
//! Transmittance from moments of optical depth: the distribution with the given moments and most weight at a depth has
//! its other weights at the roots of a polynomial. Systems by elimination, roots by bisection.

use super::Profile;
use std::f64::consts::PI;

/// Solves `matrix x = right` by elimination with pivots.
fn solve(mut matrix: Vec<Vec<f64>>, mut right: Vec<f64>) -> Vec<f64> {
    let n = right.len();
    for column in 0..n {
        let larger = |a: &usize, b: &usize| matrix[*a][column].abs().total_cmp(&matrix[*b][column].abs());
        let pivot = (column..n).max_by(larger).unwrap_or(column);
        matrix.swap(column, pivot);
        right.swap(column, pivot);
        let above = matrix[column].clone();
        let known = right[column];
        for (row, (entries, value)) in matrix.iter_mut().zip(&mut right).enumerate() {
            if row != column {
                let factor = entries[column] / above[column];
                entries.iter_mut().zip(&above).for_each(|(entry, from)| *entry -= factor * from);
                *value -= factor * known;
            }
        }
    }
    (0..n).map(|i| right[i] / matrix[i][i]).collect()
}

/// Zeros of a continuous function between `from` and `to`.
fn zeros(function: impl Fn(f64) -> f64, from: f64, to: f64) -> Vec<f64> {
    const CELLS: usize = 20_000;
    let at = |i: usize| from + (to - from) * i as f64 / CELLS as f64;
    let mut found = Vec::new();
    for i in 0..CELLS {
        let (mut low, mut high) = (at(i), at(i + 1));
        let sign = function(low) > 0.0;
        if sign == (function(high) > 0.0) {
            continue;
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if (function(middle) > 0.0) == sign { low = middle } else { high = middle }
        }
        found.push(0.5 * (low + high));
    }
    found
}

/// Transmittance from the near side to `x` metres by the total and six power moments. `bias`: share of the density
/// 1 / (π √(1 − z²)); `overestimation`: part of the weight at `x` itself that lies before it.
#[must_use]
pub fn power_transmittance(profile: &Profile, x: f64, bias: f64, overestimation: f64) -> f64 {
    let signed = |x: f64| 2.0 * x / profile.range - 1.0;
    let total = profile.integral(|_| 1.0);
    if total <= 0.0 {
        return 1.0;
    }
    let even = [1.0, 0.0, 0.5, 0.0, 0.375, 0.0, 0.3125];
    let moment = |k: usize| profile.integral(|x| signed(x).powi(k as i32)) / total;
    let moments: Vec<f64> = (0..7).map(|k| (1.0 - bias) * moment(k) + bias * even[k]).collect();
    let hankel: Vec<Vec<f64>> = (0..4).map(|i| (0..4).map(|j| moments[i + j]).collect()).collect();
    let powers = |z: f64| (0..4).map(|k| z.powi(k)).collect::<Vec<f64>>();
    let dual = |z: f64| solve(hankel.clone(), powers(z));
    let kernel = |dual: &[f64], z: f64| dual.iter().zip(powers(z)).map(|(a, b)| a * b).sum::<f64>();
    let weight = |z: f64| 1.0 / kernel(&dual(z), z);
    let z = signed(x);
    let own = dual(z);
    // Roots beyond the range come from both sides of infinity: in 1 / z.
    let inside = zeros(|z| kernel(&own, z), -1.0, 1.0);
    let flipped = |t: f64| own[0] * t.powi(3) + own[1] * t * t + own[2] * t + own[3];
    let outside = zeros(flipped, -1.0, 1.0).into_iter().map(|t| 1.0 / t);
    let nodes = inside.into_iter().chain(outside);
    let before: f64 = nodes.filter(|node| *node < z).map(weight).sum();
    (-total * (before + overestimation * weight(z))).exp()
}

/// Transmittance from the near side to `x` metres by the total and two complex trigonometric moments of the phase
/// `(2 π − gap) x / d`. `bias`: share of an even density; roots in the gap count as before by how much of it lies before them.
#[must_use]
pub fn trigonometric_transmittance(
    profile: &Profile,
    x: f64,
    gap: f64,
    bias: f64,
    overestimation: f64,
) -> f64 {
    let arc = 2.0 * PI - gap;
    let total = profile.integral(|_| 1.0);
    if total <= 0.0 {
        return 1.0;
    }
    let mean = |value: &dyn Fn(f64) -> f64| {
        (1.0 - bias) * profile.integral(|x| value(arc * x / profile.range)) / total
    };
    let cosine = |k: i32| if k == 0 { 1.0 } else { mean(&|p| (f64::from(k) * p).cos()) };
    let sine = |k: i32| mean(&|p| (f64::from(k) * p).sin());
    // C_jk = mean of exp(i (j - k) phase), as a real matrix of twice the size.
    let real: Vec<Vec<f64>> = (0..3).map(|j| (0..3).map(|k| cosine(j - k)).collect()).collect();
    let imaginary: Vec<Vec<f64>> = (0..3).map(|j| (0..3).map(|k| sine(j - k)).collect()).collect();
    let mut matrix = vec![vec![0.0; 6]; 6];
    for j in 0..3 {
        for k in 0..3 {
            matrix[j][k] = real[j][k];
            matrix[j + 3][k + 3] = real[j][k];
            matrix[j][k + 3] = -imaginary[j][k];
            matrix[j + 3][k] = imaginary[j][k];
        }
    }
    let powers = |p: f64| -> Vec<f64> {
        let angle = |k: usize| k as f64 * p;
        (0..3).map(|k| angle(k).cos()).chain((0..3).map(|k| angle(k).sin())).collect()
    };
    // e(r)* C^-1 e(s), turned by exp(i (r - s)), is real.
    let kernel = |dual: &[f64], r: f64, s: f64| -> f64 {
        (0..3)
            .map(|k| {
                let angle = r - s - k as f64 * r;
                dual[k] * angle.cos() - dual[k + 3] * angle.sin()
            })
            .sum()
    };
    let weight = |p: f64| 1.0 / kernel(&solve(matrix.clone(), powers(p)), p, p);
    let phase = arc * x / profile.range;
    let own = solve(matrix.clone(), powers(phase));
    let share = |node: f64| {
        if node > arc { (node - arc) / gap } else { f64::from(u8::from(node < phase)) }
    };
    let nodes = zeros(|r| kernel(&own, r, phase), 0.0, 2.0 * PI);
    let before: f64 = nodes.iter().map(|node| weight(*node) * share(*node)).sum();
    (-total * (before + overestimation * weight(phase))).exp()
}

#[cfg(test)]
mod tests {
    use super::super::Stretch;
    use super::*;

    #[test]
    fn two_sheets_are_exact_between_and_behind_them() {
        let sheet = |at: f64, depth: f64| Stretch { from: at, to: at + 1e-6, extinction: depth * 1e6 };
        let profile = Profile { range: 10.0, stretches: vec![sheet(3.0, 0.7), sheet(6.5, 1.2)] };
        for (x, expected) in [(1.0, 0.0_f64), (4.5, 0.7), (9.0, 1.9)] {
            let expected = (-expected).exp();
            let power = power_transmittance(&profile, x, 1e-9, 0.25);
            let trigonometric = trigonometric_transmittance(&profile, x, 0.3, 1e-9, 0.25);
            assert!((power - expected).abs() < 1e-4, "{x}: {power} instead of {expected}");
            assert!((trigonometric - expected).abs() < 1e-4, "{x}: {trigonometric} instead of {expected}");
        }
    }
}
