// SPDX-License-Identifier: MIT OR Apache-2.0
//! Strokes that stay where they were put on a surface that turns (thesis Fig. 5.1).

use super::super::album::{Album, Section};
use super::super::studio::Studio;
use super::easel::style;
use super::{BRAIN, Easel};
use crate::command::CommandError;

/// Frames of the turn.
const FRAMES: u32 = 15;
/// One frame in this many is shown.
const SHOWN: u32 = 3;
/// Degrees a frame.
const TURN: f32 = 3.0;

/// The section.
pub fn section(studio: &Studio, folder: &str) -> Result<Section, CommandError> {
    let easel = Easel::new(studio, &BRAIN)?;
    let about = format!(
        "After the first picture no stroke is born and none is deleted for density, while the brain turns by {TURN} degrees a \
         frame: strokes keep their places on it, those that it hides fade, and what comes into sight shows the canvas \
         with what is painted under strokes."
    );
    let mut album = Album::new(&studio.out, folder, "Strokes on a surface that turns".to_owned(), about)?;
    let mut painting = easel.painting(style("a")?, 1.0)?;
    easel.fill(&mut painting)?;
    for frame in 0..=FRAMES {
        let degrees = TURN * frame as f32;
        if frame > 0 {
            easel.paint(&mut painting, degrees, 1.0 / 60.0, false)?;
        }
        if frame % SHOWN == 0 {
            let painted = easel.read(&painting)?;
            let caption = format!("Turned by {degrees} degrees, {} strokes", painted.strokes.len());
            album.add_tile(format!("{frame:02}.png"), caption, studio.size, &painted.pixels)?;
        }
    }
    album.finish_with_sheet(3, "Every third frame")
}
