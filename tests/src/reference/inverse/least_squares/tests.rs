// SPDX-License-Identifier: MIT OR Apache-2.0
//! Solutions by what must hold for them.

use super::super::tests::{medium, numbers, paths};
use super::super::{Basis, ExtinctionTargets, Grid, Medium, Part, Property, Row, touched};
use super::*;

const EMISSION: Part = Part { property: Property::Emission, size: [3, 4, 2], basis: Basis::Trilinear };
const ALBEDO: Part = Part { property: Property::Albedo, size: [2, 2, 3], basis: Basis::Box };
const REGULARISERS: [Regulariser; 2] = [
    Regulariser { laplacian: 0.02, zero: 0.003, one: 0.0 },
    Regulariser { laplacian: 0.05, zero: 0.0, one: 0.004 },
];

fn assert_near(found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() <= tolerance, "{found} instead of {expected}");
    }
}

fn both() -> Matrix {
    let [straight, bent] = paths();
    let matrix = |rays: &[_]| Matrix::new(rays, &medium(), &[EMISSION, ALBEDO]);
    Matrix::stacked(&[matrix(&straight), matrix(&bent)])
}

/// Targets that nothing meets, uneven weights, a few values known.
fn inconsistent() -> (Vec<f64>, Vec<f64>, Vec<bool>) {
    let mut numbers = numbers(21);
    let mut take = |count: usize| -> Vec<f64> { numbers.by_ref().take(count).collect() };
    let (targets, weights) = (take(60), take(60));
    (targets, weights, (0..36).map(|column| column % 7 != 3).collect())
}

#[test]
fn cholesky_solves_definite_systems_and_no_others() {
    let matrix = vec![vec![4.0, 2.0, -2.0], vec![2.0, 10.0, 2.0], vec![-2.0, 2.0, 6.0]];
    let solution = cholesky(&matrix, &[-2.0, 16.0, 17.0]).expect("definite");
    for (row, right) in matrix.iter().zip([-2.0, 16.0, 17.0]) {
        let left: f64 = row.iter().zip(&solution).map(|(entry, value)| entry * value).sum();
        assert!((left - right).abs() < 1e-14);
    }
    assert!(cholesky(&vec![vec![1.0, 2.0], vec![2.0, 4.0]], &[1.0, 2.0]).is_none());
    assert!(cholesky(&vec![vec![1.0, 2.0], vec![2.0, 1.0]], &[1.0, 2.0]).is_none());
    assert!(cholesky(&vec![vec![0.0]], &[0.0]).is_none());
}

#[test]
fn laplacians_add_up_to_zero_and_measure_curvature() {
    let size = [5, 4, 6];
    let rows = laplacian(size, &[true; 120]);
    for (index, row) in rows.iter().enumerate() {
        assert_eq!(row.iter().map(|&(_, entry)| entry).sum::<f64>(), 0.0);
        let [x, y, z] = voxel(size, index).map(|i| i as f64);
        let values = |other: usize| {
            let [x, y, z] = voxel(size, other).map(|i| i as f64);
            x * x - 3.0 * y * y + 0.5 * z * z + x * y - 2.0 * z
        };
        let found: f64 = row.iter().map(|&(column, entry)| entry * values(column)).sum();
        // At the faces the difference to the missing neighbour is left out.
        let quadratic = |at: f64, last: f64, square: f64, line: f64| {
            let [mut sum, step] = [0.0, 1.0];
            for step in [-step, step] {
                if at + step >= 0.0 && at + step <= last {
                    sum += square * ((at + step).powi(2) - at * at) + line * step;
                }
            }
            sum
        };
        let expected = quadratic(x, 4.0, 1.0, y) + quadratic(y, 3.0, -3.0, x) + quadratic(z, 5.0, 0.5, -2.0);
        assert!((found - expected).abs() < 1e-12);
    }
    let unknown: Vec<bool> = (0..120).map(|index| index % 3 == 0).collect();
    for (index, row) in laplacian(size, &unknown).iter().enumerate() {
        assert!(row.iter().all(|&(column, _)| unknown[column]) && row.is_empty() != unknown[index]);
    }
}

#[test]
fn the_gradient_is_that_of_the_function_and_none_at_the_solution() {
    let matrix = both();
    let (targets, weights, unknown) = inconsistent();
    let (targets, weights) = (&targets[..], &weights[..]);
    let problem =
        Problem { matrix: &matrix, targets, weights, unknown: &unknown, regularisers: &REGULARISERS };
    let normal = problem.normal();
    let place: Vec<f64> = numbers(4).take(normal.right.len()).collect();
    for (i, slope) in normal.gradient(&place).iter().enumerate() {
        let beside = |step: f64| {
            let mut place = place.clone();
            place[i] += step;
            problem.cost(&normal.expand(&place))
        };
        // Central differences of a quadratic function are exact.
        assert!((beside(0.5) - beside(-0.5) - slope).abs() < 1e-12);
    }
    // The same from the matrix's own two ways.
    let solution = normal.solve().expect("regularised");
    let values = normal.expand(&solution);
    assert!(values.iter().zip(&unknown).all(|(value, unknown)| *unknown || *value == 0.0));
    let residual: Vec<f64> =
        matrix.apply(&values).iter().zip(targets).zip(weights).map(|((a, o), c)| c * (a - o)).collect();
    let mut gradient = matrix.apply_transposed(&residual);
    for (first, size, own) in [(0, EMISSION.size, REGULARISERS[0]), (24, ALBEDO.size, REGULARISERS[1])] {
        let count: usize = size.iter().product();
        let rows = laplacian(size, &unknown[first..first + count]);
        for row in &rows {
            let curvature: f64 = row.iter().map(|&(column, entry)| entry * values[first + column]).sum();
            for &(column, entry) in row {
                gradient[first + column] += normal.scale * own.laplacian * curvature * entry;
            }
        }
        for index in first..first + count {
            gradient[index] += normal.scale * (own.zero * values[index] + own.one * (values[index] - 1.0));
        }
    }
    assert!(normal.restrict(&gradient).iter().all(|slope| slope.abs() < 1e-14), "{gradient:?}");
    assert!(residual.iter().any(|residual| residual.abs() > 0.01));
}

#[test]
fn regularisers_are_measured_by_the_columns() {
    let matrix = both();
    let (targets, weights, _) = inconsistent();
    let (targets, weights) = (&targets[..], &weights[..]);
    let unknown = [true; 36];
    let problem =
        Problem { matrix: &matrix, targets, weights, unknown: &unknown, regularisers: &REGULARISERS };
    let mut sum = 0.0;
    for i in 0..36 {
        for j in 0..36 {
            let products = (0..60).map(|row| weights[row] * matrix.entry(row, i) * matrix.entry(row, j));
            sum += products.sum::<f64>();
        }
    }
    assert!((problem.scale() / (sum / 36.0) - 1.0).abs() < 1e-13);
    let solve = |laplacian: f64, zero: f64, one: f64| {
        let own = Regulariser { laplacian, zero, one };
        Problem { regularisers: &[own, own], ..problem }.normal().solve().expect("regularised")
    };
    assert_near(&solve(0.0, 0.0, 1e9), &[1.0; 36], 1e-6);
    assert_near(&solve(0.0, 1e9, 0.0), &[0.0; 36], 1e-6);
    assert_near(&solve(0.0, 1e9, 3e9), &[0.75; 36], 1e-6);
    let smooth = solve(1e6, 1e-3, 0.0);
    assert_near(&smooth[..24], &[smooth[0]; 24], 1e-4);
    assert_near(&smooth[24..], &[smooth[24]; 12], 1e-4);
    assert!((smooth[0] - smooth[24]).abs() > 0.01, "each part has neighbours of its own");
    assert!(
        Problem { regularisers: &[Regulariser::default(); 2], weights: &[0.0; 60], ..problem }
            .normal()
            .solve()
            .is_none()
    );
}

#[test]
fn emission_and_albedo_are_found_in_their_pictures() {
    let emission = Part { size: [2, 2, 2], ..EMISSION };
    let albedo = Part { size: [2, 1, 2], ..ALBEDO };
    let [straight, bent] = paths();
    let [straight, bent] = [straight, bent].map(|rays| Matrix::new(&rays, &medium(), &[emission, albedo]));
    let matrix = Matrix::stacked(&[straight, bent]);
    let known: Vec<f64> = numbers(8).take(12).collect();
    let behind = [0.7; 60];
    let picture = matrix.picture(&known, &behind);
    let through = matrix.transmittance.iter().zip(behind);
    let targets: Vec<f64> = picture.iter().zip(through).map(|(l, (t, behind))| l - t * behind).collect();
    let problem = Problem {
        matrix: &matrix,
        targets: &targets,
        weights: &[1.0; 60],
        unknown: &[true; 12],
        regularisers: &[Regulariser::default(); 2],
    };
    assert_near(&problem.normal().solve().expect("more pixels than values"), &known, 1e-8);
    assert!(problem.cost(&known) < 1e-28);
}

#[test]
fn extinction_is_found_in_pictures_of_a_medium_of_one_radiance() {
    let part = Part { property: Property::Extinction, size: [2, 3, 2], basis: Basis::Trilinear };
    let known = Grid { size: part.size, values: numbers(13).take(12).collect() };
    let medium = Medium { extinction: known.clone(), scattered: Grid::constant([1, 1, 1], 0.0) };
    let emission = Part { property: Property::Emission, ..part };
    let [straight, bent] = paths();
    let of = |part| Matrix::stacked(&[&straight, &bent].map(|rays| Matrix::new(rays, &medium, &[part])));
    // The picture is that of a volume whose emission is its radiance.
    let behind: Vec<f64> = (0..60).map(|k| if k % 9 == 0 { 0.4 } else { f64::from(k % 2) }).collect();
    let picture = of(emission).picture(&[0.4; 12], &behind);
    let targets = ExtinctionTargets::new(&picture, &behind, 0.4, 8.0, &[1.0; 60]);
    assert_eq!(targets.count(Row::Dropped), 7);
    let matrix = of(part);
    let problem = Problem {
        matrix: &matrix,
        targets: &targets.optical_depths,
        weights: &targets.weights,
        unknown: &[true; 12],
        regularisers: &[Regulariser::default()],
    };
    assert_near(&problem.normal().solve().expect("more pixels than values"), &known.values, 1e-8);
}

#[test]
fn values_without_extinction_have_empty_columns() {
    let mut medium = medium();
    for (index, value) in medium.extinction.values.iter_mut().enumerate() {
        if index % 4 > 0 || index > 60 {
            *value = 0.0;
        }
    }
    let part = Part { size: [8, 5, 6], ..EMISSION };
    let [straight, _] = paths();
    let matrix = Matrix::new(&straight, &medium, &[part]);
    let touched = touched(&part, &medium.extinction);
    let sums = matrix.apply_transposed(&[1.0; 30]);
    assert!(sums.iter().zip(&touched).all(|(sum, touched)| *touched || *sum == 0.0));
    assert!(touched.contains(&false) && touched.contains(&true));
}
