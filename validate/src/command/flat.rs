// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight-validate flat`.

use super::{Stop, in_folder, library, print};
use airlight_validate::{Error, flat};
use std::{path::PathBuf, process::ExitCode};

pub(crate) fn run(subject: &str, dir: Option<PathBuf>) -> Result<ExitCode, Stop> {
    let library = library(dir.as_deref()).map_err(Stop::from)?;
    let (pass, permutation) = subject.split_once(':').unwrap_or((subject, "default"));
    let text = flat::text(&library, pass, permutation).map_err(|error| match (&error, library.root()) {
        (Error::UnknownPass { .. } | Error::UnknownPermutation { .. }, _) => {
            Stop::Misuse(format!("PASS `{subject}`: {error}"))
        }
        (_, Some(root)) => Stop::Failure(in_folder(root, &error)),
        (_, None) => Stop::Failure(error.to_string()),
    })?;
    print(&text)?;
    Ok(ExitCode::SUCCESS)
}
