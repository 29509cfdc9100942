// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight-validate vendor`.

use super::{Stop, print};
use airlight_validate::{
    Error, Library,
    vendor::{self, Form, Lock, Problem, Request},
};
use std::{fmt::Write as _, path::Path, process::ExitCode};

pub(crate) fn run(dir: &Path, passes: &[String], form: Form, force: bool) -> Result<ExitCode, Stop> {
    if dir.exists() && !dir.is_dir() {
        return Err(Stop::Misuse(format!("DIR `{}` is no folder", dir.display())));
    }
    let requests: Vec<Request> = passes.iter().map(|pass| Request::from(pass.as_str())).collect();
    let files = vendor::package(&Library::builtin(), &requests, form).map_err(|error| match error {
        Error::UnknownPass { .. } | Error::UnknownPermutation { .. } => {
            Stop::Misuse(format!("--pass: {error}"))
        }
        error => Stop::Failure(error.to_string()),
    })?;
    let lock = Lock::new(&requests, form, &files);
    let done = vendor::install(dir, &lock, &files, force).map_err(stop)?;
    let mut text = String::new();
    for (what, files) in [("wrote", &done.written), ("removed", &done.removed)] {
        for file in files {
            let _ = writeln!(text, "{what} {}", dir.join(file).display());
        }
    }
    for file in &done.kept {
        let _ = writeln!(
            text,
            "kept {}, which is no longer needed but locally changed",
            dir.join(file).display()
        );
    }
    let _ = writeln!(text, "{}: {} files of Airlight {}", dir.display(), files.len(), lock.version);
    print(&text)?;
    Ok(ExitCode::SUCCESS)
}

/// How the command ends for a problem.
pub(super) fn stop(problem: Problem) -> Stop {
    match problem {
        Problem::NoLock(_) | Problem::BrokenLock { .. } => Stop::Misuse(problem.to_string()),
        problem => Stop::Failure(problem.to_string()),
    }
}
