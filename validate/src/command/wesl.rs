// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight-validate wesl`.

use super::{Stop, in_folder, library, print, write_whole};
use airlight_validate::wesl;
use std::{
    fs,
    path::{Path, PathBuf},
    process::ExitCode,
};

pub(crate) fn run(dir: Option<PathBuf>, out: &Path) -> Result<ExitCode, Stop> {
    let library = library(dir.as_deref()).map_err(Stop::from)?;
    let files = wesl::package(&library, &wesl::modules(&library)).map_err(|error| match library.root() {
        Some(root) => Stop::Failure(in_folder(root, &error)),
        None => Stop::Failure(error.to_string()),
    })?;
    for (path, text) in &files {
        let file = out.join(path);
        let folder = file.parent().unwrap_or(out);
        fs::create_dir_all(folder)
            .and_then(|()| write_whole(&file, text))
            .map_err(|error| Stop::Failure(format!("cannot write {}: {error}", file.display())))?;
    }
    let modules = files.len() - 1;
    print(&format!("{modules} of {} modules in {}\n", library.modules().len(), out.display()))?;
    Ok(ExitCode::SUCCESS)
}
