// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight-validate flat`.

use super::{Stop, in_folder, library, print};
use airlight_validate::{Error, flat};
use std::{path::PathBuf, process::ExitCode};

pub(crate) fn run(subject: &str, dir: Option<PathBuf>) -> Result<ExitCode, Stop> {
    let library = library(dir.as_deref()).map_err(Stop::from)?;
    let (pass, permutation) = subject.split_once(':').unwrap_or((subject, "default"));
    let misuse = |error: Error| Stop::Misuse(format!("PASS `{subject}`: {error}"));
    let source = library.pass(pass).map_err(misuse)?;
    let permutation = library.permutation(pass, permutation).map_err(misuse)?;
    let failure = |error: Error| match library.root() {
        Some(root) => Stop::Failure(in_folder(root, &error)),
        None => Stop::Failure(error.to_string()),
    };
    let composed = library.compose(pass, &permutation.definitions).map_err(failure)?;
    let text = flat::write(&composed).map_err(failure)?;
    // The licence goes with the text; the writer drops comments.
    let licence = source.source.lines().next().filter(|line| line.starts_with("// SPDX"));
    let licence = licence.map(|line| format!("{line}\n")).unwrap_or_default();
    let definitions = match composed.definitions.is_empty() {
        true => String::new(),
        false => format!(" ({})", composed.definitions),
    };
    let name = &permutation.name;
    print(&format!("{licence}// {pass}:{name}{definitions}, composed by airlight-validate\n\n{text}"))?;
    Ok(ExitCode::SUCCESS)
}
