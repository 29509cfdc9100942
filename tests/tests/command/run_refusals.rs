// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight run`: every way to ask for what cannot be ends with one clear error, and nothing is written.

use crate::command::{airlight, files, folder, refuses, succeeds, words};
use crate::npy;
use crate::own_passes::{camera, own_shaders};
use tempfile::TempDir;

/// Input for the refusals: fine files and broken ones.
fn stage() -> TempDir {
    let at = folder();
    let folder = at.path();
    own_shaders(folder);
    npy::write_f32(&folder.join("hdr.npy"), &[2, 3, 3], &[0.5; 18]);
    npy::write_f32(&folder.join("flat.npy"), &[18], &[0.5; 18]);
    npy::write_f32(&folder.join("five.npy"), &[2, 3, 5], &[0.5; 30]);
    npy::write_f32(&folder.join("none.npy"), &[0, 3], &[]);
    npy::write_f32(&folder.join("huge.npy"), &[1, 2], &[1.0, 70000.0]);
    npy::write_f32(&folder.join("camera.npy"), &[40], &camera());
    npy::write_f32(&folder.join("wide.npy"), &[1, 8193], &[0.5; 8193]);
    npy::write_u32(&folder.join("v.npy"), &[8], &[1; 8]);
    npy::write_u32(&folder.join("ids.npy"), &[2, 3], &[1; 6]);
    npy::write_u8(&folder.join("bytes.npy"), &[8], &[1; 8]);
    std::fs::write(folder.join("empty.npy"), "").unwrap();
    std::fs::write(folder.join("garbage.npy"), "this is no array at all, but long enough for one").unwrap();
    let whole = std::fs::read(folder.join("hdr.npy")).unwrap();
    std::fs::write(folder.join("cut.npy"), &whole[..whole.len() - 5]).unwrap();
    std::fs::write(folder.join("old.npy"), "old").unwrap();
    std::fs::create_dir(folder.join("folder.npy")).unwrap();
    at
}

/// `tonemap` with one thing different: the arguments that replace those with the same flag.
fn tonemap(changed: &str) -> String {
    let lacks = |flag: &str| !words(changed).contains(&flag);
    let mut line = "run core/tonemap --set parameters.exposure=1".to_owned();
    if lacks("--in") {
        line += " --in radiance=hdr.npy";
    }
    if lacks("--out") {
        line += " --out picture=old.npy:2,3";
    }
    if lacks("--over") && lacks("--dispatch") {
        line += " --over 3,2";
    }
    line + " " + changed
}

/// The first entry point of `scan`, on one block.
fn scan(more: &str) -> String {
    format!("run core/scan --entry scan_blocks --dispatch 1 {more}")
}

/// An entry point of the tests' own.
fn own(pass_and_more: &str) -> String {
    format!("run t/{pass_and_more} --shaders own")
}

#[test]
fn names_that_are_not_there_are_told_with_those_that_are() {
    let at = stage();
    let bad = |line: &str, parts: &[&str]| refuses(at.path(), &words(line), 2, parts);
    bad("run core/nope --dispatch 1", &["core/nope", "core/tonemap", "scattering/filter"]);
    bad("run core/tonemap:nope", &["core/tonemap", "nope", "default"]);
    bad("run tonemap", &["`tonemap`", "SYSTEM/PASS"]);
    bad("run", &["SYSTEM/PASS"]);
    bad(&tonemap("--nope 1"), &["--nope"]);
    bad(
        &tonemap("--in radianc=hdr.npy"),
        &["--in radianc=hdr.npy", "`radianc`", "`radiance` (2d texture of float)"],
    );
    bad(
        &tonemap("--out pictur=x.npy:2,3"),
        &["--out pictur=x.npy", "`picture` (2d storage texture rgba8unorm)"],
    );
    bad(&tonemap("--out radiance=x.npy:2,3"), &["--out radiance=x.npy", "is not written", "`picture`"]);
    bad(
        &tonemap("--set parameters.exposur=1"),
        &["--set parameters.exposur=1", "exposure (f32), dither (f32)"],
    );
    bad(&tonemap("--set parameters.exposure.x=1"), &["f32 is no struct"]);
    bad(&tonemap("--set parameters=1"), &["--set parameters=1", "is a struct", "exposure (f32)"]);
    bad(&tonemap("--set param.exposure=1"), &["`param`", "parameters (TonemapParameters)"]);
    bad(&tonemap("--set radiance.x=1"), &["`radiance`", "is no uniform", "parameters"]);
    bad(&tonemap("--entry nope"), &["--entry", "`nope`", "tonemap (compute)"]);
    bad(&tonemap("--vertex nope"), &["--vertex", "`nope`", "compute"]);
    bad(&tonemap("--define NOPE=1"), &["--define", "`NOPE`", "none"]);
    bad("run scattering/filter --define BASE=8", &["--define", "`BASE`", "BASES, BASES_PER_THREAD, COLORS"]);
    bad("run core/scan --dispatch 1", &["--entry", "scan_blocks (compute), add_offsets (compute)"]);
    bad(
        &own("mixed --entry gather --dispatch 1 --set Parameters.shift=1"),
        &["several uniforms are a Parameters", "parameters", "again"],
    );
    bad(&own("mixed --entry mark --dispatch 1 --in ids=ids.npy"), &["t/mixed (mark)", "`ids`", "`marks`"]);
}

#[test]
fn numbers_that_cannot_be_meant_are_told() {
    let at = stage();
    let bad = |line: &str, parts: &[&str]| refuses(at.path(), &words(line), 2, parts);
    for value in ["nan", "inf", "-inf", "1e99", "abc", "1;2"] {
        let set = format!("parameters.exposure={value}");
        bad(&tonemap(&format!("--set {set}")), &[&set, "finite number"]);
    }
    bad(&tonemap("--set parameters.exposure=1,2"), &["parameters.exposure=1,2", "takes 1"]);
    bad(&tonemap("--set parameters.exposure="), &["parameters.exposure="]);
    for value in ["-1", "1.5", "4294967296"] {
        let set = format!("parameters.count={value}");
        bad(
            &scan(&format!("--in values=v.npy --out block_sums=x.npy:1 --set {set}")),
            &[&set, "whole number"],
        );
    }
    bad(&tonemap("--define BASES=1.5"), &["BASES=1.5"]);
    for value in ["0", "1,0", "1,2,3,4", "x", "1.5"] {
        bad(&tonemap(&format!("--dispatch {value}")), &["--dispatch", value]);
        bad(&tonemap(&format!("--over {value}")), &["--over", value]);
    }
    bad(&tonemap("--dispatch 65536"), &["--dispatch", "65536", "65535"]);
    bad(&tonemap("--over 1,600000"), &["--over", "1,600000", "75000", "65535"]);
    bad(&tonemap("--over 1 --dispatch 1"), &["--over", "--dispatch"]);
    bad("run core/tonemap --in radiance=hdr.npy --out picture=x.npy:2,3", &["--dispatch", "--over"]);
    for shape in ["0,3", "2", "2,3,4", "a,b", "-1,3", ""] {
        bad(&tonemap(&format!("--out picture=x.npy:{shape}")), &["picture=x.npy"]);
    }
    bad(&tonemap("--out picture=x.npy:2,3:u32"), &["picture=x.npy", "u32"]);
    bad(&tonemap("--out picture=x.npy:2,3:f64"), &["f64", "f32, u32 or i32"]);
    bad(&tonemap("--out picture=x.png:2,3"), &["picture=x.png", ".npy"]);
    bad(&tonemap("--size 3x2"), &["--size 3x2"]);
    bad(&tonemap("--size 0x2"), &["--size", "0x2"]);
}

#[test]
fn what_is_missing_or_given_twice_is_told() {
    let at = stage();
    let bad = |line: &str, parts: &[&str]| refuses(at.path(), &words(line), 2, parts);
    bad(
        "run core/tonemap --over 3,2",
        &["--in radiance=FILE.npy", "--out picture=FILE.npy:HEIGHT,WIDTH", "rgba8unorm"],
    );
    bad(&tonemap("--out picture=x.npy"), &["--out picture=x.npy", "HEIGHT,WIDTH"]);
    bad(&scan("--in values=v.npy --out block_sums=x.npy"), &["--out block_sums=x.npy", "COUNT"]);
    bad(&scan("--in values=v.npy --in block_sums=v.npy"), &["--out", "values", "block_sums"]);
    bad(&tonemap("--in radiance=hdr.npy --in radiance=hdr.npy"), &["`radiance` is given twice"]);
    bad(&tonemap("--out picture=x.npy:2,3 --out picture=y.npy:2,3"), &["`picture` is given twice"]);
    bad(
        &scan("--in values=v.npy --out values=x.npy --out block_sums=x.npy:1"),
        &["--out block_sums=x.npy", "same file"],
    );
    bad(
        "run scattering/evaluate --entry evaluate --dispatch 1 --in bases_sampler=hdr.npy",
        &["bases_sampler", "sampler"],
    );
    bad(
        &own("depths --entry depth_main --dispatch 1 --in depths=hdr.npy --out results=x.npy:1"),
        &["--in depths=hdr.npy", "depth texture"],
    );
    bad(
        &own("depths --entry depth_main --dispatch 1 --out results=x.npy:1"),
        &["`depths` (2d texture of depth)", "no array can fill"],
    );
}

#[test]
fn full_screen_passes_that_cannot_be_drawn_are_told() {
    let at = stage();
    let bad = |more: &str, parts: &[&str]| {
        let line = format!("run core/raster --in camera=camera.npy {more}");
        refuses(at.path(), &words(&line), 2, parts);
    };
    let with = |more: &str| format!("--entry fragment_background --out color=x.npy {more}");
    bad(&with(""), &["--size", "fragment_background"]);
    bad(&with("--size 8x8 --dispatch 1"), &["--dispatch", "fragment"]);
    bad(&with("--size 8x8 --over 1"), &["--over", "fragment"]);
    bad(&with("--size 10000x10"), &["--size", "10000x10", "8192"]);
    bad(&with("--size 8x8 --vertex nope"), &["--vertex", "`nope`", "vertex_background (vertex)"]);
    bad(&with("--size 8x8 --vertex vertex_shadow"), &["--vertex", "vertex_shadow", "position: vec3<f32>"]);
    bad(&with("--size 8x8 --out picture=y.npy"), &["picture", "`color`"]);
    bad("--entry fragment_background --size 8x8", &["--out color=FILE.npy"]);
    bad("--entry fragment_background --size 8x8 --out color=x.npy:8,9", &["color=x.npy", "8,8"]);
    bad(
        "--entry fragment_surface --size 8x8 --out color=x.npy",
        &["vertex_background does not write", "fragment_surface", "world: vec3<f32>"],
    );
    bad("--entry vertex_background --size 8x8", &["--entry", "vertex_background", "fragment_background"]);
    for (entry, part) in [("two", "2 targets"), ("three", "vec3<f32>")] {
        refuses(
            at.path(),
            &words(&own(&format!("depths --entry {entry} --size 8x8 --out color=x.npy"))),
            2,
            &[entry, part],
        );
    }
}

#[test]
fn files_that_do_not_fit_are_told() {
    let at = stage();
    let bad = |line: &str, parts: &[&str]| refuses(at.path(), &words(line), 1, parts);
    for (file, part) in [
        ("missing.npy", "missing.npy"),
        ("empty.npy", "empty.npy"),
        ("garbage.npy", "garbage.npy"),
        ("cut.npy", "cut.npy"),
        ("folder.npy", "folder.npy"),
        ("flat.npy", "(18); `radiance` takes (height, width)"),
        ("five.npy", "(2, 3, 5)"),
        ("none.npy", "(0, 3)"),
        ("ids.npy", "not u32"),
        ("wide.npy", "8193"),
    ] {
        let input = format!("radiance={file}");
        bad(&tonemap(&format!("--in {input}")), &["--in radiance", file, part]);
    }
    bad(
        &scan("--in values=hdr.npy --in block_sums=v.npy --out values=x.npy"),
        &["values=hdr.npy", "array<u32>", "not f32"],
    );
    bad(
        &scan("--in values=bytes.npy --in block_sums=v.npy --out values=x.npy"),
        &["values=bytes.npy", "not u8"],
    );
    bad(&scan("--in values=none.npy --in block_sums=v.npy --out values=x.npy"), &["values=none.npy"]);
    bad(
        "run scattering/filter:average --dispatch 1 --in rectified=five.npy --out bases=x.npy:8,2,3",
        &["rectified=five.npy", "(2, 3, 5)"],
    );
    bad(
        "run core/raster --entry fragment_background --size 8x8 --in camera=v.npy --out color=x.npy",
        &["camera=v.npy", "8 numbers", "Camera takes 40"],
    );
    // The inputs of `gather`, but for one.
    let mixed = |changed: &str| {
        let mut line = own("mixed --entry gather --dispatch 1 --out results=x.npy:16");
        for input in ["volume=five.npy", "image=hdr.npy", "ids=ids.npy", "points=camera.npy"] {
            let same_name = changed.split('=').next() == input.split('=').next();
            line = line + " --in " + if same_name { changed } else { input };
        }
        line
    };
    succeeds(at.path(), &words(&mixed("")));
    std::fs::remove_file(at.path().join("x.npy")).unwrap();
    bad(&mixed("volume=flat.npy"), &["volume=flat.npy", "(depth, height, width)"]);
    bad(&mixed("image=huge.npy"), &["image=huge.npy", "70000", "65504"]);
    bad(&mixed("ids=hdr.npy"), &["ids=hdr.npy", "takes u32, not f32"]);
    bad(&mixed("points=hdr.npy"), &["points=hdr.npy", "18 numbers", "multiple of 4"]);
    let marks = |more: &str| own(&format!("mixed --entry mark --dispatch 1 {more}"));
    refuses(
        at.path(),
        &words(&marks("--in marks=ids.npy --out marks=x.npy:3,2")),
        2,
        &["--out marks=x.npy", "--in"],
    );
    bad(&marks("--in marks=hdr.npy --out marks=x.npy"), &["marks=hdr.npy", "3 channels"]);
    refuses(
        at.path(),
        &words(&scan("--in values=v.npy --out values=x.npy:9 --out block_sums=y.npy:1")),
        2,
        &["--out values=x.npy", "9", "8"],
    );

    bad("run core/tonemap --shaders nowhere", &["--shaders", "nowhere"]);
    bad(&own("broken --dispatch 1"), &["t/passes/broken.wgsl:4"]);
}

#[test]
fn sizes_over_the_limits_of_the_device_are_told() {
    let at = stage();
    let bad = |line: &str, parts: &[&str]| refuses(at.path(), &words(line), 2, parts);
    bad(&tonemap("--out picture=x.npy:9000,10"), &["--out picture=x.npy", "9000", "8192"]);
    bad(
        "run core/tonemap --in radiance=hdr.npy --over 1 --size 100000x10 --out picture=x.npy",
        &["100000", "8192"],
    );
    bad(
        "run scattering/filter:average --in rectified=hdr.npy --over 1 --out bases=x.npy:257,2,3",
        &["257 layers", "256"],
    );
    bad(
        "run scattering/filter:average_rgba16float --in rectified=hdr.npy --over 1 \
         --out bases=x.npy:256,1024,1024",
        &["bases=x.npy", "2147483648 bytes", "268435456"],
    );
    for shape in ["33554433", "65536,513", "4294967295,4294967295,4294967295,4294967295,4294967295"] {
        let output = format!("block_sums=x.npy:{shape}");
        bad(
            &scan(&format!("--in values=v.npy --out {output}")),
            &["--out block_sums=x.npy", "134217728 bytes"],
        );
    }

    // 128 MiB and one word of zeros, without taking the disk.
    let count = (32 << 20) + 1;
    let header = npy::encoded("<u4", &[count], &[]);
    let length = (header.len() + 4 * count) as u64;
    std::fs::write(at.path().join("large.npy"), header).unwrap();
    let file = std::fs::OpenOptions::new().write(true).open(at.path().join("large.npy")).unwrap();
    file.set_len(length).unwrap();
    refuses(
        at.path(),
        &words(&scan("--in values=large.npy --out block_sums=x.npy:1")),
        1,
        &["--in values=large.npy", "134217728 bytes"],
    );
}

#[test]
fn what_cannot_be_written_is_told_and_nothing_is_lost() {
    let at = stage();
    let bad = |output: &str, part: &str| {
        refuses(at.path(), &words(&tonemap(&format!("--out {output}"))), 1, &["--out picture=", part])
    };
    bad("picture=no/such/x.npy:2,3", "no/such");
    bad("picture=old.npy/x.npy:2,3", "old.npy");
    bad("picture=folder.npy:2,3", "folder");
    // One that can be written goes unwritten with one that cannot.
    refuses(
        at.path(),
        &words(&scan("--in values=v.npy --out values=x.npy --out block_sums=no/y.npy:1")),
        1,
        &["--out block_sums=no/y.npy"],
    );

    // Success replaces the old file and leaves nothing beside it.
    let before = files(at.path()).len();
    let ended = airlight(at.path(), &words(&tonemap("")));
    assert_eq!((ended.code, ended.err.as_str()), (0, ""), "{ended:?}");
    assert_eq!(files(at.path()).len(), before);
    assert_eq!(npy::read_u8(&at.path().join("old.npy")).0, [2, 3, 4]);
}
