// SPDX-License-Identifier: MIT OR Apache-2.0
//! Scans in brush strokes: the figures of the thesis on painterly volumes, on scans of our own.

mod directions;
mod easel;
mod marks;
mod motifs;
mod progression;
mod sources;
mod stroke_maps;
mod styles;
mod target_pictures;
mod targets;

use super::album::Section;
use super::studio::Studio;
use crate::command::CommandError;
use easel::{Easel, Painted};
use motifs::{BRAIN, CUT, Motif, STENT};

/// Pictures of this system, as in `--only painterly/NAME`.
pub const NAMES: [&str; 9] = [
    "head",
    "head_cut",
    "stent",
    "head_targets",
    "stent_targets",
    "stroke_maps",
    "directions",
    "progression",
    "sources",
];

/// The section of a name; of the last one for a name that is not among [`NAMES`].
pub fn section(studio: &Studio, folder: &str, name: &str) -> Result<Section, CommandError> {
    match name {
        "head" => styles::section(studio, folder, &BRAIN),
        "head_cut" => styles::section(studio, folder, &CUT),
        "stent" => styles::section(studio, folder, &STENT),
        "head_targets" => targets::section(studio, folder, &BRAIN),
        "stent_targets" => targets::section(studio, folder, &STENT),
        "stroke_maps" => stroke_maps::section(studio, folder),
        "directions" => directions::section(studio, folder),
        "progression" => progression::section(studio, folder),
        _ => sources::section(studio, folder),
    }
}
