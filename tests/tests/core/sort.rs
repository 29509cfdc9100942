// SPDX-License-Identifier: MIT OR Apache-2.0
//! The radix sort against the standard library's stable sort, and the functions that it is made of.

use crate::gpu::{Probe, Random, gpu, shaders};
use airlight::Buffer;
use airlight::core::Sort;

fn storage(words: &[u32]) -> Buffer {
    let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    Buffer::with_bytes(gpu(), &bytes, wgpu::BufferUsages::STORAGE)
}

/// Keys and values as the GPU sorts them.
fn sorted(sort: &Sort, keys: &[u32], values: &[u32], count: usize, bits: u32) -> [Vec<u32>; 2] {
    let buffers = [storage(keys), storage(values)];
    let mut encoder = gpu().encoder();
    sort.record(gpu(), &mut encoder, [&buffers[0], &buffers[1]], count as u32, bits).unwrap();
    gpu().submit(encoder).unwrap();
    buffers.map(|buffer| {
        let mut words = buffer.read_words(gpu()).unwrap();
        words.truncate(keys.len());
        words
    })
}

#[test]
fn keys_of_any_number_are_sorted_and_equal_ones_keep_their_order() {
    let sort = Sort::new(gpu(), shaders()).unwrap();
    let mut random = Random(17);
    for (count, bits) in
        [(0, 32), (1, 32), (2, 32), (5, 7), (1023, 32), (1024, 24), (1025, 32), (20_000, 12), (300_001, 32)]
    {
        // Few different keys in places, so that order among equals matters; what follows the counted ones must stay.
        let shift = 32 - bits.min(32);
        let keys: Vec<u32> =
            (0..count + 3).map(|_| (random.bits() >> shift) >> (random.below(3) * 4)).collect();
        let values: Vec<u32> = (0..keys.len() as u32).map(|index| index ^ 0x5000_0000).collect();
        let mut expected: Vec<(u32, u32)> = keys.iter().copied().zip(values.iter().copied()).collect();
        expected[..count].sort_by_key(|(key, _)| *key);
        let [found_keys, found_values] = sorted(&sort, &keys, &values, count, bits);
        let found = found_keys.into_iter().zip(found_values);
        let wrong = found.zip(&expected).position(|(found, expected)| found != *expected);
        assert_eq!(wrong, None, "{count} keys of {bits} bits");
    }
}

#[test]
fn only_the_bits_asked_for_are_sorted_by() {
    let sort = Sort::new(gpu(), shaders()).unwrap();
    let keys = [0x103, 0x001, 0x302, 0x201, 0x001];
    let [keys, values] = sorted(&sort, &keys, &[0, 1, 2, 3, 4], 5, 8);
    assert_eq!(keys, [0x001, 0x201, 0x001, 0x302, 0x103]);
    assert_eq!(values, [1, 3, 4, 2, 0]);
}

#[test]
fn keys_of_numbers_ascend_with_them() {
    let ascending = [
        f32::NEG_INFINITY,
        f32::MIN,
        -1.5,
        -1.0,
        -f32::MIN_POSITIVE,
        -0.0,
        0.0,
        f32::MIN_POSITIVE,
        1e-3,
        1.0,
        1.000_000_1,
        f32::MAX,
        f32::INFINITY,
    ];
    let probe = Probe {
        head: "#import airlight::core::sort::{ascending_key, key_digit, one_counted, counted_together, counted}",
        body: "output(0u, select(0.0, 1.0, ascending_key(input(0u)) < ascending_key(input(1u))));
               let key = 0x89abcdefu;
               output(1u, f32(key_digit(key, u32(input(2u)))));
               var sum = counted_together(one_counted(u32(input(3u))), one_counted(u32(input(4u))));
               for (var more = 0u; more < 1022u; more++) { sum = counted_together(sum, one_counted(u32(input(3u)))); }
               output(2u, f32(counted(sum, u32(input(3u)))));
               output(3u, f32(counted(sum, u32(input(4u)))));
               output(4u, f32(counted(sum, u32(input(5u)))));",
        inputs: 6,
        outputs: 5,
    };
    let mut records = Vec::new();
    let mut expected = Vec::new();
    let mut case = 0_u32;
    for (low, a) in ascending.iter().enumerate() {
        for (high, b) in ascending.iter().enumerate() {
            let shift = case % 8 * 4;
            let [own, other, none] = [case % 16, (case / 16 + case + 1) % 16, (case + 7) % 16];
            records.extend([*a, *b, shift as f32, own as f32, other as f32, none as f32]);
            let count = |of: u32| 1023 * u32::from(of == own) + u32::from(of == other);
            expected.push([
                u32::from(low < high),
                (0x89ab_cdef_u32 >> shift) & 15,
                count(own),
                count(other),
                count(none),
            ]);
            case += 1;
        }
    }
    for (found, expected) in probe.run(&records).chunks_exact(5).zip(expected) {
        assert_eq!(found, expected.map(|number| number as f32));
    }
}
