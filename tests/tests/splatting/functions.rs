// SPDX-License-Identifier: MIT OR Apache-2.0
//! The functions that sheets of splats are made of: sections of footprints, exact parts, shares of light, gradients.

use crate::gpu::{Probe, Random};
use crate::probing::{f, hold, triple, worst};
use airlight::splatting::Kernel;
use airlight_tests::linear::Vec3;
use airlight_tests::reference::splatting::Kernel as ReferenceKernel;

/// 2 / sqrt(pi) times the integral of exp(-t^2) from 0 to `x`, by the midpoint rule.
fn error_function(x: f64) -> f64 {
    const STEPS: u32 = 4000;
    let step = x / f64::from(STEPS);
    let value = |i: u32| (-((f64::from(i) + 0.5) * step).powi(2)).exp();
    2.0 / std::f64::consts::PI.sqrt() * (0..STEPS).map(value).sum::<f64>() * step
}

#[test]
fn the_error_function_is_that() {
    let probe = Probe {
        head: "#import airlight::splatting::footprint::error_function",
        body: "output(0u, error_function(input(0u)));",
        inputs: 1,
        outputs: 1,
    };
    let mut values: Vec<f32> = (-300..=300).map(|i| i as f32 / 100.0).collect();
    values.extend([-1e30, 1e30, 1e-20, 17.0]);
    let found = probe.run(&values);
    let pairs = values.iter().zip(&found).map(|(x, y)| (f(*y), error_function(f(*x).clamp(-2.5, 2.5))));
    hold("error function", worst(pairs), 4.3e-6);
    assert_eq!(found[300], 0.0);
}

/// A probe of sections: kernel, square of the distance, begin and end.
const SECTIONS: Probe<'static> = Probe {
    head: "#import airlight::splatting::footprint::{Kernel, footprint_section}",
    body: "let kernel = Kernel(input(0u), input(1u), input(2u), input(3u));
           output(0u, footprint_section(kernel, input(4u), input(5u), input(6u)));",
    inputs: 7,
    outputs: 1,
};

const KERNELS: [(f32, f32); 4] = [(0.7, 2.25), (0.6, 2.0), (1.0, 1.5), (2.0, 7.0)];

fn record(kernel: Kernel, distance: f64, [begin, end]: [f64; 2]) -> [f32; 7] {
    let Kernel { sigma, radius, scale, edge } = kernel;
    [sigma, radius, scale, edge, (distance * distance) as f32, begin as f32, end as f32]
}

#[test]
fn sections_of_footprints_are_integrals_of_the_kernel() {
    let mut random = Random(5);
    for (sigma, radius) in KERNELS {
        let kernel = Kernel::new(sigma, radius).unwrap();
        let reference = ReferenceKernel::new(f(sigma), f(radius));
        assert!((f(kernel.scale) / reference.scale - 1.0).abs() < 2e-5, "{kernel:?} {reference:?}");
        let mut records: Vec<f32> = Vec::new();
        let mut expected = Vec::new();
        for _ in 0..400 {
            let distance = random.between(0.0, 1.1) * f(radius);
            let [a, b] = [0; 2].map(|_| random.between(-1.3, 1.3) * f(radius));
            records.extend(record(kernel, distance, [a.min(b), a.max(b)]));
            expected.push(reference.section(distance, a.min(b), a.max(b)));
        }
        let peak = reference.section(0.0, -f(radius), f(radius));
        let found = SECTIONS.run(&records);
        assert!(found.iter().all(|section| *section >= 0.0));
        let error = worst(found.iter().map(|x| f(*x)).zip(expected)) / peak;
        hold(&format!("section of {sigma} to {radius}, of the peak"), error, 1.5e-5);
    }
}

#[test]
fn sections_of_any_tilt_add_up_to_the_whole() {
    // Heights of sheets along any normal, seen along any ray, as `splat_sheet` makes sections of them.
    let mut random = Random(6);
    for (sigma, radius) in KERNELS {
        let kernel = Kernel::new(sigma, radius).unwrap();
        let mut records: Vec<f32> = Vec::new();
        let sheets = 12;
        for _ in 0..100 {
            let distance = random.between(0.0, 1.0) * f(radius);
            // The cosine between ray and normal, and how far the sheets are shifted at this pixel.
            let (cosine, shift) = (random.between(0.05, 1.0), random.between(-2.0, 2.0));
            let thickness = random.between(0.1, 1.0) * f(radius);
            let first = -0.5 * thickness * f64::from(sheets) + shift;
            let place = |sheet: i32| (first + thickness * f64::from(sheet)) / cosine;
            for sheet in 0..sheets {
                records.extend(record(kernel, distance, [place(sheet), place(sheet + 1)]));
            }
            records.extend(record(kernel, distance, [place(0), place(sheets)]));
        }
        let found = SECTIONS.run(&records);
        let peak = ReferenceKernel::new(f(sigma), f(radius)).section(0.0, -f(radius), f(radius));
        let sums = found.chunks_exact(sheets as usize + 1).map(|sections| {
            let (whole, parts) = sections.split_last().unwrap();
            (parts.iter().map(|x| f(*x)).sum::<f64>(), f(*whole))
        });
        hold(&format!("sum of sections of {sigma} to {radius}, of the peak"), worst(sums) / peak, 3e-6);
    }
}

#[test]
fn exact_parts_are_multiples_that_half_floats_hold() {
    let probe = Probe {
        head: "#import airlight::splatting::sheets::{in_exact_parts, sheet_mean}",
        body: "let parts = in_exact_parts(input(0u));
               output(0u, parts.x); output(1u, parts.y); output(2u, parts.z); output(3u, sheet_mean(parts));",
        inputs: 1,
        outputs: 4,
    };
    let mut random = Random(7);
    let values: Vec<f32> = (0..2000).map(|_| random.magnitude(1e-8, 4.0) as f32).collect();
    let found = probe.run(&values);
    for parts in found.chunks_exact(4) {
        assert_eq!((parts[0] * 512.0).fract(), 0.0, "{parts:?}");
        assert_eq!([(parts[1] * 32.0).fract(), (parts[2] * 32.0).fract()], [0.0; 2], "{parts:?}");
        assert!(parts[1].abs() <= 0.5 && parts[2].abs() <= 0.5, "{parts:?}");
    }
    let pairs = values.iter().zip(found.chunks_exact(4)).map(|(value, parts)| (f(parts[3]), f(*value)));
    // Half of the least multiple, and what f32 rounds of 4.
    hold("sum of the parts", worst(pairs), 1.5e-6);
}

#[test]
fn the_mean_transmittance_is_that_of_the_depth() {
    let probe = Probe {
        head: "#import airlight::splatting::sheet_shading::mean_transmittance",
        body: "output(0u, mean_transmittance(input(0u)));",
        inputs: 1,
        outputs: 1,
    };
    let mut random = Random(8);
    let mut values: Vec<f32> = (0..3000).map(|_| random.magnitude(1e-6, 200.0) as f32).collect();
    values.extend([0.199_999, 0.2, 0.200_001]);
    let ratio = |(x, y): (&f32, &f32)| (f(*y) * f(*x) / -(-f(*x)).exp_m1(), 1.0);
    hold("mean transmittance", worst(values.iter().zip(&probe.run(&values)).map(ratio)), 1.5e-6);
    assert_eq!(probe.run(&[0.0, -1.0]), [1.0, 1.0]);
}

#[test]
fn gradients_of_linear_fields_are_exact() {
    let probe = Probe {
        head: "#import airlight::splatting::sheet_shading::gradient_of_changes",
        body: "var v: array<vec3<f32>, 4>;
               for (var i = 0u; i < 4u; i++) { v[i] = vec3<f32>(input(3u * i), input(3u * i + 1u), input(3u * i + 2u)); }
               let gradient = gradient_of_changes(v[0], v[1], v[2], v[3]);
               output(0u, gradient.x); output(1u, gradient.y); output(2u, gradient.z);",
        inputs: 12,
        outputs: 3,
    };
    let mut random = Random(9);
    let (mut records, mut expected) = (Vec::new(), Vec::new());
    while expected.len() < 500 {
        let ways = [0; 3].map(|_| random.direction() * random.magnitude(1e-3, 10.0));
        let unit = ways.map(Vec3::normalised);
        // As far from a plane as neighbouring pixels and sheets are.
        if unit[0].dot(unit[1].cross(unit[2])).abs() < 0.3 {
            continue;
        }
        let gradient = random.direction() * random.magnitude(0.01, 10.0);
        records.extend(ways.iter().flat_map(|way| way.to_array()).map(|x| x as f32));
        records.extend(ways.map(|way| way.dot(gradient) as f32));
        expected.push(gradient);
    }
    let found = probe.run(&records);
    let errors = found.chunks_exact(3).zip(&expected);
    let relative =
        errors.map(|(found, expected)| ((triple(found) - *expected).length() / expected.length(), 0.0));
    hold("gradient of a linear field", worst(relative), 5e-6);
    let flat = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 3.0, 4.0, 5.0];
    let none = [0.0; 12];
    assert_eq!(probe.run(&[flat, none].concat()), [0.0; 6]);
}
