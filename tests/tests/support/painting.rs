// SPDX-License-Identifier: MIT OR Apache-2.0
//! Runs of `airlight painterly` on the lumps, for several files.
#![allow(dead_code, clippy::unwrap_used)]

use crate::command::{Ended, files, succeeds, words};
use crate::npy;
use std::collections::BTreeMap;
use std::path::Path;

/// Columns and rows of the picture.
pub const SIZE: [u32; 2] = [200, 125];
/// What strokes are put on, so that it is told apart from all that is painted.
pub const CANVAS: [u8; 3] = [0x20, 0x40, 0x60];

/// Paints the lumps, or another volume that `flags` name, into the folder `out`.
#[track_caller]
pub fn paint(at: &Path, flags: &str, out: &str) -> Ended {
    let mut line = format!("painterly {flags} --out {out}");
    for (flag, given) in
        [("--volume", "lumps.npy"), ("--size", "200x125"), ("--canvas", "#204060"), ("--settle", "4")]
    {
        if !line.contains(flag) {
            line.push_str(&format!(" {flag} {given}"));
        }
    }
    succeeds(at, &words(&line))
}

/// The pixels of a picture file.
#[track_caller]
pub fn pixels(path: &Path) -> Vec<[u8; 3]> {
    let picture = image::open(path).unwrap().into_rgb8();
    picture.pixels().map(|pixel| pixel.0).collect()
}

/// The painting of one run.
#[track_caller]
pub fn painting(at: &Path, flags: &str) -> Vec<[u8; 3]> {
    paint(at, flags, "one");
    let found = pixels(&at.join("one/painting.png"));
    let names: Vec<_> = files(&at.join("one")).into_keys().collect();
    assert_eq!(names, [at.join("one/painting.png")], "{flags}");
    std::fs::remove_dir_all(at.join("one")).unwrap();
    found
}

/// The share of a picture that is not canvas.
pub fn painted(picture: &[[u8; 3]]) -> f64 {
    picture.iter().filter(|pixel| **pixel != CANVAS).count() as f64 / picture.len() as f64
}

/// Arrays of a folder by their names.
pub fn buffers(folder: &Path) -> BTreeMap<String, (Vec<usize>, Vec<f32>)> {
    let files = files(folder).into_keys();
    files.map(|path| (path.file_stem().unwrap().to_str().unwrap().to_owned(), npy::read_f32(&path))).collect()
}

/// Numbers of a line of the report that begins so, in their order.
#[track_caller]
pub fn numbers(said: &str, begin: &str) -> Vec<usize> {
    let line = said.lines().find(|line| line.starts_with(begin)).unwrap_or_else(|| panic!("{said}"));
    line.split(|c: char| !c.is_ascii_digit()).filter_map(|word| word.parse().ok()).collect()
}
/// A transfer function in full.
pub const TRANSFER: &str = "
    range = [0.1, 0.9]
    [[point]]
    value = 0.2
    color = '#0000ff'
    opacity = 0
    [[point]]
    value = 0.6
    color = '#00ff00'
    opacity = 1";
