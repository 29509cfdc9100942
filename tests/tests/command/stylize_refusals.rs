// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight stylize` with what cannot be meant: one sentence with flag or file, value and remedy.

use crate::command::{refuses, refuses_first, words};
use crate::stylized::{SUN, halls, own};
use std::path::Path;

/// Refused, and as well where there is no adapter: before any GPU work.
#[track_caller]
fn refused(at: &Path, flags: &str, code: i32, parts: &[&str]) {
    let out = if words(flags).contains(&"--out") { "" } else { " --out x.png" };
    let line = format!("stylize --mesh room.obj --mesh plate.obj{out} {}", own(flags));
    refuses_first(at, &words(&line), code, parts);
}

#[test]
fn widths_that_no_kernel_has_are_refused() {
    let at = halls();
    for flag in ["--close-box", "--close-disc", "--close-epipolar", "--extrude"] {
        for (width, said) in [
            ("4", "a kernel of 4 texels"),
            ("0", "a kernel of 0 texels"),
            ("-3", "a kernel of -3 texels"),
            ("2.5", "a kernel of 2.5 texels"),
            ("nan", "NaN texels"),
            ("inf", "inf texels"),
            ("wide", "`wide`"),
            ("0:5,8:6", "frame 8: a kernel of 6"),
            ("8:5,0:7", "0 follows 8"),
            ("0:5,0:7", "0 follows 0"),
            ("0:nan", "0:nan"),
            ("0:5,", "`0:5,`"),
        ] {
            refused(at.path(), &format!("{flag}={width}"), 2, &[flag, said]);
        }
    }
    refused(at.path(), "--extrude 5 --epipolar round", 2, &["--epipolar", "round", "rectified"]);
    refused(at.path(), "--close-box 5 --epipolar direct", 2, &["--epipolar", "--extrude"]);
}

#[test]
fn holes_that_cannot_be_are_refused() {
    let at = halls();
    let at = at.path();
    for (holes, said) in [
        ("density=1.5", "density 1.5"),
        ("density=-0.5", "density -0.5"),
        ("density=nan", "`nan`"),
        ("density=0:0.5/8:2", "density 2"),
        ("octaves=0", "0 octaves"),
        ("octaves=2.5", "2.5"),
        ("size=0", "size 0"),
        ("persistence=1.5", "persistence 1.5"),
        ("width=1", "`width`"),
        ("size", "`size`"),
        ("size=1,size=2", "twice"),
        ("size=8:1/3:2", "3 follows 8"),
        ("pace=0:1/8:2", "key frames of time"),
    ] {
        refused(at, &format!("--holes={holes}"), 2, &["--holes", said]);
    }
    refused(at, "--holes density=0.2 --cascades 2", 2, &["--holes", "--cascades"]);
    refused(at, "--holes-on plate.obj", 2, &["--holes-on", "--holes as well"]);
    let other = "--holes density=0.2 --holes-on tree.obj";
    refused(at, other, 2, &["--holes-on", "`tree.obj`", "room.obj, plate.obj"]);
    // What depends on the size of the map.
    let line = |holes: &str| {
        let flags = own(&format!("{SUN} --holes {holes}"));
        format!("stylize --mesh room.obj --out x.png {flags}")
    };
    refuses(at, &words(&line("size=0.00001")), 2, &["--holes", "0.00001 m are too small"]);
    refuses(at, &words(&line("size=0.2,distance=5")), 2, &["--holes", "cannot move by 5 m"]);
    let late = "size=0.2,distance=0:0/4:5 --frames 0..4";
    refuses(at, &words(&line(late)), 2, &["--holes", "cannot move by"]);
}

#[test]
fn frames_that_cannot_be_are_refused() {
    let at = halls();
    let at = at.path();
    let bad = |flags: &str, parts: &[&str]| refused(at, flags, 2, parts);
    bad("--frames 5..3", &["--frames", "5..3", "before it begins"]);
    bad("--frames 0..10000", &["--frames", "10001 frames", "10000"]);
    for wrong in ["5", "-1..3", "a..b", "1...3", "1.5..2"] {
        bad(&format!("--frames={wrong}"), &["--frames", wrong, "0..48"]);
    }
    bad("--frames 0..3 --out x.exr", &["--frames", "x.exr", ".png"]);
    bad("--frames 0..3 --frame 2", &["--frame", "--frames"]);
    bad("--frame 2", &["--frame", "key frames"]);
    bad("--frame 2 --extrude 5", &["--frame", "key frames"]);
    bad("--rate 24", &["--rate", "--frames"]);
    for rate in ["0", "-24", "nan", "1e9"] {
        bad(&format!("--frames 0..1 --rate={rate}"), &["--rate", rate]);
    }
    std::fs::create_dir(at.join("x.0001.png")).unwrap();
    refused(at, "--frames 0..3", 1, &["--frames", "x.0001.png", "folder"]);
    refused(at, "--out nowhere/x.png", 1, &["--out", "nowhere"]);
    refused(at, "--frames 0..3 --out nowhere/x.png", 1, &["--out", "nowhere"]);
    bad("--out x.jpg", &["--out", "x.jpg", ".png or .exr"]);
}

#[test]
fn picks_outside_the_picture_are_refused() {
    let at = halls();
    let at = at.path();
    let bad = |flags: &str, parts: &[&str]| refused(at, flags, 2, parts);
    bad("--pick 64,0", &["--pick", "64,0", "64x48"]);
    bad("--pick 3,4 --pick 0,48", &["--pick", "0,48", "64x48"]);
    bad("--stereo 0.1 --pick 128,0", &["--pick", "128,0", "128x48"]);
    for wrong in ["5", "-1,3", "1.5,2", "a,b", "1,2,3"] {
        bad(&format!("--pick={wrong}"), &["--pick", wrong, "X,Y"]);
    }
}

#[test]
fn transfer_files_that_cannot_be_read_are_refused_with_line_and_key() {
    let at = halls();
    let at = at.path();
    let solid = "[[layer]]\nkind = 'solid'\ncolor = ";
    for (text, said) in [
        ("colour = 1\n[[layer]]\nkind = 'solid'\ncolor = '#ffffff'", "t.toml:1:1: colour"),
        (&*format!("{solid}[2.0, 0.0, 0.0]"), "t.toml:3:9: layer[0].color: 2 is out of range"),
        (&*format!("{solid}'red'"), "t.toml:3:9: layer[0].color"),
        ("size = 64", "at least one layer"),
        ("[[layer]]\nkind = 'image'\nfile = 'none.png'", "t.toml:3:8: layer[0].file"),
        (
            "[[layer]]\nkind = 'diffusion'\n[[layer.constraint]]\nat = [1.5, 0.0]\ncolor = '#ffffff'",
            "t.toml:4:6: layer[0].constraint[0].at",
        ),
        ("x = 3 =", "t.toml:1:"),
    ] {
        std::fs::write(at.join("t.toml"), text).unwrap();
        refused(at, "--transfer t.toml", 1, &["--transfer", said]);
    }
    refused(at, "--transfer none.toml", 1, &["--transfer", "none.toml", "cannot be read"]);
    // Constraints are placed in the picture.
    for (place, said) in [
        ("pixel = [64, 3]", "pixel 64, 3 lies outside the picture of 64x48"),
        ("point = [0.0, 0.0, 60.0]", "lies outside the picture"),
        ("point = [0.0, 0.0, 0.0]\nfollow = 'bird'", "no object `bird` to follow; it has `plate`, `room`"),
    ] {
        let text = format!("[[layer]]\nkind = 'diffusion'\n[[layer.constraint]]\n{place}\ncolor = '#ffffff'");
        std::fs::write(at.join("t.toml"), text).unwrap();
        let flags = own(&format!("{SUN} --transfer t.toml"));
        let line = format!("stylize --mesh room.obj --mesh plate.obj --out x.png {flags}");
        refuses(at, &words(&line), 1, &["--transfer: t.toml: layer[0].constraint[0]", said]);
    }
}
