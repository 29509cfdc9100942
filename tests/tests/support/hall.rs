// SPDX-License-Identifier: MIT OR Apache-2.0
//! A hall on disk for the command to draw.
#![allow(dead_code, clippy::unwrap_used)]

use tempfile::TempDir;

/// Eye and target of most setups.
pub const EYE: &str = "--eye 0.5,1.2,6 --target 0,1.1,0";

/// A ground, and over it a plate and a wall.
pub fn scene() -> TempDir {
    let at = tempfile::tempdir().unwrap();
    let quads = [
        "v -4 0 -4\nv 4 0 -4\nv 4 0 4\nv -4 0 4\n",
        "v -1.6 2 -1.2\nv 1.3 2 -1.2\nv 1.3 2 1.4\nv -1.6 2 1.4\n",
        "v 1.6 0 -1.5\nv 1.8 1.9 -1.5\nv 1.8 1.9 1.1\nv 1.6 0 1.1\n",
    ];
    let faces = "f 1 4 3 2\nf 5 8 7 6\nf 9 12 11 10\n";
    std::fs::write(at.path().join("hall.obj"), quads.concat() + faces).unwrap();
    // As large, and without shadows above the ground.
    let bare = format!("{}v 1.8 2 0\nf 1 4 3 2\n", quads[0]);
    std::fs::write(at.path().join("bare.obj"), bare).unwrap();
    let glass = image::RgbImage::from_fn(8, 8, |x, y| {
        image::Rgb([if (x / 2 + y / 2) % 2 == 1 { 255 } else { 120 }, if x < 4 { 200 } else { 90 }, 160])
    });
    glass.save(at.path().join("glass.png")).unwrap();
    at
}
