// SPDX-License-Identifier: MIT OR Apache-2.0
//! Kernels of the blurs.

use crate::gpu::Probe;
use crate::probing::{f, hold, worst};

#[test]
fn kernels_of_blurs_have_the_variance_that_was_asked_for() {
    let probe = Probe {
        head: "#import airlight::splatting::blur::{blur_sums, blur_weight}",
        body: "let v = input(0u); let sums = blur_sums(v);
               for (var i = 0u; i < 14u; i++) { output(i, blur_weight(v, sums, i)); }",
        inputs: 1,
        outputs: 14,
    };
    let values: Vec<f32> = (0..=1600).map(|i| i as f32 / 100.0).collect();
    let found = probe.run(&values);
    let moments = |kernel: &[f32]| {
        let both = |i: usize| if i == 0 { 1.0 } else { 2.0 };
        let sum = |power: i32| -> f64 {
            kernel.iter().enumerate().map(|(i, w)| both(i) * f(*w) * (i as f64).powi(power)).sum()
        };
        [sum(0), sum(2)]
    };
    let all: Vec<[f64; 2]> = found.chunks_exact(14).map(moments).collect();
    assert!(
        found.iter().all(|weight| *weight >= 0.0) && found.chunks_exact(14).all(|kernel| kernel[13] == 0.0)
    );
    hold("sum of weights", worst(all.iter().map(|m| (m[0], 1.0))), 5e-7);
    let variances = all.iter().zip(&values).map(|(m, v)| (m[1] / f(*v).max(1.0), f(*v) / f(*v).max(1.0)));
    hold("variance of kernels, relative", worst(variances), 2e-6);
}
