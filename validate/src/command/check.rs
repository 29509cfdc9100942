// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight-validate check`.

use super::{Failed, Stop, folder, library, print};
use airlight_validate::{
    Definitions, Error,
    check::{self, Finding, Format, Lint, Report, Tool},
    tree,
};
use std::{
    io::{self, IsTerminal},
    path::{Path, PathBuf},
    process::ExitCode,
};

/// What to check, and how to say what was found.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Folder of shaders, or one shader; default `wgsl` if it is here, else the built-in library. A folder with
    /// `<system>/permutations` is read as Airlight's own layout, unless one of the next three flags is given.
    dir: Option<PathBuf>,
    /// A definition that every file is checked with; may be repeated.
    #[arg(long, value_name = "NAME[=VALUE]")]
    define: Vec<String>,
    /// File that lists files or import paths, each followed by lines `+ name: DEFINITION DEFINITION=VALUE`.
    #[arg(long, value_name = "FILE")]
    permutations: Option<PathBuf>,
    /// Folder with modules that may be imported and are not checked themselves; may be repeated.
    #[arg(long, value_name = "DIR")]
    module_dir: Vec<PathBuf>,
    /// Form of the report.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
    /// Programs whose absence is a finding, with commas between.
    #[arg(long, value_enum, value_delimiter = ',', value_name = "PROGRAM,…")]
    require: Vec<Tool>,
    /// Findings to leave out, by the name in brackets; `airlight-validate explain` lists the names.
    #[arg(long, value_delimiter = ',', value_name = "LINT,…")]
    allow: Vec<String>,
    /// Print findings only.
    #[arg(long, short)]
    quiet: bool,
}

pub(crate) fn run(arguments: Arguments) -> Result<ExitCode, Stop> {
    if let Some(unknown) = arguments.allow.iter().find(|name| Lint::named(name).is_none()) {
        let known: Vec<&str> = Lint::all().map(|lint| lint.name).collect();
        return Err(Stop::Misuse(format!("--allow `{unknown}` is no lint; there are {}", known.join(", "))));
    }
    let (require, allow) = (arguments.require.clone(), arguments.allow.clone());
    let options = check::Options { require, allow, ..Default::default() };
    let check = |library| check::run(&library, &options).map_err(|error| Stop::Failure(error.to_string()));
    let report = match foreign(&arguments)? {
        Some(library) => check(library)?,
        None => match library(arguments.dir.as_deref()) {
            Ok(library) => check(library)?,
            Err(Failed::Misuse(message)) => return Err(Stop::Misuse(message)),
            // What is wrong in a file of the library is a finding like others.
            Err(Failed::Broken(error)) => broken(&error, arguments.dir.as_deref()),
        },
    };
    let color = io::stdout().is_terminal() && std::env::var_os("NO_COLOR").is_none();
    print(&report.render(arguments.format, arguments.quiet, color))?;
    Ok(ExitCode::from(u8::from(!report.is_clean())))
}

/// The tree of others that is asked for; none where it is Airlight's own layout.
fn foreign(arguments: &Arguments) -> Result<Option<airlight_validate::Library>, Stop> {
    let mut definitions = Definitions::new();
    for text in &arguments.define {
        tree::define(&mut definitions, text).map_err(|error| Stop::Misuse(format!("--define: {error}")))?;
    }
    let (permutations, module_dirs) = (arguments.permutations.clone(), arguments.module_dir.clone());
    let is_asked = !definitions.is_empty() || permutations.is_some() || !module_dirs.is_empty();
    let Some(dir) = folder(arguments.dir.as_deref()) else {
        let message = "--define, --permutations and --module-dir need DIR, the folder with your shaders";
        return if is_asked { Err(Stop::Misuse(message.to_owned())) } else { Ok(None) };
    };
    if !is_asked && tree::is_airlight_layout(dir) {
        return Ok(None);
    }
    let options = tree::Options { definitions, permutations, module_dirs };
    tree::open(dir, &options).map(Some).map_err(Stop::Misuse)
}

fn broken(error: &Error, dir: Option<&Path>) -> Report {
    let mut finding = Finding::of("library", error);
    if let Error::Read { path, .. } = error {
        finding.file = path.display().to_string();
    } else if let Some(root) = folder(dir) {
        finding.file = root.join(&finding.file).display().to_string();
    }
    Report { findings: vec![finding], ..Report::default() }
}
