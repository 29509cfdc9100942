// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight-validate verify`.

use super::{Stop, print, vendor::stop};
use airlight_validate::{
    Library,
    check::{Format, Report},
    vendor::{self, Lock, Status},
};
use std::{fmt::Write as _, path::Path, process::ExitCode};

pub(crate) fn run(dir: &Path, format: Format) -> Result<ExitCode, Stop> {
    let (lock, files) = vendor::verify(dir, &Library::builtin()).map_err(stop)?;
    let text = match format {
        Format::Human => human(dir, &lock, &files),
        Format::Json => {
            let document = serde_json::json!({ "version": lock.version, "form": lock.form, "files": files });
            serde_json::to_string_pretty(&document).unwrap_or_default() + "\n"
        }
        Format::Github => {
            let findings = files.iter().filter_map(|file| file.finding(dir)).collect();
            Report { findings, ..Report::default() }.render(format, true, false)
        }
    };
    print(&text)?;
    Ok(ExitCode::from(u8::from(!files.iter().all(Status::is_current))))
}

fn human(dir: &Path, lock: &Lock, files: &[Status]) -> String {
    let mut text = String::new();
    for status in files {
        let outdated = if status.outdated { ", outdated" } else { "" };
        let _ = writeln!(text, "{}: {}{outdated}", dir.join(&status.file).display(), status.state);
    }
    let wrong = files.iter().filter(|status| !status.is_current()).count();
    let verdict = match wrong {
        0 => "all unmodified and current".to_owned(),
        wrong => format!("{wrong} not as they should be"),
    };
    let _ = writeln!(text, "{} files of Airlight {}: {verdict}", files.len(), lock.version);
    text
}
