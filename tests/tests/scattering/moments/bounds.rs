// SPDX-License-Identifier: MIT OR Apache-2.0
//! Bounds of visibility from six moments, against the f64 reference.

use crate::gpu::{Probe, Random};
use crate::probing::hold;
use airlight_tests::reference::scattering as reference;

/// MOMENT_BIAS and MOMENT_BLEND of the shader.
pub const BIAS: f64 = 1e-5;

pub const BLEND: f64 = 0.15;

/// One step of a stored moment.
pub const STEP: f64 = 2.0 / 2_097_151.0;

/// Depths of the texels of a prefix: of all kinds, degenerate ones among them.
fn prefix(random: &mut Random) -> Vec<f64> {
    let most = [1, 4, 40, 400][random.below(4)];
    let count = 1 + random.below(most);
    let centre = random.between(0.05, 0.95);
    let spread = random.magnitude(1e-6, 1.0);
    let levels = 1 + random.below(5);
    let kind = random.below(8);
    let edge = random.unit();
    (0..count)
        .map(|i| match kind {
            0 => 1.0,
            1 => centre,
            2 => (centre + spread * (random.unit() - 0.5)).clamp(0.0, 1.0),
            3 => (random.below(levels) as f64 + 0.5) / levels as f64,
            4 => edge + (1.0 - edge) * i as f64 / count as f64,
            5 => [0.0, 1.0, centre][random.below(3)],
            6 => {
                if random.unit() < edge {
                    1.0
                } else {
                    centre + 1e-3 * random.unit()
                }
            }
            _ => random.unit(),
        })
        .collect()
}

/// A ray's depth, often at or next to one that is stored.
fn ray(random: &mut Random, depths: &[f64]) -> f64 {
    let stored = depths[random.below(depths.len())];
    let depth = match random.below(4) {
        0 => stored,
        1 => stored + random.between(-1.0, 1.0) * random.magnitude(1e-6, 0.1),
        _ => random.unit(),
    };
    depth.clamp(0.05, 0.95)
}

#[test]
fn bounds_are_those_of_the_reference() {
    let probe = Probe {
        head: "#import airlight::core::moment_bounds::Moments
               #import airlight::scattering::visibility_moments::{moment_bounds, moment_visibility}",
        body: "let m = Moments(vec3<f32>(input(0u), input(1u), input(2u)), vec3<f32>(input(3u), input(4u), input(5u)));
               let bounds = moment_bounds(m, input(6u));
               output(0u, bounds.x); output(1u, bounds.y); output(2u, moment_visibility(m, input(6u)));",
        inputs: 7,
        outputs: 3,
    };
    let mut random = Random(401);
    let mut records = Vec::new();
    let mut truths = Vec::new();
    for _ in 0..20_000 {
        let depths = prefix(&mut random);
        // What a filter sees: f32 depths; and what it stores.
        let moments = reference::chebyshev_moments(depths.iter().map(|d| (f64::from(*d as f32), 1.0)));
        let stored = moments.map(|m| (((m * 0.5 + 0.5) / (0.5 * STEP)).round() * STEP - 1.0) as f32);
        let depth = ray(&mut random, &depths) as f32;
        let lit = depths.iter().filter(|d| f64::from(depth) <= f64::from(**d as f32)).count();
        truths.push(lit as f64 / depths.len() as f64);
        records.extend(stored);
        records.push(depth);
    }
    let found = probe.run(&records);
    let (mut worst, mut outside, mut blend, mut mean, mut wide) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0, 0);
    for ((record, found), truth) in records.chunks_exact(7).zip(found.chunks_exact(3)).zip(&truths) {
        let moments: [f64; 6] = std::array::from_fn(|k| f64::from(record[k]));
        let (low, high) = reference::visibility_bounds(&moments, BIAS, f64::from(record[6]));
        let [least, greatest, visibility] = [0, 1, 2].map(|k| f64::from(found[k]));
        assert!((0.0..=1.0).contains(&least) && (least..=1.0).contains(&greatest), "{record:?}: {found:?}");
        let error = (least - low).abs().max((greatest - high).abs());
        worst = if error <= worst { worst } else { error };
        mean += error;
        outside = outside.max(least - truth).max(truth - greatest);
        blend = blend.max((visibility - (BLEND * least + (1.0 - BLEND) * greatest)).abs());
        wide += usize::from(high - low > 0.01);
    }
    println!("{} prefixes, mean error {:.1e}, {wide} with room", truths.len(), mean / truths.len() as f64);
    assert!(wide > truths.len() / 5);
    // Where all depths are nearly the same, the pivots of the matrix are BIAS / 2, and a weight w = 1 / (1 + x / pivot) errs by
    // at most a quarter of the pivot's relative error: that of two roundings of f32, each of 6e-8.
    hold("bounds", worst, 0.25 * 2.0 * 6e-8 / (0.5 * BIAS));
    hold("bounds, mean", mean / truths.len() as f64, 5e-5);
    hold("truth outside of the bounds", outside, 1e-4);
    hold("blend", blend, 1e-6);
}

#[test]
fn any_moments_give_a_visibility() {
    let probe = Probe {
        head: "#import airlight::core::moment_bounds::Moments
               #import airlight::scattering::visibility_moments::{moment_visibility, moment_bounds}",
        body: "let m = Moments(vec3<f32>(input(0u), input(1u), input(2u)), vec3<f32>(input(3u), input(4u), input(5u)));
               output(0u, moment_visibility(m, input(6u)));
               let bounds = moment_bounds(m, input(6u));
               output(1u, bounds.x); output(2u, bounds.y);",
        inputs: 7,
        outputs: 3,
    };
    let mut random = Random(402);
    let mut records: Vec<[f32; 7]> = (0..20_000)
        .map(|i| {
            std::array::from_fn(|_| match i % 4 {
                0 => random.between(-1.0, 1.0) as f32,
                1 => [0.0, 1.0, -1.0, 1e-20, 3e38, -3e38][random.below(6)],
                2 => [1.0, -1.0, 1.0 - 6e-8, -1.0 + 1e-6][random.below(4)],
                _ => (random.between(-1.0, 1.0) * random.magnitude(1e-30, 1e30)) as f32,
            })
        })
        .collect();
    records.push([0.0; 7]);
    for (record, found) in records.iter().zip(probe.run(records.as_flattened()).chunks_exact(3)) {
        assert!(found.iter().all(|v| (0.0..=1.0).contains(v)), "{record:?}: {found:?}");
    }
}

#[test]
fn cosine_of_a_third_is_never_too_small() {
    let probe = Probe {
        head: "#import airlight::core::moment_bounds::cosine_of_third",
        body: "output(0u, cosine_of_third(input(0u)));",
        inputs: 1,
        outputs: 1,
    };
    let records: Vec<f32> = (0..=4000).map(|i| -1.0 + i as f32 / 2000.0).collect();
    let (mut below, mut above) = (0.0_f64, 0.0_f64);
    for (x, found) in records.iter().zip(probe.run(&records)) {
        let error = f64::from(found) - (f64::from(*x).acos() / 3.0).cos();
        (below, above) = (below.max(-error), above.max(error));
    }
    // Two units in the last place.
    hold("cosine of a third of an angle, too small", below, 1.2e-7);
    hold("cosine of a third of an angle, too great", above, 3e-6);
}
