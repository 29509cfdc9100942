// SPDX-License-Identifier: MIT OR Apache-2.0
//! Transfer functions that are part of the program, from `host/styles/stylize`.

use crate::command::CommandError;
use crate::stylize::{Keyed, Transfer, parse_transfer};

/// A file of `host/styles/stylize`: its name and its text.
pub type Style = (&'static str, &'static str);

/// Hard bands of red and yellow.
pub const ALARM: Style = ("alarm.toml", include_str!("../../../../styles/stylize/alarm.toml"));
/// Violet shade, golden light.
pub const DUSK: Style = ("dusk.toml", include_str!("../../../../styles/stylize/dusk.toml"));
/// Blue and green, deeper with distance.
pub const UNDERWATER: Style = ("underwater.toml", include_str!("../../../../styles/stylize/underwater.toml"));
/// Monochrome, with shadows lifted.
pub const LIFT: Style = ("lift.toml", include_str!("../../../../styles/stylize/lift.toml"));
/// The function of a style.
pub fn read((name, text): Style) -> Result<Keyed<Transfer>, CommandError> {
    parse_transfer(format!("host/styles/stylize/{name}"), text).map_err(CommandError::failure)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn every_style_that_ships_is_known_and_sound() {
        let known = [ALARM, DUSK, UNDERWATER, LIFT];
        for style in known {
            for (_, transfer) in read(style).unwrap().keys() {
                assert!(transfer.check().is_ok(), "{}", style.0);
            }
            assert!(style.1.lines().nth(1).unwrap().starts_with("# "), "{} says what it is", style.0);
        }
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/styles/stylize");
        let mut files: Vec<_> =
            std::fs::read_dir(folder).unwrap().map(|file| file.unwrap().file_name()).collect();
        files.sort();
        let mut names = known.map(|(name, _)| name);
        names.sort_unstable();
        assert_eq!(files, names);
    }
}
