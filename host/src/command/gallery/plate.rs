// SPDX-License-Identifier: MIT OR Apache-2.0
//! One scene: its picture, the marched reference, and the maps between.

use super::album::{Album, Section};
use super::plates;
use super::studio::{AMPLIFIED, STEPS, Studio, parameters};
use crate::command::CommandError;

/// The section of a scene.
pub fn section(studio: &Studio, folder: &str, name: &str) -> Result<Section, CommandError> {
    let (scene, stage) = studio.scene(name)?;
    let shot = studio.shoot(&stage)?;
    let (marched, march_time) = studio.march(&stage)?;
    let gpu = &studio.gpu;
    let mut album = Album::new(&studio.out, folder, scene.title.to_owned(), parameters(&scene))?;
    let composed = studio.compose(&stage, &shot.scattered)?;
    let difference = plates::difference(gpu, &shot.scattered, &marched.read(gpu)?, AMPLIFIED)?;
    for (file, caption, texture) in [
        ("final.png", "Final picture".to_owned(), &composed),
        ("scattered.png", "Scattered light alone".to_owned(), &shot.scattered),
        ("march.png", format!("Marched reference, {STEPS} steps"), &marched),
        ("difference.png", format!("Difference of the two, times {AMPLIFIED}"), &difference),
        ("surface.png", "Surfaces without air".to_owned(), &stage.pictures.surface),
    ] {
        album.add(file, caption, studio.size, &studio.pixels(texture, scene.exposure)?)?;
    }
    let (shadow_map, caption) = match &stage.pictures.shadow_maps {
        Some(maps) => (maps, "Shadow maps, one a view"),
        None => (&stage.pictures.shadow_map, "Standard shadow map"),
    };
    let stored = shot.prefilter.stored();
    let inner = if shot.prefilter.textures().len() > 1 {
        ("cells.png", "Cells of the rank structure, a row each", plates::cells(gpu, stored)?)
    } else {
        ("bases.png", "Filtered bases 1, 5, 9 and so on", plates::bases(gpu, stored)?)
    };
    for (file, caption, grey) in [
        ("shadow_map.png", caption, plates::depth(gpu, shadow_map)?),
        ("rectified.png", "Rectified map", plates::depth(gpu, &shot.rectified)?),
        inner,
    ] {
        album.add(file, caption, [grey.width, grey.height], &grey.pixels)?;
    }
    for (step, milliseconds) in &shot.times {
        album.fact(*step, format!("{milliseconds:.1} ms"));
    }
    album.fact("marched reference", format!("{march_time:.1} ms"));
    album.fact("rectified map", shot.rows);
    Ok(album.finish())
}
