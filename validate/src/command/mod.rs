// SPDX-License-Identifier: MIT OR Apache-2.0
//! The subcommands, and what they share: the library that is read, files that are written, errors.

pub(crate) mod abi;
pub(crate) mod check;
pub(crate) mod docs;
pub(crate) mod explain;
pub(crate) mod flat;
pub(crate) mod flatten;
pub(crate) mod list;
pub(crate) mod manifest;
pub(crate) mod vendor;
pub(crate) mod verify;
pub(crate) mod wesl;

use airlight_validate::{Error, Library};
use std::{
    fs,
    io::{self, Write},
    path::Path,
};

/// Why the command stops.
pub(crate) enum Stop {
    /// Something is wrong with what was given: exit code 1.
    Failure(String),
    /// Something is wrong with how it was asked: exit code 2.
    Misuse(String),
}

/// Why there is no library.
pub(crate) enum Failed {
    Misuse(String),
    Broken(Error),
}

impl From<Failed> for Stop {
    fn from(failed: Failed) -> Self {
        match failed {
            Failed::Misuse(message) => Self::Misuse(message),
            Failed::Broken(error) => Self::Failure(error.to_string()),
        }
    }
}

/// The folder to read: the one given, or `wgsl` where it is here.
pub(crate) fn folder(dir: Option<&Path>) -> Option<&Path> {
    dir.or_else(|| Some(Path::new("wgsl")).filter(|here| here.is_dir()))
}

pub(crate) fn library(dir: Option<&Path>) -> Result<Library, Failed> {
    let Some(folder) = folder(dir) else { return Ok(Library::builtin()) };
    let shown = folder.display();
    if !folder.is_dir() {
        let what = if folder.exists() { "is no folder" } else { "does not exist" };
        return Err(Failed::Misuse(format!(
            "DIR `{shown}` {what}; give the folder that holds the systems, such as `wgsl`"
        )));
    }
    Library::from_directory(folder).map_err(|error| match error {
        Error::Empty(_) => Failed::Misuse(format!(
            "DIR `{shown}` holds no `<system>/<module>.wgsl`; give the folder that holds the \
             systems, such as `wgsl`"
        )),
        error => Failed::Broken(error),
    })
}

/// An error with the folder before its file.
pub(crate) fn in_folder(folder: &Path, error: &Error) -> String {
    match error.location() {
        Some(location) => {
            let mut location = location.clone();
            location.file = folder.join(&location.file).display().to_string();
            format!("{location}: {}", error.message())
        }
        None => error.to_string(),
    }
}

/// A file whole or not at all.
pub(crate) fn write_whole(file: &Path, text: &str) -> io::Result<()> {
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty());
    let mut temporary = tempfile::NamedTempFile::new_in(folder.unwrap_or(Path::new(".")))?;
    temporary.write_all(text.as_bytes())?;
    #[cfg(unix)]
    {
        // A temporary file is its owner's alone; this one is to be read like its neighbours.
        use std::os::unix::fs::PermissionsExt;
        let permissions = match fs::metadata(file) {
            Ok(there) => there.permissions(),
            Err(_) => fs::Permissions::from_mode(0o644),
        };
        temporary.as_file().set_permissions(permissions)?;
    }
    temporary.persist(file)?;
    Ok(())
}

/// Prints; a reader that has gone away is no error.
pub(crate) fn print(text: &str) -> Result<(), Stop> {
    match io::stdout().lock().write_all(text.as_bytes()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Stop::Failure(format!("cannot print: {error}")))
        }
        _ => Ok(()),
    }
}
