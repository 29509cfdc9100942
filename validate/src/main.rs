// SPDX-License-Identifier: MIT OR Apache-2.0
//! The command `airlight-validate`.

mod command;

use clap::{Parser, Subcommand};
use command::Stop;
use std::{
    io::{self, Write},
    path::PathBuf,
    process::ExitCode,
};

/// Checks WGSL modules and passes against every compiler at hand, and describes them.
///
/// Exit codes: 0 clean, 1 findings, 2 misuse.
#[derive(Parser)]
#[command(name = "airlight-validate", version)]
struct Arguments {
    #[command(subcommand)]
    command: Job,
}

#[derive(Subcommand)]
enum Job {
    /// Check every module alone and every shader in every permutation.
    Check(command::check::Arguments),
    /// Explain a kind of finding: what it is, why it goes unseen, how to mend it.
    Explain {
        /// The name in brackets before the finding; all of them with a line each where it is left out.
        #[arg(value_name = "LINT")]
        name: Option<String>,
    },
    /// Write what an engine binds of every pass to `DIR/manifest.json`.
    Manifest {
        /// Folder with `<system>/<module>.wgsl`.
        #[arg(default_value = "wgsl")]
        dir: PathBuf,
        /// Write nothing; fail if the file is not what would be written.
        #[arg(long)]
        check: bool,
        /// File instead of `DIR/manifest.json`.
        #[arg(long, value_name = "FILE")]
        out: Option<PathBuf>,
    },
    /// Print a pass as stand-alone WGSL.
    Flat {
        /// `<system>/<pass>` or `<system>/<pass>:<permutation>`.
        #[arg(value_name = "PASS[:PERMUTATION]")]
        pass: String,
        /// Folder with `<system>/<module>.wgsl`; default `wgsl` if it is here, else the built-in library.
        dir: Option<PathBuf>,
    },
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    // Panics of back ends are caught and reported as findings; their traces would only be noise.
    std::panic::set_hook(Box::new(|_| {}));
    let done = std::panic::catch_unwind(|| match arguments.command {
        Job::Check(arguments) => command::check::run(arguments),
        Job::Explain { name } => command::explain::run(name.as_deref()),
        Job::Manifest { dir, check, out } => command::manifest::run(&dir, check, out),
        Job::Flat { pass, dir } => command::flat::run(&pass, dir),
    });
    let (message, code) = match done {
        Ok(Ok(code)) => return code,
        Ok(Err(Stop::Failure(message))) => (message, 1),
        Ok(Err(Stop::Misuse(message))) => (message, 2),
        Err(_) => ("internal error; please report it with the shaders that cause it".to_owned(), 1),
    };
    // Nobody is left to tell if this fails.
    let _ = writeln!(io::stderr(), "airlight-validate: {message}");
    ExitCode::from(code)
}
