// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight-validate manifest`.

use super::{Stop, in_folder, library, write_whole};
use airlight_validate::manifest;
use std::{
    fs,
    path::{Path, PathBuf},
    process::ExitCode,
};

pub(crate) fn run(dir: &Path, check: bool, out: Option<PathBuf>, release: bool) -> Result<ExitCode, Stop> {
    let library = library(Some(dir)).map_err(Stop::from)?;
    let text = manifest::render(&library).map_err(|error| Stop::Failure(in_folder(dir, &error)))?;
    let file = out.unwrap_or_else(|| dir.join("manifest.json"));
    if check {
        return match fs::read_to_string(&file) {
            Ok(there) if there == text => Ok(ExitCode::SUCCESS),
            Ok(_) => Err(Stop::Failure(format!(
                "{} is stale; run `airlight-validate manifest {}`",
                file.display(),
                dir.display()
            ))),
            Err(error) => Err(Stop::Failure(format!("cannot read {}: {error}", file.display()))),
        };
    }
    let released = release.then(|| dir.join("manifest.released.json"));
    for file in [Some(file), released].into_iter().flatten() {
        write_whole(&file, &text)
            .map_err(|error| Stop::Failure(format!("cannot write {}: {error}", file.display())))?;
    }
    Ok(ExitCode::SUCCESS)
}
