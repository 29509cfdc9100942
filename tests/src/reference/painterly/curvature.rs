// SPDX-License-Identifier: MIT OR Apache-2.0
//! Splines over all voxels, and curvatures as eigenvalues of a projected matrix.

use crate::linear::Vec3;

/// The rows of a symmetric matrix.
pub type Form = [[f64; 3]; 3];

/// The cubic B-spline, or its derivative of an order to 2, as the fourth difference of a truncated power.
#[must_use]
pub fn cubic_spline(at: f64, order: usize) -> f64 {
    // Beyond its support powers cancel but for their rounding.
    if at.abs() >= 2.0 {
        return 0.0;
    }
    let power = |x: f64| match order {
        0 => x.powi(3) / 6.0,
        1 => x.powi(2) / 2.0,
        _ => x,
    };
    let terms = [1.0, -4.0, 6.0, -4.0, 1.0].into_iter().zip([2.0, 1.0, 0.0, -1.0, -2.0]);
    terms.map(|(factor, shift)| factor * power((at + shift).max(0.0))).sum()
}

/// Value, first and second derivatives a voxel of the cubic B-spline over a grid at a place in the box 0..1, voxel `i` lying
/// at `(i + 0.5) / size`; beyond the outer voxels as there.
#[must_use]
pub fn spline_jet(size: [usize; 3], values: &[f64], unit: [f64; 3]) -> (f64, [f64; 3], Form) {
    let place: [f64; 3] = std::array::from_fn(|a| unit[a] * size[a] as f64 - 0.5);
    let sum = |orders: [usize; 3]| {
        let mut sum = 0.0;
        let around = |a: usize| -4..size[a] as i64 + 4;
        for z in around(2) {
            for y in around(1) {
                for x in around(0) {
                    let held = [x, y, z].map(|i| i.max(0) as usize);
                    let [i, j, k] = std::array::from_fn(|a| held[a].min(size[a] - 1));
                    let weight: f64 = [x, y, z]
                        .into_iter()
                        .enumerate()
                        .map(|(a, i)| cubic_spline(place[a] - i as f64, orders[a]))
                        .product();
                    sum += weight * values[(k * size[1] + j) * size[0] + i];
                }
            }
        }
        sum
    };
    let orders = |along: &[usize]| {
        let mut orders = [0; 3];
        along.iter().for_each(|a| orders[*a] += 1);
        orders
    };
    let gradient = std::array::from_fn(|a| sum(orders(&[a])));
    let hessian = std::array::from_fn(|a| std::array::from_fn(|b| sum(orders(&[a, b]))));
    (sum([0; 3]), gradient, hessian)
}

/// A gradient and a matrix of second derivatives in the coordinates that `to` takes to theirs, by rows.
#[must_use]
pub fn in_other_coordinates(to: &Form, gradient: [f64; 3], hessian: &Form) -> ([f64; 3], Form) {
    let all = || (0..3).flat_map(|i| (0..3).map(move |j| (i, j)));
    let changed = std::array::from_fn(|a| (0..3).map(|i| to[i][a] * gradient[i]).sum());
    let bent = |a: usize, b: usize| all().map(|(i, j)| to[i][a] * hessian[i][j] * to[j][b]).sum();
    (changed, std::array::from_fn(|a| std::array::from_fn(|b| bent(a, b))))
}

/// Principal curvatures of a level set, the greater first, and their directions; positive where it is convex on the side of the
/// normal, which is `side` times the gradient: eigenvalues and eigenvectors of side P H P / |g|, P = I - n n'.
#[must_use]
pub fn principal_curvatures(gradient: Vec3, hessian: &Form, side: f64) -> [(f64, Vec3); 2] {
    let n = gradient.normalised().to_array();
    let p: Form = std::array::from_fn(|a| std::array::from_fn(|b| f64::from(u8::from(a == b)) - n[a] * n[b]));
    let (_, projected) = in_other_coordinates(&p, [0.0; 3], hessian);
    let factor = side / gradient.length();
    let mut all = eigen(projected.map(|row| row.map(|entry| entry * factor)));
    // That of the normal is none.
    all.sort_by(|(_, a), (_, b)| a.dot(gradient).abs().total_cmp(&b.dot(gradient).abs()));
    let [mut one, mut two, _] = all;
    if one.0 < two.0 {
        (one, two) = (two, one);
    }
    [one, two]
}

/// Eigenvalues and unit eigenvectors of a symmetric matrix, by Jacobi's rotations.
#[must_use]
pub fn eigen(mut form: Form) -> [(f64, Vec3); 3] {
    let mut vectors: Form = std::array::from_fn(|a| std::array::from_fn(|b| f64::from(u8::from(a == b))));
    for _ in 0..40 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if form[p][q] == 0.0 {
                continue;
            }
            let angle = 0.5 * (2.0 * form[p][q]).atan2(form[q][q] - form[p][p]);
            let (sine, cosine) = angle.sin_cos();
            // Columns, then rows.
            for row in form.iter_mut().chain(vectors.iter_mut()) {
                (row[p], row[q]) = (cosine * row[p] - sine * row[q], sine * row[p] + cosine * row[q]);
            }
            let (a, b) = (form[p], form[q]);
            for i in 0..3 {
                form[p][i] = cosine * a[i] - sine * b[i];
                form[q][i] = sine * a[i] + cosine * b[i];
            }
        }
    }
    std::array::from_fn(|a| (form[a][a], Vec3::new(vectors[0][a], vectors[1][a], vectors[2][a])))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn splines_reproduce_what_they_should() {
        for (at, value, slope, bend) in
            [(0.0, 2.0 / 3.0, 0.0, -2.0), (1.0, 1.0 / 6.0, -0.5, 1.0), (-1.5, 1.0 / 48.0, 0.125, 0.5)]
        {
            for (order, expected) in [value, slope, bend].into_iter().enumerate() {
                assert!((cubic_spline(at, order) - expected).abs() < 1e-14, "{at} {order}");
            }
        }
        // A quadratic field keeps its derivatives.
        let field =
            |x: f64, y: f64, z: f64| 0.3 * x - y + 0.2 * x * x - 0.1 * z * z + 0.4 * x * y - 0.3 * y * z;
        let size = [10, 9, 8];
        let mut values = Vec::new();
        for z in 0..8 {
            for y in 0..9 {
                values.extend((0..10).map(|x| field(f64::from(x), f64::from(y), f64::from(z))));
            }
        }
        let unit = [0.47, 0.52, 0.55];
        let [x, y, z] = std::array::from_fn(|a| unit[a] * size[a] as f64 - 0.5);
        let (value, gradient, hessian) = spline_jet(size, &values, unit);
        assert!((value - field(x, y, z) - (0.4 - 0.2) / 6.0).abs() < 1e-12);
        for (found, expected) in
            gradient.into_iter().zip([0.3 + 0.4 * x + 0.4 * y, -1.0 + 0.4 * x - 0.3 * z, -0.2 * z - 0.3 * y])
        {
            assert!((found - expected).abs() < 1e-12);
        }
        let expected = [[0.4, 0.4, 0.0], [0.4, 0.0, -0.3], [0.0, -0.3, -0.2]];
        for (found, expected) in hessian.as_flattened().iter().zip(expected.as_flattened()) {
            assert!((found - expected).abs() < 1e-12);
        }
    }

    #[test]
    fn a_cylinder_bends_around() {
        // Distance from the z axis at (3, 4, 1), times 2: gradient (0.6, 0.8, 0) 2, bending 1/5 around.
        let [x, y] = [0.6, 0.8];
        let bend = 2.0 / 5.0;
        let hessian = [[bend * y * y, -bend * x * y, 0.0], [-bend * x * y, bend * x * x, 0.0], [0.0; 3]];
        let [one, two] = principal_curvatures(Vec3::new(1.2, 1.6, 0.0), &hessian, 1.0);
        assert!((one.0 - 0.2).abs() < 1e-12 && two.0.abs() < 1e-12, "{one:?} {two:?}");
        assert!((one.1.dot(Vec3::new(-0.8, 0.6, 0.0)).abs() - 1.0).abs() < 1e-12);
        assert!((two.1.z.abs() - 1.0).abs() < 1e-12);
        // Trace and Frobenius norm.
        let form = [[1.0, 0.5, -0.25], [0.5, -2.0, 0.75], [-0.25, 0.75, 0.1]];
        let all = eigen(form);
        let norm = form.as_flattened().iter().map(|v| v * v).sum::<f64>();
        assert!((all.iter().map(|(k, _)| k).sum::<f64>() + 0.9).abs() < 1e-12);
        assert!((all.iter().map(|(k, _)| k * k).sum::<f64>() - norm).abs() < 1e-12);
        for (value, vector) in all {
            let image = Vec3::from(form.map(|row| Vec3::from(row).dot(vector)));
            assert!((image - vector * value).length() < 1e-12);
        }
    }
}
