// SPDX-License-Identifier: MIT OR Apache-2.0
//! Chance and layers: what is drawn for pixels is even, independent, and says yes as often as it should.

use crate::gpu::{Probe, Random};
use airlight_tests::reference::noise::hash;
use airlight_tests::reference::painterly::strokes::layer;
use airlight_tests::statistics::{Test, binomial, sample_mean, two_sided};

/// One false alarm in ten thousand runs of new seeds; the seeds here are fixed.
const CONFIDENCE: f64 = 0.9999;
const SIDE: usize = 256;

/// What is drawn for each pixel of a square, and 24 bits of the stroke's own hash, in 0..1.
fn drawn(layer: u32, frame: u32, seed: u32) -> Vec<[f64; 2]> {
    let probe = Probe {
        head: "#import airlight::core::noise::unit_from_hash
               #import airlight::painterly::stroke_placement::placement_hashes",
        body: "let pixel = vec2<u32>(u32(input(0u)), u32(input(1u)));
               let hashes = placement_hashes(pixel, u32(input(2u)), u32(input(3u)), u32(input(4u)));
               output(0u, unit_from_hash(hashes.x));
               output(1u, unit_from_hash(hashes.y));",
        inputs: 5,
        outputs: 2,
    };
    let mut records = Vec::new();
    for index in 0..SIDE * SIDE {
        let [x, y] = [index % SIDE, index / SIDE].map(|k| k as f32);
        records.extend([x, y, layer as f32, frame as f32, seed as f32]);
    }
    probe.run(&records).chunks_exact(2).map(|two| [f64::from(two[0]), f64::from(two[1])]).collect()
}

/// Chi-squared of counts against the same expectation, by the Wilson-Hilferty cube root.
fn even(counts: &[f64], expected: f64) -> Test {
    let freedom = (counts.len() - 1) as f64;
    let squares: f64 = counts.iter().map(|count| (count - expected).powi(2) / expected).sum();
    let spread = 2.0 / (9.0 * freedom);
    let z = ((squares / freedom).cbrt() - (1.0 - spread)) / spread.sqrt();
    Test { z, p: two_sided(z) }
}

fn agree(what: &str, test: Test) {
    println!("{what}: z = {:.2}", test.z);
    assert!(test.accepts(CONFIDENCE), "{what}: z = {:.2}", test.z);
}

#[test]
fn placement_draws_evenly_and_anew_in_every_pixel_layer_and_frame() {
    let pixels = (SIDE * SIDE) as u64;
    let [first, next, other_layer, other_seed] =
        [(0, 7, 1), (0, 8, 1), (1, 7, 1), (0, 7, 2)].map(|(layer, frame, seed)| drawn(layer, frame, seed));
    for p in [0.01, 0.05, 0.5] {
        let placed = |of: &[[f64; 2]]| of.iter().map(|draw| draw[0] < p).collect::<Vec<_>>();
        let one = placed(&first);
        let count = |of: &[bool]| of.iter().filter(|placed| **placed).count() as u64;
        agree("frequency", binomial(count(&one), pixels, p));
        // Evenly over the square: 16 by 16 tiles.
        let mut tiles = vec![0.0; 256];
        for (index, _) in one.iter().enumerate().filter(|(_, placed)| **placed) {
            tiles[index / SIDE / 16 * 16 + index % SIDE / 16] += 1.0;
        }
        // A tile's count is binomial: its variance is smaller by 1 - p.
        let spread: Vec<f64> = tiles.iter().map(|n| (n - 256.0 * p) / (1.0 - p).sqrt() + 256.0 * p).collect();
        agree("tiles", even(&spread, 256.0 * p));
        // What is placed here does not tell what is placed there.
        let both = |a: &[bool], b: &[bool]| a.iter().zip(b).filter(|(a, b)| **a && **b).count() as u64;
        for (what, other) in [("frames", &next), ("layers", &other_layer), ("seeds", &other_seed)] {
            agree(what, binomial(both(&one, &placed(other)), pixels, p * p));
        }
        for (what, shift) in [("columns", 1), ("rows", SIDE), ("diagonals", SIDE + 1)] {
            agree(what, binomial(both(&one[shift..], &one), pixels - shift as u64, p * p));
        }
        let own: Vec<f64> = first.iter().filter(|draw| draw[0] < p).map(|draw| draw[1]).collect();
        agree("own hashes of those placed", sample_mean(&own, 0.5));
    }
    let mut steps = vec![0.0; 64];
    for draw in &first {
        steps[(draw[0] * 64.0) as usize] += 1.0;
    }
    agree("values", even(&steps, pixels as f64 / 64.0));
    // The hash itself, by its definition in whole numbers.
    for (index, draw) in first.iter().enumerate().step_by(97) {
        let key = (index % SIDE + index / SIDE * 65536) as u64;
        let expected = hash([key, 1 ^ 0x9e37_79b9, 7]);
        assert_eq!(draw[0], (expected[0] >> 8) as f64 / 16_777_216.0);
        assert_eq!(draw[1], (expected[1] >> 8) as f64 / 16_777_216.0);
    }
}

#[test]
fn chance_never_says_yes_at_zero_and_always_at_one() {
    let probe = Probe {
        head: "#import airlight::painterly::stroke_placement::{
                   chance, thinning_hash, own_variation, first_in_queue, place_in_queue
               }",
        body: "let hash = u32(input(0u)) * 4099u;
               output(0u, select(0.0, 1.0, chance(hash, 0.0)));
               output(1u, select(0.0, 1.0, chance(~hash, 1.0)));
               output(2u, select(0.0, 1.0, chance(thinning_hash(hash, 3u, 9u), 0.3)));
               output(3u, select(0.0, 1.0, chance(thinning_hash(hash, 4u, 9u), 0.3)));
               output(4u, own_variation(hash, 1u));
               let first = first_in_queue(20000u, 5u, 1u);
               output(5u, f32(place_in_queue(u32(input(0u)), first, 20000u)));
               output(6u, f32(first));
               output(7u, f32(first_in_queue(20000u, 6u, 1u)));",
        inputs: 1,
        outputs: 8,
    };
    let records: Vec<f32> = (0..20_000).map(|k| k as f32).collect();
    let results = probe.run(&records);
    let column = |k: usize| results.iter().skip(k).step_by(8).map(|x| f64::from(*x)).collect::<Vec<_>>();
    let count = |k: usize| column(k).iter().sum::<f64>() as u64;
    assert_eq!((count(0), count(1)), (0, 20_000));
    agree("thinned", binomial(count(2), 20_000, 0.3));
    let both = column(2).iter().zip(column(3)).filter(|(a, b)| **a + b == 2.0).count() as u64;
    agree("thinned twice", binomial(both, 20_000, 0.09));
    agree("variation", sample_mean(&column(4), 0.0));
    assert!(column(4).iter().all(|x| (-1.0..=1.0).contains(x)));
    // Every pixel has a place of its own in the queue, and the queue begins elsewhere in the next frame.
    let mut places = column(5);
    let first = results[6] as usize;
    assert_eq!(places[first], 0.0);
    assert_ne!(results[6], results[7]);
    places.sort_by(f64::total_cmp);
    assert!(places.iter().enumerate().all(|(k, place)| k as f64 == *place));
}

#[test]
fn thresholds_divide_layers_and_hysteresis_holds_strokes_in_theirs() {
    let ends = [0.1_f32, 0.3, 1.0];
    let probe = Probe {
        head: "#import airlight::painterly::stroke_placement::{layer_of, stays_in_layer}",
        body: "let ends = vec3<f32>(0.1, 0.3, 1.0);
               output(0u, f32(layer_of(input(0u), ends)));
               for (var layer = 0u; layer < 3u; layer++) {
                   output(1u + layer, select(0.0, 1.0, stays_in_layer(input(0u), layer, ends, input(1u))));
               }",
        inputs: 2,
        outputs: 4,
    };
    let mut random = Random(5);
    let mut records = Vec::new();
    for _ in 0..2000 {
        records.extend([random.between(-0.1, 1.3) as f32, [0.0, 0.2][random.below(2)]]);
    }
    records.extend([0.1, 0.0, 0.3, 0.0, 1.0, 0.0, 0.0, 0.0]);
    for (record, found) in records.chunks_exact(2).zip(probe.run(&records).chunks_exact(4)) {
        let magnitude = f64::from(record[0]);
        let expected = if magnitude < 0.0 { None } else { layer(magnitude, ends.map(f64::from)) };
        assert_eq!(found[0] as usize, expected.unwrap_or(3), "{magnitude}");
        let wider = 1.0 + f64::from(record[1]);
        for of in 0..3 {
            let begin = if of == 0 { 0.0 } else { f64::from(ends[of - 1]) / wider };
            let end = f64::from(ends[of]) * wider;
            // At the very ends rounding decides.
            if record[1] == 0.0 {
                assert_eq!(found[1 + of] == 1.0, expected == Some(of), "{magnitude} in {of}");
            } else if [begin, end].iter().all(|edge| (edge - magnitude).abs() > 1e-6) {
                assert_eq!(
                    found[1 + of] == 1.0,
                    magnitude >= begin && magnitude < end,
                    "{magnitude} in {of}"
                );
            }
        }
    }
}
