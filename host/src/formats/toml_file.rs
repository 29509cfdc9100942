// SPDX-License-Identifier: MIT OR Apache-2.0
//! TOML files, and what can be wrong with them.

use serde::de::DeserializeOwned;
use std::path::{Path, PathBuf};

/// Why a file says nothing.
#[derive(Debug, thiserror::Error)]
pub enum TomlFileError {
    /// It cannot be read.
    #[error("{path} cannot be read: {source}")]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// It is wrong; also where a key is unknown.
    #[error("{path}:{line}:{column}: {reason}")]
    Wrong {
        /// The file.
        path: PathBuf,
        /// From 1 on.
        line: usize,
        /// From 1 on.
        column: usize,
        /// What is wrong.
        reason: String,
    },
}

/// Reads a file.
///
/// # Errors
/// [`TomlFileError::Unreadable`].
pub(crate) fn read_toml(path: &Path) -> Result<String, TomlFileError> {
    std::fs::read_to_string(path)
        .map_err(|source| TomlFileError::Unreadable { path: path.to_owned(), source })
}

/// Reads a text. `path`: where it lies.
///
/// # Errors
/// [`TomlFileError::Wrong`].
pub(crate) fn parse_toml<T: DeserializeOwned>(path: &Path, text: &str) -> Result<T, TomlFileError> {
    toml::from_str(text).map_err(|error| {
        let at = error.span().map_or(0, |span| span.start);
        let before = text.get(..at).unwrap_or(text);
        TomlFileError::Wrong {
            path: path.to_owned(),
            line: before.matches('\n').count() + 1,
            column: before.rsplit('\n').next().unwrap_or_default().chars().count() + 1,
            reason: error.message().trim().replace('\n', ", "),
        }
    })
}
