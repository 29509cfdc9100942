// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight transmittance` with files, numbers and flags that cannot be meant, alone or together.

use crate::command::{folder, refuses, refuses_first, words};
use crate::npy;
use std::path::Path;

const CLOUD: &str = "--volume cloud --voxels 8";
const BURST: &str = "--particles burst --count 8";

/// Refused, and before any GPU work: where there is no adapter it is said as well.
#[track_caller]
fn refused(at: &Path, flags: &str, code: i32, parts: &[&str]) {
    let mut arguments = words("transmittance --size 32x24");
    if !flags.contains("--out") {
        arguments.extend(["--out", "x.exr"]);
    }
    arguments.extend(words(flags));
    refuses_first(at, &arguments, code, parts);
}

#[test]
fn media_that_cannot_be_are_refused() {
    let at = folder();
    let at = at.path();
    let bad = |flags: &str, code: i32, parts: &[&str]| refused(at, flags, code, parts);
    bad("", 2, &["--volume", "--particles"]);
    bad("--volume cloud --particles burst", 2, &["--volume", "--particles"]);
    bad("--volume clowd", 2, &["--volume", "`clowd`", "cloud, plume", ".nii.gz"]);
    bad("--volume head.dcm", 2, &["--volume", "head.dcm", ".nii.gz"]);
    bad("--particles cloud", 2, &["--particles", "`cloud`", "burst", ".npy"]);
    bad("--volume none.nii.gz", 1, &["--volume", "none.nii.gz", "check the path"]);
    bad("--volume none.npy", 1, &["--volume", "none.npy", "check the path"]);
    bad("--particles none.npy", 1, &["--particles", "none.npy", "check the path"]);
    std::fs::write(at.join("text.nii"), "no volume").unwrap();
    std::fs::write(at.join("text.npy"), "no array").unwrap();
    bad("--volume text.nii", 1, &["--volume", "text.nii", "no valid NIfTI", "export it again"]);
    bad("--volume text.npy", 1, &["--volume", "text.npy", "numpy.save"]);
    bad("--particles text.npy", 1, &["--particles", "text.npy", "numpy.save"]);
    let columns = "x, y, z, radius (metres) and extinction (1/m)";
    for shape in [&[5, 4][..], &[20], &[2, 2, 5]] {
        npy::write_f32(&at.join("p.npy"), shape, &[0.5; 20][..shape.iter().product()]);
        bad("--particles p.npy", 1, &["--particles", "p.npy", &format!("{shape:?}"), "[n, 5]", columns]);
        if shape.len() != 3 {
            bad("--volume p.npy", 1, &["--volume", "p.npy", &format!("{shape:?}"), "[z, y, x]"]);
        }
    }
    npy::write_f32(&at.join("bad.npy"), &[2, 5], &[f32::NAN, 0., 0., 1., 1., 0., 0., 0., 0., 1.]);
    let parts = ["--particles", "bad.npy", "none of 2", "1 not finite, 1 of zero", "check columns"];
    bad("--particles bad.npy", 1, &parts);
    npy::write_f32(&at.join("none.npy"), &[0, 5], &[]);
    bad("--particles none.npy", 1, &["none of 0 particles"]);
    for value in [0.0, -1.0, f32::NAN] {
        npy::write_f32(&at.join("empty.npy"), &[2, 2, 2], &[value; 8]);
        bad("--volume empty.npy", 1, &["--volume", "empty.npy", "no voxel exceeds 0", "--threshold"]);
    }
    npy::write_f32(&at.join("ones.npy"), &[2, 2, 2], &[1.0; 8]);
    bad("--volume ones.npy --threshold 1", 1, &["no voxel exceeds 1", "--threshold"]);
}

#[test]
fn numbers_that_cannot_be_meant_are_refused() {
    let at = folder();
    let at = at.path();
    let bad = |flags: &str, parts: &[&str]| refused(at, &format!("{CLOUD} {flags}"), 2, parts);
    for count in ["0", "3", "6", "32"] {
        bad(&format!("--coefficients {count}"), &["--coefficients", count, "4, 8 or 16"]);
    }
    bad("--coefficients -4", &["--coefficients", "-4"]);
    for map in ["moments", "trigonometric"] {
        bad(&format!("--map {map} --coefficients 4"), &["--coefficients", "4", "take 8"]);
    }
    bad("--map shadow", &["--map", "shadow", "etm", "reference"]);
    for size in ["0", "8193", "-1", "64x64"] {
        bad(&format!("--map-size {size}"), &["--map-size", size]);
    }
    bad("--format float64", &["--format", "float64", "float16"]);
    bad("--reading cubic", &["--reading", "cubic", "nearest"]);
    for voxels in ["3", "513"] {
        refused(at, &format!("--volume cloud --voxels {voxels}"), 2, &["--voxels", voxels]);
    }
    bad("--seed -1", &["--seed", "-1"]);
    for scale in ["-1", "2e6"] {
        bad(&format!("--extinction-scale {scale}"), &["--extinction-scale", "0 to 1e6"]);
    }
    bad("--extinction-scale nan", &["--extinction-scale", "nan"]);
    bad("--light sun", &["--light", "sun"]);
    bad("--radiance -1,0,0", &["--radiance", "0 to 1e4"]);
    bad("--background 1e5", &["--background", "0 to 1e4"]);
    bad("--background blue", &["--background", "`blue`"]);
    bad("--albedo 1.5", &["--albedo", "1.5", "from 0 to 1"]);
    bad("--albedo -0.1,0,0", &["--albedo", "-0.1", "from 0 to 1"]);
    bad("--g 1", &["--g", "1", "-0.999 to 0.999"]);
    bad("--fov 0", &["--fov", "0"]);
    bad("--fov 180", &["--fov", "180"]);
    bad("--eye 1,1,1 --target 1,1,1", &["--eye, --target", "1"]);
    bad("--eye 1,1", &["--eye", "1,1"]);
    for exposure in ["0", "-2"] {
        bad(&format!("--exposure {exposure}"), &["--exposure", exposure, "positive"]);
    }
    bad("--size 9000x24", &["--size"]);
    bad("--out x.jpg", &["--out", "x.jpg", ".png or .exr"]);
    let burst = |flags: &str, parts: &[&str]| refused(at, &format!("{BURST} {flags}"), 2, parts);
    burst("--bounds 0,0,0,1,1", &["--bounds", "six numbers"]);
    for flat in ["0,0,0,1,0,1", "0,0,0,0,0,0", "1,1,1,0,2,2"] {
        burst(&format!("--bounds {flat}"), &["--bounds", "range of zero", "exceed"]);
    }
    refused(at, "--particles burst --count 0", 2, &["--count", "0"]);
}

#[test]
fn flags_that_cannot_be_meant_together_are_refused() {
    let at = folder();
    let at = at.path();
    npy::write_f32(&at.join("ones.npy"), &[2, 2, 2], &[1.0; 8]);
    npy::write_f32(&at.join("p.npy"), &[1, 5], &[1.0; 5]);
    let bad = |flags: &str, parts: &[&str]| refused(at, flags, 2, parts);
    let volume = |flags: &str, parts: &[&str]| bad(&format!("{CLOUD} {flags}"), parts);
    let burst = |flags: &str, parts: &[&str]| bad(&format!("{BURST} {flags}"), parts);
    burst("--map tfm", &["--map", "`tfm`", "bounded or etm"]);
    burst("--map tfm-fourier", &["--map", "`tfm`", "bounded or etm"]);
    burst("--map reference --splat fixed", &["--splat", "no map"]);
    bad("--particles burst --count 200001 --map reference", &["--map", "200001", "bounded"]);
    volume("--map reference --coefficients 4", &["--coefficients", "no map"]);
    volume("--map reference --map-size 4", &["--map-size", "no map"]);
    volume("--map reference --format float16", &["--format", "no map"]);
    for map in ["fom", "tfm", "tfm-fourier", "moments", "trigonometric", "reference"] {
        volume(&format!("--map {map} --monotone"), &["--monotone", "etm and bounded"]);
    }
    for map in ["moments", "trigonometric"] {
        volume(&format!("--map {map} --format float16"), &["--format", "`float16`", "float32"]);
        burst(&format!("--map {map} --splat blend"), &["--splat", "`blend`", "fixed"]);
    }
    volume("--splat fixed", &["--splat", "leave it out"]);
    volume("--camera orthographic --fov 30", &["--fov", "--height"]);
    volume("--height 3", &["--height", "--camera orthographic"]);
    volume("--camera orthographic --height 0", &["--height"]);
    burst("--splat blend", &["--splat", "`blend`", "etm and fom"]);
    burst("--map etm --splat blend --format float32", &["--format", "float16, or --splat fixed"]);
    for light in ["spot:0,4,0,0,0,0.1,30", "point:0,3,0"] {
        volume(&format!("--light {light}"), &["--light", "directional:AZ,EL"]);
    }
    volume("--bounds 0,0,0,1,1,1", &["--bounds", "leave it out"]);
    volume("--threshold 1", &["--threshold", "leave it out"]);
    volume("--voxel 1", &["--voxel", "leave it out"]);
    volume("--count 7", &["--count", "burst"]);
    burst("--reading linear", &["--reading", "leave it out"]);
    burst("--voxels 7", &["--voxels", "cloud and plume"]);
    bad("--volume ones.npy --voxels 7", &["--voxels", "cloud and plume"]);
    bad("--volume ones.npy --seed 7", &["--seed", "leave it out"]);
    bad("--particles p.npy --seed 7", &["--seed", "leave it out"]);
    bad("--particles p.npy --count 7", &["--count", "burst"]);
    bad("--particles p.npy --threshold 7", &["--threshold", "leave it out"]);
}

/// What only the device knows.
#[test]
fn maps_beyond_the_device_are_refused() {
    let at = folder();
    let line = format!("transmittance {BURST} --out x.exr --map etm --coefficients 16 --map-size 2048");
    refuses(at.path(), &words(&line), 2, &["--map-size", "fewer coefficients"]);
}
