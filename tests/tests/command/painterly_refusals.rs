// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight painterly` with files, numbers and flags that cannot be meant, alone or together.

use crate::command::{refuses, refuses_first, succeeds, words};
use crate::lumps;
use crate::npy;
use std::path::Path;

fn typed(flags: &str) -> String {
    let volume = if flags.contains("--volume") { "" } else { "--volume lumps.npy" };
    let out = if flags.contains("--out") { "" } else { "--out out" };
    let size = if flags.contains("--size") { "" } else { "--size 40x25" };
    format!("painterly {volume} {out} {size} {flags}")
}

/// Refused, and before any GPU work: where there is no adapter it is said as well.
#[track_caller]
fn refused(at: &Path, flags: &str, code: i32, parts: &[&str]) {
    let line = typed(flags);
    refuses_first(at, &words(&line), code, parts);
}

/// A NIfTI file of voxels of 8 bits, of these sides; `big`: the order of bytes.
fn nifti(sides: &[i16], big: bool) -> Vec<u8> {
    let mut file = vec![0; 352];
    let mut put = |at: usize, mut bytes: Vec<u8>| {
        if big {
            bytes.reverse();
        }
        file[at..at + bytes.len()].copy_from_slice(&bytes);
    };
    put(0, 348_i32.to_le_bytes().to_vec());
    put(40, (sides.len() as i16).to_le_bytes().to_vec());
    for axis in 0..7 {
        put(42 + 2 * axis, sides.get(axis).copied().unwrap_or(1).to_le_bytes().to_vec());
        put(80 + 4 * axis, 1_f32.to_le_bytes().to_vec());
    }
    put(70, 2_i16.to_le_bytes().to_vec());
    put(72, 8_i16.to_le_bytes().to_vec());
    put(108, 352_f32.to_le_bytes().to_vec());
    file[344..348].copy_from_slice(b"n+1\0");
    let voxels: usize = sides.iter().map(|side| *side as usize).product();
    file.extend((0..voxels).map(|index| (index * 37 % 251) as u8));
    file
}

#[test]
fn volumes_that_cannot_be_are_refused() {
    let at = lumps::folder();
    let at = at.path();
    let bad = |flags: &str, code: i32, parts: &[&str]| refused(at, flags, code, parts);
    refuses(at, &words("painterly --out out"), 2, &["--volume"]);
    refuses(at, &words("painterly --volume lumps.npy"), 2, &["--out"]);
    bad("--volume head.dcm", 2, &["--volume", "`head.dcm`", ".nii.gz or .npy"]);
    bad("--volume cloud", 2, &["--volume", "`cloud`", ".nii.gz or .npy"]);
    bad("--volume none.nii.gz", 1, &["--volume", "none.nii.gz", "check the path"]);
    bad("--volume none.npy", 1, &["--volume", "none.npy", "check the path"]);
    // Truncated.
    let whole = std::fs::read(at.join("lumps.npy")).unwrap();
    let good = nifti(&[5, 4, 3], false);
    for (name, bytes) in [
        ("half.npy", &whole[..whole.len() / 2]),
        ("less.npy", &whole[..whole.len() - 1]),
        ("head.npy", &whole[..40]),
        ("half.nii", &good[..good.len() - 1]),
        ("head.nii", &good[..200]),
        ("none.nii", &[]),
    ] {
        std::fs::write(at.join(name), bytes).unwrap();
        bad(
            &format!("--volume {name}"),
            1,
            &["--volume", name, if name.ends_with('y') { "numpy.save" } else { "export it again" }],
        );
        std::fs::remove_file(at.join(name)).unwrap();
    }
    // The wrong order of bytes: both are read where the whole file is of one, and none where it is of two.
    for big in [false, true] {
        std::fs::write(at.join("fine.nii"), nifti(&[5, 4, 3], big)).unwrap();
        succeeds(at, &words(&typed("--volume fine.nii --settle 0")));
        let mut swapped = nifti(&[5, 4, 3], big);
        swapped[40..56].chunks_exact_mut(2).for_each(|side| side.reverse());
        std::fs::write(at.join("swapped.nii"), &swapped).unwrap();
        bad("--volume swapped.nii", 1, &["--volume", "swapped.nii", "no valid NIfTI"]);
    }
    // Axes.
    std::fs::write(at.join("axes.nii"), nifti(&[5, 4, 3, 1, 1], false)).unwrap();
    succeeds(at, &words(&typed("--volume axes.nii --settle 0")));
    std::fs::write(at.join("axes.nii"), nifti(&[5, 4, 3, 2], false)).unwrap();
    bad("--volume axes.nii", 1, &["--volume", "axes.nii", "2 volumes", "extract the one"]);
    std::fs::write(at.join("axes.nii"), nifti(&[5, 0, 3], false)).unwrap();
    bad("--volume axes.nii", 1, &["--volume", "axes.nii", "no valid NIfTI"]);
    for shape in [&[2, 0, 4][..], &[6], &[2, 3], &[1, 2, 3, 4]] {
        npy::write_f32(&at.join("axes.npy"), shape, &vec![0.5; shape.iter().product()]);
        bad(
            "--volume axes.npy",
            1,
            &["--volume", "axes.npy", &format!("{shape:?}"), "[z, y, x]", "at least one voxel"],
        );
    }
}

#[test]
fn volumes_beyond_the_limit_are_refused_with_a_remedy() {
    let at = lumps::folder();
    let at = at.path();
    for (shape, remedy) in
        [([1, 1, 2049], "--downsample 2"), ([5000, 1, 1], "--downsample 3"), ([1, 140_000, 1], "crop it")]
    {
        npy::write_f32(&at.join("long.npy"), &shape, &vec![0.5; shape.iter().product()]);
        let sides = format!("{} x {} x {}", shape[2], shape[1], shape[0]);
        refused(at, "--volume long.npy", 1, &["--volume", "long.npy", &sides, "2048 a side", remedy]);
    }
    npy::write_f32(&at.join("long.npy"), &[1, 1, 4097], &[0.5; 4097]);
    refused(at, "--volume long.npy --downsample 2", 1, &["--volume", "--downsample 3"]);
}

const POINT: &str = "[[point]]\nvalue = 0.5\ncolor = '#ffffff'\nopacity = 1\n";

#[test]
fn files_of_looks_that_cannot_be_are_refused() {
    let at = lumps::folder();
    let at = at.path();
    let bad = |flags: &str, code: i32, parts: &[&str]| refused(at, flags, code, parts);
    let write = |name: &str, text: &str| std::fs::write(at.join(name), text).unwrap();
    bad("--transfer hed", 2, &["--transfer", "`hed`", "head, stent", ".toml"]);
    bad("--transfer none.toml", 1, &["--transfer", "none.toml", "cannot be read"]);
    write("t.toml", &format!("{POINT}tint = 1\n"));
    bad("--transfer t.toml", 1, &["--transfer", "t.toml:5:1", "unknown field `tint`"]);
    write("t.toml", &format!("colour = 1\n{POINT}"));
    bad("--transfer t.toml", 1, &["--transfer", "t.toml:1:1", "unknown field `colour`"]);
    write("t.toml", "");
    bad("--transfer t.toml", 1, &["--transfer", "t.toml", "no points"]);
    write("t.toml", &POINT.replace("= 1", "= 2"));
    bad("--transfer t.toml", 1, &["--transfer", "t.toml", "opacity of 2"]);
    write("t.toml", &format!("range = [3, 2]\n{POINT}"));
    bad("--transfer t.toml", 1, &["--transfer", "t.toml", "from 3 to 2"]);
    write("t.toml", "[[point");
    bad("--transfer t.toml", 1, &["--transfer", "t.toml:1:"]);

    bad("--style d", 2, &["--style", "`d`", "a, b, c, dense", ".toml"]);
    bad("--style none.toml", 1, &["--style", "none.toml", "cannot be read"]);
    let style = include_str!("../../../host/styles/painterly/dense.toml");
    write("s.toml", &style.replace("[coarse]", "[coarse]\nthickness = 3"));
    let line = style.lines().position(|line| line == "[coarse]").unwrap() + 2;
    bad("--style s.toml", 1, &["--style", &format!("s.toml:{line}:1"), "unknown field `thickness`"]);
    write("s.toml", &style.replace("threshold = 0.3", "threshold = 0.05"));
    bad("--style s.toml", 1, &["--style", "s.toml", "medium.threshold of 0.05", "greater"]);
    write("s.toml", "");
    bad("--style s.toml", 1, &["--style", "s.toml:1:1", "missing field"]);

    bad("--brush none.png", 1, &["--brush", "none.png", "cannot be read"]);
    write("b.png", "no picture");
    bad("--brush b.png", 1, &["--brush", "b.png", "no valid PNG"]);
    write("b.png", "");
    bad("--brush b.png", 1, &["--brush", "b.png", "no valid PNG"]);
    let clear = image::RgbaImage::new(8, 4);
    clear.save(at.join("b.png")).unwrap();
    bad("--brush b.png", 1, &["--brush", "b.png", "nowhere opaque"]);
    let whole = std::fs::read(at.join("b.png")).unwrap();
    std::fs::write(at.join("b.png"), &whole[..whole.len() / 2]).unwrap();
    bad("--brush b.png", 1, &["--brush", "b.png", "no valid PNG"]);
    // Of no width; the checksum of the header fits.
    let mut flat = whole;
    flat[16..20].fill(0);
    let sum = checksum(&flat[12..29]);
    flat[29..33].copy_from_slice(&sum.to_be_bytes());
    std::fs::write(at.join("b.png"), &flat).unwrap();
    bad("--brush b.png", 1, &["--brush", "b.png", "no valid PNG"]);
    image::GrayImage::new(4097, 1).save(at.join("b.png")).unwrap();
    bad("--brush b.png", 1, &["--brush", "b.png", "4097x1", "4096", "shrink it"]);
}

/// The checksum of a part of a PNG.
fn checksum(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0_u32, |sum, byte| {
        (0..8).fold(sum ^ u32::from(*byte), |sum, _| (sum >> 1) ^ (0xedb8_8320 & (sum & 1).wrapping_neg()))
    })
}

#[test]
fn numbers_that_cannot_be_meant_are_refused() {
    let at = lumps::folder();
    let bad = |flags: &str, parts: &[&str]| refused(at.path(), flags, 2, parts);
    for iso in ["0", "-0.5", "1.5"] {
        bad(&format!("--iso {iso}"), &["--iso", iso, "above 0, at most 1"]);
    }
    bad("--iso nan", &["--iso", "nan"]);
    for steps in ["0.1", "17", "-1"] {
        bad(&format!("--steps {steps}"), &["--steps", steps, "0.25 to 16"]);
    }
    for scale in ["0", "-1", "1.5", "nan"] {
        bad(&format!("--source-scale {scale}"), &["--source-scale", scale]);
    }
    for number in ["0", "65", "-1", "x"] {
        bad(&format!("--downsample {number}"), &["--downsample", number]);
    }
    for frames in ["3..1", "5", "0..10000", "-1..2"] {
        bad(&format!("--frames {frames}"), &["--frames", frames]);
    }
    for rate in ["0", "-3", "1001", "fast"] {
        bad(&format!("--frames 0..1 --rate {rate}"), &["--rate", rate]);
    }
    bad("--frames 0..1 --turn inf", &["--turn", "inf"]);
    for size in ["0x5", "9000x5", "5", "5x8193"] {
        bad(&format!("--size {size}"), &["--size", size]);
    }
    for settle in ["-1", "1001"] {
        bad(&format!("--settle {settle}"), &["--settle", settle]);
    }
    for number in ["-0.1", "1.1", "nan"] {
        bad(&format!("--underpainting {number}"), &["--underpainting", number]);
    }
    bad("--exposure -1", &["--exposure", "-1", "0 to 1000"]);
    for colour in ["white", "#fff", "#12345g"] {
        bad(&format!("--canvas {colour}"), &["--canvas", colour, "#rrggbb"]);
    }
    for plane in ["1,0,0", "0,0,0,1", "1,0,nan,0"] {
        bad(&format!("--clip {plane}"), &["--clip"]);
    }
    bad(&"--clip 1,0,0,0 ".repeat(9), &["--clip", "9 clip planes", "at most 8"]);
    bad("--seed -1", &["--seed", "-1"]);
    bad("--capacity -1", &["--capacity", "-1"]);
    bad("--voxel 0", &["--voxel", "0"]);
    bad("--fov 0", &["--fov", "0"]);
    bad("--fov 175", &["--fov", "175"]);
    bad("--camera orthographic --height -2", &["--height", "-2"]);
    bad("--camera fisheye", &["--camera", "fisheye", "orthographic"]);
    bad("--eye 1,1", &["--eye", "1,1"]);
    bad("--eye 1,1,1 --target 1,1,1", &["--eye, --target"]);
    bad("--orientation round", &["--orientation", "round", "curvature"]);
    bad("--jitter white", &["--jitter", "white", "blue-noise"]);
    bad("--light sun", &["--light", "sun"]);
    bad("--light directional:0,91", &["--light", "-90 to 90"]);
}

#[test]
fn flags_that_cannot_be_meant_together_are_refused() {
    let at = lumps::folder();
    let at = at.path();
    let bad = |flags: &str, parts: &[&str]| refused(at, flags, 2, parts);
    for light in ["spot:0,4,0,0,0,0.1,30", "point:0,3,0"] {
        bad(&format!("--light {light}"), &["--light", "directional:AZ,EL"]);
    }
    bad("--turn 5", &["--turn", "--frames"]);
    bad("--rate 5", &["--rate", "--frames"]);
    bad("--camera orthographic --fov 30", &["--fov", "--height"]);
    bad("--height 3", &["--height", "--camera orthographic"]);
    bad("--volume none.nii --voxel 1", &["--voxel", ".npy", "leave it out"]);
}

#[test]
fn folders_that_cannot_be_written_are_refused() {
    let at = lumps::folder();
    let at = at.path();
    std::fs::write(at.join("file"), "").unwrap();
    std::fs::create_dir_all(at.join("taken/painting.png")).unwrap();
    std::fs::create_dir_all(at.join("numbered/painting.0001.png")).unwrap();
    refused(at, "--out file", 1, &["--out", "file", "give the name of a folder"]);
    refused(at, "--out file/inner", 1, &["--out", "file is a file"]);
    refused(at, "--out taken", 1, &["--out", "taken/painting.png", "is a folder"]);
    refused(at, "--out numbered --frames 0..1", 1, &["--out", "painting.0001.png", "is a folder"]);
    succeeds(at, &words(&typed("--out numbered --settle 0")));
}

/// What only the device knows: nothing is left of what was begun.
#[test]
fn buffers_beyond_the_device_are_refused() {
    let at = lumps::folder();
    let at = at.path();
    for capacity in ["0", "4000000000"] {
        let line = typed(&format!("--capacity {capacity}"));
        refuses(at, &words(&line), 2, &["--capacity", capacity, "between 1 and"]);
    }
}
