// SPDX-License-Identifier: MIT OR Apache-2.0
//! Light through media in closed form, and lights found in pictures.

use super::super::tests::{medium, numbers, paths, sheared_box, unit_box};
use super::super::{Problem, Regulariser, bounded};
use super::*;

#[test]
fn light_fades_by_the_integral_of_what_it_passes() {
    let volume = unit_box();
    let up = Vec3::new(0.0, 1.0, 0.0);
    let point = Vec3::new(0.3, 0.25, 0.6);
    let even = Grid::constant([2, 2, 2], 1.7);
    assert!((transmittance_to(&volume, &even, point, up, 3) - (-1.7_f64 * 0.75).exp()).abs() < 1e-14);
    // From 0.25 to 0.75 of the way up it rises from 1 to 2 and is even above.
    let rising = Grid { size: [1, 2, 1], values: vec![1.0, 2.0] };
    let expected = (-(0.5 * 1.5 + 0.25 * 2.0_f64)).exp();
    assert!((transmittance_to(&volume, &rising, point, up, 3000) - expected).abs() < 1e-12);
    let slanted = Vec3::new(0.6, 0.0, -0.8);
    let way = (0.7 / 0.6_f64).min(0.6 / 0.8);
    assert!((transmittance_to(&volume, &even, point, slanted, 3) - (-1.7 * way).exp()).abs() < 1e-14);
    assert_eq!(transmittance_to(&volume, &even, Vec3::new(0.3, 1.2, 0.6), up, 3), 1.0);
}

#[test]
fn clear_surroundings_of_one_radiance_scatter_just_that() {
    let count = 40;
    let light = |i: usize| {
        let y = (2 * i + 1) as f64 / count as f64 - 1.0;
        let (sin, cos) = (2.4 * i as f64).sin_cos();
        let r = (1.0 - y * y).sqrt();
        let towards = Vec3::new(r * cos, y, r * sin);
        DirectionalLight { towards, radiance: 3.0, solid_angle: 4.0 * PI / count as f64 }
    };
    let lights: Vec<_> = (0..count).map(light).collect();
    let volume = sheared_box();
    let clear = Grid::constant([2, 2, 2], 0.0);
    let open = scattered_grid(&volume, &clear, &lights, [3, 2, 2], 4, |_, _| 1.0);
    assert!(open.values.iter().all(|value| (value - 3.0).abs() < 1e-13));
    // A floor below hides half of them.
    let floor = |_: Vec3, towards: Vec3| if towards.y > 0.0 { 1.0 } else { 0.0 };
    let half = scattered_grid(&volume, &clear, &lights, [3, 2, 2], 4, floor);
    assert!(half.values.iter().all(|value| (value - 1.5).abs() < 1e-13));
}

#[test]
fn grids_hold_the_light_of_their_own_places() {
    let volume = sheared_box();
    let medium = medium();
    let lights = [[0.3, 0.9, 0.2], [-0.8, 0.1, 0.4]].map(|towards| DirectionalLight {
        towards: Vec3::from(towards).normalised(),
        radiance: 2.0,
        solid_angle: 0.7,
    });
    // Clear above a height, so that place and light are known to be right by the closure alone.
    let visible = |point: Vec3, _: Vec3| f64::from(u8::from(point.y > 0.0));
    let grid = scattered_grid(&volume, &medium.extinction, &lights, [2, 3, 2], 50, visible);
    let mut dark = 0;
    for (index, value) in grid.values.iter().enumerate() {
        let unit = Vec3::new(
            ((index % 2) as f64 + 0.5) / 2.0,
            ((index / 2 % 3) as f64 + 0.5) / 3.0,
            ((index / 6) as f64 + 0.5) / 2.0,
        );
        let point = volume.world(unit);
        let through = |light: &DirectionalLight| {
            transmittance_to(&volume, &medium.extinction, point, light.towards, 50)
        };
        let expected: f64 = lights.iter().map(|light| 1.4 / (4.0 * PI) * through(light)).sum();
        dark += u32::from(point.y <= 0.0);
        assert!((value - if point.y > 0.0 { expected } else { 0.0 }).abs() < 1e-14);
    }
    assert!((1..12).contains(&dark));
}

fn light_volumes() -> Vec<Grid> {
    let lights = [[0.3, 0.9, 0.2], [-0.8, 0.1, 0.4], [0.1, -0.7, 0.8], [0.6, 0.0, -0.7]];
    let volume = |towards: [f64; 3]| {
        let towards = Vec3::from(towards).normalised();
        let light = DirectionalLight { towards, radiance: 1.0, solid_angle: 1.1 };
        scattered_grid(&sheared_box(), &medium().extinction, &[light], [4, 4, 4], 60, |_, _| 1.0)
    };
    lights.map(volume).to_vec()
}

#[test]
fn lights_are_found_in_their_pictures() {
    let albedo = Grid { size: [2, 3, 2], values: numbers(2).take(12).collect() };
    let volumes = light_volumes();
    for rays in paths() {
        let columns = light_columns(&rays, &medium().extinction, &albedo, &volumes);
        let solve = |known: [f64; 4]| {
            let targets = columns.apply(&known);
            let problem = Problem {
                matrix: &columns,
                targets: &targets,
                weights: &[1.0; 30],
                unknown: &[true; 4],
                regularisers: &[Regulariser::default()],
            };
            let normal = problem.normal();
            (
                normal.solve().expect("four different lights"),
                bounded(&normal, f64::INFINITY).expect("decided"),
            )
        };
        let known = [2.0, 0.5, 0.0, 1.3];
        let (free, positive) = solve(known);
        for j in 0..4 {
            assert!((free[j] - known[j]).abs() < 1e-8 && (positive[j] - known[j]).abs() < 1e-8);
        }
        let (free, positive) = solve([2.0, 0.5, -0.4, 1.3]);
        assert!((free[2] + 0.4).abs() < 1e-8 && positive[2] == 0.0);
        // The light of all together is the sum of the columns.
        let mut sum = volumes[0].clone();
        for (i, value) in sum.values.iter_mut().enumerate() {
            *value = (0..4).map(|j| known[j] * volumes[j].values[i]).sum();
        }
        let medium = Medium { scattered: sum, ..medium() };
        let part = Part { property: Property::Albedo, size: albedo.size, basis: Basis::Trilinear };
        let picture = Matrix::new(&rays, &medium, &[part]).apply(&albedo.values);
        let together = columns.apply(&known);
        assert!(picture.iter().zip(&together).all(|(a, b)| (a - b).abs() < 1e-13));
    }
}

#[test]
fn one_pass_back_serves_all_light_volumes() {
    // T^T c = volume . (W^T c), W that of emission on the grid of the volumes.
    let volumes = light_volumes();
    let white = Grid::constant([1, 1, 1], 1.0);
    let part = Part { property: Property::Emission, size: [4, 4, 4], basis: Basis::Trilinear };
    for rays in paths() {
        let columns = light_columns(&rays, &medium().extinction, &white, &volumes);
        let pixels: Vec<f64> = numbers(9).take(rays.len()).map(|number| number - 0.3).collect();
        let back = Matrix::new(&rays, &medium(), &[part]).apply_transposed(&pixels);
        for (one, volume) in columns.apply_transposed(&pixels).iter().zip(&volumes) {
            let other: f64 = volume.values.iter().zip(&back).map(|(a, b)| a * b).sum();
            assert!((one - other).abs() < 1e-14 && one.abs() > 1e-3, "{one}");
        }
    }
}
