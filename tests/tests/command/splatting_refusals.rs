// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight splatting` with files, numbers and flags that cannot be meant, alone or together.

use crate::command::{folder, refuses_first, words};
use crate::npy;
use std::path::Path;

const CLOUD: &str = "--volume cloud --voxels 8";

/// Refused, and before any GPU work: where there is no adapter it is said as well.
#[track_caller]
fn refused(at: &Path, flags: &str, code: i32, parts: &[&str]) {
    let mut arguments = vec!["splatting"];
    if !flags.contains("--size") {
        arguments.extend(["--size", "32x24"]);
    }
    if !flags.contains("--out") {
        arguments.extend(["--out", "x.exr"]);
    }
    arguments.extend(words(flags));
    refuses_first(at, &arguments, code, parts);
}

#[test]
fn files_that_cannot_be_are_refused() {
    let at = folder();
    let at = at.path();
    let bad = |flags: &str, code: i32, parts: &[&str]| refused(at, flags, code, parts);
    bad("", 2, &["--volume"]);
    bad("--volume clowd", 2, &["--volume", "`clowd`", "clouds, plume, smoke", ".nii.gz"]);
    bad("--volume head.dcm@1,2,3", 2, &["--volume", "head.dcm", ".nii.gz"]);
    bad("--volume none.npy", 1, &["--volume", "none.npy", "check the path"]);
    bad("--volume cloud --volume none.nii", 1, &["--volume", "none.nii", "check the path"]);
    std::fs::write(at.join("text.npy"), "no array").unwrap();
    bad("--volume text.npy", 1, &["--volume", "text.npy", "numpy.save"]);
    npy::write_f32(&at.join("p.npy"), &[2, 2], &[0.5; 4]);
    bad("--volume p.npy", 1, &["--volume", "p.npy", "[z, y, x]"]);
    let cloud = |flags: &str, code: i32, parts: &[&str]| bad(&format!("{CLOUD} {flags}"), code, parts);
    cloud("--mesh none.obj", 1, &["--mesh", "none.obj"]);
    std::fs::write(at.join("empty.obj"), "v 0 0 0\n").unwrap();
    cloud("--mesh empty.obj", 1, &["--mesh", "empty.obj", "no triangles"]);
    cloud("--transfer clowd", 2, &["--transfer", "`clowd`", "head, stent, cloud, smoke, vessels", ".toml"]);
    cloud("--transfer none.toml", 1, &["--transfer", "none.toml"]);
    std::fs::write(at.join("f.toml"), "[[point]]\nvalue = 2\ncolor = \"#ffffff\"\nopacity = 1\n").unwrap();
    cloud("--transfer f.toml", 1, &["--transfer", "f.toml", "point 0", "beyond the range"]);
    cloud("--light-texture none.png", 1, &["--light-texture", "none.png"]);
}

#[test]
fn numbers_that_cannot_be_meant_are_refused() {
    let at = folder();
    let at = at.path();
    let bad = |flags: &str, parts: &[&str]| refused(at, &format!("{CLOUD} {flags}"), 2, parts);
    for count in ["0", "4097", "-1", "many"] {
        bad(&format!("--sheets {count}"), &["--sheets", count]);
    }
    for size in ["0", "8193", "-1", "64x64"] {
        bad(&format!("--light-size {size}"), &["--light-size", size]);
    }
    for size in ["0x5", "-1x5", "9000x24"] {
        bad(&format!("--size={size}"), &["--size"]);
    }
    for place in ["1,2", "1,2,3,0", "1,2,3,-1", "1,2,3,1,0,0", "1,2,nan"] {
        refused(at, &format!("--volume cloud@{place}"), 2, &["--volume", "cloud@"]);
    }
    for voxels in ["3", "513"] {
        refused(at, &format!("--volume cloud --voxels {voxels}"), 2, &["--voxels", voxels]);
    }
    for scale in ["-1", "2e6"] {
        bad(&format!("--extinction-scale {scale}"), &["--extinction-scale", "0 to 1e6"]);
    }
    bad("--threshold nan", &["--threshold", "nan"]);
    bad("--seed -1", &["--seed", "-1"]);
    bad("--radiance -1,0,0", &["--radiance", "0 to 60000"]);
    bad("--radiance 60001,0,0", &["--radiance", "0 to 60000"]);
    bad("--background 1e5", &["--background", "0 to 10000"]);
    bad("--ambient -1", &["--ambient", "0 to 10000"]);
    bad("--albedo 1.5", &["--albedo", "0 to 1"]);
    bad("--g 1", &["--g", "-0.99 to 0.99"]);
    bad("--fov 0", &["--fov", "0"]);
    bad("--eye 1,1,1 --target 1,1,1", &["--eye, --target", "1"]);
    bad("--camera orthographic --height 0", &["--height"]);
    for exposure in ["0", "-2"] {
        bad(&format!("--exposure {exposure}"), &["--exposure", exposure, "positive"]);
    }
    bad("--out x.jpg", &["--out", "x.jpg", ".png or .exr"]);
    bad("--out x.exr --frames 0..1", &["--out", "x.exr", ".png with --frames"]);
    bad("--out x.png --frames 3..1", &["--frames", "3..1"]);
    bad("--out x.png --frames 0..1 --rate 0", &["--rate"]);
    bad("--light sun", &["--light", "sun"]);
    for area in ["0,30,0", "0,30,-5", "0,5,0,-1", "0,5,0,0"] {
        bad(&format!("--soft --light area:{area}"), &["--light", "impossible"]);
    }
    for flag in ["--cone 0", "--cone -5", "--free-path 0", "--free-path -1", "--sweeps 0", "--sweeps 17"] {
        bad(&format!("--back {flag}"), &[flag.split(' ').next().unwrap()]);
    }
    bad("--forward --cone 81", &["--cone", "80 degrees"]);
}

/// Light has to meet the first sheet first.
#[test]
fn lights_in_the_midst_of_the_volumes_are_refused() {
    let at = folder();
    let bad = |flags: &str, parts: &[&str]| refused(at.path(), &format!("{CLOUD} {flags}"), 2, parts);
    bad("--light point:0,0,0", &["--light", "inside the volumes' box"]);
    bad("--light spot:1,0.5,0,0,9,0,20", &["--light", "inside the volumes' box"]);
    bad("--light point:0,2.9,0", &["--light", "too near"]);
    bad("--volume cloud@9,0,0 --light point:4.5,0,0", &["--light", "inside the volumes' box"]);
    bad("--light point:0,6,0 --radiance 7e4,0,0", &["--radiance"]);
}

#[test]
fn flags_that_cannot_be_meant_together_are_refused() {
    let at = folder();
    let at = at.path();
    npy::write_f32(&at.join("ones.npy"), &[2, 2, 2], &[1.0; 8]);
    let bad = |flags: &str, parts: &[&str]| refused(at, &format!("{CLOUD} {flags}"), 2, parts);
    let area = "--light area:70,40,5";
    bad(&format!("{area} --soft --forward"), &["--soft", "--forward and --back"]);
    bad(&format!("{area} --soft --back"), &["--soft", "--forward and --back"]);
    bad("--soft", &["--soft", "area light"]);
    bad(area, &["--light", "`area`", "--soft"]);
    bad("--sweeps 2", &["--sweeps", "--back"]);
    bad("--forward --sweeps 2", &["--sweeps", "--back"]);
    bad("--cone 20", &["--cone", "--forward"]);
    bad("--free-path 1", &["--free-path", "--forward"]);
    bad("--shading phong --g 0.5", &["--g", "phong"]);
    bad("--voxel 1", &["--voxel", ".npy"]);
    refused(at, "--volume ones.npy --voxels 8", 2, &["--voxels", "cloud, clouds, plume and smoke"]);
    refused(at, "--volume ones.npy --seed 8", 2, &["--seed", "leave it out"]);
    bad("--turn 5", &["--turn", "--frames"]);
    bad("--rate 5", &["--rate", "--frames"]);
    bad("--fov 30 --camera orthographic", &["--fov", "--height"]);
    bad("--height 3", &["--height", "--camera orthographic"]);
}

#[test]
fn what_light_that_spreads_cannot_have_is_refused() {
    let at = folder();
    let at = at.path();
    std::fs::write(at.join("t.png"), "none").unwrap();
    for flags in ["--forward", "--back", "--soft --light area:10,20,3"] {
        refused(
            at,
            &format!("{CLOUD} --light-texture t.png {flags}"),
            2,
            &["--light-texture", "leave it out"],
        );
    }
}
