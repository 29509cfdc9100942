// SPDX-License-Identifier: MIT OR Apache-2.0
//! The rank structure on the GPU: counts against brute force over the stepped map, weighted means against their proven
//! bound, pictures against the exact ones, and settings that are refused.
//!
//! `--nocapture` prints what was measured.
#![allow(clippy::unwrap_used)]

#[path = "support/gpu.rs"]
mod gpu;
#[path = "support/probing.rs"]
mod probing;
#[path = "support/rank.rs"]
mod rank;

use airlight::scattering::{
    Filtering, LightForm, Prefiltered, ProjectiveMap, ProjectivePrefiltered, Rectification, Settings,
    Visibility, Weighting,
};
use airlight::{Stage, scenes};
use airlight_tests::error;
use airlight_tests::reference::scattering as reference;
use gpu::{Probe, Random, gpu, shaders};
use probing::hold;
use rank::{KINDS, Query, Structure, clear_of_borders, queries, refusal, row_of_kind};
use reference::SteppedRow;

/// What it makes of weighted means: a ratio of two weights, each stated to be good to 1e-6, and a few exponentials.
const WEIGHTED_ROUNDING: f64 = 3e-6;

/// The bound of docs/src/rank.md for a query of a weighted structure over `covered` of `columns` texels. Optical depths of a texel,
/// `ray`: of the ray, `least`: the lesser one that the structure was built for.
fn weighted_bound(columns: u32, covered: f64, ray: f64, least: f64) -> f64 {
    let weight = |step: f64, texels: f64| {
        if step == 0.0 { texels } else { (-step * texels).exp_m1() / (-step).exp_m1() }
    };
    // Columns left of the last block, and what the ray lies between.
    let left = 32.0 * (covered.min(f64::from(columns - 1)) / 32.0).floor();
    let least = least.max(1e-30);
    let between = (ray - least) / least;
    let depths = left * left * (ray - least).abs() * (ray - 2.0 * least).abs();
    let steps = left / weight(2.0 * least, left).max(1.0) + 1.0;
    let storage = (between.abs() + (1.0 - between).abs()) * steps * 2.0_f64.powi(-17);
    let part = if covered > 0.0 { weight(ray, left) / weight(ray, covered) } else { 0.0 };
    8.0 * -(-ray).exp_m1() + part * (depths / 62.0 + storage) + WEIGHTED_ROUNDING
}

#[test]
fn depths_are_rounded_to_steps() {
    let _turn = gpu::turn();
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
    let _turn = gpu::turn();
    rank::hold_counts(502, |bits| Visibility::Rank { bits });
}

/// Rows that make the structure err most: in sorted order texels of the row's begin and its end take turns by halves of
/// chunks, so that the mean weight of a chunk is that of neither.
fn worst_row(width: usize) -> Vec<f32> {
    let chunks = width.div_ceil(32);
    let mut row = vec![1.0; width];
    for chunk in 0..chunks {
        for rank in 0..16.min(width / 2) {
            let (near, far) = (16 * chunk + rank, width - 1 - 16 * chunk - rank);
            if near < far {
                row[near] = (chunk as f32 + 0.25) / (chunks + 1) as f32;
                row[far] = (chunk as f32 + 0.75) / (chunks + 1) as f32;
            }
        }
    }
    row
}

#[test]
fn weighted_means_err_by_no_more_than_proven() {
    let _turn = gpu::turn();
    let mut random = Random(503);
    let bits = 12;
    let steps =
        [0.0, 1e-12, 1e-8, 1e-7, 3e-7, 9e-7, 1.1e-6, 1e-5, 3e-5, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 0.1_f32];
    let mut failures = Vec::new();
    for optical_step in steps {
        let (mut mean, mut typical, mut greatest, mut count, mut tightest) = (0.0, 0.0, 0.0_f64, 0, 0.0_f64);
        let mut typical_count = 0;
        for width in [31, 33, 100, 1000, 1024, 2048] {
            let structure = Structure::new(bits, [width, 13], Weighting::Transmittance);
            let mut rows: Vec<Vec<f32>> =
                (0..12).map(|kind| row_of_kind(&mut random, kind % KINDS, width as usize, bits)).collect();
            let worst = worst_row(width as usize);
            rows.push(worst.iter().map(|v| if clear_of_borders(*v, bits) { *v } else { v + 1e-4 }).collect());
            let least_step = structure.build_weighted(&rows, optical_step);
            let mut queries = queries(&mut random, &rows, bits, 1500);
            for query in &mut queries {
                // Rays that cross texels as fast as the fastest, and some slower; a few faster, as rounding makes them.
                query.optical_step = least_step * [1.0, random.between(0.9, 5.0) as f32][random.below(2)];
                query.least_step = least_step;
            }
            let stepped: Vec<SteppedRow> = rows.iter().map(|row| SteppedRow::new(row, bits)).collect();
            for (query, found) in queries.iter().zip(structure.ask(&queries)) {
                let (texels, depth, a) =
                    (f64::from(query.texels), f64::from(query.depth), f64::from(query.optical_step));
                let row = &stepped[query.row as usize];
                let exact = row.visibility(texels, depth, a).weighted;
                let off = (f64::from(found) - exact).abs();
                let (_, covered) = row.lit_texels(texels, depth);
                let bound = weighted_bound(width, covered, a, f64::from(least_step));
                if off.is_nan() || off > bound || !(0.0..=1.0).contains(&found) {
                    failures.push(format!("{width}, {query:?}: {found}, {exact}, bound {bound:.2e}"));
                }
                count += 1;
                mean += off;
                if covered >= 32.0 {
                    typical += off;
                    typical_count += 1;
                }
                greatest = greatest.max(off);
                tightest = tightest.max(off / bound);
            }
        }
        println!(
            "optical step {optical_step:.0e}: mean {:.1e} (of 32 texels and more {:.1e}), greatest {greatest:.1e}, closest to \
             its bound {tightest:.2}",
            mean / f64::from(count),
            typical / f64::from(typical_count),
        );
    }
    assert!(
        failures.is_empty(),
        "{} beyond the bound, first {:?}",
        failures.len(),
        &failures[..5.min(failures.len())]
    );
}

#[test]
fn eights_of_one_kind_in_the_first_block_are_all_but_exact() {
    let _turn = gpu::turn();
    let structure = Structure::new(12, [32, 4], Weighting::Transmittance);
    // No rank lies left of the first block, and the mean of the weights of eight columns is that of their middle but for
    // 21/8 of the square of the optical depth of a texel.
    let rows: Vec<Vec<f32>> = [0b0101, 0b1010, 0b0011, 0b1100]
        .map(|dark| (0..32).map(|i| if dark >> (i / 8) & 1 == 1 { 0.2 } else { 0.8 }).collect())
        .to_vec();
    let stepped: Vec<SteppedRow> = rows.iter().map(|row| SteppedRow::new(row, 12)).collect();
    let mut random = Random(505);
    for optical_step in [0.0, 1e-5, 1e-3, 1e-2, 3e-2_f32] {
        let optical_step = structure.build_weighted(&rows, optical_step);
        let queries: Vec<Query> = (0..400)
            .map(|i| {
                let part = if i % 4 == 0 { 0.0 } else { random.unit() };
                // Not the whole row: its last column counts by itself.
                let texels = (8 * random.below(4)) as f64 + part;
                Query {
                    row: i % 4,
                    texels: texels as f32,
                    depth: 0.5,
                    optical_step,
                    least_step: optical_step,
                }
            })
            .collect();
        let a = f64::from(optical_step);
        let mut worst = 0.0_f64;
        for (query, found) in queries.iter().zip(structure.ask(&queries)) {
            let exact = stepped[query.row as usize].visibility(f64::from(query.texels), 0.5, a).weighted;
            let off = (f64::from(found) - exact).abs();
            worst = if off <= worst { worst } else { off };
        }
        hold(
            &format!("eights of one kind, optical step {optical_step:.0e}"),
            worst,
            2.7 * a * a + WEIGHTED_ROUNDING,
        );
    }
}

#[test]
fn air_that_is_opaque_within_a_texel_gives_a_visibility() {
    let _turn = gpu::turn();
    let mut random = Random(504);
    for width in [1, 33, 1024] {
        let structure = Structure::new(12, [width, KINDS as u32], Weighting::Transmittance);
        let rows: Vec<Vec<f32>> =
            (0..KINDS).map(|kind| row_of_kind(&mut random, kind, width as usize, 12)).collect();
        for optical_step in [1.0, 30.0, 1e4, 1e10, 1e30] {
            let optical_step = structure.build_weighted(&rows, optical_step);
            let mut queries = queries(&mut random, &rows, 12, 500);
            for query in &mut queries {
                (query.optical_step, query.least_step) = (optical_step, optical_step);
            }
            for (query, found) in queries.iter().zip(structure.ask(&queries)) {
                assert!((0.0..=1.0).contains(&found), "{width}, {query:?}: {found}");
            }
        }
    }
}

#[test]
fn pictures_mix_the_rows_about_a_ray_around_the_seam_too() {
    let _turn = gpu::turn();
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
    let _turn = gpu::turn();
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
    let _turn = gpu::turn();
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
