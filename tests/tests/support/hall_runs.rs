// SPDX-License-Identifier: MIT OR Apache-2.0
//! Runs of `airlight scattering` in the hall, for several files.
#![allow(dead_code, clippy::unwrap_used)]

use crate::command::{files, succeeds};
use crate::npy;
use std::collections::BTreeMap;
use std::path::Path;

/// Columns and rows of the picture.
pub const SIZE: [usize; 2] = [96, 64];
/// A setup with the sun.
pub const SUN: &str = "--eye 0.5,1.2,6 --target 0,1.1,0 --light directional:95,35";

/// What a run left behind.
pub struct Run {
    pub said: String,
    pub buffers: BTreeMap<String, (Vec<usize>, Vec<f32>)>,
}

impl Run {
    /// Runs the command at a small size.
    #[track_caller]
    pub fn new(at: &Path, mesh: &str, flags: &str) -> Self {
        let folder = tempfile::tempdir_in(at).unwrap();
        let [out, buffers] = ["picture.exr", "buffers"].map(|name| folder.path().join(name));
        let (out, buffers) = (out.to_str().unwrap(), buffers.to_str().unwrap());
        let own = "--size 96x64 --map 128x128 --shadow-map 256x256 --extinction 0.08 --g 0.3";
        let mut arguments = vec!["scattering", "--mesh", mesh, "--out", out, "--buffers", buffers];
        let flags_of_own: Vec<&str> = own.split(' ').collect();
        let given: Vec<&str> = flags.split(' ').filter(|flag| !flag.is_empty()).collect();
        let kept = flags_of_own.chunks(2).filter(|pair| !given.contains(&pair[0]));
        arguments.extend(kept.flatten().chain(&given));
        let said = succeeds(at, &arguments).out;
        let arrays = files(Path::new(buffers)).into_keys();
        let name = |path: &Path| path.file_stem().unwrap().to_str().unwrap().to_owned();
        let values = |path: &Path| {
            if npy::read(path).descr != "<u4" {
                return npy::read_f32(path);
            }
            let (shape, words) = npy::read_u32(path);
            (shape, words.into_iter().map(|word| word as f32).collect())
        };
        let buffers: BTreeMap<_, _> = arrays.map(|path| (name(&path), values(&path))).collect();
        for (name, (_, values)) in &buffers {
            // Two integers among the words of `rows` are no floats.
            let finite = values.iter().all(|value| value.is_finite());
            assert!(finite, "{flags}: {name} is not finite");
        }
        let picture = image::open(out).unwrap().into_rgba32f();
        let eyes = buffers.keys().filter(|name| name.ends_with("composed")).count();
        assert_eq!(
            [picture.width() as usize, picture.height() as usize],
            [SIZE[0] * eyes, SIZE[1]],
            "{flags}"
        );
        for (eye, name) in buffers.keys().filter(|name| name.ends_with("composed")).enumerate() {
            let composed = &buffers[name].1;
            for y in 0..SIZE[1] {
                let row = 4 * (y * eyes + eye) * SIZE[0];
                let written = &picture.as_raw()[row..row + 4 * SIZE[0]];
                let shown = &composed[4 * y * SIZE[0]..4 * (y + 1) * SIZE[0]];
                let same = written.iter().zip(shown).enumerate().all(|(i, (a, b))| i % 4 == 3 || a == b);
                assert!(same, "{flags}: row {y} of {name} is not that of the picture");
            }
        }
        Self { said, buffers }
    }

    pub fn reason(&self) -> &str {
        self.said.lines().find_map(|line| line.strip_prefix("rectification: ")).unwrap()
    }

    pub fn radiance(&self, name: &str) -> Vec<f32> {
        self.buffers[name].1.chunks_exact(4).flat_map(|texel| texel[..3].to_vec()).collect()
    }

    pub fn visibility(&self, name: &str) -> Vec<f32> {
        self.buffers[name].1.chunks_exact(4).map(|texel| texel[3]).collect()
    }
}
