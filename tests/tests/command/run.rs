// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight run`: passes on arrays against closed forms. What it refuses is in `run_refusals.rs`.

use crate::command::{Ended, folder, succeeds, words};
use crate::npy;
use crate::own_passes::{camera, own_shaders};
use std::f64::consts::PI;
use std::path::Path;

/// Runs a line of `airlight` and expects success.
#[track_caller]
fn run(folder: &Path, line: &str) -> Ended {
    succeeds(folder, &words(line))
}

/// The tone curve and the sRGB encoding of core/color, from their published formulas.
fn toned(x: f64) -> f64 {
    let curve = (x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)).clamp(0.0, 1.0);
    255.0 * if curve <= 0.003_130_8 { 12.92 * curve } else { 1.055 * curve.powf(1.0 / 2.4) - 0.055 }
}

#[track_caller]
fn assert_picture(path: &Path, shape: &[usize], expected: &[f64]) {
    let (found_shape, found) = npy::read_u8(path);
    assert_eq!(found_shape, shape);
    for (index, (found, expected)) in found.iter().zip(expected).enumerate() {
        assert!((f64::from(*found) - expected).abs() <= 0.55, "value {index}: {found}, not {expected}");
    }
}

#[test]
fn tonemap_follows_its_formula_for_floats_of_any_size_and_bytes() {
    let at = folder();
    let values: Vec<f32> = (0..2 * 3 * 3).map(|index| 0.002 * 1.6_f32.powi(index)).collect();
    let expected: Vec<f64> = values
        .chunks(3)
        .flat_map(|rgb| {
            [
                toned(2.0 * f64::from(rgb[0])),
                toned(2.0 * f64::from(rgb[1])),
                toned(2.0 * f64::from(rgb[2])),
                255.0,
            ]
        })
        .collect();
    npy::write_f32(&at.path().join("a.npy"), &[2, 3, 3], &values);
    let wide: Vec<f64> = values.iter().map(|value| f64::from(*value)).collect();
    npy::write_f64(&at.path().join("b.npy"), &[2, 3, 3], &wide);
    for file in ["a", "b"] {
        let (input, output) = (format!("radiance={file}.npy"), format!("picture={file}_out.npy:2,3"));
        run(
            at.path(),
            &format!("run core/tonemap --in {input} --set parameters.exposure=2 --over 3,2 --out {output}"),
        );
        assert_picture(&at.path().join(format!("{file}_out.npy")), &[2, 3, 4], &expected);
    }

    // Bytes stand for 0..1; the struct's name does for the binding's; --size for the shape.
    let bytes: Vec<u8> = (0..16).map(|index| index * 17).collect();
    npy::write_u8(&at.path().join("c.npy"), &[2, 2, 4], &bytes);
    run(
        at.path(),
        "run core/tonemap:default --in radiance=c.npy --set TonemapParameters.exposure=1 --dispatch 1 \
         --size 2x2 --out picture=c_out.npy",
    );
    let expected: Vec<f64> = (0..16)
        .map(|index| if index % 4 == 3 { 255.0 } else { toned(f64::from(bytes[index]) / 255.0) })
        .collect();
    assert_picture(&at.path().join("c_out.npy"), &[2, 2, 4], &expected);
}

#[test]
fn scan_runs_by_entry_point_and_its_buffers_go_round() {
    let at = folder();
    let count = 2500;
    let values: Vec<u32> = (0..count).map(|index| index * 7919 % 1000).collect();
    npy::write_u32(&at.path().join("v.npy"), &[count as usize], &values);
    let set = format!("parameters.count={count}");
    run(
        at.path(),
        &format!(
            "run core/scan --entry scan_blocks --set {set} --in values=v.npy --dispatch 3 \
                  --out values=scanned.npy --out block_sums=sums.npy:3"
        ),
    );

    let (shape, scanned) = npy::read_u32(&at.path().join("scanned.npy"));
    assert_eq!(shape, [2500]);
    for (block, found) in scanned.chunks(1024).enumerate() {
        let mut sum = 0;
        for (index, found) in found.iter().enumerate() {
            assert_eq!(*found, sum, "block {block}, value {index}");
            sum += values[block * 1024 + index];
        }
    }
    let (shape, sums) = npy::read_u32(&at.path().join("sums.npy"));
    assert_eq!(shape, [3]);
    let expected: Vec<u32> = values.chunks(1024).map(|block| block.iter().sum()).collect();
    assert_eq!(sums, expected);

    let before = [0, sums[0], sums[0] + sums[1]];
    npy::write_u32(&at.path().join("before.npy"), &[3], &before);
    run(
        at.path(),
        &format!(
            "run core/scan --entry add_offsets --set {set} --in values=scanned.npy \
                  --in block_sums=before.npy --over 640,1,1 --out values=done.npy:50,50:i32"
        ),
    );
    let (shape, done) = npy::read_i32(&at.path().join("done.npy"));
    assert_eq!(shape, [50, 50]);
    let mut sum = 0;
    for (index, found) in done.iter().enumerate() {
        assert_eq!(found.cast_unsigned(), sum, "value {index}");
        sum += values[index];
    }
}

/// Basis `index` (from 0) of Eq. 4.7 of a blocker at depth `z`, as it is stored, 0..1. Of `bases`, blockers are
/// moved by 0.6 / M, at most 0.04, and not beyond 1.
fn stored_basis(index: usize, bases: usize, z: f64) -> f64 {
    let z = (z + (0.6 / bases as f64).min(0.04)).min(1.0);
    let angle = PI * (2.0 * (index / 2) as f64 + 1.0) * z;
    0.5 + 0.5 * if index.is_multiple_of(2) { angle.sin() } else { angle.cos() }
}

#[track_caller]
fn assert_bases(found: &[f64], bases: usize, rows: &[[f64; 4]], ratio: f64, tolerance: f64) {
    for layer in 0..bases / 4 {
        for (row, depths) in rows.iter().enumerate() {
            for column in 0..4 {
                for channel in 0..4 {
                    let basis = 4 * layer + channel;
                    let weights: Vec<f64> = (0..=column as i32).map(|i| ratio.powi(i)).collect();
                    let sum: f64 =
                        weights.iter().zip(depths).map(|(w, z)| w * stored_basis(basis, bases, *z)).sum();
                    let expected = sum / weights.iter().sum::<f64>();
                    let at = ((layer * rows.len() + row) * 4 + column) * 4 + channel;
                    let error = (found[at] - expected).abs();
                    assert!(
                        error <= tolerance,
                        "basis {basis} at {row},{column}: {} not {expected}",
                        found[at]
                    );
                }
            }
        }
    }
}

#[test]
fn filter_makes_the_means_that_its_equations_say() {
    let at = folder();
    let rows = [[0.25, 0.25, 0.25, 0.25], [0.0, 0.0, 0.5, 1.0], [0.1, 0.9, 0.3, 0.7]];
    let values: Vec<f32> = rows.iter().flatten().map(|z| *z as f32).collect();
    npy::write_f32(&at.path().join("map.npy"), &[3, 4], &values);

    run(
        at.path(),
        "run scattering/filter:average_rgba16float --in rectified=map.npy --over 3,4 \
         --out bases=average.npy:8,3,4",
    );
    let (shape, found) = npy::read_f32(&at.path().join("average.npy"));
    assert_eq!(shape, [8, 3, 4, 4]);
    let found: Vec<f64> = found.into_iter().map(f64::from).collect();
    assert_bases(&found, 32, &rows, 1.0, 6e-4);

    // Fewer bases by definition; weights that halve from texel to texel: extinction * radius_max / (4 * reference) = ln 2.
    let slice = [0.0, 1.0, 8.0, 2.0].repeat(3);
    npy::write_f32(&at.path().join("slices.npy"), &[1, 3, 4], &slice);
    let set = format!("medium.extinction={}", std::f64::consts::LN_2);
    run(
        at.path(),
        &format!(
            "run scattering/filter --define BASES=8 --define BASES_PER_THREAD=4 \
                  --in rectified=map.npy --in slices=slices.npy --set {set} --over 3,2 \
                  --out bases=weighted.npy:2,3,4"
        ),
    );
    let (shape, found) = npy::read_u8(&at.path().join("weighted.npy"));
    assert_eq!(shape, [2, 3, 4, 4]);
    let found: Vec<f64> = found.into_iter().map(|value| f64::from(value) / 255.0).collect();
    assert_bases(&found, 8, &rows, 0.5, 0.51 / 255.0);
}

#[test]
fn a_full_screen_pass_draws_the_sky() {
    let at = folder();
    npy::write_f32(&at.path().join("camera.npy"), &[40], &camera());
    run(
        at.path(),
        "run core/raster --entry fragment_background --vertex vertex_background --size 8x8 \
         --in camera=camera.npy --set sky.zenith=1,2,3 --set Sky.horizon=0.5,0.25,0 --set sky.ground=0,0,8 \
         --out color=sky.npy",
    );
    let (shape, sky) = npy::read_f32(&at.path().join("sky.npy"));
    assert_eq!(shape, [8, 8, 4]);
    let mix = |a: [f64; 3], b: [f64; 3], t: f64| [0, 1, 2].map(|i| a[i] + (b[i] - a[i]) * t);
    for row in 0..8 {
        for column in 0..8 {
            let (x, y) = ((f64::from(column) + 0.5) / 4.0 - 1.0, 1.0 - (f64::from(row) + 0.5) / 4.0);
            let up = y / (x * x + y * y + 1.0).sqrt();
            let (zenith, horizon, ground) = ([1.0, 2.0, 3.0], [0.5, 0.25, 0.0], [0.0, 0.0, 8.0]);
            let t = (-up / 0.12).clamp(0.0, 1.0);
            let expected = if up >= 0.0 {
                mix(horizon, zenith, up.sqrt())
            } else {
                mix(horizon, ground, t * t * (3.0 - 2.0 * t))
            };
            let place = ((row * 8 + column) * 4) as usize;
            for channel in 0..3 {
                let found = f64::from(sky[place + channel]);
                assert!(
                    (found - expected[channel]).abs() < 1e-4,
                    "{row},{column}: {found}, not {}",
                    expected[channel]
                );
            }
            assert_eq!(sky[place + 3], 1.0);
        }
    }
}

#[test]
fn a_struct_that_one_pass_writes_is_the_uniform_of_the_next() {
    let at = folder();
    let folder = at.path();
    npy::write_f32(&folder.join("camera.npy"), &[40], &camera());
    run(
        folder,
        "run scattering/slices --in camera=camera.npy --set light.direction=0,1,0 \
         --set medium.distance_limit=10 --over 8 --out frame=frame.npy --out slices=slices.npy:1,8",
    );
    let (shape, frame) = npy::read_f32(&folder.join("frame.npy"));
    assert_eq!(shape, [32]);
    // light, towards it; the number of rows is where the layout says.
    assert_eq!(frame[..3], [0.0, 1.0, 0.0]);
    assert_eq!(frame[11], 8.0);
    let (shape, slices) = npy::read_f32(&folder.join("slices.npy"));
    assert_eq!(shape, [1, 8, 4]);
    assert!(slices.iter().all(|value| value.is_finite()));

    // Without a blocker anywhere every depth of the rectified map is 1.
    npy::write_f32(&folder.join("shadow.npy"), &[4, 4], &[1.0; 16]);
    run(
        folder,
        "run scattering/rectify --in frame=frame.npy --in slices=slices.npy --in shadow_map=shadow.npy \
         --set light.far_depth=1 --over 5,8 --out rectified=map.npy:8,5",
    );
    let (shape, map) = npy::read_f32(&folder.join("map.npy"));
    assert_eq!(shape, [8, 5]);
    assert_eq!(map, [1.0; 40]);
}

#[test]
fn shaders_of_a_folder_get_every_kind_of_resource() {
    let at = folder();
    let folder = at.path();
    own_shaders(folder);
    npy::write_f32(&folder.join("volume.npy"), &[2, 1, 3], &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
    // Two rows, two columns, two channels: 0.25 down is the centre of the first row, 0.5 between its columns.
    npy::write_f32(&folder.join("image.npy"), &[2, 2, 2], &[0.0, 1.0, 0.0, 2.0, 0.0, 9.0, 0.0, 9.0]);
    npy::write_u32(&folder.join("ids.npy"), &[2, 2], &[0, 0, 0, 77]);
    npy::write_f32(
        &folder.join("points.npy"),
        &[3, 4],
        &[0.0, 0.0, 0.0, 0.0, 1.5, 2.5, 3.5, 9.0, 0.0, 0.0, 0.0, 0.0],
    );
    run(
        folder,
        "run t/mixed --shaders own --entry gather --dispatch 1 --set parameters.turn=1,2,3,4 \
         --set parameters.inner[1].count=12 --set parameters.shift=-3 --set parameters.inner[0].scale=0.5,-0.5 \
         --set again.inner[0].scale=7,8 --in volume=volume.npy --in image=image.npy --in ids=ids.npy \
         --in points=points.npy --out results=results.npy:5,4",
    );
    let (shape, results) = npy::read_f32(&folder.join("results.npy"));
    assert_eq!(shape, [5, 4]);
    let expected = [
        // Columns (1, 2) and (3, 4) times (1, 10).
        [31.0, 42.0, 12.0, -3.0],
        [4.0, 1.5, 77.0, 5.0],
        [1.5, 2.5, 3.5, 3.0],
        [0.5, -0.5, 7.0, 8.0],
        [0.0; 4],
    ];
    assert_eq!(results, expected.concat());

    // The other entry point asks for nothing that only the first one uses; its texture is both given and kept.
    npy::write_u32(&folder.join("marks.npy"), &[2, 2], &[1, 20_000_001, 3, 4]);
    run(
        folder,
        "run t/mixed --shaders own --entry mark --over 2,2 --set parameters.shift=5 --in marks=marks.npy \
         --out marks=marked.npy",
    );
    let (shape, marked) = npy::read_u32(&folder.join("marked.npy"));
    assert_eq!(shape, [2, 2]);
    assert_eq!(marked, [7, 40_000_008, 11, 14]);

    let listed = run(folder, "list --shaders own t");
    assert!(listed.out.contains("t/mixed   Everything that can be bound."), "{}", listed.out);
}
