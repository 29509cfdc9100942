// SPDX-License-Identifier: MIT OR Apache-2.0
//! What has become of vendored files.

use super::{
    Problem,
    install::present,
    lock::{Lock, sum},
    package,
};
use crate::{
    Library, Location,
    check::{Finding, Severity},
    files_below,
};
use serde::Serialize;
use std::{collections::BTreeMap, fmt, path::Path};

/// What has become of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum State {
    /// As it was vendored.
    Unmodified,
    /// Changed since it was vendored.
    Changed,
    /// Gone.
    Missing,
    /// A `.wgsl` file that vendoring did not write.
    Extra,
    /// Needed by the library of today, and not vendored.
    New,
}

impl fmt::Display for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Unmodified => "unmodified",
            Self::Changed => "locally changed",
            Self::Missing => "missing",
            Self::Extra => "unknown",
            Self::New => "not yet vendored",
        })
    }
}

/// A file, what has become of it here, and of its source.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Status {
    /// The path in the folder, with `/`.
    pub file: String,
    /// What has become of it.
    pub state: State,
    /// Whether the library of today has another text, or none.
    pub outdated: bool,
}

impl Status {
    /// Whether it is as it was vendored, and as it would be today.
    pub fn is_current(&self) -> bool {
        self.state == State::Unmodified && !self.outdated
    }

    /// What is to be said of it; none if it is current.
    pub fn finding(&self, folder: &Path) -> Option<Finding> {
        let place = Location::file(folder.join(&self.file).display().to_string());
        let advice = match self.state {
            _ if self.is_current() => return None,
            State::Extra => "; move it elsewhere",
            _ if self.outdated => "; vendor again",
            _ => "; vendor again with --force, or keep the change and know of it",
        };
        let outdated = if self.outdated && self.state != State::New { ", outdated" } else { "" };
        let message = format!("{}{outdated}{advice}", self.state);
        Some(Finding::new(Severity::Error, place, "verify", message))
    }
}

/// Compares a folder with its lock file, and that with the library of today; files in the order of their names.
///
/// # Errors
/// No lock file, a broken one, or a file that cannot be read; a library that does not compose.
pub fn verify(folder: &Path, library: &Library) -> Result<(Lock, Vec<Status>), Problem> {
    let lock = Lock::read(folder)?.ok_or_else(|| Problem::NoLock(folder.to_owned()))?;
    let today: BTreeMap<String, String> = match package(library, &lock.requests(), lock.form) {
        Ok(files) => files.into_iter().map(|(file, text)| (file, sum(text.as_bytes()))).collect(),
        // A pass that is gone: nothing of it is up to date.
        Err(crate::Error::UnknownPass { .. } | crate::Error::UnknownPermutation { .. }) => BTreeMap::new(),
        Err(error) => return Err(error.into()),
    };
    let mut states = BTreeMap::new();
    for (file, locked) in &lock.files {
        let state = match present(folder, file)? {
            None => State::Missing,
            Some(there) if sum(&there) == *locked => State::Unmodified,
            Some(_) => State::Changed,
        };
        states.insert(file.clone(), (state, today.get(file) != Some(locked)));
    }
    let there = files_below(folder, "wgsl").map_err(|source| {
        let path = folder.to_owned();
        Problem::File { what: "read", path, source }
    })?;
    for file in there.into_iter().filter(|file| !lock.files.contains_key(file)) {
        states.insert(file, (State::Extra, false));
    }
    for file in today.keys().filter(|file| !lock.files.contains_key(*file)) {
        states.insert(file.clone(), (State::New, true));
    }
    let statuses = states.into_iter().map(|(file, (state, outdated))| Status { file, state, outdated });
    Ok((lock, statuses.collect()))
}
