// SPDX-License-Identifier: MIT OR Apache-2.0
//! Volumes and light that are found from painted views: the figures of the thesis on media of our own.

mod animation;
mod easel;
mod extended;
mod glass;
mod light;
mod logos;
mod mountain;
mod refraction;
mod volcano;

use super::album::Section;
use super::studio::Studio;
use crate::command::CommandError;

/// Pictures of this system, as in `--only inverse/NAME`.
pub const NAMES: [&str; 5] = ["logos", "volcano", "light", "refraction", "animation"];

/// The section of a name; of the last one for a name that is not among [`NAMES`].
pub fn section(studio: &Studio, folder: &str, name: &str) -> Result<Section, CommandError> {
    match name {
        "logos" => logos::section(studio, folder),
        "volcano" => volcano::section(studio, folder),
        "light" => light::section(studio, folder),
        "refraction" => refraction::section(studio, folder),
        _ => animation::section(studio, folder),
    }
}
