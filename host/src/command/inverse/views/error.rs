// SPDX-License-Identifier: MIT OR Apache-2.0
//! Why views cannot be read, loaded or written.

use crate::core::CameraError;
use crate::data::EnvironmentError;
use crate::formats::{ArrayError, PictureError, TomlFileError, WriteError};
use std::path::PathBuf;

/// Why views cannot be had. Each message names the file, the view, the key, and what to do.
#[derive(Debug, thiserror::Error)]
pub enum ViewsError {
    /// The file of views cannot be read, or is no such file.
    #[error("the file of views {0}")]
    File(#[from] TomlFileError),
    /// What the file says.
    #[error("the file of views {file}: {}{key}: {reason}", of(view))]
    Impossible {
        /// The file of views.
        file: PathBuf,
        /// Name of the view; empty where it is about all.
        view: String,
        /// The key.
        key: &'static str,
        /// The value, what is wrong with it and the remedy.
        reason: String,
    },
    /// The camera of a view.
    #[error("the file of views {file}: {}camera: {source}", of(view))]
    Camera {
        /// The file of views.
        file: PathBuf,
        /// Name of the view.
        view: String,
        /// What is wrong.
        source: CameraError,
    },
    /// The surroundings of a view.
    #[error("view `{view}`: environment: {source}")]
    Environment {
        /// Name of the view.
        view: String,
        /// What is wrong.
        source: EnvironmentError,
    },
    /// A picture cannot be read.
    #[error("view `{view}`: {key}: {source}")]
    Picture {
        /// Name of the view.
        view: String,
        /// The key.
        key: &'static str,
        /// What is wrong.
        source: PictureError,
    },
    /// An array cannot be read.
    #[error("view `{view}`: {key}: {source}")]
    Array {
        /// Name of the view.
        view: String,
        /// The key.
        key: &'static str,
        /// What is wrong.
        source: ArrayError,
    },
    /// The file has a format that cannot hold what is wanted.
    #[error("view `{view}`: {key}: {path}: {reason}")]
    Format {
        /// Name of the view.
        view: String,
        /// The key.
        key: &'static str,
        /// The file.
        path: PathBuf,
        /// What is wrong, and the remedy.
        reason: &'static str,
    },
    /// A picture of another size than its view.
    #[error(
        "view `{view}`: {key}: {path} has {found} pixels, the view {}x{}; scale the picture, or give the view its size",
        wanted[0], wanted[1]
    )]
    Size {
        /// Name of the view.
        view: String,
        /// The key.
        key: &'static str,
        /// The file.
        path: PathBuf,
        /// Its size, `WIDTHxHEIGHT`, or the shape of an array.
        found: String,
        /// Width and height of the view.
        wanted: [u32; 2],
    },
    /// Pixels with numbers that mean nothing.
    #[error(
        "view `{view}`: {key}: {count} pixels of {path} are {what}, the first in column {x} of row {y}; repair the file"
    )]
    Values {
        /// Name of the view.
        view: String,
        /// The key.
        key: &'static str,
        /// The file.
        path: PathBuf,
        /// Number of pixels.
        count: usize,
        /// What they are, such as `not finite`.
        what: &'static str,
        /// Column of the first, from 0.
        x: u32,
        /// Row of the first, from 0 at the top.
        y: u32,
    },
    /// No pixel of a view counts.
    #[error(
        "view `{view}`: {key}: all weights of {path} are zero, so that nothing of the view counts; leave the view out, or raise some"
    )]
    NoWeight {
        /// Name of the view.
        view: String,
        /// The key: `weights`, or `target` where its alpha does it.
        key: &'static str,
        /// The file.
        path: PathBuf,
    },
    /// A view without a target where one is needed.
    #[error(
        "the file of views {file}: view `{view}` has no target; give the picture that is wanted as target = \"FILE\""
    )]
    NoTarget {
        /// The file of views.
        file: PathBuf,
        /// Name of the view.
        view: String,
    },
    /// A file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

fn of(view: &str) -> String {
    if view.is_empty() { String::new() } else { format!("view `{view}`: ") }
}
