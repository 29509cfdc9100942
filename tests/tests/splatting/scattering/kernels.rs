// SPDX-License-Identifier: MIT OR Apache-2.0
//! Shares and slopes of cones, and kernels, against quadrature.

use crate::gpu::{Probe, Random};
use crate::probing::{f, hold, worst};
use airlight_tests::reference::phase::henyey_greenstein;
use std::f32::consts::{FRAC_PI_2, FRAC_PI_3, FRAC_PI_6};
use std::f64::consts::PI;

/// Integral over a cone, by Simpson's rule over the angle; finer where phase functions peak.
pub fn over_cone(g: f64, cone: f64, value: impl Fn(f64) -> f64) -> f64 {
    const STEPS: u32 = 20_000;
    let at = |i: u32| {
        let unit = f64::from(i) / f64::from(STEPS);
        let angle = cone * unit * unit;
        2.0 * PI * henyey_greenstein(angle.cos(), g) * angle.sin() * value(angle) * 2.0 * cone * unit
    };
    let weight = |i: u32| match i {
        0 | STEPS => 1.0,
        i if i % 2 == 1 => 4.0,
        _ => 2.0,
    };
    (0..=STEPS).map(|i| weight(i) * at(i)).sum::<f64>() / (3.0 * f64::from(STEPS))
}

const CONES: [f32; 6] = [0.02, FRAC_PI_6, FRAC_PI_3, FRAC_PI_2, 2.4, 3.1415925];
const MEANS: [f32; 9] = [-0.95, -0.6, -0.01, -1e-6, 0.0, 1e-4, 0.3, 0.85, 0.97];

#[test]
fn shares_and_slopes_of_cones_are_integrals() {
    let probe = Probe {
        head: "#import airlight::splatting::light_scattering::{Scattering, cone_share, cone_shares, mean_square_slope}",
        body: "output(0u, cone_share(input(0u), input(1u))); output(1u, mean_square_slope(input(0u), input(1u)));
               let both = cone_shares(Scattering(input(1u), input(1u), 0.0, 0.0), input(0u));
               output(2u, both.x); output(3u, both.y);",
        inputs: 2,
        outputs: 4,
    };
    let all: Vec<[f32; 2]> = MEANS.iter().flat_map(|g| CONES.map(|cone| [*g, cone])).collect();
    let found = probe.run(&all.concat());
    let steepest = 75_f64.to_radians();
    let (mut shares, mut slopes) = (Vec::new(), Vec::new());
    for ([g, cone], found) in all.iter().zip(found.chunks_exact(4)) {
        let share = over_cone(f(*g), f(*cone), |_| 1.0);
        shares.push((f(found[0]) / share, 1.0));
        let slope = over_cone(f(*g), f(*cone), |angle| angle.min(steepest).tan().powi(2)) / share;
        slopes.push((f(found[1]) / slope, 1.0));
        assert_eq!(found[2], found[0]);
        let back = over_cone(-f(*g), f(*cone), |_| 1.0).min(1.0 - share);
        assert!((f(found[3]) - back).abs() < 2e-6 && found[2] + found[3] <= 1.0, "{g} {cone}: {found:?}");
    }
    hold("share of a cone, relative", worst(shares.into_iter()), 2e-5);
    hold("mean squared slope, relative", worst(slopes.into_iter()), 2e-3);
    // Figures of EQUATIONS.md, 9.
    let degrees = |g: f32, cone: f32| probe.run(&[g, cone.to_radians()])[0];
    for (found, expected) in [
        (degrees(0.85, 30.0), 0.762),
        (degrees(-0.85, 30.0), 0.0031),
        (degrees(0.85, 90.0), 0.964),
        (degrees(0.0, 30.0), 0.067),
    ] {
        assert!((found - expected).abs() < 5.1e-4, "{found} for {expected}");
    }
}

#[test]
fn kernels_have_their_sum_and_variance() {
    let probe = Probe {
        head: "#import airlight::splatting::light_scattering::axis_kernel",
        body: "let kernel = axis_kernel(input(0u));
               for (var i = 0u; i < 16u; i++) { output(i, kernel.weights[i >> 2u][i & 3u]); }",
        inputs: 1,
        outputs: 16,
    };
    let mut random = Random(3);
    let mut values = vec![0.0, 1e-6, 0.499_999, 0.5, 0.500_001, 15.999, 16.0, 17.0, 1e30];
    values.extend((0..500).map(|_| random.magnitude(1e-3, 16.0) as f32));
    let found = probe.run(&values);
    let (mut sums, mut variances) = (Vec::new(), Vec::new());
    for (variance, kernel) in values.iter().zip(found.chunks_exact(16)) {
        let (weights, rest) = kernel.split_at(13);
        let moment = |power: i32| -> f64 {
            let sides = weights.iter().enumerate().skip(1);
            2.0 * sides.map(|(i, weight)| (i as f64).powi(power) * f(*weight)).sum::<f64>()
        };
        sums.push((f(weights[0]) + moment(0), 1.0));
        let expected = f(variance.min(16.0));
        variances.push((moment(2) / expected.max(1e-30), if expected > 0.0 { 1.0 } else { 0.0 }));
        let radius = rest[2] as usize;
        assert_eq!([rest[0], rest[1]], [0.0; 2]);
        assert!(radius <= 12 && weights[radius + 1..].iter().all(|weight| *weight == 0.0), "{kernel:?}");
        assert!(weights.windows(2).all(|pair| pair[0] >= pair[1] && pair[1] >= 0.0), "{variance} {kernel:?}");
    }
    hold("sum of weights", worst(sums.into_iter()), 5e-7);
    hold("variance, relative", worst(variances.into_iter()), 5e-6);
}
