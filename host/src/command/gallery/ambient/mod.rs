// SPDX-License-Identifier: MIT OR Apache-2.0
//! Surfaces in the light of environment maps: the figures of the thesis on scenes of our own.

mod angles;
mod blur;
mod easel;
mod failure;
mod methods;
mod samplers;
mod sampling;

use super::album::Section;
use super::studio::Studio;
use crate::command::CommandError;
use crate::scenes::{AmbientScene, ambient_scenes};

/// Pictures of this system, as in `--only ambient/NAME`.
pub const NAMES: [&str; 8] =
    ["bunny", "suzanne", "room", "samplers", "angles", "sampling", "blur", "failure"];

/// The section of a name; of the last one for a name that is not among [`NAMES`].
pub fn section(studio: &Studio, folder: &str, name: &str) -> Result<Section, CommandError> {
    match name {
        "bunny" | "suzanne" | "room" => methods::section(studio, folder, scene(name)?),
        "samplers" => samplers::section(studio, folder, scene("bunny")?),
        "angles" => angles::section(studio, folder, scene("suzanne")?),
        "sampling" => sampling::section(studio, folder, scene("suzanne")?),
        "blur" => blur::section(studio, folder),
        _ => failure::section(studio, folder),
    }
}

fn scene(name: &str) -> Result<AmbientScene, CommandError> {
    let found = ambient_scenes()?.into_iter().find(|scene| scene.name == name);
    found.ok_or_else(|| CommandError::failure(format!("no scene `{name}`")))
}
