// SPDX-License-Identifier: MIT OR Apache-2.0
//! Rays for every pixel, and for one in four and in sixteen (thesis 4.1.7).

use super::super::album::{Album, Section};
use super::super::studio::Studio;
use super::easel::style;
use super::{BRAIN, Easel};
use crate::command::CommandError;

/// The section.
pub fn section(studio: &Studio, folder: &str) -> Result<Section, CommandError> {
    let easel = Easel::new(studio, &BRAIN)?;
    let about = "Sources of the size of the picture, of half its side, and of a quarter; strokes are drawn at full size in all.";
    let mut album = Album::new(&studio.out, folder, "Sources of fewer rays".to_owned(), about.to_owned())?;
    for (file, caption, scale) in [
        ("whole.png", "A ray a pixel", 1.0),
        ("half.png", "A ray for two by two pixels", 0.5),
        ("quarter.png", "A ray for four by four pixels", 0.25),
    ] {
        let painted = easel.still(style("a")?, scale)?;
        album.fact(caption, format!("{} strokes", painted.strokes.len()));
        album.add_tile(file, caption, studio.size, &painted.pixels)?;
    }
    album.finish_with_sheet(3, "A ray for a pixel, for two by two and for four by four pixels")
}
