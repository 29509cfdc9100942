// SPDX-License-Identifier: MIT OR Apache-2.0
//! Gradient noise on the GPU against f64, its range, and what it does with coordinates beyond all bounds.

use crate::gpu::{Probe, Random};
use crate::probing::{f, hold, worst};
use airlight_tests::reference::noise;
use std::f64::consts::{FRAC_1_SQRT_2, TAU};

/// A whole number as two halves, which floats carry exactly.
fn halves(word: u32) -> [f32; 2] {
    [(word >> 16) as f32, (word & 0xffff) as f32]
}

fn word(halves: &[f32]) -> u32 {
    ((halves[0] as u32) << 16) | halves[1] as u32
}

const WORDS: &str = "
    fn word(k: u32) -> u32 { return (u32(input(k)) << 16u) | u32(input(k + 1u)); }
    fn put(k: u32, w: u32) { output(k, f32(w >> 16u)); output(k + 1u, f32(w & 0xffffu)); }";

#[test]
fn hashes_are_those_of_the_definition() {
    let head = format!("#import airlight::core::noise::{{hash_of_three, unit_from_hash}}\n{WORDS}");
    let probe = Probe {
        head: &head,
        body: "let h = hash_of_three(vec3<u32>(word(0u), word(2u), word(4u)));
               put(0u, h.x); put(2u, h.y); put(4u, h.z); output(6u, unit_from_hash(h.x));",
        inputs: 6,
        outputs: 7,
    };
    let mut random = Random(11);
    let mut keys = vec![[0; 3], [u32::MAX; 3], [1, 0, 0], [0, 1, 0], [0, 0, 1]];
    keys.extend((0..2000).map(|_| [0; 3].map(|_| random.bits())));
    let inputs: Vec<f32> = keys.iter().flatten().flat_map(|key| halves(*key)).collect();
    for (key, found) in keys.iter().zip(probe.run(&inputs).chunks_exact(7)) {
        let expected = noise::hash(key.map(u64::from));
        let words = [0, 2, 4].map(|k| u64::from(word(&found[k..k + 2])));
        assert_eq!(words, expected, "{key:?}");
        assert_eq!(f(found[6]), (expected[0] >> 8) as f64 / 16_777_216.0);
    }
}

#[test]
fn directions_have_length_one_and_the_angle_of_the_hash() {
    let head = format!("#import airlight::core::noise::{{direction_from_hash, quintic_fade}}\n{WORDS}");
    let probe = Probe {
        head: &head,
        body: "let d = direction_from_hash(word(0u)); output(0u, d.x); output(1u, d.y);
               let t = quintic_fade(vec2<f32>(input(1u) / 65536.0, 1.0 - input(1u) / 65536.0));
               output(2u, t.x); output(3u, t.y);",
        inputs: 2,
        outputs: 4,
    };
    let mut random = Random(12);
    let mut hashes: Vec<u32> = (0..1024).map(|i| i << 22).collect();
    hashes.extend((0..1024_u32).map(|i| (i << 22).wrapping_sub(1)));
    hashes.extend((0..4000).map(|_| random.bits()));
    let inputs: Vec<f32> = hashes.iter().flat_map(|hash| halves(*hash)).collect();
    let found = probe.run(&inputs);
    let records = || hashes.iter().zip(found.chunks_exact(4));
    let angle = |hash: u32| TAU * (f64::from(hash) / 4_294_967_296.0 - 0.125);
    let directions =
        worst(records().flat_map(|(hash, found)| {
            [(f(found[0]), angle(*hash).cos()), (f(found[1]), angle(*hash).sin())]
        }));
    // The angle has 24 bits a quarter of a turn: 9.4e-8.
    hold("direction_from_hash", directions, 3e-7);
    let lengths = worst(records().map(|(_, found)| (f(found[0]).hypot(f(found[1])), 1.0)));
    hold("its length", lengths, 2e-7);
    let fades = worst(records().flat_map(|(hash, found)| {
        let t = f64::from(hash & 0xffff) / 65536.0;
        [(f(found[2]), noise::fade(t)), (f(found[3]), noise::fade(1.0 - t))]
    }));
    hold("quintic_fade", fades, 8e-7);
}

/// Noise at places, as the GPU has it: at the place, and inside the cell that holds it.
fn gradient_noise(places: &[[f32; 2]], seed: u32) -> Vec<[f32; 2]> {
    let head = format!(
        "#import airlight::core::noise::{{gradient_noise, gradient_noise_in_cell, corner_slope}}\n{WORDS}"
    );
    let probe = Probe {
        head: &head,
        body: "let p = vec2<f32>(input(0u), input(1u));
               output(0u, gradient_noise(p, word(2u)));
               let cell = floor(clamp(p, vec2<f32>(-1e6), vec2<f32>(1e6)));
               output(1u, gradient_noise_in_cell(vec2<i32>(cell), p - cell, word(2u)));
               output(2u, corner_slope(vec2<i32>(cell), word(2u), vec2<f32>(1.0, 0.0)));
               output(3u, corner_slope(vec2<i32>(cell), word(2u), vec2<f32>(0.0, 1.0)));",
        inputs: 4,
        outputs: 4,
    };
    let inputs: Vec<f32> = places.iter().flat_map(|p| p.iter().copied().chain(halves(seed))).collect();
    let found = probe.run(&inputs);
    // Bit for bit the same from run to run.
    let again: Vec<u32> = probe.run(&inputs).into_iter().map(f32::to_bits).collect();
    assert_eq!(found.iter().map(|value| value.to_bits()).collect::<Vec<_>>(), again);
    for (place, found) in places.iter().zip(found.chunks_exact(4)) {
        if place.iter().all(|x| x.abs() < 1e6) {
            let [x, y] = place.map(|x| f(x).floor() as i64);
            let [g_x, g_y] = noise::gradient(x, y, seed);
            assert!((f(found[2]) - g_x).abs() < 3e-7 && (f(found[3]) - g_y).abs() < 3e-7, "{place:?}");
        }
    }
    found.chunks_exact(4).map(|found| [found[0], found[1]]).collect()
}

#[test]
fn noise_is_that_of_the_reference() {
    let mut random = Random(13);
    for (reach, seed) in [(4.0, 0), (4.0, u32::MAX), (1000.0, 17), (60_000.0, 0x9e37_79b9)] {
        let mut places = vec![[0.0, 0.0], [-0.0, 1.0], [-1e-10, -1e-10], [-1.5, 2.5], [0.5, 0.5]];
        places.extend((0..4000).map(|_| [0; 2].map(|_| random.between(-reach, reach) as f32)));
        let found = gradient_noise(&places, seed);
        let expected = |place: [f32; 2]| noise::noise(f(place[0]), f(place[1]), seed);
        let errors = worst(places.iter().zip(&found).map(|(place, found)| (f(found[0]), expected(*place))));
        hold(&format!("gradient_noise within {reach} cells"), errors, 1.5e-6);
        let errors = worst(places.iter().zip(&found).map(|(place, found)| (f(found[1]), expected(*place))));
        hold(&format!("gradient_noise_in_cell within {reach} cells"), errors, 1.5e-6);
    }
}

#[test]
fn noise_stays_in_its_range_and_nearly_fills_it() {
    // Middles of cells, where the range is met, and places around them.
    let mut random = Random(14);
    let place = |random: &mut Random| {
        let wide = if random.unit() < 0.5 { 0.02 } else { 0.5 };
        [0; 2].map(|_| (random.between(-2000.0, 2000.0).floor() + 0.5 + random.between(-wide, wide)) as f32)
    };
    let places: Vec<[f32; 2]> = (0..400_000).map(|_| place(&mut random)).collect();
    let found = gradient_noise(&places, 3);
    let [least, most] = [f32::min, f32::max].map(|of| found.iter().map(|v| v[0]).fold(0.0, of));
    println!("{least} to {most}");
    let limit = FRAC_1_SQRT_2 * (1.0 + 5e-7);
    assert!(f(most) <= limit && f(-least) <= limit, "{least} to {most}");
    assert!(most > 0.69 && least < -0.69, "{least} to {most}");
    // Neither sign is preferred: the standard deviation is about 0.3 at these places.
    let mean = found.iter().map(|v| f(v[0])).sum::<f64>() / found.len() as f64;
    assert!(mean.abs() < 4.0 * 0.35 / (found.len() as f64).sqrt(), "{mean}");
}

#[test]
fn coordinates_without_bounds_give_finite_noise() {
    let wild = [
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::MAX,
        f32::MIN,
        2.2e9,
        -2.2e9,
        4.3e9,
        -1e20,
        16_777_216.0,
        -16_777_217.0,
        8_388_608.5,
        f32::MIN_POSITIVE,
        -1e-30,
    ];
    let places: Vec<[f32; 2]> = wild.iter().flat_map(|x| wild.iter().map(|y| [*x, *y])).collect();
    for (place, [found, _]) in places.iter().zip(gradient_noise(&places, 5)) {
        assert!(found.is_finite() && f(found.abs()) <= FRAC_1_SQRT_2 + 1e-6, "{place:?}: {found}");
        if place.iter().all(|x| x.abs() >= 16_777_216.0 || !x.is_finite()) {
            assert_eq!(found, 0.0, "{place:?}");
        }
    }
    // One coordinate beyond all bounds takes no detail from the other.
    let found = gradient_noise(&[[f32::NAN, 0.3], [0.0, 0.3], [1e30, 0.3], [16_777_216.0, 0.3]], 5);
    assert_eq!(found[0][0], found[1][0]);
    assert_eq!(found[2][0], found[3][0]);
}
