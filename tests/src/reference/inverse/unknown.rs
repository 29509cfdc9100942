// SPDX-License-Identifier: MIT OR Apache-2.0
//! Which values of emission and albedo matter: those whose basis functions meet extinction somewhere.

use super::grid::{Basis, Grid, voxel};
use super::matrix::Part;

/// Where the basis function i of n is not 0 along an axis of the box.
fn support(basis: Basis, n: usize, i: usize) -> [f64; 2] {
    let reach = match basis {
        Basis::Trilinear => 1.0,
        Basis::Box => 0.5,
    };
    let middle = i as f64 + 0.5;
    // The outermost ones go on to the faces.
    [(middle - reach).max(0.0), (middle + reach).min(n as f64)].map(|side| side / n as f64)
}

/// Whether each value of a part meets extinction above 0: every value against every value.
#[must_use]
pub fn touched(part: &Part, extinction: &Grid) -> Vec<bool> {
    let meets = |index: usize, other: usize| {
        let [own, others] = [voxel(part.size, index), voxel(extinction.size, other)];
        (0..3).all(|axis| {
            let [low, high] = support(part.basis, part.size[axis], own[axis]);
            let [least, most] = support(Basis::Trilinear, extinction.size[axis], others[axis]);
            // In exact arithmetic supports share an end or overlap by far more.
            low.max(least) + 1e-9 < high.min(most)
        })
    };
    let dense: Vec<usize> =
        (0..extinction.values.len()).filter(|&other| extinction.values[other] > 0.0).collect();
    (0..part.columns()).map(|index| dense.iter().any(|&other| meets(index, other))).collect()
}

#[cfg(test)]
mod tests {
    use super::super::matrix::Property;
    use super::*;
    use crate::linear::Vec3;

    #[test]
    fn a_value_is_touched_where_some_point_has_both() {
        let mut extinction = Grid::constant([6, 5, 4], 0.0);
        extinction.values[(2 * 5 + 1) * 6 + 4] = 2.0;
        extinction.values[0] = 1.0;
        for (size, basis) in [
            ([6, 5, 4], Basis::Trilinear),
            ([6, 5, 4], Basis::Box),
            ([3, 4, 5], Basis::Trilinear),
            ([9, 2, 3], Basis::Box),
        ] {
            let part = Part { property: Property::Emission, size, basis };
            let mut met = vec![false; part.columns()];
            let n = 60;
            for i in 0..n * n * n {
                let at = |i: usize| (i as f64 + 0.5) / n as f64;
                let unit = Vec3::new(at(i % n), at(i / n % n), at(i / (n * n)));
                if extinction.at(Basis::Trilinear, unit) > 0.0 {
                    for (index, _) in basis.weights(size, unit) {
                        met[index] = true;
                    }
                }
            }
            assert_eq!(touched(&part, &extinction), met);
            assert!(met.contains(&true) && met.contains(&false));
        }
    }
}
