// SPDX-License-Identifier: MIT OR Apache-2.0
//! Rows against closed forms, and both ways of the matrix against each other.

use super::super::tests::{medium, numbers, paths, sheared_box, unit_box, view};
use super::super::{Ray, Slices, bent, straight};
use super::*;
use crate::linear::Vec3;

const SIZES: [[usize; 3]; 3] = [[4, 5, 6], [2, 3, 2], [7, 4, 9]];

fn parts(property: Property) -> impl Iterator<Item = Part> {
    [Basis::Trilinear, Basis::Box]
        .into_iter()
        .flat_map(move |basis| SIZES.map(|size| Part { property, size, basis }))
}

#[test]
fn rows_of_emission_add_up_to_what_is_not_let_through() {
    for rays in paths() {
        for part in parts(Property::Emission) {
            let matrix = Matrix::new(&rays, &medium(), &[part]);
            for (sum, transmittance) in matrix.row_sums().iter().zip(&matrix.transmittance) {
                assert!((sum - (1.0 - transmittance)).abs() < 1e-14);
            }
            let most = matrix.row_sums().into_iter().fold(0.0, f64::max);
            assert!(most > 0.3, "{most}");
        }
    }
}

#[test]
fn rows_of_extinction_add_up_to_the_way_in_the_box() {
    let (volume, view) = (sheared_box(), view());
    let whole = [Vec3::default(), Vec3::new(1.0, 1.0, 1.0)];
    let chords = view.rays(|ray| volume.clip(ray, whole).map_or(0.0, |[begin, end]| end - begin));
    let even = Grid::constant([2, 2, 2], 1.4);
    let rays = [paths()[0].clone(), view.rays(|ray| bent(&volume, &even, 0.11, ray))];
    for part in parts(Property::Extinction) {
        for rays in &rays {
            let sums = Matrix::new(rays, &medium(), &[part]).row_sums();
            assert!(sums.iter().zip(&chords).all(|(sum, chord)| (sum - chord).abs() < 1e-12));
        }
    }
}

#[test]
fn a_homogeneous_slab_shines_by_the_law_of_beer_and_lambert() {
    let volume = unit_box();
    let medium =
        Medium { extinction: Grid::constant([3, 3, 3], 1.3), scattered: Grid::constant([1, 1, 1], 0.25) };
    let direction = Vec3::new(0.3, -0.2, 0.9).normalised();
    let ray = Ray { origin: Vec3::new(0.5, 0.5, 0.5) - direction * 3.0, direction, depth: f64::INFINITY };
    let slices = Slices { axis: 2, count: 5 };
    let emission = Part { property: Property::Emission, size: [2, 3, 4], basis: Basis::Trilinear };
    let albedo = Part { property: Property::Albedo, ..emission };
    for depth in [f64::INFINITY, 3.1] {
        let samples = straight(&volume, &slices, &Ray { depth, ..ray });
        let length = if depth.is_finite() { 0.5 / direction.z + 0.1 } else { direction.z.recip() };
        let taken = 1.0 - (-1.3 * length).exp();
        let matrix = Matrix::new(&[samples], &medium, &[emission, albedo]);
        let values = [[2.0; 24], [0.6; 24]].concat();
        let [radiance] = matrix.picture(&values, &[5.0])[..] else { panic!("one pixel") };
        assert!((radiance - (taken * (2.0 + 0.6 * 0.25) + 5.0 * (1.0 - taken))).abs() < 1e-14);
        assert!((matrix.transmittance[0] - (1.0 - taken)).abs() < 1e-14);
    }
}

#[test]
fn emission_that_rises_evenly_converges_to_its_integral() {
    // Within the middle half of the box two values make a straight line: e(t) = 1 + 2 t.
    let volume = unit_box();
    let medium =
        Medium { extinction: Grid::constant([1, 1, 1], 4.0), scattered: Grid::constant([1, 1, 1], 0.0) };
    let part = Part { property: Property::Emission, size: [2, 1, 1], basis: Basis::Trilinear };
    let ray = Ray { origin: Vec3::new(0.25, 0.5, 0.5), direction: Vec3::new(1.0, 0.0, 0.0), depth: 0.5 };
    let exact = |t: f64| -(-4.0 * t).exp() * (1.0 + 2.0 * t + 0.5);
    let error = |count: usize| {
        let samples = straight(&volume, &Slices { axis: 0, count }, &ray);
        (Matrix::new(&[samples], &medium, &[part]).apply(&[1.0, 2.0])[0] - (exact(0.5) - exact(0.0))).abs()
    };
    let [coarse, fine] = [error(40), error(80)];
    assert!((coarse / fine - 4.0).abs() < 0.1 && fine > 1e-6 && fine < 1e-4, "{coarse} {fine}");
}

#[test]
fn applying_is_sampling_the_field_along_the_ray() {
    let medium = medium();
    let mut numbers = numbers(3);
    for rays in paths() {
        for property in [Property::Emission, Property::Albedo, Property::Extinction] {
            for part in parts(property) {
                let values: Vec<f64> = numbers.by_ref().take(part.columns()).collect();
                let grid = Grid { size: part.size, values: values.clone() };
                let pixels = Matrix::new(&rays, &medium, &[part]).apply(&values);
                for (ray, pixel) in rays.iter().zip(pixels) {
                    let mut sum = 0.0;
                    for (s, sample) in ray.iter().enumerate() {
                        let depth = |sample: &Sample| {
                            medium.extinction.at(Basis::Trilinear, sample.unit) * sample.length
                        };
                        let before: f64 = ray[..s].iter().map(depth).sum();
                        let weight = (-before).exp() - (-before - depth(sample)).exp();
                        let value = grid.at(part.basis, sample.unit);
                        sum += value
                            * match property {
                                Property::Emission => weight,
                                Property::Albedo => {
                                    weight * medium.scattered.at(Basis::Trilinear, sample.unit)
                                }
                                Property::Extinction => sample.length,
                            };
                    }
                    assert!((sum - pixel).abs() < 1e-13);
                }
            }
        }
    }
}

#[test]
fn projecting_back_is_the_transpose() {
    let mut numbers = numbers(5);
    let emission = Part { property: Property::Emission, size: [3, 4, 2], basis: Basis::Trilinear };
    let albedo = Part { property: Property::Albedo, size: [5, 2, 4], basis: Basis::Box };
    let extinction = Part { property: Property::Extinction, ..emission };
    for rays in paths() {
        for parts in [vec![emission], vec![albedo], vec![emission, albedo], vec![extinction]] {
            let matrix = Matrix::new(&rays, &medium(), &parts);
            let mut take = |count: usize| -> Vec<f64> { numbers.by_ref().take(count).collect() };
            let (values, pixels) = (take(matrix.columns()), take(rays.len()));
            let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
            let [one, other] =
                [dot(&matrix.apply(&values), &pixels), dot(&values, &matrix.apply_transposed(&pixels))];
            assert!((one - other).abs() < 1e-13 * one && one > 0.1, "{one} {other}");
        }
    }
}

#[test]
fn both_together_are_the_two_side_by_side() {
    let emission = Part { property: Property::Emission, size: [3, 4, 2], basis: Basis::Trilinear };
    let albedo = Part { property: Property::Albedo, size: [5, 2, 4], basis: Basis::Box };
    let [rays, _] = paths();
    let of = |parts: &[Part]| Matrix::new(&rays, &medium(), parts);
    let (first, second, both) = (of(&[emission]), of(&[albedo]), of(&[emission, albedo]));
    assert_eq!(both.columns(), 64);
    for row in 0..rays.len() {
        for column in 0..64 {
            let alone = if column < 24 { first.entry(row, column) } else { second.entry(row, column - 24) };
            assert_eq!(both.entry(row, column), alone);
        }
    }
    let twice = Matrix::stacked(&[both.clone(), both.clone()]);
    assert_eq!(twice.apply(&[0.5; 64]), [both.apply(&[0.5; 64]), both.apply(&[0.5; 64])].concat());
    assert_eq!(twice.transmittance.len(), 60);
}

#[test]
fn bent_rays_of_an_even_index_near_straight_ones() {
    let (volume, view, medium) = (sheared_box(), view(), medium());
    let index = Grid::constant([2, 2, 2], 1.5);
    let part = Part { property: Property::Albedo, size: [4, 4, 4], basis: Basis::Trilinear };
    let values: Vec<f64> = numbers(11).take(64).collect();
    let slices = Slices { axis: 2, count: 3000 };
    let pixels = |rays: &[Vec<Sample>]| Matrix::new(rays, &medium, &[part]).apply(&values);
    let exact = pixels(&view.rays(|ray| straight(&volume, &slices, ray)));
    let error = |step: f64| {
        let rays = view.rays(|ray| bent(&volume, &index, step, ray));
        pixels(&rays).iter().zip(&exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    let [coarse, fine] = [error(0.16), error(0.04)];
    assert!(fine < 0.25 * coarse && fine < 1e-3 && coarse > 1e-4, "{coarse} {fine}");
}
