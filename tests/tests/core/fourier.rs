// SPDX-License-Identifier: MIT OR Apache-2.0
//! The Fourier series of visibility on the GPU against f64, within stated error budgets, and what weighs it: means
//! along a row, and the exponentials of optical depth.

use crate::gpu::{Probe, Random};
use crate::probing::{f, hold, worst};
use airlight_tests::linear::Vec3;
use airlight_tests::reference::{fourier, prefix_sum, scattering};
use std::f64::consts::PI;

/// Depths of all kinds in [0, 1].
fn depths() -> Vec<f32> {
    let mut random = Random(3);
    let mut depths: Vec<f32> = (0..=256).map(|i| i as f32 / 256.0).collect();
    depths.extend((0..2000).map(|_| random.unit() as f32));
    depths.extend([0.05, 0.95, 1e-7, 1.0 - 6e-8, 1.0 / 3.0]);
    depths
}

#[test]
fn bases_are_sines_and_cosines() {
    let probe = Probe {
        head: "#import airlight::core::fourier_basis::{series_at, series_first, series_next, sine_cosine, rotate}",
        body: "for (var g = 0u; g < 32u; g++) {
                   let s = series_at(input(0u), g);
                   for (var k = 0u; k < 4u; k++) { output(4u * g + k, s.basis[k]); }
               }
               var s = series_at(input(0u), 0u);
               for (var g = 0u; g < 32u; g++) {
                   for (var k = 0u; k < 4u; k++) { output(128u + 4u * g + k, s.basis[k]); }
                   s = series_next(s);
               }
               let a = sine_cosine(input(0u) * 100.0 - 50.0);
               let b = rotate(sine_cosine(input(0u)), sine_cosine(0.25));
               output(256u, a.x); output(257u, a.y); output(258u, b.x); output(259u, b.y);
               s = series_first(input(0u));
               for (var g = 0u; g < 32u; g++) {
                   for (var k = 0u; k < 4u; k++) { output(260u + 4u * g + k, s.basis[k]); }
                   s = series_next(s);
               }",
        inputs: 1,
        outputs: 388,
    };
    let depths = depths();
    let found = probe.run(&depths);
    let records = || depths.iter().zip(found.chunks_exact(388)).map(|(z, found)| (f(*z), found));
    for group in [0, 1, 3, 7, 15, 31] {
        // The argument is rounded once: half a unit in the last place of the number of half turns.
        let frequency = f64::from(4 * group as u32 + 3);
        let budget = 1e-6 + 3e-7 * frequency;
        let error = |offset: usize| {
            worst(records().flat_map(|(z, found)| {
                let expected = fourier::basis(128, z)[4 * group..4 * group + 4].to_vec();
                let found = found[offset + 4 * group..][..4].to_vec();
                found.into_iter().map(f).zip(expected)
            }))
        };
        hold(&format!("series_at, group {group}"), error(0), budget);
        hold(&format!("series_next, group {group}"), error(128), 1e-6 + 4e-7 * group as f64 * PI);
        // The turn is four times the first angle, error included.
        hold(&format!("series_first, group {group}"), error(260), 1e-6 + 8e-7 * group as f64 * PI);
    }
    let turns = worst(records().flat_map(|(z, found)| {
        let angle = PI * f((z as f32) * 100.0 - 50.0);
        [(f(found[256]), angle.sin()), (f(found[257]), angle.cos())]
    }));
    // The product may be fused with the difference: one rounding of 100 half turns.
    hold("sine_cosine", turns, 2e-5);
    let rotated = worst(records().flat_map(|(z, found)| {
        let angle = PI * (z + 0.25);
        [(f(found[258]), angle.sin()), (f(found[259]), angle.cos())]
    }));
    hold("rotate", rotated, 1e-6);
}

/// Coefficients, plain and windowed, and the series of a ray and a texel, for M bases.
fn series(m: u32, pairs: &[[f32; 2]]) -> Vec<f32> {
    let body = "let groups = u32(input(2u)) / 4u;
        var ray = series_at(input(0u), 0u);
        var texel = series_at(input(1u), 0u);
        var window = series_at(1.0 / input(2u), 0u);
        var plain = 0.5;
        var lanczos = 0.5;
        for (var g = 0u; g < groups; g++) {
            let a = coefficients(ray, g);
            let b = coefficients_lanczos(ray, window, g, 4u * groups);
            for (var k = 0u; k < 4u; k++) { output(4u * g + k, a[k]); output(128u + 4u * g + k, b[k]); }
            let stored = basis_from_stored(stored_from_basis(texel.basis));
            plain += dot(a, stored);
            lanczos += dot(b, stored);
            ray = series_next(ray); texel = series_next(texel); window = series_next(window);
        }
        output(256u, plain); output(257u, lanczos);
        let scale = coefficient_scale(groups - 1u);
        output(258u, scale.x); output(259u, scale.y);";
    let probe = Probe {
        head: "#import airlight::core::fourier_basis::{
            series_at, series_next, coefficients, coefficients_lanczos, coefficient_scale, stored_from_basis, basis_from_stored
        }",
        body,
        inputs: 3,
        outputs: 260,
    };
    let inputs: Vec<f32> = pairs.iter().flat_map(|[ray, texel]| [*ray, *texel, m as f32]).collect();
    probe.run(&inputs)
}

#[test]
fn coefficients_and_series_are_those_of_the_reference() {
    let mut random = Random(5);
    let pairs: Vec<[f32; 2]> = (0..500).map(|_| [random.unit() as f32, random.unit() as f32]).collect();
    for m in [4_u32, 8, 12, 16, 32, 64, 100, 128] {
        let found = series(m, &pairs);
        let count = m as usize;
        for (window, offset, name) in
            [(fourier::Window::None, 0, "plain"), (fourier::Window::Lanczos, 128, "Lanczos")]
        {
            let records = || pairs.iter().zip(found.chunks_exact(260));
            let coefficients = worst(records().flat_map(|(pair, found)| {
                let expected = fourier::coefficients(count, f(pair[0]), window);
                found[offset..offset + count]
                    .iter()
                    .map(|x| f(*x))
                    .collect::<Vec<_>>()
                    .into_iter()
                    .zip(expected)
            }));
            hold(&format!("coefficients, {name}, {m} bases"), coefficients, 1e-6);
            let at = 256 + usize::from(offset > 0);
            let sums =
                worst(records().map(|(pair, found)| {
                    (f(found[at]), fourier::series(count, f(pair[0]), f(pair[1]), window))
                }));
            hold(&format!("series, {name}, {m} bases"), sums, 1e-5);
        }
        let scale =
            found[258..260].iter().zip([m - 3, m - 1]).map(|(s, n)| (f(*s), 2.0 / (PI * f64::from(n))));
        hold(&format!("coefficient_scale, {m} bases"), worst(scale), 1e-7);
    }
}

#[test]
fn errors_on_a_plane_are_those_of_the_table() {
    // EQUATIONS.md 1.4: mean error of one texel at 0.5 over all rays, to four digits.
    let rays: Vec<[f32; 2]> = (0..8000).map(|i| [(i as f32 + 0.5) / 8000.0, 0.5]).collect();
    for (m, none, lanczos) in [
        (4, 0.1091, 0.1262),
        (8, 0.0660, 0.0643),
        (16, 0.0386, 0.0326),
        (32, 0.0221, 0.0164),
        (64, 0.0125, 0.0082),
        (128, 0.0069, 0.0041),
    ] {
        let found = series(m, &rays);
        let mean = |at: usize| {
            let errors = rays.iter().zip(found.chunks_exact(260));
            errors.map(|(r, found)| (f(found[at]) - fourier::visibility(f(r[0]), 0.5)).abs()).sum::<f64>()
                / 8000.0
        };
        let (plain, windowed) = (mean(256), mean(257));
        println!("{m} bases on a plane: {plain:.4} plain, {windowed:.4} Lanczos");
        assert!((plain - none).abs() < 1e-4, "{m} plain: {plain} instead of {none}");
        assert!((windowed - lanczos).abs() < 1e-4, "{m} Lanczos: {windowed} instead of {lanczos}");
        // Overshoot: 9 % of the plain series, 1.2 % of the windowed one.
        let over = |at: usize| found.chunks_exact(260).map(|r| f(r[at]) - 1.0).fold(0.0, f64::max);
        assert!(m < 16 || ((over(256) - 0.09).abs() < 0.005 && (over(257) - 0.012).abs() < 0.003), "{m}");
    }
}

#[test]
fn the_guard_keeps_rays_from_both_ends() {
    let probe = Probe {
        head: "#import airlight::core::fourier_basis::{guarded, GUARD, surface_bias}",
        body: "output(0u, guarded(input(0u))); output(1u, GUARD);
               output(2u, surface_bias(4u)); output(3u, surface_bias(32u)); output(4u, surface_bias(128u));",
        inputs: 1,
        outputs: 5,
    };
    let mut inputs: Vec<f32> = (-100..=200).map(|i| i as f32 / 100.0).collect();
    inputs.extend([-1e30, 1e30, -0.06, 1.06]);
    let found = probe.run(&inputs);
    let error = worst(inputs.iter().zip(found.chunks_exact(5)).map(|(unit, found)| {
        assert_eq!(found[1], 0.05);
        // Half the softened edge, and never the whole guard.
        assert!(worst([0.04, 0.01875, 0.0046875].iter().zip(&found[2..]).map(|(e, b)| (*e, f(*b)))) < 1e-8);
        (f(found[0]), (0.05 + 0.9 * f(*unit)).clamp(0.0, 1.0))
    }));
    hold("guarded", error, 1.5e-7);
    for (unit, found) in
        inputs.iter().zip(found.chunks_exact(5)).filter(|(unit, _)| (0.0..=1.0).contains(*unit))
    {
        assert!((0.05 - 1e-7..=0.95 + 1e-7).contains(&f(found[0])), "{unit}");
    }
}

// Prefix sums.

#[test]
fn running_means_are_those_of_the_reference() {
    let probe = Probe {
        head: "#import airlight::core::prefix_sum::{row_weights, row_weights_next, running_mean}",
        body: "var weights = row_weights(input(0u));
               var mean = vec4<f32>(0.0);
               let count = u32(input(1u));
               for (var i = 0u; i < count; i++) {
                   let value = vec4<f32>(input(2u + i), -input(2u + i), 1.0, 0.0);
                   mean = running_mean(mean, value, weights);
                   output(2u * i, mean.x);
                   output(2u * i + 1u, mean.z);
                   weights = row_weights_next(weights);
               }",
        inputs: 4098,
        outputs: 8192,
    };
    let mut random = Random(37);
    let values: Vec<f32> = (0..4096).map(|_| random.between(-1.0, 1.0) as f32).collect();
    let steps = [0.0_f32, 1e-9, 1e-5, 1e-3, 0.03, 1.0, 60.0, 1e6, -1.0];
    let mut inputs = Vec::new();
    for step in steps {
        inputs.extend([step, 4096.0]);
        inputs.extend(&values);
    }
    let found = probe.run(&inputs);
    let exact: Vec<f64> = values.iter().map(|v| f(*v)).collect();
    for (step, found) in steps.iter().zip(found.chunks_exact(8192)) {
        // An optical depth below zero counts as none. Weights are powers of a rounded ratio: the budget
        // allows for that over the texels that still weigh anything.
        let weights = prefix_sum::transmittance_weights(4096, f(step.max(0.0)));
        let expected = prefix_sum::running_mean(&exact, &weights);
        let error = worst(found.chunks_exact(2).map(|pair| f(pair[0])).zip(expected));
        hold(&format!("running_mean, optical step {step}"), error, 5e-6);
        let ones = worst(found.chunks_exact(2).map(|pair| (f(pair[1]), 1.0)));
        hold(&format!("mean of ones, optical step {step}"), ones, 1e-6);
    }
}

// What `scattering/single_scatter` adds.

#[test]
fn absorption_and_in_scattering_keep_their_precision() {
    let probe = Probe {
        head: "#import airlight::scattering::single_scatter::{Medium, transmittance, in_scattered}
               #import airlight::core::prefix_sum::{one_minus_exp, prefix_weight}",
        body: "let medium = Medium(vec3<f32>(0.9), input(0u), input(1u), 100.0, 0.0, 0.0);
               output(0u, one_minus_exp(input(0u)));
               output(1u, transmittance(input(0u)));
               output(2u, in_scattered(medium, vec3<f32>(3.0, 2.0, 1.0), input(2u), input(3u), 0.75).y);
               output(3u, prefix_weight(input(0u), 10.0 * input(3u)));",
        inputs: 4,
        outputs: 4,
    };
    let mut random = Random(41);
    let mut inputs = Vec::new();
    for i in 0..=1200 {
        let x = 10_f32.powf(i as f32 / 25.0 - 40.0);
        let x = if i < 20 { [0.0, 0.05, 0.049_999, 0.050_001][i % 4] } else { x.min(1e6) };
        let g = random.between(-0.9, 0.9) as f32;
        inputs.extend([x, g, random.between(-1.0, 1.0) as f32, random.magnitude(0.01, 100.0) as f32]);
    }
    let found = probe.run(&inputs);
    let (mut absorbed, mut passed, mut radiance, mut prefix) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
    for (input, found) in inputs.chunks_exact(4).zip(found.chunks_exact(4)) {
        let [x, g, cosine, distance] = [0, 1, 2, 3].map(|i| f(input[i]));
        // Below 1e-37 the number itself is at the end of f32.
        if x > 1e-37 {
            absorbed = absorbed.max((f(found[0]) / -(-x).exp_m1() - 1.0).abs());
        }
        passed = passed.max((f(found[1]) - (-x).exp()).abs());
        // In units of the first of equal texels of the optical depth x; up to 1000 texels.
        let texels = 10.0 * distance;
        let weight = if x == 0.0 { texels } else { (-x * texels).exp_m1() / (-x).exp_m1() };
        prefix = prefix.max((f(found[3]) / weight - 1.0).abs());
        let medium = scattering::Medium { extinction: x, albedo: f(0.9), g, distance_limit: 100.0 };
        let light = scattering::Light { direction: Vec3::new(0.0, 1.0, 0.0), radiance: [3.0, 2.0, 1.0] };
        let direction = Vec3::new((1.0 - cosine * cosine).sqrt(), cosine, 0.0);
        let expected = medium.radiance(&light, direction, distance, 0.75)[1];
        if expected > 1e-35 {
            radiance = radiance.max((f(found[2]) / expected - 1.0).abs());
        } else {
            assert!(f(found[2]).abs() <= 1e-34, "{found:?}");
        }
    }
    hold("one_minus_exp, relative", absorbed, 1e-6);
    hold("transmittance", passed, 3e-7);
    // Where a texel's optical depth is below 1e-6, texels count alike.
    hold("prefix_weight, relative", prefix, 6e-4);
    hold("in_scattered, relative", radiance, 5e-6);
    assert_eq!(found[0..3], [0.0, 1.0, 0.0], "no medium scatters nothing");
}
