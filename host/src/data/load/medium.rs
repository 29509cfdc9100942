// SPDX-License-Identifier: MIT OR Apache-2.0
//! Why a file of a medium could not be loaded.

use crate::formats::ArrayError;
use std::fmt::Display;
use std::io;
use std::path::{Path, PathBuf};

/// Why a volume or particles could not be loaded. Each message names the file, and what to do.
#[derive(Debug, thiserror::Error)]
pub enum MediumFileError {
    /// There is no such file.
    #[error("{path}: there is no such file; check the path")]
    Missing {
        /// The file.
        path: PathBuf,
    },
    /// The file cannot be read.
    #[error("{path}: the file cannot be read: {source}")]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: io::Error,
    },
    /// The name does not tell the format.
    #[error("{path}: the format is not known; give a file that ends in {wanted}")]
    UnknownExtension {
        /// The file.
        path: PathBuf,
        /// The endings that are known.
        wanted: &'static str,
    },
    /// The file is not what its name says.
    #[error("{path}: the file is no valid NIfTI volume: {reason}; export it again as NIfTI-1")]
    Broken {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// The file is valid but needs what the loader does not do.
    #[error("{path}: {reason}")]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// What is not supported, and the remedy.
        reason: String,
    },
    /// The .npy array is broken.
    #[error(transparent)]
    Array(#[from] ArrayError),
    /// The array has another shape than is wanted.
    #[error("{path}: the array has the shape {shape:?}; {wanted}")]
    Shape {
        /// The file.
        path: PathBuf,
        /// Length of each axis.
        shape: Vec<usize>,
        /// What is wanted.
        wanted: &'static str,
    },
}

impl MediumFileError {
    pub(super) fn io(path: &Path, source: io::Error) -> Self {
        let path = path.to_owned();
        match source.kind() {
            io::ErrorKind::NotFound => Self::Missing { path },
            _ => Self::Unreadable { path, source },
        }
    }

    pub(super) fn broken(path: &Path, reason: impl Display) -> Self {
        Self::Broken { path: path.to_owned(), reason: reason.to_string() }
    }

    pub(super) fn unsupported(path: &Path, reason: impl Display) -> Self {
        Self::Unsupported { path: path.to_owned(), reason: reason.to_string() }
    }
}
