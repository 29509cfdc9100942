// SPDX-License-Identifier: MIT OR Apache-2.0
//! Steps of depth, and counts against brute force over the stepped map.

use crate::gpu::{Probe, Random};
use crate::rank_rows::{self, clear_of_borders};
use airlight::scattering::Visibility;
use airlight_tests::reference::scattering as reference;

#[test]
fn depths_are_rounded_to_steps() {
    let probe = Probe {
        head: "#import airlight::scattering::visibility_rank::{rank_value, low_bits}",
        body: "output(0u, f32(rank_value(input(0u), u32(input(1u)))));
               output(1u, f32(countOneBits(low_bits(u32(input(2u))))));
               output(2u, f32(firstTrailingBit(~low_bits(u32(input(2u))))));",
        inputs: 3,
        outputs: 3,
    };
    let mut random = Random(501);
    let mut records = Vec::new();
    for bits in 8..=12_u32 {
        let steps = ((1_u32 << bits) - 1) as f32;
        // Every step, what lies about it, and what lies beyond all of them.
        let own = (0..=1 << bits).map(|step| step as f32 / steps);
        let about = (0..4000).map(|_| random.between(-0.01, 1.01) as f32);
        let depths: Vec<f32> = own.chain(about).chain([-1e30, 1e30, -0.0, 1e-40, 0.999_999_94]).collect();
        for depth in depths {
            records.push([depth, bits as f32, random.below(33) as f32]);
        }
    }
    records.extend((0..=32).map(|count| [0.5, 8.0, count as f32]));
    let mut undecided = 0;
    for (record, found) in records.iter().zip(probe.run(records.as_flattened()).chunks_exact(3)) {
        let (depth, bits) = (f64::from(record[0]), record[1] as u32);
        let found_steps = f64::from(found[0]);
        if clear_of_borders(record[0], bits) {
            assert_eq!(found[0] as u32, reference::depth_step(depth, bits), "{record:?}");
        } else {
            undecided += 1;
            let off = found_steps - depth.clamp(0.0, 1.0) * f64::from((1_u32 << bits) - 1);
            assert!(off.abs() <= 0.501, "{record:?}: {found_steps}");
        }
        assert_eq!(found[1], record[2], "low_bits");
        let first_clear = if record[2] < 32.0 { record[2] } else { u32::MAX as f32 };
        assert_eq!(found[2], first_clear, "low_bits");
    }
    println!("{} depths, {undecided} next to a border between two steps", records.len());
    assert!(undecided * 50 < records.len());
}

#[test]
fn counts_are_exactly_those_of_the_stepped_map() {
    rank_rows::hold_counts(502, |bits| Visibility::Rank { bits });
}
