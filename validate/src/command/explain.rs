// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight-validate explain`.

use super::{Stop, print};
use airlight_validate::check::Lint;
use std::process::ExitCode;

pub(crate) fn run(name: Option<&str>) -> Result<ExitCode, Stop> {
    let text = match name.map(|name| (name, Lint::named(name))) {
        None => Lint::list(),
        Some((_, Some(lint))) => lint.explanation(),
        Some((name, None)) => {
            let known: Vec<&str> = Lint::all().map(|lint| lint.name).collect();
            return Err(Stop::Misuse(format!("LINT `{name}` is unknown; there are {}", known.join(", "))));
        }
    };
    print(&text)?;
    Ok(ExitCode::SUCCESS)
}
