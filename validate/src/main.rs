// SPDX-License-Identifier: MIT OR Apache-2.0
//! The command `airlight-validate`.

#[cfg(test)]
mod book;
mod command;

use airlight_validate::{check::Format, vendor::Form};
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
        /// Write `DIR/manifest.released.json`, which later manifests are held to, as well.
        #[arg(long, conflicts_with_all = ["check", "out"])]
        release: bool,
    },
    /// Tell compatible from breaking changes of two manifests; fail where a breaking one comes without a new version.
    Abi {
        /// The older `manifest.json`.
        old: PathBuf,
        /// The newer one.
        new: PathBuf,
    },
    /// Write the book's pages that follow from the shaders.
    Docs {
        /// Folder with `<system>/<module>.wgsl`.
        #[arg(default_value = "wgsl")]
        dir: PathBuf,
        /// Folder of the book's chapters.
        #[arg(long, value_name = "DIR", default_value = "docs/src")]
        out: PathBuf,
        /// Write nothing; fail if a page is not what would be written.
        #[arg(long)]
        check: bool,
    },
    /// Write the lists of the crate, every module, pass and system of `DIR`, to `DIR/src/list.rs`.
    List {
        /// Folder with `<system>/<module>.wgsl`.
        #[arg(default_value = "wgsl")]
        dir: PathBuf,
        /// Write nothing; fail if the file is not what would be written.
        #[arg(long)]
        check: bool,
    },
    /// Print a pass as stand-alone WGSL.
    Flat {
        /// `<system>/<pass>` or `<system>/<pass>:<permutation>`.
        #[arg(value_name = "PASS[:PERMUTATION]")]
        pass: String,
        /// Folder with `<system>/<module>.wgsl`; default `wgsl` if it is here, else the built-in library.
        dir: Option<PathBuf>,
    },
    /// Copy passes with what they need, licences and a lock file into a folder.
    Vendor {
        /// The folder; made where there is none.
        dir: PathBuf,
        /// A pass with all its permutations, or one permutation of it; may be given several times.
        #[arg(long = "pass", required = true, value_name = "SYSTEM/PASS[:PERMUTATION]")]
        passes: Vec<String>,
        /// Form of the copies.
        #[arg(long, value_enum, default_value_t)]
        form: Form,
        /// Overwrite files that vendoring did not write, or that were changed since.
        #[arg(long)]
        force: bool,
    },
    /// Tell what has become of a vendored folder: unmodified, locally changed, missing, unknown, outdated.
    Verify {
        /// The folder, with its `airlight.lock.json`.
        dir: PathBuf,
        /// Form of the report.
        #[arg(long, value_enum, default_value_t)]
        format: Format,
    },
    /// Write every permutation of every pass as stand-alone WGSL to `DIR/flat`.
    Flatten {
        /// Folder with `<system>/<module>.wgsl`.
        #[arg(default_value = "wgsl")]
        dir: PathBuf,
        /// Write nothing; fail naming the first file that is stale, missing or superfluous.
        #[arg(long)]
        check: bool,
        /// Folder instead of `DIR/flat`; other `.wgsl` files in it are removed.
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
    },
    /// Write the modules that hold no bindings as a WESL package.
    Wesl {
        /// Folder with `<system>/<module>.wgsl`; default `wgsl` if it is here, else the built-in library.
        dir: Option<PathBuf>,
        /// Folder of the package; its name is that of the package.
        #[arg(long, value_name = "DIR", default_value = "airlight")]
        out: PathBuf,
    },
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    // Panics of back ends are caught and reported as findings; their traces would only be noise.
    std::panic::set_hook(Box::new(|_| {}));
    let done = std::panic::catch_unwind(|| match arguments.command {
        Job::Manifest { dir, check, out, release } => command::manifest::run(&dir, check, out, release),
        Job::Abi { old, new } => command::abi::run(&old, &new),
        Job::Docs { dir, out, check } => command::docs::run(&dir, &out, check),
        Job::List { dir, check } => command::list::run(&dir, check),
        Job::Check(arguments) => command::check::run(arguments),
        Job::Explain { name } => command::explain::run(name.as_deref()),
        Job::Flat { pass, dir } => command::flat::run(&pass, dir),
        Job::Vendor { dir, passes, form, force } => command::vendor::run(&dir, &passes, form, force),
        Job::Verify { dir, format } => command::verify::run(&dir, format),
        Job::Flatten { dir, check, out } => command::flatten::run(&dir, check, out),
        Job::Wesl { dir, out } => command::wesl::run(dir, &out),
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
