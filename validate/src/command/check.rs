// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight-validate check`.

use super::{Failed, Stop, folder, library, print};
use airlight_validate::{
    Error,
    check::{self, Finding, Format, Report, Tool},
};
use std::{
    io::{self, IsTerminal},
    path::PathBuf,
    process::ExitCode,
};

pub(crate) fn run(
    dir: Option<PathBuf>,
    format: Format,
    require: Vec<Tool>,
    quiet: bool,
) -> Result<ExitCode, Stop> {
    let report = match library(dir.as_deref()) {
        Ok(library) => check::run(&library, &check::Options { require, ..Default::default() })
            .map_err(|error| Stop::Failure(error.to_string()))?,
        Err(Failed::Misuse(message)) => return Err(Stop::Misuse(message)),
        // What is wrong in a file of the library is a finding like others.
        Err(Failed::Broken(error)) => {
            let mut finding = Finding::of("library", &error);
            if let Error::Read { path, .. } = &error {
                finding.file = path.display().to_string();
            } else if let Some(root) = folder(dir.as_deref()) {
                finding.file = root.join(&finding.file).display().to_string();
            }
            Report { findings: vec![finding], ..Report::default() }
        }
    };
    let color = io::stdout().is_terminal() && std::env::var_os("NO_COLOR").is_none();
    print(&report.render(format, quiet, color))?;
    Ok(ExitCode::from(u8::from(!report.is_clean())))
}
