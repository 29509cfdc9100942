// SPDX-License-Identifier: MIT OR Apache-2.0
//! Environment maps by name, from `host/assets`, or from a file.

use super::CommandError;
use crate::data::{Environment, environment_from_bytes, load_environment};
use std::path::Path;

/// Names of the maps that are part of the program, and their files.
const KNOWN: [(&str, &str, &[u8]); 2] = [
    ("forest", "forest.exr", include_bytes!("../../assets/forest.exr")),
    ("sunset", "sunset.exr", include_bytes!("../../assets/sunset.exr")),
];

/// The map of `--environment`.
///
/// # Errors
/// Misuse: an unknown name. A failure: a file that cannot be read, or radiance that light cannot have.
pub fn environment(path: &Path) -> Result<Environment, CommandError> {
    let read = match KNOWN.iter().find(|(name, ..)| path.as_os_str() == *name) {
        Some((_, file, bytes)) => environment_from_bytes(file, bytes),
        None if path.extension().is_none() => {
            let known = KNOWN.map(|(name, ..)| name).join(", ");
            let problem = format!(
                "`{}` is unknown: give {known}, or a file that ends in .exr, .hdr or .png",
                path.display()
            );
            return Err(CommandError::misuse("--environment", problem));
        }
        None => load_environment(path),
    };
    read.map_err(|error| CommandError::failure(format!("--environment: {error}")))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn maps_of_the_program_are_of_the_whole_sphere() {
        for (name, ..) in KNOWN {
            let [width, height] = environment(Path::new(name)).unwrap().size();
            assert_eq!(width, 2 * height, "{name}");
        }
    }
}
