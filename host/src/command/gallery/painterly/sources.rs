// SPDX-License-Identifier: MIT OR Apache-2.0
//! Rays for every pixel, and for one in four (thesis 4.1.7).

use super::super::album::{Album, Section};
use super::super::studio::Studio;
use super::easel::style;
use super::{BRAIN, Easel};
use crate::command::CommandError;

/// The section.
pub fn section(studio: &Studio, folder: &str) -> Result<Section, CommandError> {
    let easel = Easel::new(studio, &BRAIN)?;
    let about = "Rays for every pixel of the picture, and for two by two of them; strokes are drawn at full size in both.";
    let mut album = Album::new(&studio.out, folder, "Sources of fewer rays".to_owned(), about.to_owned())?;
    for (file, caption, scale) in
        [("whole.png", "A ray a pixel", 1.0), ("half.png", "A ray for two by two pixels", 0.5)]
    {
        let painted = easel.still(style("a")?, scale)?;
        album.fact(caption, format!("{} strokes", painted.strokes.len()));
        album.add_tile(file, caption, studio.size, &painted.pixels)?;
    }
    album.finish_with_sheet(2, "A ray for a pixel, and for two by two pixels")
}
