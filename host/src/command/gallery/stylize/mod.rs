// SPDX-License-Identifier: MIT OR Apache-2.0
//! What an artist makes of light shafts: the figures of the stylization papers on scenes of our own.

mod easel;
mod occluders;
mod openings;
mod plates;
mod sequence;
mod styles;
mod transfers;

use super::album::Section;
use super::studio::Studio;
use crate::command::CommandError;
use easel::{Change, Easel};

/// Pictures of this system, as in `--only stylize/NAME`.
pub const NAMES: [&str; 11] = [
    "closing",
    "holes",
    "parameters",
    "halo",
    "motion",
    "patch",
    "extrusion",
    "transfer",
    "combined",
    "lantern",
    "sequence",
];

/// The section of a name; of the last one for a name that is not among [`NAMES`].
pub fn section(studio: &Studio, folder: &str, name: &str) -> Result<Section, CommandError> {
    match name {
        "closing" => occluders::closing(studio, folder),
        "extrusion" => occluders::extrusion(studio, folder),
        "holes" => openings::holes(studio, folder),
        "parameters" => openings::parameters(studio, folder),
        "halo" => openings::halo(studio, folder),
        "motion" => openings::motion(studio, folder),
        "lantern" => openings::lantern(studio, folder),
        "patch" => transfers::patch(studio, folder),
        "transfer" => transfers::transfer(studio, folder),
        "combined" => transfers::combined(studio, folder),
        _ => sequence::section(studio, folder),
    }
}

/// A file's name, its caption and its pixels.
type Tile = (String, String, Vec<u8>);

fn tile(file: &str, caption: impl Into<String>, pixels: Vec<u8>) -> Tile {
    (format!("{file}.png"), caption.into(), pixels)
}
