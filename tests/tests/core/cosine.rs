// SPDX-License-Identifier: MIT OR Apache-2.0
//! The cosine basis on the GPU against f64, within stated error budgets.

use crate::gpu::{Probe, Random};
use crate::probing::{f, hold, worst};
use std::f64::consts::{PI, SQRT_2};

const GROUPS: usize = 4;

fn depths() -> Vec<f32> {
    let mut random = Random(13);
    let mut depths: Vec<f32> = (0..=128).map(|i| i as f32 / 128.0).collect();
    depths.extend((0..1000).map(|_| random.unit() as f32));
    depths.extend([1e-7, 1e-4, 1.0 - 6e-8, 1.0 / 3.0]);
    depths
}

/// Simpson's rule.
fn integral(function: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    let step = (to - from) / 400.0;
    let weight = |i: i32| {
        if i == 0 || i == 400 {
            1.0
        } else if i % 2 == 1 {
            4.0
        } else {
            2.0
        }
    };
    (0..=400).map(|i| weight(i) * function(from + f64::from(i) * step)).sum::<f64>() * step / 3.0
}

fn basis(j: usize, x: f64) -> f64 {
    if j == 0 { 1.0 } else { SQRT_2 * (j as f64 * PI * x).cos() }
}

#[test]
fn bases_integrals_and_means_are_those_of_the_cosines() {
    let probe = Probe {
        head: "#import airlight::core::cosine_basis::{
                   harmonics_first, harmonics_next, cosine_basis, cosine_integral, cosine_spread, cosine_orders
               }",
        body: "var at = harmonics_first(input(0u));
               var extent = harmonics_first(input(1u));
               for (var g = 0u; g < 4u; g++) {
                   let b = cosine_basis(at, g);
                   let i = cosine_integral(at, input(0u), g);
                   let m = b * cosine_spread(extent, input(1u), g);
                   let o = cosine_orders(g);
                   for (var k = 0u; k < 4u; k++) {
                       output(4u * g + k, b[k]); output(16u + 4u * g + k, i[k]); output(32u + 4u * g + k, m[k]);
                       output(48u + 4u * g + k, o[k]);
                   }
                   at = harmonics_next(at);
                   extent = harmonics_next(extent);
               }",
        inputs: 2,
        outputs: 64,
    };
    let mut random = Random(17);
    let records: Vec<f32> = depths()
        .into_iter()
        .flat_map(|x| {
            let half = if random.unit() < 0.2 { 0.0 } else { random.magnitude(1e-6, 0.5) };
            [x, half.min(f64::from(x)).min(1.0 - f64::from(x)) as f32]
        })
        .collect();
    let found = probe.run(&records);
    let rows = || records.chunks_exact(2).map(|r| (f(r[0]), f(r[1]))).zip(found.chunks_exact(64));
    for j in 0..4 * GROUPS {
        // The angle is rounded once, then multiplied: j pi half a unit in the last place of 1, and the root of two.
        let budget = 1e-6 + 3e-7 * j as f64;
        hold(&format!("b_{j}"), worst(rows().map(|((x, _), v)| (f(v[j]), basis(j, x)))), budget);
        let integrals = rows().map(|((x, _), v)| (f(v[16 + j]), integral(|t| basis(j, t), 0.0, x)));
        hold(&format!("B_{j}"), worst(integrals), 1e-6);
        let means = rows().map(|((x, half), v)| {
            let mean = integral(|t| basis(j, t), x - half, x + half) / (2.0 * half);
            (f(v[32 + j]), if half < 1e-5 { basis(j, x) } else { mean })
        });
        hold(&format!("mean of b_{j}"), worst(means), 2.0 * budget);
        assert!(found.chunks_exact(64).all(|v| v[48 + j] == j as f32));
    }
}

/// Fifteen rotations, as many as a walk takes before it begins anew.
#[test]
fn harmonics_of_a_sum_of_depths_go_on_by_rotation() {
    let probe = Probe {
        head: "#import airlight::core::cosine_basis::{harmonics_first, harmonics_next, harmonics_sum}",
        body: "var at = harmonics_first(input(0u));
               let step = harmonics_first(input(1u));
               for (var i = 0u; i < 15u; i++) { at = harmonics_sum(at, step); }
               for (var g = 0u; g < 4u; g++) {
                   for (var k = 0u; k < 4u; k++) {
                       output(4u * g + k, at.cosine[k]); output(16u + 4u * g + k, at.sine[k]);
                   }
                   at = harmonics_next(at);
               }",
        inputs: 2,
        outputs: 32,
    };
    let mut random = Random(23);
    let records: Vec<f32> =
        (0..2000).flat_map(|_| [random.unit() as f32, random.between(0.0, 0.06) as f32]).collect();
    let found = probe.run(&records);
    for j in 0..4 * GROUPS {
        let angle = |r: &[f32]| j as f64 * PI * (f(r[0]) + 15.0 * f(r[1]));
        let rows = || records.chunks_exact(2).zip(found.chunks_exact(32));
        let budget = 2e-6 + 1.5e-6 * j as f64;
        hold(&format!("cosine {j}"), worst(rows().map(|(r, v)| (f(v[j]), angle(r).cos()))), budget);
        hold(&format!("sine {j}"), worst(rows().map(|(r, v)| (f(v[16 + j]), angle(r).sin()))), budget);
    }
}

#[test]
fn the_window_and_the_quotient_of_sine_and_angle() {
    let probe = Probe {
        head: "#import airlight::core::cosine_basis::{sine_over_angle, fejer_window}",
        body: "let x = vec4<f32>(input(0u));
               output(0u, sine_over_angle(sin(x), x).x);
               for (var g = 0u; g < 4u; g++) {
                   let w = fejer_window(g, 16u);
                   for (var k = 0u; k < 4u; k++) { output(1u + 4u * g + k, w[k]); }
               }",
        inputs: 1,
        outputs: 17,
    };
    let mut random = Random(19);
    let mut angles: Vec<f32> = (0..2000).map(|_| random.magnitude(1e-9, 20.0) as f32).collect();
    angles.extend([0.0, 0.5, 0.49999, 0.50001, -0.3, -2.0]);
    let found = probe.run(&angles);
    let quotient = |x: f64| if x == 0.0 { 1.0 } else { x.sin() / x };
    let pairs = angles.iter().zip(found.chunks_exact(17));
    hold("sin(x) / x", worst(pairs.map(|(x, v)| (f(v[0]), quotient(f(*x))))), 5e-7);
    for j in 0..16 {
        assert!((f(found[1 + j]) - (1.0 - j as f64 / 16.0)).abs() < 1e-7);
    }
}
