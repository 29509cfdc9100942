// SPDX-License-Identifier: MIT OR Apache-2.0
//! Bounded solutions against all sets of bounds, and by the conditions that mark them.

use super::super::tests::{medium, numbers, paths};
use super::super::{Basis, Matrix, Part, Problem, Property, Regulariser};
use super::*;

/// A definite system whose unbounded solution has values on all sides of 0..1.
fn system(n: usize, seed: u64) -> Normal {
    let mut numbers = numbers(seed);
    let factor: Dense =
        (0..n).map(|_| numbers.by_ref().take(n).map(|number| number - 0.4).collect()).collect();
    let entry = |i: usize, j: usize| {
        let product: f64 = (0..n).map(|k| factor[k][i] * factor[k][j]).sum();
        product + if i == j { 0.05 } else { 0.0 }
    };
    let matrix = (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect();
    let right = numbers.take(n).map(|number| 1.5 * number - 0.5).collect();
    Normal { matrix, right, columns: (0..n).collect(), total: n, scale: 1.0 }
}

fn cost(normal: &Normal, values: &[f64]) -> f64 {
    let sides = normal.gradient(values).into_iter().zip(&normal.right).zip(values);
    sides.map(|((slope, right), value)| 0.5 * value * (slope - right)).sum()
}

#[test]
fn it_is_the_best_of_all_sets_of_bounds() {
    let n = 6;
    let mut at_bounds = 0;
    for seed in 1..30 {
        let normal = system(n, seed);
        let found = bounded(&normal, 1.0).expect("decided");
        let mut least = f64::INFINITY;
        let mut best = Vec::new();
        // Each value free, at 0 or at 1.
        for set in 0..3_usize.pow(n as u32) {
            let state = |i: usize| set / 3_usize.pow(i as u32) % 3;
            let values: Vec<f64> = (0..n).map(|i| if state(i) == 2 { 1.0 } else { 0.0 }).collect();
            let free: Vec<bool> = (0..n).map(|i| state(i) == 0).collect();
            let values = solve_free(&normal.matrix, &normal.right, &values, &free).expect("definite");
            let inside = values.iter().all(|value| (0.0..=1.0).contains(value));
            if inside && cost(&normal, &values) < least {
                (least, best) = (cost(&normal, &values), values);
            }
        }
        assert!(found.iter().zip(&best).all(|(a, b)| (a - b).abs() < 1e-10), "{found:?} {best:?}");
        assert!(kkt_violation(&normal, &found, 1.0) < 1e-12);
        at_bounds += u32::from(found.contains(&0.0) && found.contains(&1.0));
    }
    assert!(at_bounds > 5, "{at_bounds}");
}

#[test]
fn it_is_the_same_from_wherever_one_begins() {
    for (seed, upper) in [(1, 1.0), (2, 0.3), (3, f64::INFINITY), (4, 1.0)] {
        let normal = system(40, seed);
        let found = bounded(&normal, upper).expect("decided");
        assert!(found.iter().filter(|&&value| value == 0.0).count() > 5);
        let most = upper.min(2.0);
        let inside = numbers(seed).take(40).map(|number| number * most).collect();
        for begin in [vec![0.0; 40], vec![most; 40], inside, descended(&normal, upper, 3)] {
            let other = decided(&normal, upper, begin).expect("decided");
            assert!(found.iter().zip(&other).all(|(a, b)| (a - b).abs() < 1e-9));
            assert!(kkt_violation(&normal, &other, upper) < 1e-12);
        }
        // What descent finds goes towards the same.
        let near = descended(&normal, upper, 100_000);
        assert!(found.iter().zip(&near).all(|(a, b)| (a - b).abs() < 1e-6));
    }
}

#[test]
fn without_need_of_bounds_it_is_the_free_solution() {
    let mut normal = system(8, 3);
    let known: Vec<f64> = numbers(6).take(8).collect();
    normal.right = vec![0.0; 8];
    normal.right = normal.gradient(&known);
    let found = bounded(&normal, 1.0).expect("decided");
    assert!(found.iter().zip(&known).all(|(a, b)| (a - b).abs() < 1e-11), "{found:?} {known:?}");
}

#[test]
fn pictures_that_nothing_makes_have_bounded_solutions() {
    let part = |property, basis| Part { property, size: [4, 4, 4], basis };
    for (property, basis, upper) in [
        (Property::Emission, Basis::Trilinear, f64::INFINITY),
        (Property::Albedo, Basis::Box, 1.0),
        (Property::Extinction, Basis::Trilinear, f64::INFINITY),
    ] {
        let matrices = paths().map(|rays| Matrix::new(&rays, &medium(), &[part(property, basis)]));
        let matrix = Matrix::stacked(&matrices);
        let mut numbers = numbers(17);
        let mut take = |count: usize| -> Vec<f64> { numbers.by_ref().take(count).collect() };
        let (targets, weights) = (take(60), take(60));
        let problem = Problem {
            matrix: &matrix,
            targets: &targets,
            weights: &weights,
            unknown: &[true; 64],
            regularisers: &[Regulariser { laplacian: 1e-3, zero: 1e-3, one: 0.0 }],
        };
        let normal = problem.normal();
        let found = bounded(&normal, upper).expect("decided");
        assert!(kkt_violation(&normal, &found, upper) < 1e-12);
        let free = normal.solve().expect("regularised");
        assert!(free.iter().any(|value| *value < 0.0) && kkt_violation(&normal, &free, upper).is_infinite());
        let clamped: Vec<f64> = free.iter().map(|value| value.clamp(0.0, upper)).collect();
        let least = problem.cost(&found);
        assert!(problem.cost(&free) < least && problem.cost(&clamped) > 1.001 * least);
        for towards in [clamped, vec![0.5; 64], take(64)] {
            let step: Vec<f64> = found.iter().zip(&towards).map(|(a, b)| a + 0.01 * (b - a)).collect();
            assert!(problem.cost(&step) > least);
        }
    }
}

#[test]
fn violations_are_those_of_the_bounds() {
    let normal = Normal { matrix: vec![vec![2.0]], right: vec![1.0], columns: vec![0], total: 1, scale: 1.0 };
    let violations = [0.0, 0.5, 1.0, 1.5, -0.1].map(|value| kkt_violation(&normal, &[value], 1.0));
    assert_eq!(violations, [1.0, 0.0, 1.0, f64::INFINITY, f64::INFINITY]);
    assert_eq!(kkt_violation(&normal, &[0.25], 0.25), 0.0);
    assert_eq!(kkt_violation(&Normal { right: vec![-1.0], ..normal }, &[0.0], 1.0), 0.0);
}
