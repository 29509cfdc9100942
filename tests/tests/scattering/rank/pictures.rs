// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pictures against the exact ones, and settings that are refused.

use crate::gpu::{self, gpu, shaders};
use crate::rank_rows::refusal;
use airlight::scattering::{
    Filtering, LightForm, Prefiltered, ProjectiveMap, ProjectivePrefiltered, Rectification, Settings,
    Visibility, Weighting,
};
use airlight::{Stage, scenes};
use airlight_tests::error;
use airlight_tests::reference::scattering as reference;
use reference::SteppedRow;

#[test]
fn pictures_mix_the_rows_about_a_ray_around_the_seam_too() {
    const PICTURE: [u32; 2] = [160, 90];
    // So few rows that every pair counts, that of the last and the first among them.
    const MAP: [u32; 2] = [200, 8];
    let scene = gpu::small_tree();
    let stage = scene.stage(PICTURE, [512, 512]);
    for filtering in [Filtering::Nearest, Filtering::Linear] {
        let settings = Settings {
            visibility: Visibility::Rank { bits: 12 },
            map: MAP,
            weighting: Weighting::Average,
            filtering,
            epipole_march: false,
            ..Settings::default()
        };
        let method = Prefiltered::new(gpu(), shaders(), settings, PICTURE).unwrap();
        let bound = method.bind(gpu(), &stage.inputs()).unwrap();
        let mut encoder = gpu().encoder();
        method.record(&mut encoder, &bound);
        gpu().submit(encoder).unwrap();
        let map = &method.rectification;
        let rectified = map.rectified.read(gpu()).unwrap();
        let rows: Vec<SteppedRow> =
            rectified.chunks_exact(MAP[0] as usize).map(|row| SteppedRow::new(row, 12)).collect();
        let expected = gpu::of_pixels(&stage, &scene.view, map, |rectification, ray| {
            assert!(rectification.full_circle);
            // The depth of a ray is that in the nearest slice, in both rows.
            let end = ray.end(rectification, ray.nearest(), 0.0);
            let at = |j: usize| rows[j].visibility(end.s, end.z, 0.0).average;
            let visibility = match filtering {
                Filtering::Nearest => at(ray.nearest()),
                Filtering::Linear => at(ray.rows[0]) * (1.0 - ray.share) + at(ray.rows[1]) * ray.share,
            };
            (visibility, ray.rows[1] == 0)
        });
        let found = method.scattered.read(gpu()).unwrap();
        let (mut mean, mut off, mut seam) = (0.0, 0, 0);
        for (texel, (visibility, at_seam)) in found.chunks_exact(4).zip(&expected) {
            let error = (f64::from(texel[3]) - visibility).abs();
            mean += error / expected.len() as f64;
            off += usize::from(error > 2e-3);
            seam += usize::from(*at_seam);
        }
        let share = off as f64 / expected.len() as f64;
        println!(
            "{filtering:?}: mean {mean:.1e}, {:.2} % off by more than 2e-3, {seam} at the seam",
            100.0 * share
        );
        // Half floats hold 0..1 to 4.9e-4, for this adapter rounds towards zero; more where depths tie but for rounding.
        assert!(mean < 4.9e-4 && share < 0.001, "{filtering:?}: {mean}, {share}");
        assert!(seam > expected.len() / 100);
    }
}

/// A scene of the gallery and the exact visibilities of its pixels.
struct Case {
    stage: Stage,
    /// Plain means and those weighted by the ray's own transmittance; over the nearest row and between two rows.
    exact: [[Vec<f64>; 2]; 2],
}

impl Case {
    const PICTURE: [u32; 2] = [480, 270];
    const MAP: [u32; 2] = [1024, 1024];

    fn new(name: &str) -> Self {
        let scene = scenes::scene(name).unwrap().unwrap();
        let view = scene.view.perspective().unwrap();
        let stage = Stage::new(gpu(), gpu::raster(), &scene.setting(), Self::PICTURE, [1024, 1024]).unwrap();
        let map = Rectification::new(gpu(), shaders(), Self::MAP).unwrap();
        let bound = map.bind(gpu(), &stage.inputs()).unwrap();
        let mut encoder = gpu().encoder();
        map.record(&mut encoder, &bound);
        gpu().submit(encoder).unwrap();
        let rectified = map.rectified.read(gpu()).unwrap();
        let extinction = f64::from(stage.medium.extinction);
        let pixels = gpu::of_pixels(&stage, &view, &map, |rectification, ray| -> [[f64; 2]; 2] {
            let at = |j: usize| -> [f64; 2] {
                let row = &rectified[j * rectification.width..(j + 1) * rectification.width];
                let own = reference::row_visibility(row, ray.end(rectification, j, extinction));
                [own.average, own.weighted]
            };
            let [a, b] = ray.rows.map(at);
            let mixed = std::array::from_fn(|i| a[i] * (1.0 - ray.share) + b[i] * ray.share);
            [if ray.share >= 0.5 { b } else { a }, mixed]
        });
        let exact = std::array::from_fn(|rows| {
            std::array::from_fn(|mean| pixels.iter().map(|pixel| pixel[rows][mean]).collect())
        });
        Self { stage, exact }
    }

    /// Visibility of every pixel.
    fn visibility(&self, settings: Settings) -> Vec<f32> {
        let settings = Settings { map: Self::MAP, epipole_march: false, ..settings };
        let method = Prefiltered::new(gpu(), shaders(), settings, Self::PICTURE).unwrap();
        let bound = method.bind(gpu(), &self.stage.inputs()).unwrap();
        let mut encoder = gpu().encoder();
        method.record(&mut encoder, &bound);
        gpu().submit(encoder).unwrap();
        method.scattered.read(gpu()).unwrap().chunks_exact(4).map(|texel| texel[3]).collect()
    }
}

#[test]
fn pictures_reach_their_figures() {
    let mut failures = Vec::new();
    for name in ["foliage", "torus", "plane", "terrain"] {
        let case = Case::new(name);
        for (filtering, rows) in [(Filtering::Nearest, 0), (Filtering::Linear, 1)] {
            for weighting in [Weighting::Average, Weighting::Transmittance] {
                let weighted = weighting == Weighting::Transmittance;
                let exact = &case.exact[rows][usize::from(weighted)];
                let measure = |visibility: Visibility| {
                    let settings = Settings { visibility, filtering, weighting, ..Settings::default() };
                    let found = case.visibility(settings);
                    let mean = error::mean_absolute(&found, exact);
                    println!(
                        "{name}, {filtering:?}, {}, {visibility:?}: mean {mean:.5}, greatest {:.3}",
                        gpu::weighting_name(weighting),
                        error::max_absolute(&found, exact)
                    );
                    mean
                };
                let fourier = measure(Visibility::Fourier);
                measure(Visibility::Rank { bits: 10 });
                let rank = measure(Visibility::Rank { bits: 12 });
                let what = format!("{name}, {filtering:?}, {}", gpu::weighting_name(weighting));
                if weighted && (rank.is_nan() || rank > 5e-4) {
                    failures.push(format!("{what}: {rank:.5} of at most 0.0005"));
                }
                if rank.is_nan() || rank > 0.2 * fourier {
                    failures.push(format!("{what}: {rank:.5}, over a fifth of {fourier:.5}"));
                }
            }
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
}

#[test]
fn what_ranks_cannot_do_is_refused() {
    let rank = Settings { visibility: Visibility::Rank { bits: 12 }, map: [64, 16], ..Settings::default() };
    for bits in [0, 7, 13, 32, u32::MAX] {
        assert_eq!(
            refusal(Settings { visibility: Visibility::Rank { bits }, ..rank }),
            format!("{bits} bits a depth are impossible: the number must be from 8 to 12")
        );
    }
    let needs = |what: &str| format!("the method `rank` needs {what}; `fourier` does without");
    assert_eq!(refusal(Settings { map: [2049, 16], ..rank }), needs("maps of at most 2048 columns"));
    assert_eq!(refusal(Settings { regions: 2, ..rank }), needs("rows in one region"));
    assert!(refusal(Settings { map: [0, 16], ..rank }).contains("0x16 is impossible"));
    let map = ProjectiveMap::drawn(gpu(), [64, 16]).unwrap();
    let parts = Settings { regions: 3, ..rank };
    match ProjectivePrefiltered::new(gpu(), shaders(), map, parts, [16, 16]) {
        Err(error) => assert_eq!(error.to_string(), needs("rows in one region")),
        Ok(_) => panic!("regions are taken"),
    }
    // Lights and rows that have weights of their own.
    let spot = LightForm { spot: true, ..LightForm::default() };
    let texture = LightForm { texture: true, ..LightForm::default() };
    for light in [spot, texture] {
        assert!(Prefiltered::new(gpu(), shaders(), Settings { light, ..rank }, [16, 16]).is_ok());
    }
    let map = || ProjectiveMap::drawn(gpu(), [64, 16]).unwrap();
    assert!(ProjectivePrefiltered::new(gpu(), shaders(), map(), rank, [16, 16]).is_ok());
    // What lies at the bounds is taken.
    for (bits, map) in [(8, [2048, 1]), (12, [1, 16]), (9, [5, 5]), (11, [40, 3])] {
        let settings = Settings { visibility: Visibility::Rank { bits }, map, ..rank };
        assert!(Prefiltered::new(gpu(), shaders(), settings, [16, 16]).is_ok(), "{settings:?}");
    }
}
