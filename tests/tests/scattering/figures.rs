// SPDX-License-Identifier: MIT OR Apache-2.0
//! Average visibility and radiance by prefiltered bases, within the figures that the book states.

use crate::cases::{Case, PICTURE, foliage, plane};
use crate::methods::{marched, prefiltered};
use airlight::scattering::{Along, BasisFormat, Settings, Weighting};
use airlight_tests::error;

fn average_error(case: &Case, settings: Settings) -> f64 {
    let settings = Settings { map: [512, 512], weighting: Weighting::Average, ..settings };
    let found = prefiltered(&case.stage.inputs(), settings, PICTURE).visibility;
    error::mean_absolute(&found, &case.exact.average())
}

#[test]
fn average_visibility_on_foliage_falls_with_the_bases_to_its_figure() {
    let mut previous = f64::INFINITY;
    let mut figures = Vec::new();
    for bases in [4, 8, 16, 32, 64, 128] {
        let found = average_error(foliage(), Settings { bases, ..Settings::default() });
        let half = Settings { bases, format: BasisFormat::Rgba16Float, ..Settings::default() };
        let half = average_error(foliage(), half);
        let plain = average_error(foliage(), Settings { bases, window: false, ..Settings::default() });
        println!(
            "foliage, {bases} bases: {found:.5} rgba8unorm, {half:.5} rgba16float, {plain:.5} without window"
        );
        figures.push((bases, found, half, previous));
        previous = found;
    }
    for (bases, found, half, previous) in figures {
        assert!(found < previous, "{bases} bases: {found} after {previous}");
        assert!(found - half <= 0.002, "{bases} bases: 8 bits add {}", found - half);
        assert!(bases != 32 || found <= 0.005, "{bases} bases: {found}");
    }
}

#[test]
fn average_visibility_on_a_plane_under_an_overhead_light_reaches_its_figure() {
    let found = average_error(plane(), Settings::default());
    let half = average_error(plane(), Settings { format: BasisFormat::Rgba16Float, ..Settings::default() });
    let plain = average_error(plane(), Settings { window: false, ..Settings::default() });
    println!("plane, 32 bases: {found:.5} rgba8unorm, {half:.5} rgba16float, {plain:.5} without window");
    assert!(found <= 0.020, "{found}");
    assert!(found - half <= 0.002, "8 bits add {}", found - half);
}

fn radiance_error(case: &Case, map: [u32; 2]) -> f64 {
    let found = prefiltered(&case.stage.inputs(), Settings { map, ..Settings::default() }, PICTURE).radiance;
    error::relative_rmse(&found, &case.exact.radiance())
}

#[test]
fn radiance_reaches_its_figures() {
    let cases = [("foliage", 0.03), ("terrain", 0.03), ("torus", 0.05)];
    let mut failures = Vec::new();
    for (name, budget) in cases {
        for map in [[512, 512], [1024, 1024]] {
            let case = Case::new(name, PICTURE, map);
            let found = radiance_error(&case, map);
            let rows =
                marched(&case.stage.inputs(), &Along::Rows(&case.map), Weighting::Transmittance, PICTURE);
            let rows = error::relative_rmse(&rows.radiance, &case.exact.radiance());
            println!(
                "{name}, map {}x{}: relative RMSE {:.2} % of at most {:.0} %; marched row {:.2} %",
                map[0],
                map[1],
                100.0 * found,
                100.0 * budget,
                100.0 * rows
            );
            if found > budget || found.is_nan() {
                failures.push(format!("{name} {map:?}: {found}"));
            }
        }
    }
    assert!(failures.is_empty(), "{failures:?}");
}
