// SPDX-License-Identifier: MIT OR Apache-2.0
//! A key-framed sequence.

use super::super::album::{Album, Section};
use super::super::studio::Studio;
use super::openings::canopy_holes;
use super::styles::{ALARM, DUSK, UNDERWATER, read};
use super::{Change, Easel};
use super::occluders::closing_across;
use crate::command::CommandError;
use crate::stylize::{Baker, Element, HoleMotion, Holes, Keyed};

const FRAMES: u32 = 36;
const SIZE: [u32; 2] = [480, 270];

/// The section.
pub fn section(studio: &Studio, folder: &str) -> Result<Section, CommandError> {
    let easel = Easel::sized(studio, "canopy", 1024, SIZE)?;
    let baker = Baker::new(&studio.gpu, &studio.shaders).map_err(CommandError::failure)?;
    let mut keys = Vec::new();
    for (frame, style) in [(0.0, UNDERWATER), (12.0, DUSK), (24.0, ALARM), (36.0, UNDERWATER)] {
        keys.extend(read(style)?.keys().iter().map(|(_, transfer)| (frame, transfer.clone())));
    }
    let style = Keyed::new(keys).map_err(CommandError::failure)?;
    let width = Keyed::new(vec![(0.0, 61.0), (12.0, 1.0), (24.0, 1.0), (36.0, 61.0)]).map_err(CommandError::failure)?;
    let about = "The kernel of a closing, the holes' time and the function all move.".to_owned();
    let mut album = Album::new(&studio.out, folder, "A key-framed sequence".to_owned(), about)?;
    let motion = HoleMotion { distance: 0.25, turn: 1.5, pace: 0.5 };
    for frame in 0..FRAMES {
        let operators = [closing_across(Element::Box, width.value(frame as f32))];
        let holes = Some(Holes { motion, ..canopy_holes() });
        let change = Change { holes, time: f64::from(frame) / 12.0, operators: &operators };
        let shadows = easel.shadows(&change)?;
        let inputs = shadows.inputs(&easel.stage.inputs());
        let scattered = easel.scatter(&inputs)?;
        let map = easel.function(&baker, &style, frame as f32, inputs, scattered)?;
        let restyled = easel.restyled(&style, frame as f32, &map, &inputs, scattered)?;
        let pixels = easel.finish(&restyled)?;
        if frame % 3 == 0 {
            album.add_tile(format!("{frame:02}.png"), format!("Frame {frame}"), SIZE, &pixels)?;
        }
    }
    album.finish_with_sheet(4, "Every third frame")
}
