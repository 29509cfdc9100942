// SPDX-License-Identifier: MIT OR Apache-2.0
//! Files of views for `airlight inverse`, and volumes with known properties.
#![allow(dead_code, clippy::unwrap_used)]

use crate::npy;
use std::fmt::Write;
use std::path::Path;

/// Voxels along each side of the volumes.
pub const SIDE: usize = 24;
/// Width and height of the pictures.
pub const SIZE: [u32; 2] = [48, 36];

/// From where four views look at the middle.
pub const EYES: [[f32; 3]; 4] = [[0.0, 1.0, 9.0], [9.0, 0.5, 0.5], [-6.0, 3.0, 5.0], [2.0, -3.0, -8.0]];

/// One view. `more`: further keys, line by line.
pub fn view(name: &str, eye: [f32; 3], more: &str) -> String {
    let [width, height] = SIZE;
    let [x, y, z] = eye;
    format!(
        "[[view]]\nname = \"{name}\"\nsize = [{width}, {height}]\n{more}\n\
         camera = {{ eye = [{x:?}, {y:?}, {z:?}], target = [0, 0, 0], field_of_view = 34 }}\n\n"
    )
}

/// Four views.
pub fn views(more: &str) -> String {
    EYES.iter().enumerate().fold(String::new(), |mut all, (i, eye)| {
        write!(all, "{}", view(&format!("v{i}"), *eye, more)).unwrap();
        all
    })
}

/// An array [SIDE, SIDE, SIDE] or with three channels, from a function of places from -1 to 1.
pub fn volume<const N: usize>(path: &Path, value: impl Fn([f32; 3]) -> [f32; N]) {
    let at = |i: usize| (2 * i + 1) as f32 / SIDE as f32 - 1.0;
    let values: Vec<f32> = (0..SIDE * SIDE * SIDE)
        .flat_map(|i| value([at(i % SIDE), at(i / SIDE % SIDE), at(i / SIDE / SIDE)]))
        .collect();
    let mut shape = vec![SIDE; 3];
    shape.extend((N > 1).then_some(N));
    npy::write_f32(path, &shape, &values);
}

/// Shape and values of an array of 32-bit floats.
#[track_caller]
pub fn read(path: &Path) -> (Vec<usize>, Vec<f32>) {
    npy::read_f32(path)
}

/// A soft ball with a hollow, and what glows and scatters in it.
pub fn ball(folder: &Path) {
    volume(&folder.join("ball.npy"), |[x, y, z]| {
        let hollow = ((x - 0.3).powi(2) + y * y + (z - 0.2).powi(2)).sqrt();
        let dense = (1.0 - (x * x + y * y + z * z) / 0.6).max(0.0);
        [if hollow < 0.25 { 0.0 } else { dense }]
    });
    volume(&folder.join("glow.npy"), |[x, y, z]| {
        let near = (-4.0 * ((x + 0.3).powi(2) + (y - 0.3).powi(2) + z * z)).exp();
        [0.5 * near, 0.2 * near, 0.05]
    });
    volume(&folder.join("paint.npy"), |[x, y, z]| [0.4 + 0.3 * x, 0.3 + 0.2 * y, 0.4 - 0.3 * z]);
}
