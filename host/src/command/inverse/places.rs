// SPDX-License-Identifier: MIT OR Apache-2.0
//! Which files are written, and that none of them is read.

use super::error::SolveError;
use super::options::{MediumFlags, Property};
use super::views::{Background, Views};
use std::path::{Path, PathBuf};

/// Refuses names in `--out` of files that the command reads: what was painted is not to be replaced by what was rendered.
///
/// # Errors
/// [`SolveError::Replaces`].
pub fn check_names(flags: &MediumFlags, views: &Views, names: &[PathBuf]) -> Result<(), SolveError> {
    let Ok(folder) = flags.out.canonicalize() else { return Ok(()) };
    let properties = [&flags.emission, &flags.albedo].into_iter().filter_map(|property| match property {
        Property::File(path) => Some(path.as_path()),
        Property::Constant(_) => None,
    });
    let pictures = views.list.iter().flat_map(|view| {
        let background = match &view.background {
            Background::Picture(path) => Some(path),
            Background::Color(_) => None,
        };
        let own = [&view.target, &view.weights, &view.mask, &view.depth, &view.environment];
        own.into_iter().flatten().chain(background)
    });
    let pictures = pictures.map(PathBuf::as_path);
    let more = [&flags.light.environment, &flags.refraction].into_iter().flatten().map(PathBuf::as_path);
    let read = [flags.volume.as_path(), flags.views.as_path()];
    let keys = views.keys.iter().map(|key| key.volume.as_path());
    let replaced = |path: &&Path| {
        let Ok(path) = path.canonicalize() else { return false };
        names.iter().any(|name| path == folder.join(name))
    };
    match read.into_iter().chain(properties).chain(more).chain(keys).chain(pictures).find(replaced) {
        Some(path) => Err(SolveError::Replaces(path.to_owned())),
        None => Ok(()),
    }
}
