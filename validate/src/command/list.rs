// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight-validate list`.

use super::{Stop, library, write_whole};
use airlight_validate::list;
use std::{fs, path::Path, process::ExitCode};

pub(crate) fn run(dir: &Path, check: bool) -> Result<ExitCode, Stop> {
    let text = list::render(&library(Some(dir)).map_err(Stop::from)?);
    let file = dir.join("src/list.rs");
    let failure = |what: &str, error: &dyn std::fmt::Display| {
        Stop::Failure(format!("cannot {what} {}: {error}", file.display()))
    };
    if check {
        let there = fs::read_to_string(&file).map_err(|error| failure("read", &error))?;
        if there == text {
            return Ok(ExitCode::SUCCESS);
        }
        let (file, dir) = (file.display(), dir.display());
        return Err(Stop::Failure(format!("{file} is stale; run `airlight-validate list {dir}`")));
    }
    write_whole(&file, &text).map_err(|error| failure("write", &error))?;
    Ok(ExitCode::SUCCESS)
}
