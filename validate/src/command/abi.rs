// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight-validate abi`.

use super::{Stop, print};
use airlight_validate::abi;
use std::{fs, path::Path, process::ExitCode};

pub(crate) fn run(old: &Path, new: &Path) -> Result<ExitCode, Stop> {
    let read = |name: &str, file: &Path| {
        let text = fs::read_to_string(file)
            .map_err(|error| Stop::Misuse(format!("{name}: cannot read {}: {error}", file.display())))?;
        abi::read(&text).map_err(|message| Stop::Misuse(format!("{name}: {} {message}", file.display())))
    };
    let comparison = abi::compare(&read("OLD", old)?, &read("NEW", new)?);
    print(&comparison.render())?;
    if !comparison.is_breaking() || comparison.is_bumped() {
        return Ok(ExitCode::SUCCESS);
    }
    let [from, to] = comparison.versions.map(|version| match version.is_empty() {
        true => "none".to_owned(),
        false => version,
    });
    Err(Stop::Failure(format!(
        "breaking changes need a greater major version (minor, below 1.0); it goes from {from} to {to}"
    )))
}
