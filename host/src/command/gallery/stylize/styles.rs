// SPDX-License-Identifier: MIT OR Apache-2.0
//! Transfer functions that are part of the program, from `host/styles`.

use crate::command::CommandError;
use crate::stylize::{Keyed, Transfer, parse_transfer};

/// A file of `host/styles`: its name and its text.
pub type Style = (&'static str, &'static str);

/// Hard bands of red and yellow.
pub const ALARM: Style = ("alarm.toml", include_str!("../../../../styles/alarm.toml"));
/// Violet shade, golden light.
pub const DUSK: Style = ("dusk.toml", include_str!("../../../../styles/dusk.toml"));
/// Blue and green, deeper with distance.
pub const UNDERWATER: Style = ("underwater.toml", include_str!("../../../../styles/underwater.toml"));
/// Monochrome, with shadows lifted.
pub const LIFT: Style = ("lift.toml", include_str!("../../../../styles/lift.toml"));
/// The function of a style.
pub fn read((name, text): Style) -> Result<Keyed<Transfer>, CommandError> {
    parse_transfer(format!("host/styles/{name}"), text).map_err(CommandError::failure)
}
