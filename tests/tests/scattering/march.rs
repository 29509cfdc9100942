// SPDX-License-Identifier: MIT OR Apache-2.0
//! The march along rows against exact sums.

use crate::cases::{Case, PICTURE, foliage};
use crate::gpu::{self, gpu};
use crate::methods::marched;
use airlight::scattering::{Along, Weighting};
use airlight_tests::error;
use airlight_tests::reference::scattering as reference;

/// Exact visibility over the row that is nearest to each pixel's azimuth.
fn nearest_row(case: &Case) -> (Vec<f64>, Vec<f64>) {
    let map = case.map.rectified.read(gpu()).unwrap();
    let extinction = f64::from(case.stage.medium.extinction);
    let pixels = gpu::of_pixels(&case.stage, &case.view, &case.map, |rectification, ray| {
        let j = ray.nearest();
        let row = &map[j * rectification.width..(j + 1) * rectification.width];
        reference::row_visibility(row, ray.end(rectification, j, extinction))
    });
    (pixels.iter().map(|p| p.average).collect(), pixels.iter().map(|p| p.weighted).collect())
}

#[test]
fn march_along_rows_is_the_exact_sum_over_the_nearest_row() {
    let case = foliage();
    let (average, weighted) = nearest_row(case);
    for (weighting, expected) in [(Weighting::Average, average), (Weighting::Transmittance, weighted)] {
        let found = marched(&case.stage.inputs(), &Along::Rows(&case.map), weighting, PICTURE).visibility;
        let mean = error::mean_absolute(&found, &expected);
        // Half floats hold 0..1 to 4.9e-4, for this adapter rounds towards zero; one texel more or less where z ties, or another row where two are as near.
        let off = found.iter().zip(&expected).filter(|(f, e)| (f64::from(**f) - **e).abs() > 2e-3).count();
        let share = off as f64 / found.len() as f64;
        println!(
            "march along rows, {}: mean {mean:.2e}, {:.2} % off by more than 2e-3, {}",
            gpu::weighting_name(weighting),
            100.0 * share,
            error::worst(&found, &expected, PICTURE[0] as usize).unwrap()
        );
        assert!(mean < 4e-4 && share < 0.005);
    }
}
