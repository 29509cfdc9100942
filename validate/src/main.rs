// SPDX-License-Identifier: MIT OR Apache-2.0
//! The command `airlight-validate`.

use airlight_validate::{
    Error, Library,
    check::{self, Finding, Format, Report, Tool},
    flat, manifest,
};
use clap::{Parser, Subcommand};
use std::{
    fs,
    io::{self, IsTerminal, Write},
    path::{Path, PathBuf},
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
    /// Check every module alone and every pass in every permutation.
    Check {
        /// Folder with `<system>/<module>.wgsl`; default `wgsl` if it is here, else the built-in library.
        dir: Option<PathBuf>,
        /// Form of the report.
        #[arg(long, value_enum, default_value_t)]
        format: Format,
        /// Programs whose absence is a finding, with commas between.
        #[arg(long, value_enum, value_delimiter = ',', value_name = "PROGRAM,…")]
        require: Vec<Tool>,
        /// Print findings only.
        #[arg(long, short)]
        quiet: bool,
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

/// Why the command stops.
enum Stop {
    /// Something is wrong with what was given: exit code 1.
    Failure(String),
    /// Something is wrong with how it was asked: exit code 2.
    Misuse(String),
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    // Panics of back ends are caught and reported as findings; their traces would only be noise.
    std::panic::set_hook(Box::new(|_| {}));
    let done = std::panic::catch_unwind(|| match arguments.command {
        Job::Check { dir, format, require, quiet } => run_check(dir, format, require, quiet),
        Job::Manifest { dir, check, out } => run_manifest(&dir, check, out),
        Job::Flat { pass, dir } => run_flat(&pass, dir),
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

fn run_check(
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

fn run_manifest(dir: &Path, check: bool, out: Option<PathBuf>) -> Result<ExitCode, Stop> {
    let library = library(Some(dir)).map_err(Stop::from)?;
    let text = manifest::render(&library).map_err(|error| Stop::Failure(in_folder(dir, &error)))?;
    let file = out.unwrap_or_else(|| dir.join("manifest.json"));
    if check {
        return match fs::read_to_string(&file) {
            Ok(there) if there == text => Ok(ExitCode::SUCCESS),
            Ok(_) => Err(Stop::Failure(format!(
                "{} is stale; run `airlight-validate manifest {}`",
                file.display(),
                dir.display()
            ))),
            Err(error) => Err(Stop::Failure(format!("cannot read {}: {error}", file.display()))),
        };
    }
    write_whole(&file, &text)
        .map_err(|error| Stop::Failure(format!("cannot write {}: {error}", file.display())))?;
    Ok(ExitCode::SUCCESS)
}

fn run_flat(subject: &str, dir: Option<PathBuf>) -> Result<ExitCode, Stop> {
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

/// Why there is no library.
enum Failed {
    Misuse(String),
    Broken(Error),
}

impl From<Failed> for Stop {
    fn from(failed: Failed) -> Self {
        match failed {
            Failed::Misuse(message) => Self::Misuse(message),
            Failed::Broken(error) => Self::Failure(error.to_string()),
        }
    }
}

/// The folder to read: the one given, or `wgsl` where it is here.
fn folder(dir: Option<&Path>) -> Option<&Path> {
    dir.or_else(|| Some(Path::new("wgsl")).filter(|here| here.is_dir()))
}

fn library(dir: Option<&Path>) -> Result<Library, Failed> {
    let Some(folder) = folder(dir) else { return Ok(Library::builtin()) };
    let shown = folder.display();
    if !folder.is_dir() {
        let what = if folder.exists() { "is no folder" } else { "does not exist" };
        return Err(Failed::Misuse(format!(
            "DIR `{shown}` {what}; give the folder that holds the systems, such as `wgsl`"
        )));
    }
    Library::from_directory(folder).map_err(|error| match error {
        Error::Empty(_) => Failed::Misuse(format!(
            "DIR `{shown}` holds no `<system>/<module>.wgsl`; give the folder that holds the \
             systems, such as `wgsl`"
        )),
        error => Failed::Broken(error),
    })
}

/// An error with the folder before its file.
fn in_folder(folder: &Path, error: &Error) -> String {
    match error.location() {
        Some(location) => {
            let mut location = location.clone();
            location.file = folder.join(&location.file).display().to_string();
            format!("{location}: {}", error.message())
        }
        None => error.to_string(),
    }
}

/// A file whole or not at all.
fn write_whole(file: &Path, text: &str) -> io::Result<()> {
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty());
    let mut temporary = tempfile::NamedTempFile::new_in(folder.unwrap_or(Path::new(".")))?;
    temporary.write_all(text.as_bytes())?;
    #[cfg(unix)]
    {
        // A temporary file is its owner's alone; this one is to be read like its neighbours.
        use std::os::unix::fs::PermissionsExt;
        let permissions = match fs::metadata(file) {
            Ok(there) => there.permissions(),
            Err(_) => fs::Permissions::from_mode(0o644),
        };
        temporary.as_file().set_permissions(permissions)?;
    }
    temporary.persist(file)?;
    Ok(())
}

/// Prints; a reader that has gone away is no error.
fn print(text: &str) -> Result<(), Stop> {
    match io::stdout().lock().write_all(text.as_bytes()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Stop::Failure(format!("cannot print: {error}")))
        }
        _ => Ok(()),
    }
}
