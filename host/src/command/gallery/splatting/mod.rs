// SPDX-License-Identifier: MIT OR Apache-2.0
//! Volumes and meshes in sheets of splats: the figures of the paper on scenes of our own.

mod clouds;
mod easel;
mod rooms;
mod scans;

use super::album::Section;
use super::studio::Studio;
use crate::command::CommandError;

/// Pictures of this system, as in `--only splatting/NAME`.
pub const NAMES: [&str; 7] = ["clouds", "aeroplane", "stent", "teapot", "smoke", "mushrooms", "slide"];

/// The section of a name; of the last one for a name that is not among [`NAMES`].
pub fn section(studio: &Studio, folder: &str, name: &str) -> Result<Section, CommandError> {
    match name {
        "clouds" => clouds::scattered(studio, folder),
        "aeroplane" => clouds::aeroplane(studio, folder),
        "stent" => scans::stent(studio, folder),
        "teapot" => scans::teapot(studio, folder),
        "smoke" => rooms::smoke(studio, folder),
        "mushrooms" => scans::mushrooms(studio, folder),
        _ => rooms::slide(studio, folder),
    }
}
