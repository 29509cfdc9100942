// SPDX-License-Identifier: MIT OR Apache-2.0
//! What tests of single shader functions share: errors and their budgets, vectors and matrices in records.
#![allow(dead_code)]

use airlight_tests::linear::Vec3;

/// Reads a matrix from a record, column by column.
pub const MATRIX_AT: &str = "
    fn matrix_at(first: u32) -> mat4x4<f32> {
        var m: mat4x4<f32>;
        for (var c = 0u; c < 4u; c++) {
            let k = first + 4u * c;
            m[c] = vec4<f32>(input(k), input(k + 1u), input(k + 2u), input(k + 3u));
        }
        return m;
    }";

/// Prints and holds a measured error.
pub fn hold(what: &str, error: f64, budget: f64) {
    println!("{what}: {error:.2e} of at most {budget:.1e}");
    assert!(error <= budget, "{what}: {error:e} exceeds {budget:e}");
}

/// The greatest difference of pairs; NaN where there is one.
pub fn worst(pairs: impl Iterator<Item = (f64, f64)>) -> f64 {
    let errors = pairs.map(|(found, expected)| (found - expected).abs());
    errors.fold(0.0, |a, b| if a.is_nan() || b <= a { a } else { b })
}

/// A number of the GPU in the precision of the references.
pub fn f(x: f32) -> f64 {
    f64::from(x)
}

/// The vector that begins a slice of a record.
pub fn triple(values: &[f32]) -> Vec3 {
    Vec3::from([values[0], values[1], values[2]])
}
