// SPDX-License-Identifier: MIT OR Apache-2.0
//! Weighted means against their proven bound.

use crate::gpu::Random;
use crate::probing::hold;
use crate::rank_rows::{KINDS, Query, Structure, clear_of_borders, queries, row_of_kind};
use airlight::scattering::Weighting;
use airlight_tests::reference::scattering::SteppedRow;

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
