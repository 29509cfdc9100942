// SPDX-License-Identifier: MIT OR Apache-2.0
//! The wavelet matrix on the GPU: counts against brute force over the stepped map, what is stored against its definition,
//! pictures against those of rank queries, its memory, and settings that are refused.

use crate::gpu::{self, Random, gpu, shaders};
use crate::rank_rows::{self, KINDS, Structure, refusal, row_of_kind};
use airlight::scattering::{
    Filtering, LightForm, Prefiltered, ProjectiveMap, ProjectivePrefiltered, Settings, Start, Visibility,
    Weighting,
};
use airlight_tests::reference::scattering::depth_step;

fn wavelet(bits: u32) -> Settings {
    let visibility = Visibility::Wavelet { bits };
    Settings { visibility, weighting: Weighting::Average, ..Settings::default() }
}

#[test]
fn counts_are_exactly_those_of_the_stepped_map() {
    rank_rows::hold_counts(601, |bits| Visibility::Wavelet { bits });
}

/// The texels of a row as the book defines them.
fn matrix(row: &[f32], bits: u32) -> Vec<[u32; 4]> {
    let values: Vec<u32> = row.iter().map(|depth| depth_step(f64::from(*depth), bits)).collect();
    let mut texels = Vec::new();
    for level in 0..bits / 2 {
        let digit = |value: u32, level: u32| value >> (bits - 2 - 2 * level) & 3;
        // Sorted by the earlier digits, the last of them first; stable.
        let mut places = values.clone();
        places.sort_by_key(|value| (0..level).rev().map(|l| digit(*value, l)).collect::<Vec<_>>());
        let digits: Vec<u32> = places.iter().map(|value| digit(*value, level)).collect();
        for begin in (0..row.len()).step_by(32) {
            let block = &digits[begin..row.len().min(begin + 32)];
            let bit = |b: u32| block.iter().enumerate().map(|(i, d)| (d >> b & 1) << i).sum::<u32>();
            let place = |d: u32| {
                let smaller = digits.iter().filter(|other| **other < d).count();
                smaller + digits[..begin].iter().filter(|other| **other == d).count()
            };
            let sum = |d: u32| (0..=d).map(place).sum::<usize>() as u32;
            texels.push([bit(0), bit(1), sum(0) | sum(1) << 16, sum(2) | sum(3) << 16]);
        }
    }
    texels
}

#[test]
fn the_matrix_is_that_of_the_book() {
    let mut random = Random(602);
    for bits in [8, 10, 12] {
        for width in [1, 31, 32, 100, 2048] {
            let map = [width, KINDS as u32];
            let structure = Structure::of(Visibility::Wavelet { bits }, map, Weighting::Average);
            let rows: Vec<Vec<f32>> =
                (0..KINDS).map(|kind| row_of_kind(&mut random, kind, width as usize, bits)).collect();
            structure.build(&rows);
            let stored = structure.words();
            let expected: Vec<u32> = rows.iter().flat_map(|row| matrix(row, bits)).flatten().collect();
            assert!(stored == expected, "{bits} bits, {width} columns");
            // The same again, whichever thread comes first.
            structure.build(&rows);
            assert!(structure.words() == expected, "{bits} bits, {width} columns, again");
        }
    }
}

#[test]
fn the_example_of_the_book() {
    // Eight bits are two levels of equal digits, here 0, and two of the example's, whose eight places are one block here.
    let row = [9, 4, 14, 5, 13, 0, 8, 9].map(|value| value as f32 / 255.0);
    let texels = matrix(&row, 8);
    assert_eq!(texels[2], [0b0001_1110, 0b1101_0101, 1 << 16, 4 | 10 << 16]);
    assert_eq!(texels[3], [0b1010_1100, 0b0100_0000, 3 << 16, 10 | 18 << 16]);
    let structure = Structure::of(Visibility::Wavelet { bits: 8 }, [8, 1], Weighting::Average);
    structure.build(&[row.to_vec()]);
    assert_eq!(structure.words(), texels.concat());
}

#[test]
fn pictures_are_those_of_rank_queries() {
    const PICTURE: [u32; 2] = [160, 90];
    let scene = gpu::small_tree();
    let stage = scene.stage(PICTURE, [512, 512]);
    let picture = |settings: Settings| {
        let method = Prefiltered::new(gpu(), shaders(), settings, PICTURE).unwrap();
        let bound = method.bind(gpu(), &stage.inputs()).unwrap();
        let mut encoder = gpu().encoder();
        method.record(&mut encoder, &bound);
        gpu().submit(encoder).unwrap();
        method.scattered.read(gpu()).unwrap()
    };
    for bits in [8, 10, 12] {
        for (filtering, start, map) in [
            (Filtering::Linear, Start::Eye, [1024, 256]),
            (Filtering::Linear, Start::NearPlane, [200, 8]),
            (Filtering::Nearest, Start::Eye, [333, 64]),
        ] {
            let settings = Settings { filtering, start, map, ..wavelet(bits) };
            let found = picture(settings);
            let ranks = picture(Settings { visibility: Visibility::Rank { bits }, ..settings });
            let differ = found.iter().zip(&ranks).filter(|(a, b)| a != b).count();
            let dark = found.chunks_exact(4).filter(|texel| 0.01 < texel[3] && texel[3] < 0.99).count();
            println!(
                "{bits} bits, {filtering:?}, {start:?}: {differ} numbers differ, {dark} pixels in part dark"
            );
            assert_eq!(differ, 0, "{settings:?}");
            assert!(dark > 2000, "{settings:?}: {dark}");
        }
    }
}

#[test]
fn it_takes_less_than_a_tenth_of_32_bases() {
    let memory = |settings: Settings| {
        Prefiltered::new(gpu(), shaders(), settings, [16, 16]).unwrap().prefilter.memory() as f64
    };
    let bases = memory(Settings::default());
    assert_eq!(bases, 32.0 * 1024.0 * 1024.0);
    for bits in [8, 10, 12] {
        let own = memory(wavelet(bits));
        assert_eq!(own / (1024.0 * 1024.0), f64::from(bits) / 4.0, "bytes a texel");
        assert!(own <= 0.1 * bases);
    }
}

#[test]
fn what_a_wavelet_matrix_cannot_do_is_refused() {
    let fine = Settings { map: [64, 16], ..wavelet(12) };
    for bits in [0, 6, 7, 9, 11, 13, 14, u32::MAX] {
        assert_eq!(
            refusal(Settings { map: [64, 16], ..wavelet(bits) }),
            format!("{bits} bits a depth are impossible in a wavelet matrix: the number must be 8, 10 or 12")
        );
    }
    assert_eq!(
        refusal(Settings { weighting: Weighting::Transmittance, ..fine }),
        "the method `wavelet` counts texels alike: take the weighting `Average`, or the method `rank`"
    );
    let needs = |what: &str| format!("the method `wavelet` needs {what}; `fourier` does without");
    assert_eq!(refusal(Settings { map: [2049, 16], ..fine }), needs("maps of at most 2048 columns"));
    assert_eq!(refusal(Settings { regions: 2, ..fine }), needs("rows in one region"));
    let spot = LightForm { spot: true, ..LightForm::default() };
    let texture = LightForm { texture: true, ..LightForm::default() };
    for light in [spot, texture] {
        assert_eq!(refusal(Settings { light, ..fine }), needs("a plain directional light"));
    }
    let map = ProjectiveMap::drawn(gpu(), [64, 16]).unwrap();
    match ProjectivePrefiltered::new(gpu(), shaders(), map, fine, [16, 16]) {
        Err(error) => assert_eq!(error.to_string(), needs("epipolar rows")),
        Ok(_) => panic!("projective rows are taken"),
    }
}
