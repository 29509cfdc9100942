// SPDX-License-Identifier: MIT OR Apache-2.0
//! Values that are not finite, and colours.

use crate::gpu::Probe;
use crate::probing::{f, hold, worst};

#[test]
fn what_is_not_finite_is_replaced() {
    let probe = Probe {
        head: "#import airlight::core::finite::{is_finite, finite_or, finite_or_rgb}",
        body: "let x = input(0u);
               output(0u, select(0.0, 1.0, is_finite(x)));
               output(1u, finite_or(x, 7.0));
               let rgb = finite_or_rgb(vec3<f32>(x, 2.0, x), 7.0);
               output(2u, rgb.x); output(3u, rgb.y); output(4u, rgb.z);",
        inputs: 1,
        outputs: 5,
    };
    let wild = [
        f32::NAN,
        -f32::NAN,
        f32::from_bits(0x7f80_0001),
        f32::from_bits(0xffff_ffff),
        f32::INFINITY,
        f32::NEG_INFINITY,
    ];
    let fine = [0.0, -0.0, 1.0, -1.5, f32::MAX, f32::MIN, f32::MIN_POSITIVE, 1e-30];
    let subnormal = [f32::from_bits(1), f32::from_bits(0x8000_0001), f32::from_bits(0x007f_ffff)];
    let inputs: Vec<f32> = wild.into_iter().chain(fine).chain(subnormal).collect();
    for (x, found) in inputs.iter().zip(probe.run(&inputs).chunks_exact(5)) {
        if x.is_finite() {
            // A subnormal number may be flushed to zero.
            let kept = |y: f32| y == *x || (!x.is_normal() && y == 0.0);
            assert!(found[0] == 1.0 && [1, 2, 4].iter().all(|i| kept(found[*i])), "{x:e}: {found:?}");
        } else {
            assert_eq!(found, [0.0, 7.0, 7.0, 2.0, 7.0], "{x}");
        }
        assert_eq!(found[3], 2.0);
    }
}

#[test]
fn colours_follow_their_closed_forms() {
    let probe = Probe {
        head: "#import airlight::core::color::{luminance, tone_curve, srgb_from_linear}",
        body: "let x = input(0u);
               output(0u, srgb_from_linear(vec3<f32>(x, 0.0, 1.0)).x);
               output(1u, tone_curve(vec3<f32>(x, 0.0, 1.0)).x);
               output(2u, luminance(vec3<f32>(x, 0.5, 0.25)));
               output(3u, srgb_from_linear(vec3<f32>(x, 0.0, 1.0)).z);",
        inputs: 1,
        outputs: 4,
    };
    let mut inputs: Vec<f32> = (0..=2000).map(|i| i as f32 / 2000.0).collect();
    inputs.extend([0.0031307, 0.0031308, 0.0031309]);
    inputs.extend((0..600).map(|i| 10_f32.powf(i as f32 / 15.0 - 10.0)));
    inputs.sort_unstable_by(f32::total_cmp);
    let found = probe.run(&inputs);
    let srgb = worst(inputs.iter().zip(found.chunks_exact(4)).map(|(x, found)| {
        let x = f(*x).clamp(0.0, 1.0);
        (f(found[0]), if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 })
    }));
    hold("srgb_from_linear", srgb, 5e-6);
    let tone =
        worst(inputs.iter().zip(found.chunks_exact(4)).filter(|(x, _)| **x < 1e4).map(|(x, found)| {
            let x = f(*x);
            (f(found[1]), ((x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14)).clamp(0.0, 1.0))
        }));
    hold("tone_curve", tone, 1e-6);
    let luminance = worst(inputs.iter().zip(found.chunks_exact(4)).map(|(x, found)| {
        let expected = 0.2126 * f(*x) + 0.7152 * 0.5 + 0.0722 * 0.25;
        (f(found[2]) / expected, 1.0)
    }));
    hold("luminance, relative", luminance, 3e-7);
    let mut before = 0.0;
    for (x, found) in inputs.iter().zip(found.chunks_exact(4)) {
        assert!((0.0..=1.0).contains(&found[1]) && (0.0..=1.0).contains(&found[0]), "{x}: {found:?}");
        // Equal inputs of different order of operations may differ in the last place.
        assert!(found[1] >= before - 1e-7, "the tone curve falls at {x}: {} after {before}", found[1]);
        assert!((1.0 - 1e-6..=1.0).contains(&found[3]), "white is {}", found[3]);
        before = found[1];
    }
    assert_eq!(before, 1.0, "the tone curve ends at 1");
    let beyond = probe.run(&[-1.0, -1e30, f32::MAX]);
    assert_eq!([beyond[0], beyond[1], beyond[4], beyond[5], beyond[9]], [0.0, 0.0, 0.0, 0.0, 1.0]);
    assert!((beyond[8] - 1.0).abs() < 1e-6);
}
