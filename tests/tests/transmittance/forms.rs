// SPDX-License-Identifier: MIT OR Apache-2.0
//! Every form of transmittance map: the GPU against f64 references of the same truncated series or moments, and the table of what
//! each form reaches on smooth media, smoke and boxes.
//!
//! `--nocapture` prints the table.

use crate::gpu::Random;
use crate::probing::hold;
use crate::rays::{Medium, RANGE, Rays, ask, light_along_z, medium};
use airlight::transmittance::{Form, MapSettings, Precision};
use airlight_tests::media::{self, EACH, OPTICAL_DEPTHS as TOTALS, STEPS as LENGTH};
use airlight_tests::parallel;
use airlight_tests::reference::transmittance::{
    Basis, Profile, Series, power_transmittance, trigonometric_transmittance,
};
use glam::Vec3;

/// MOMENT_BIAS, TRIGONOMETRIC_BIAS, OVERESTIMATION and GAP of the shaders.
const BIAS: f64 = 1e-5;
const OVERESTIMATION: f64 = 0.25;
const GAP: f64 = 0.314_159_265_358_979_3;
const KINDS: [Medium; 5] = Medium::ALL;

fn depths() -> Vec<f64> {
    (0..32).map(|i| (f64::from(i) + 0.37) / 32.0).collect()
}

/// What a form with `count` coefficients gives at depths of a ray, in f64.
fn reference(profile: &Profile, form: Form, count: usize, depths: &[f64]) -> Vec<f64> {
    let at = |of: &dyn Fn(f64) -> f64| -> Vec<f64> {
        depths.iter().map(|depth| of(depth * RANGE).clamp(0.0, 1.0)).collect()
    };
    match form {
        Form::Extinction | Form::Opacity => {
            let basis = if form == Form::Opacity { Basis::Period } else { Basis::Cosine };
            let series = Series::of_extinction(profile, basis, count);
            at(&|x| (-series.integral(x)).exp())
        }
        Form::Bounded => {
            let (from, to) = profile.occupied().unwrap();
            let series = Series::of_extinction(&profile.cut(from, to), Basis::Cosine, count);
            at(&|x| (-series.integral((x - from).clamp(0.0, to - from))).exp())
        }
        Form::Function | Form::FunctionPeriodic => {
            let basis = if form == Form::Function { Basis::Cosine } else { Basis::Period };
            let series = Series::of_transmittance(profile, basis, count, 40 * LENGTH);
            at(&|x| series.value(x))
        }
        Form::PowerMoments => at(&|x| power_transmittance(profile, x, BIAS, OVERESTIMATION)),
        Form::TrigonometricMoments => {
            at(&|x| trigonometric_transmittance(profile, x, GAP, BIAS, OVERESTIMATION))
        }
    }
}

const FORMS: [(Form, u32); 12] = [
    (Form::Extinction, 4),
    (Form::Bounded, 4),
    (Form::Opacity, 4),
    (Form::Function, 4),
    (Form::FunctionPeriodic, 4),
    (Form::Extinction, 8),
    (Form::Opacity, 8),
    (Form::Function, 8),
    (Form::PowerMoments, 8),
    (Form::TrigonometricMoments, 8),
    (Form::Extinction, 16),
    (Form::Function, 16),
];

/// Mean errors of transmittance by kind and optical depth.
type Errors = [[f64; TOTALS.len()]; KINDS.len()];

fn mean_errors(rays: &[Profile], found: &[Vec<f32>], depths: &[f64]) -> Errors {
    std::array::from_fn(|kind| {
        std::array::from_fn(|total| {
            let first = (kind * TOTALS.len() + total) * EACH;
            let errors = (first..first + EACH).flat_map(|ray| {
                let error = move |(depth, found): (&f64, &f32)| {
                    (rays[ray].transmittance(depth * RANGE) - f64::from(*found)).abs()
                };
                depths.iter().zip(&found[ray]).map(error)
            });
            errors.sum::<f64>() / (EACH * depths.len()) as f64
        })
    })
}

/// Mean and greatest difference from the reference that is left to f32, and to the steps of the march.
fn budget(form: Form) -> (f64, f64) {
    match form {
        Form::Extinction | Form::Bounded | Form::Opacity => (1e-6, 2e-5),
        // Transmittance is even in each step of the march.
        Form::Function | Form::FunctionPeriodic => (3e-4, 5e-3),
        Form::PowerMoments | Form::TrigonometricMoments => (3e-5, 3e-3),
    }
}

#[test]
fn every_form_is_its_reference_and_reaches_what_it_can() {
    let mut extinctions = media::table();
    let count = extinctions.len();
    // A power of two: the march takes steps of the shortest side of a voxel, a column's width here, and is exact where a whole
    // number of them fits into a voxel along the ray.
    extinctions.resize(count.next_power_of_two(), vec![1.0; LENGTH]);
    let rays = Rays { extinctions };
    let profiles = &rays.profiles()[..count];
    let depths = depths();
    let mut table = Vec::new();
    for (form, count) in FORMS {
        let found = rays.transmittances(rays.settings(form, count), false, &depths);
        // The moments' roots are sought by brute force: every third ray.
        let stride = if form.moments() { 3 } else { 1 };
        let checked: Vec<usize> = (0..profiles.len()).step_by(stride).collect();
        let expected = parallel::rows(checked.len(), |i| {
            reference(&profiles[checked[i]], form, count as usize, &depths)
        });
        let (mut sum, mut worst) = (0.0, 0.0_f64);
        for (ray, expected) in checked.iter().zip(&expected) {
            for (found, expected) in found[*ray].iter().zip(expected) {
                let error = (f64::from(*found) - expected).abs();
                worst = if error <= worst { worst } else { error };
                sum += error;
            }
        }
        let (mean_budget, worst_budget) = budget(form);
        hold(&format!("{form:?} {count}, mean"), sum / (checked.len() * depths.len()) as f64, mean_budget);
        hold(&format!("{form:?} {count}, greatest"), worst, worst_budget);
        table.push(mean_errors(profiles, &found, &depths));
    }
    println!("mean error of transmittance x 1e4, optical depths {TOTALS:?}");
    for (kind, name) in KINDS.iter().enumerate() {
        for ((form, count), errors) in FORMS.iter().zip(&table) {
            let row = errors[kind].map(|error| format!("{:6.0}", 1e4 * error)).join(" ");
            println!("{name:?} | {form:?} {count} | {row}");
        }
    }
    let of = |form: Form, count: u32, kind: usize, total: usize| {
        table[FORMS.iter().position(|f| *f == (form, count)).unwrap()][kind][total]
    };
    for total in [2, 3] {
        let extinction = |kind| of(Form::Extinction, 4, kind, total);
        // Dense media that fill the range: where the exponential is worth the most.
        assert!(extinction(0) <= 0.3 * of(Form::Function, 4, 0, total));
        assert!(extinction(1) <= 0.4 * of(Form::FunctionPeriodic, 4, 1, total));
        // The interval.
        assert!(of(Form::Bounded, 4, 3, total) <= 0.2 * extinction(3));
        assert!(of(Form::Bounded, 4, 4, total) <= 0.2 * extinction(4));
    }
    for total in 0..TOTALS.len() {
        for kind in 0..KINDS.len() {
            let [four, eight, sixteen] = [4, 8, 16].map(|count| of(Form::Extinction, count, kind, total));
            assert!(eight < four && sixteen < eight, "{kind} {total}: {four} {eight} {sixteen}");
        }
        // Moments are for few dense parts, not for smooth media.
        assert!(of(Form::PowerMoments, 8, 0, total) > of(Form::Extinction, 8, 0, total));
    }
}

/// Between texels whose intervals differ: the mean of their transmittances.
#[test]
fn intervals_are_not_mixed_but_transmittances_are() {
    let mut random = Random(77);
    let extinctions = (0..64).map(|i| medium(Medium::ShortBoxes, LENGTH, [4.0, 16.0][i % 2], &mut random));
    let rays = Rays { extinctions: extinctions.collect() };
    let profiles = rays.profiles();
    let depths = depths();
    let share = 0.4;
    let points: Vec<Vec3> = (0..63)
        .flat_map(|ray| depths.iter().map(move |depth| (ray, *depth)))
        .map(|(ray, depth)| rays.point(ray, depth).lerp(rays.point(ray + 1, depth), share))
        .collect();
    let of = |form: Form| {
        let map = rays.map(rays.settings(form, 4), &light_along_z(1.0)).unwrap();
        ask(&map, false, &points)
    };
    let (bounded, plain) = (of(Form::Bounded), of(Form::Extinction));
    let mixed = |pair: [f64; 2]| (1.0 - f64::from(share)) * pair[0] + f64::from(share) * pair[1];
    let (mut from_reference, mut error, mut error_of_plain) = (0.0_f64, 0.0, 0.0);
    for ray in 0..63 {
        let pair = [ray, ray + 1];
        let series = pair.map(|ray| reference(&profiles[ray], Form::Bounded, 4, &depths));
        for (i, depth) in depths.iter().enumerate() {
            let found = f64::from(bounded[ray * depths.len() + i]);
            let truth = mixed(pair.map(|ray| profiles[ray].transmittance(depth * RANGE)));
            from_reference = from_reference.max((found - mixed([series[0][i], series[1][i]])).abs());
            error += (found - truth).abs();
            error_of_plain += (f64::from(plain[ray * depths.len() + i]) - truth).abs();
        }
    }
    hold("bounded, from its reference", from_reference, 1e-5);
    hold("error of bounded over that of plain", error / error_of_plain, 0.2);
}

#[test]
fn half_floats_are_filtered_as_single_ones_are_mixed() {
    let mut random = Random(78);
    let extinctions = (0..64).map(|_| medium(Medium::Smoke, LENGTH, 3.0, &mut random));
    let rays = Rays { extinctions: extinctions.collect() };
    let depths = depths();
    // Beyond the first and the last texel's middle too.
    let points: Vec<Vec3> = (0..64)
        .flat_map(|ray| depths.iter().map(move |depth| (ray, *depth)))
        .map(|(ray, depth)| rays.point(ray, depth).lerp(rays.point(ray + 1, depth), [0.3, -0.45][ray % 2]))
        .collect();
    for form in [Form::Extinction, Form::Opacity, Form::Function, Form::FunctionPeriodic] {
        for coefficients in [4, 16] {
            let of = |precision| {
                let settings = MapSettings { precision, ..rays.settings(form, coefficients) };
                ask(&rays.map(settings, &light_along_z(1.0)).unwrap(), false, &points)
            };
            let (single, half) = (of(Precision::Single), of(Precision::Half));
            let away = single.iter().zip(&half).map(|(a, b)| f64::from((a - b).abs())).fold(0.0, f64::max);
            hold(&format!("{form:?} of {coefficients}"), away, 1e-3);
        }
    }
}

#[test]
fn two_thin_sheets_are_exact_with_moments_alone() {
    let mut random = Random(5);
    let length = 1024;
    let places: Vec<[usize; 2]> = (0..24)
        .map(|_| {
            // A quarter of the range apart: the bias blurs what is nearer.
            let first = random.below(300) + 20;
            [first, first + 256 + random.below(400)]
        })
        .collect();
    let depth = |i: usize| [0.4 + 0.1 * i as f64, 2.0 - 0.05 * i as f64];
    let extinctions = places
        .iter()
        .enumerate()
        .map(|(i, at)| {
            let mut ray = vec![0.0; length];
            for (at, depth) in at.iter().zip(depth(i)) {
                ray[*at] = (depth * length as f64 / RANGE) as f32;
            }
            ray
        })
        .collect();
    let rays = Rays { extinctions };
    let depths: Vec<f64> = (0..200).map(|i| (f64::from(i) + 0.5) / 200.0).collect();
    let worst = |form, count| {
        let found = rays.transmittances(rays.settings(form, count), false, &depths);
        let mut worst = 0.0_f64;
        for (i, (at, found)) in places.iter().zip(&found).enumerate() {
            for (x, found) in depths.iter().zip(found) {
                // Not within 4 % of a sheet.
                if at.iter().any(|at| (x - *at as f64 / length as f64).abs() < 0.04) {
                    continue;
                }
                let passed = at.iter().zip(depth(i)).filter(|(at, _)| **at as f64 / (length as f64) < *x);
                let truth = (-passed.map(|(_, depth)| depth).sum::<f64>()).exp();
                worst = worst.max((truth - f64::from(*found)).abs());
            }
        }
        worst
    };
    hold("power moments", worst(Form::PowerMoments, 8), 5e-3);
    hold("trigonometric moments", worst(Form::TrigonometricMoments, 8), 5e-3);
    let series = [Form::Extinction, Form::Opacity].map(|form| worst(form, 8));
    println!("extinction and opacity maps of 8 coefficients: {series:?}");
    assert!(series.iter().all(|error| *error > 0.1));
}
