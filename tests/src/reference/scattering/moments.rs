// SPDX-License-Identifier: MIT OR Apache-2.0
//! Six moments of stored depths and the visibility that they bound (Peters, Münstermann, Wetzstein and Klein, JCGT 6(1),
//! 2017): the distribution with the given moments that puts most weight at the ray's depth has it there and at three other
//! depths, the roots of a cubic.
//!
//! In power moments: the 4x4 Hankel system by elimination, the roots by bisection between extrema, and the weights
//! from the Vandermonde system.

use super::slice::GUARD;

/// Depth [0, 1] to [−1, 1]: all blockers that lie farther than 0.01 beyond every view ray are the same.
#[must_use]
pub fn signed_depth(depth: f64) -> f64 {
    let half = 0.5 * (GUARD[1] - GUARD[0]) + 0.01;
    ((depth - 0.5) / half).clamp(-1.0, 1.0)
}

/// Means of `cos(k acos z)`, `k` from 1 to 6, over signed depths `z` with weights.
#[must_use]
pub fn chebyshev_moments(depths: impl IntoIterator<Item = (f64, f64)>) -> [f64; 6] {
    let mut sums = [0.0; 6];
    let mut total = 0.0;
    for (depth, weight) in depths {
        let angle = signed_depth(depth).acos();
        for (k, sum) in sums.iter_mut().enumerate() {
            *sum += weight * ((k + 1) as f64 * angle).cos();
        }
        total += weight;
    }
    sums.map(|sum| sum / total)
}

/// Means of `z^k`, `k` from 0 to 6, from those of the Chebyshev polynomials, by their printed coefficients.
fn power_moments(t: &[f64; 6]) -> [f64; 7] {
    let [a, b, c, d, e, f] = *t;
    [
        1.0,
        a,
        (b + 1.0) / 2.0,
        (c + 3.0 * a) / 4.0,
        (d + 4.0 * b + 3.0) / 8.0,
        (e + 5.0 * c + 10.0 * a) / 16.0,
        (f + 6.0 * d + 15.0 * b + 10.0) / 32.0,
    ]
}

/// Solves `matrix x = right` by elimination with pivots.
fn solve(mut matrix: Vec<Vec<f64>>, mut right: Vec<f64>) -> Vec<f64> {
    let n = right.len();
    for column in 0..n {
        let pivot = (column..n)
            .max_by(|a, b| matrix[*a][column].abs().total_cmp(&matrix[*b][column].abs()))
            .unwrap_or(column);
        matrix.swap(column, pivot);
        right.swap(column, pivot);
        let above = matrix[column].clone();
        for row in column + 1..n {
            let factor = matrix[row][column] / above[column];
            for (entry, subtracted) in matrix[row].iter_mut().zip(&above) {
                *entry -= factor * subtracted;
            }
            right[row] -= factor * right[column];
        }
    }
    for row in (0..n).rev() {
        for k in row + 1..n {
            right[row] -= matrix[row][k] * right[k];
        }
        right[row] /= matrix[row][row];
    }
    right
}

fn value(coefficients: &[f64], z: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * z + c)
}

/// The real roots within ±`bound` of a polynomial, by bisection between the roots of its derivative.
fn roots(coefficients: &[f64], bound: f64) -> Vec<f64> {
    if coefficients.len() < 2 {
        return Vec::new();
    }
    let derivative: Vec<f64> = coefficients.iter().enumerate().skip(1).map(|(k, c)| k as f64 * c).collect();
    let mut edges = vec![-bound];
    edges.extend(roots(&derivative, bound));
    edges.push(bound);
    let mut found = Vec::new();
    for pair in edges.windows(2) {
        let (mut low, mut high) = (pair[0], pair[1]);
        let rising = value(coefficients, low) < 0.0;
        if rising == (value(coefficients, high) < 0.0) {
            continue;
        }
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if (value(coefficients, middle) < 0.0) == rising { low = middle } else { high = middle }
        }
        found.push(0.5 * (low + high));
    }
    found
}

/// Least and greatest mean visibility of a ray at `depth` [0, 1] that stored depths with these Chebyshev moments allow,
/// after a share `bias` of the density `1 / (π √(1 − z²))` is mixed into them. A bias of 0 wants four depths or more.
#[must_use]
pub fn visibility_bounds(moments: &[f64; 6], bias: f64, depth: f64) -> (f64, f64) {
    // The Chebyshev moments of that density are 0.
    let power = power_moments(&moments.map(|m| (1.0 - bias) * m));
    let z = signed_depth(depth);
    let hankel = (0..4).map(|j| power[j..j + 4].to_vec()).collect();
    let cubic = solve(hankel, (0..4).map(|k| z.powi(k)).collect());
    // A root so far away carries no weight.
    let mut nodes = roots(&cubic, 1e3);
    nodes.push(z);
    let vandermonde = (0..nodes.len()).map(|j| nodes.iter().map(|x| x.powi(j as i32)).collect()).collect();
    let weights = solve(vandermonde, power[..nodes.len()].to_vec());
    let before: f64 = nodes.iter().zip(&weights).filter(|(x, _)| **x < z).map(|(_, w)| w).sum();
    let own = weights.last().copied().unwrap_or(0.0);
    (1.0 - before - own, 1.0 - before)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Share of the weights at depths at or beyond `depth`.
    fn share(atoms: &[(f64, f64)], depth: f64) -> f64 {
        let total: f64 = atoms.iter().map(|a| a.1).sum();
        atoms.iter().filter(|a| signed_depth(a.0) >= signed_depth(depth)).map(|a| a.1).sum::<f64>() / total
    }

    struct Numbers(u64);

    impl Numbers {
        fn unit(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        }
    }

    #[test]
    fn moments_of_one_depth_are_cosines() {
        for depth in [0.04, 0.3, 0.5, 0.77, 0.96] {
            let z = signed_depth(depth);
            let power = power_moments(&chebyshev_moments([(depth, 2.0)]));
            for (k, found) in power.iter().enumerate() {
                assert!((found - z.powi(k as i32)).abs() < 1e-14);
            }
        }
        assert_eq!((signed_depth(0.0), signed_depth(0.5), signed_depth(1.0)), (-1.0, 0.0, 1.0));
    }

    #[test]
    fn the_bias_is_a_density() {
        const COUNT: usize = 1000;
        let half = 0.46;
        let points = (0..COUNT).map(|i| {
            let angle = std::f64::consts::PI * (i as f64 + 0.5) / COUNT as f64;
            (0.5 + half * angle.cos(), 1.0)
        });
        assert!(chebyshev_moments(points).iter().all(|m| m.abs() < 1e-12));
    }

    #[test]
    fn up_to_three_depths_are_reproduced() {
        let mut numbers = Numbers(1);
        for count in 1..=3 {
            for _ in 0..200 {
                let slot = 0.8 / f64::from(count);
                let atoms: Vec<_> = (0..count)
                    .map(|i| (0.1 + slot * (f64::from(i) + 0.3 + 0.4 * numbers.unit()), 0.1 + numbers.unit()))
                    .collect();
                let moments = chebyshev_moments(atoms.iter().copied());
                for i in 0..=90 {
                    let depth = 0.05 + f64::from(i) / 100.0;
                    if atoms.iter().any(|a| (a.0 - depth).abs() < 0.05) {
                        continue;
                    }
                    // Without any bias the matrix is singular.
                    let (low, high) = visibility_bounds(&moments, 1e-10, depth);
                    let expected = share(&atoms, depth);
                    assert!((low - expected).abs() < 1e-3 && (high - expected).abs() < 1e-3);
                }
            }
        }
    }

    #[test]
    fn four_depths_are_exact_at_each() {
        let atoms = [(0.15, 0.1), (0.4, 0.4), (0.6, 0.2), (0.85, 0.3)];
        let moments = chebyshev_moments(atoms);
        for (depth, weight) in atoms {
            let (low, high) = visibility_bounds(&moments, 0.0, depth);
            assert!((high - share(&atoms, depth)).abs() < 1e-9, "{high}");
            assert!((high - low - weight).abs() < 1e-9, "{low} {high}");
        }
    }

    #[test]
    fn bounds_hold_the_truth() {
        let mut numbers = Numbers(2);
        let mut closest = f64::INFINITY;
        for _ in 0..2000 {
            let count = 4 + (numbers.unit() * 40.0) as usize;
            let atoms: Vec<_> = (0..count).map(|_| (numbers.unit(), numbers.unit())).collect();
            let moments = chebyshev_moments(atoms.iter().copied());
            for _ in 0..20 {
                let depth = 0.05 + 0.9 * numbers.unit();
                let (low, high) = visibility_bounds(&moments, 1e-7, depth);
                let expected = share(&atoms, depth);
                assert!(low <= expected + 1e-5 && expected <= high + 1e-5, "{low} {expected} {high}");
                closest = closest.min(high - expected).min(expected - low);
            }
        }
        assert!(closest < 0.01, "the bounds are attained: {closest}");
    }
}
