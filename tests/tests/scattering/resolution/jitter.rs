// SPDX-License-Identifier: MIT OR Apache-2.0
//! Shifted samples: blue noise, and coarse marches that are exact on average.

use super::case::{Case, channels};
use crate::gpu::gpu;
use crate::probing::f;
use airlight::core::Jitter;
use airlight::data::{BLUE_NOISE_SIDE, blue_noise};
use airlight::scattering::Along;
use airlight_tests::error;
use std::f64::consts::PI;

#[test]
fn blue_noise_is_uniform_and_blue() {
    let side = BLUE_NOISE_SIDE;
    let tile: Vec<f64> = blue_noise().iter().map(|x| f(*x)).collect();
    // The histogram is exactly uniform, at 8 bits as well.
    let mut ranks: Vec<usize> = tile.iter().map(|x| (x * 4096.0 - 0.5) as usize).collect();
    let mut eight_bits = [0; 256];
    ranks.iter().for_each(|rank| eight_bits[rank * 256 / 4096] += 1);
    assert!(eight_bits.iter().all(|count| *count == 16));
    ranks.sort_unstable();
    assert!(ranks.into_iter().eq(0..4096));
    // The power spectrum: rows, then columns.
    let transform = |line: &dyn Fn(usize) -> (f64, f64), k: usize| {
        (0..side).fold((0.0, 0.0), |(re, im), i| {
            let (sine, cosine) = (-2.0 * PI * (k * i % side) as f64 / side as f64).sin_cos();
            let (a, b) = line(i);
            (re + a * cosine - b * sine, im + a * sine + b * cosine)
        })
    };
    let mut rows = vec![(0.0, 0.0); side * side];
    for y in 0..side {
        for k in 0..side {
            rows[y * side + k] = transform(&|i| (tile[y * side + i] - 0.5, 0.0), k);
        }
    }
    let (mut low, mut middle, mut total) = ((0.0, 0), (0.0, 0), 0.0);
    for kx in 0..side {
        for ky in 0..side {
            let (re, im) = transform(&|i| rows[i * side + kx], ky);
            let power = (re * re + im * im) / (side * side) as f64;
            let wrapped = |k: usize| k.min(side - k) as f64;
            let frequency = wrapped(kx).hypot(wrapped(ky));
            total += power;
            if frequency > 0.0 && frequency < side as f64 / 8.0 {
                low = (low.0 + power, low.1 + 1);
            } else if frequency < side as f64 / 4.0 {
                middle = (middle.0 + power, middle.1 + 1);
            }
        }
    }
    // Parseval: the mean power is the variance of uniform numbers.
    let mean = total / (side * side) as f64;
    assert!((mean - 1.0 / 12.0).abs() < 1e-4, "{mean}");
    let (low, middle) = (low.0 / f64::from(low.1) / mean, middle.0 / f64::from(middle.1) / mean);
    println!(
        "blue noise: power {low:.4} below 1/8, {middle:.3} from there to 1/4 of the sampling rate; white is 1"
    );
    assert!(low < 0.02 && middle < 0.3, "{low} {middle}");
}

/// Mean visibility over 4x4 pixels that lie at about one distance; none elsewhere.
fn blocks(values: &[f64], smooth: &[bool], [width, height]: [usize; 2]) -> Vec<f64> {
    let mut means = Vec::new();
    for y in (0..height - 3).step_by(4) {
        for x in (0..width - 3).step_by(4) {
            let at = |i: usize| (y + i / 4) * width + x + i % 4;
            if (0..16).all(|i| smooth[at(i)]) {
                means.push((0..16).map(|i| values[at(i)]).sum::<f64>() / 16.0);
            }
        }
    }
    means
}

#[test]
fn jitter_makes_a_coarse_march_exact_on_average() {
    const STEPS: u32 = 16;
    let case = Case::new("foliage", [480, 270]);
    let inputs = case.stage.inputs();
    let size = case.size.map(|side| side as usize);
    let rows = Along::RowSteps { map: &case.map, steps: STEPS };
    let shadow_map = Along::ShadowMap { steps: STEPS };
    let fine = [Along::RowSteps { map: &case.map, steps: 4096 }, Along::ShadowMap { steps: 4096 }];
    let everywhere = vec![true; size[0] * size[1]];
    for (along, fine, name) in [(&rows, &fine[0], "rows"), (&shadow_map, &fine[1], "shadow map")] {
        let visibility = |along: &Along<'_>, jitter, frame| -> Vec<f64> {
            let march = case.jittered(&inputs, along, jitter, frame, case.size);
            channels(&march.scattered.read(gpu()).unwrap(), 3..4).into_iter().map(f).collect()
        };
        let exact = visibility(fine, Jitter::None, 0);
        let exact_blocks = blocks(&exact, &everywhere, size);
        let of = |values: &[f64]| {
            let means = blocks(values, &everywhere, size);
            [error::mean_absolute(&means, &exact_blocks), error::mean_absolute(values, &exact)]
        };
        let [plain_blocks, plain] = of(&visibility(along, Jitter::None, 0));
        for jitter in [Jitter::Gradient, Jitter::BlueNoise] {
            let first = visibility(along, jitter, 0);
            let [block, pixel] = of(&first);
            let mut mean = vec![0.0; first.len()];
            for frame in 0..16 {
                for (sum, value) in mean.iter_mut().zip(visibility(along, jitter, frame)) {
                    *sum += value / 16.0;
                }
            }
            let frames = error::mean_absolute(&mean, &exact);
            println!(
                "{name}, {jitter:?}: 4x4 {block:.4} (without {plain_blocks:.4}), 16 frames {frames:.4} \
                 (without {plain:.4}), one pixel {pixel:.4}"
            );
            assert!(block < 0.6 * plain_blocks, "{name}, {jitter:?}: {block} without {plain_blocks}");
            assert!(frames < 0.35 * plain, "{name}, {jitter:?}: {frames} without {plain}");
            assert_ne!(first, visibility(along, jitter, 1), "{name}, {jitter:?} stands still");
        }
    }
    // One step a texel has nothing to shift.
    let texels = Along::Rows(&case.map);
    let plain = case.march(&inputs, &texels, case.size).scattered.read(gpu()).unwrap();
    let jittered = case.jittered(&inputs, &texels, Jitter::BlueNoise, 3, case.size);
    assert_eq!(plain, jittered.scattered.read(gpu()).unwrap());
}
