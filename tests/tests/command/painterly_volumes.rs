// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight painterly` of volumes of all kinds: broken voxels, nothing to see, eyes within, awkward sizes, and scans. Flags and
//! sequences are tested in `painterly.rs`.

use crate::command::folder;
use crate::lumps;
use crate::npy;
use crate::painting::{TRANSFER, numbers, paint, painted, painting, pixels};

#[test]
fn voxels_that_are_not_finite_are_the_least_and_are_counted() {
    let at = lumps::folder();
    let at = at.path();
    let (mut wild, mut clean) = (lumps::values(), lumps::values());
    let least = clean.iter().copied().fold(f32::INFINITY, f32::min);
    for (index, value) in [(11 + 24 * (9 + 20 * 18), f32::NAN), (6000, f32::INFINITY), (0, f32::NEG_INFINITY)]
    {
        wild[index] = value;
        clean[index] = least;
    }
    npy::write_f32(&at.join("wild.npy"), &lumps::SHAPE, &wild);
    npy::write_f32(&at.join("clean.npy"), &lumps::SHAPE, &clean);
    let said = paint(at, "--volume wild.npy", "wild");
    assert!(said.err.is_empty(), "{}", said.err);
    assert_eq!(numbers(&said.out, "voxels:"), [28 * 20 * 24, 3]);
    let said = paint(at, "--volume clean.npy", "clean").out;
    assert_eq!(numbers(&said, "voxels:"), [28 * 20 * 24, 0]);
    let [wild, clean] = ["wild", "clean"].map(|name| pixels(&at.join(name).join("painting.png")));
    assert!(wild == clean);
}

#[test]
fn nothing_to_see_is_a_bare_canvas_and_a_warning() {
    let at = lumps::folder();
    let at = at.path();
    std::fs::write(at.join("thin.toml"), TRANSFER.replace("opacity = 1", "opacity = 0.3")).unwrap();
    std::fs::write(at.join("far.toml"), TRANSFER.replace("[0.1, 0.9]", "[0.1, 900]").replace("0.6", "600"))
        .unwrap();
    npy::write_f32(&at.join("even.npy"), &[3, 3, 3], &[7.0; 27]);
    npy::write_f32(&at.join("none.npy"), &[3, 3, 3], &[f32::NAN; 27]);
    for (flags, said) in [
        ("--transfer thin.toml", "--transfer: it is nowhere as opaque as --iso 0.5, 0.3 at most"),
        ("--transfer far.toml", "--volume: none of its values, from 0"),
        ("--volume even.npy", "from 7 to 7, is as opaque as --iso 0.5"),
        ("--volume none.npy", "--volume: none of its values"),
        ("--target 0,90,0 --eye 0,80,0", "--eye and --target"),
        ("--clip 0,1,0,-90", "--clip"),
    ] {
        for more in ["", "--frames 0..1"] {
            let ended = paint(at, &format!("{flags} {more}"), "empty");
            assert!(
                ended.err.starts_with("airlight: warning: ") && ended.err.contains(said),
                "{flags}: {}",
                ended.err
            );
            assert_eq!(ended.err.trim_end().lines().count(), 1, "{}", ended.err);
            assert_eq!(numbers(&ended.out, "rays:")[0], 0);
            let picture = pixels(&at.join("empty/painting.png"));
            assert!(picture.len() == 25000 && painted(&picture) == 0.0, "{flags}");
        }
    }
}

#[test]
fn cameras_inside_see_the_surface_around_them() {
    let at = lumps::folder();
    let at = at.path();
    // A shell of radius 0.7 about the middle, empty within.
    let side = 24;
    let values: Vec<f32> = (0..side * side * side)
        .map(|index| {
            let voxel = [index % side, index / side % side, index / side / side];
            let square: f32 =
                voxel.iter().map(|i| (2.0 * (*i as f32 + 0.5) / side as f32 - 1.0).powi(2)).sum();
            (1.0 - 5.0 * (square.sqrt() - 0.7).abs()).max(0.0)
        })
        .collect();
    npy::write_f32(&at.join("shell.npy"), &[side; 3], &values);
    for (flags, least) in [
        ("--volume shell.npy --eye 0,0,0 --target 0,0.3,1", 1.0),
        ("--volume shell.npy --eye 0,0,1.4 --target 0,0,-1", 0.99),
        ("--eye 0,0,1.9 --target 0,0,0", 0.05),
    ] {
        let said = paint(at, &format!("{flags} --fov 60"), "inside").out;
        let [hit, all] = numbers(&said, "rays:")[..] else { panic!("{said}") };
        let share = hit as f64 / all as f64;
        assert!(share >= least, "{flags}: {share} of the rays hit");
    }
}

#[test]
fn awkward_volumes_and_sizes_are_painted() {
    let at = lumps::folder();
    let at = at.path();
    let value = |index: usize| ((index * 7) % 11) as f32;
    for shape in [[1, 9, 9], [9, 1, 9], [9, 9, 1], [1, 1, 9], [9, 1, 1]] {
        let values: Vec<f32> = (0..shape.iter().product()).map(value).collect();
        npy::write_f32(&at.join("thin.npy"), &shape, &values);
        let said = paint(at, "--volume thin.npy --iso 0.3", "thin").out;
        assert!(numbers(&said, "rays:")[0] > 0, "{shape:?}: {said}");
    }
    npy::write_f32(&at.join("one.npy"), &[1, 1, 1], &[3.0]);
    let ended = paint(at, "--volume one.npy", "thin");
    assert!(ended.err.contains("warning"), "{}", ended.err);
    for flags in ["--size 1x1", "--size 3x200", "--size 7x5 --source-scale 0.01", "--capacity 1"] {
        paint(at, flags, "small");
    }
    // Longer than a 3D texture may be, but not when it is averaged.
    let long: Vec<f32> = (0..2 * 2049).map(value).collect();
    npy::write_f32(&at.join("long.npy"), &[2049, 1, 2], &long);
    let said = paint(at, "--volume long.npy --downsample 2", "long").out;
    assert_eq!(numbers(&said, "voxels:"), [1025, 0]);
    // The other order of bytes.
    let big: Vec<u8> = lumps::values().iter().flat_map(|value| value.to_be_bytes()).collect();
    std::fs::write(at.join("big.npy"), npy::encoded(">f4", &lumps::SHAPE, &big)).unwrap();
    assert!(painting(at, "--volume big.npy") == painting(at, ""));
}

/// The head has a fourth axis of length one.
#[test]
fn scans_that_are_shipped_are_painted() {
    let at = folder();
    let assets = concat!(env!("CARGO_MANIFEST_DIR"), "/../host/assets");
    for (file, flags) in [("head_mri", "--transfer head"), ("stent_ct", "--iso 0.35")] {
        let said =
            paint(at.path(), &format!("--volume {assets}/{file}.nii.gz {flags} --downsample 2"), file).out;
        let [hit, all] = numbers(&said, "rays:")[..] else { panic!("{said}") };
        assert!(hit > all / 50 && hit < all / 2, "{file}: {said}");
        assert!(numbers(&said, "strokes:")[0] > 50, "{file}: {said}");
    }
}
