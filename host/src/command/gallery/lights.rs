// SPDX-License-Identifier: MIT OR Apache-2.0
//! A sheet of every kind of light, camera and shadow map.

use super::album::{Album, Section};
use super::studio::Studio;
use crate::command::CommandError;

/// Scenes, and what each is there for.
const KINDS: [(&str, &str); 8] = [
    ("foliage", "directional light"),
    ("spot", "spot"),
    ("slide", "spot with a light texture"),
    ("lamp", "point light"),
    ("sun", "directional light in the picture"),
    ("glass", "directional light with a light texture"),
    ("orthographic", "directional light, orthographic camera"),
    ("cascades", "directional light in four cascades"),
];

/// The section.
pub fn section(studio: &Studio, folder: &str) -> Result<Section, CommandError> {
    let title = "Kinds of light".to_owned();
    let about = "Of each light the final picture, and the scattered light alone below it.".to_owned();
    let mut album = Album::new(&studio.out, folder, title, about)?;
    let mut pictures = Vec::new();
    for (name, kind) in KINDS {
        let (scene, stage) = studio.scene(name)?;
        let shot = studio.shoot(&stage)?;
        let composed = studio.compose(&stage, &shot.scattered)?;
        let total: f64 = shot.times.iter().map(|(_, milliseconds)| milliseconds).sum();
        let [first, scattered] =
            [studio.pixels(&composed, scene.exposure)?, studio.pixels(&shot.scattered, scene.exposure)?];
        pictures.push((format!("{name}.png"), format!("{}: {kind}", scene.title), first));
        pictures.push((
            format!("{name}_scattered.png"),
            format!("Scattered light, {total:.0} ms"),
            scattered,
        ));
        album.fact(format!("{name}: {kind}"), format!("{}, {total:.1} ms", shot.rows));
    }
    for row in pictures.chunks(2 * COLUMNS) {
        // Scattered light lies below its picture.
        for start in [0, 1] {
            for (file, caption, pixels) in row.iter().skip(start).step_by(2) {
                album.add_tile(file, caption, studio.size, pixels)?;
            }
        }
    }
    album.finish_with_sheet(COLUMNS as u32, "All of them")
}

/// Lights side by side.
const COLUMNS: usize = 4;
