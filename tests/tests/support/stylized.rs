// SPDX-License-Identifier: MIT OR Apache-2.0
//! Runs of `airlight stylize` on a small hall, with all that they write.
#![allow(dead_code, clippy::unwrap_used)]

use crate::command::{files, succeeds, words};
use crate::{hall, npy};
use std::collections::BTreeMap;
use std::path::Path;
use tempfile::TempDir;

pub const SIZE: [usize; 2] = [64, 48];
/// Setups with a light each.
pub const SUN: &str = "--eye 0.5,1.2,6 --target 0,1.1,0 --light directional:95,35";
pub const SPOT: &str = "--eye 0.5,1.2,6 --target 0,1.1,0 --light spot:-2,4,1,0,0.5,0,30";
pub const POINT: &str = "--eye 0.5,1.2,6 --target 0,1.1,0 --light point:-1.5,1.5,0.5";

/// The hall in two files: `room.obj`, a ground and a wall, and `plate.obj`, a plate over them.
pub fn halls() -> TempDir {
    let at = hall::scene();
    let text = std::fs::read_to_string(at.path().join("hall.obj")).unwrap();
    let vertices: Vec<&str> = text.lines().filter(|line| line.starts_with("v ")).collect();
    let write = |name: &str, chosen: &[&str], faces: &str| {
        std::fs::write(at.path().join(name), chosen.join("\n") + "\n" + faces).unwrap();
    };
    write("room.obj", &[&vertices[..4], &vertices[8..12]].concat(), "f 1 4 3 2\nf 5 8 7 6\n");
    write("plate.obj", &vertices[4..8], "f 1 4 3 2\n");
    at
}

/// What a run left behind.
pub struct Run {
    pub said: String,
    /// The bytes of the picture.
    pub picture: Vec<u8>,
    /// Shapes and values.
    pub buffers: BTreeMap<String, (Vec<usize>, Vec<f32>)>,
}

impl Run {
    /// Runs a command at a small size.
    #[track_caller]
    pub fn new(at: &Path, command: &str, flags: &str) -> Self {
        let folder = tempfile::tempdir_in(at).unwrap();
        let [out, buffers] = ["picture.exr", "buffers"].map(|name| folder.path().join(name));
        let line = format!("{command} --mesh room.obj --mesh plate.obj {}", own(flags));
        let mut arguments = words(&line);
        arguments.extend(["--out", out.to_str().unwrap(), "--buffers", buffers.to_str().unwrap()]);
        let said = succeeds(at, &arguments).out;
        let name = |path: &Path| path.file_stem().unwrap().to_str().unwrap().to_owned();
        let values = |path: &Path| {
            if npy::read(path).descr != "<u4" {
                return npy::read_f32(path);
            }
            let (shape, words) = npy::read_u32(path);
            (shape, words.into_iter().map(|word| word as f32).collect())
        };
        let arrays = files(&buffers).into_keys();
        let buffers: BTreeMap<_, _> = arrays.map(|path| (name(&path), values(&path))).collect();
        for (name, (_, values)) in &buffers {
            assert!(values.iter().all(|value| value.is_finite()), "{flags}: {name} is not finite");
        }
        Self { said, picture: std::fs::read(&out).unwrap(), buffers }
    }

    /// The channel of visibility of a buffer.
    pub fn visibility(&self, name: &str) -> Vec<f32> {
        self.buffers[name].1.chunks_exact(4).map(|texel| texel[3]).collect()
    }

    /// Whether there is a buffer of this name, or an array of it.
    pub fn has(&self, name: &str) -> bool {
        self.buffers.contains_key(name) || self.buffers.contains_key(&format!("{name}s"))
    }
}

/// Flags with sizes for those that are not said.
pub fn own(flags: &str) -> String {
    let mut all = flags.to_owned();
    for (name, value) in [
        ("--size", "64x48"),
        ("--map", "128x96"),
        ("--shadow-map", "128x128"),
        ("--extinction", "0.08"),
        ("--g", "0.3"),
        ("--steps", "64"),
    ] {
        if !words(flags).contains(&name) {
            all += &format!(" {name} {value}");
        }
    }
    all
}

/// The mean.
pub fn mean(values: &[f32]) -> f64 {
    values.iter().map(|value| f64::from(*value)).sum::<f64>() / values.len() as f64
}
