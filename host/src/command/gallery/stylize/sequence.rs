// SPDX-License-Identifier: MIT OR Apache-2.0
//! A key-framed sequence.

use super::super::album::{Album, Section};
use super::super::studio::{Studio, parameters};
use super::occluders::closing_across;
use super::openings::canopy_holes;
use super::styles::{ALARM, DUSK, UNDERWATER, read};
use super::{Change, Easel};
use crate::command::CommandError;
use crate::stylize::{Baker, Element, HoleMotion, Holes, Keyed};

const FRAMES: u32 = 36;
const SIZE: [u32; 2] = [480, 270];
/// Frames a second.
const RATE: u16 = 12;
/// One frame in this many is a still.
const STILLS: u32 = 3;

/// The section: holes sway, a closing shuts them at both ends, the function goes from style to style and back.
pub fn section(studio: &Studio, folder: &str) -> Result<Section, CommandError> {
    let easel = Easel::sized(studio, "canopy", 1024, SIZE)?;
    let baker = Baker::new(&studio.gpu, &studio.shaders).map_err(CommandError::failure)?;
    let end = FRAMES as f32;
    let mut keys = Vec::new();
    for (frame, style) in [(0.0, UNDERWATER), (end / 3.0, DUSK), (2.0 * end / 3.0, ALARM), (end, UNDERWATER)]
    {
        keys.extend(read(style)?.keys().iter().map(|(_, transfer)| (frame, transfer.clone())));
    }
    let style = Keyed::new(keys).map_err(CommandError::failure)?;
    let width = Keyed::new(vec![(0.0, 41.0), (end / 3.0, 1.0), (2.0 * end / 3.0, 1.0), (end, 41.0)])
        .map_err(CommandError::failure)?;
    let about = format!(
        "Underwater, dusk, alarm and back. Holes in the crown sway; a closing of 41 texels at both ends shuts them. {}",
        parameters(&easel.scene)
    );
    let mut album = Album::new(&studio.out, folder, "A key-framed sequence".to_owned(), about)?;
    let motion = HoleMotion { distance: 0.25, turn: 1.5, pace: 0.5 };
    let mut frames: Vec<Vec<u8>> = Vec::new();
    for frame in 0..FRAMES {
        let at = frame as f32;
        let operators = [closing_across(Element::Box, width.value(at))];
        let holes = Some(Holes { motion, ..canopy_holes() });
        let change = Change { holes, time: f64::from(frame) / f64::from(RATE), operators: &operators };
        let shadows = easel.shadows(&change)?;
        let inputs = shadows.inputs(&easel.stage.inputs());
        let scattered = easel.scatter(&inputs)?;
        let map = easel.function(&baker, &style, at, inputs, scattered)?;
        let restyled = easel.restyled(&style, at, &map, &inputs, scattered)?;
        let pixels = easel.finish(&restyled)?;
        if frame % STILLS == 0 {
            album.add_tile(format!("{frame:02}.png"), format!("Frame {frame}"), SIZE, &pixels)?;
        }
        frames.push(pixels);
    }
    album.add_animation("sequence.png", "Animated", SIZE, &frames, RATE)?;
    album.finish_with_sheet(4, "Every third frame")
}
