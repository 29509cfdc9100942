// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight-validate flatten`.

use super::{Stop, in_folder, library, write_whole};
use airlight_validate::flat::{self, Kept};
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    process::ExitCode,
};

pub(crate) fn run(dir: &Path, check: bool, out: Option<PathBuf>) -> Result<ExitCode, Stop> {
    let library = library(Some(dir)).map_err(Stop::from)?;
    let files = flat::render(&library).map_err(|error| Stop::Failure(in_folder(dir, &error)))?;
    let kept = if check { Kept::Compared } else { Kept::Written };
    let advice = |message: String| {
        Stop::Failure(match check {
            true => format!("{message}; run `airlight-validate flatten {}`", dir.display()),
            false => message,
        })
    };
    let folder = out.clone().unwrap_or_else(|| dir.join("flat"));
    flat::sync(&folder, &files, kept, write_whole).map_err(advice)?;
    // The crate of the shaders includes them by a list.
    let crate_sources = dir.join("src");
    if out.is_none() && crate_sources.is_dir() {
        let list = BTreeMap::from([("flat.rs".to_owned(), flat::list(&library))]);
        flat::sync_files(&crate_sources, &list, kept, write_whole).map_err(advice)?;
    }
    Ok(ExitCode::SUCCESS)
}
