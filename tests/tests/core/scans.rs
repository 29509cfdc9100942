// SPDX-License-Identifier: MIT OR Apache-2.0
//! Prefix sums of any length, exactly.

use crate::gpu::{Random, gpu, shaders};
use airlight::Buffer;
use airlight::core::Scan;
use airlight_tests::reference::prefix_sum;

#[test]
fn scans_of_any_length_are_exact() {
    let scan = Scan::new(gpu(), shaders()).unwrap();
    let mut random = Random(43);
    for length in [0_usize, 1, 2, 3, 255, 256, 1023, 1024, 1025, 4096, 1_048_576, 1_048_577, 3_000_000] {
        // Wrap-around: thousands of numbers of all sizes up to 2^32.
        let mut values: Vec<u32> = (0..length).map(|_| random.bits() >> (random.below(4) * 10)).collect();
        // What follows the counted values must stay.
        values.extend([77, 78, 79, 80, 81]);
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        let buffer = Buffer::with_bytes(gpu(), &bytes, wgpu::BufferUsages::STORAGE);
        let mut encoder = gpu().encoder();
        scan.record(gpu(), &mut encoder, &buffer, length as u32).unwrap();
        gpu().submit(encoder).unwrap();
        let found = buffer.read_words(gpu()).unwrap();
        let mut expected = prefix_sum::exclusive(&values[..length]);
        expected.extend(&values[length..]);
        let wrong = found.iter().zip(&expected).position(|(f, e)| f != e);
        assert_eq!(
            wrong,
            None,
            "length {length}: {:?} instead of {:?}",
            wrong.map(|i| found[i]),
            wrong.map(|i| expected[i])
        );
    }
}
