// SPDX-License-Identifier: MIT OR Apache-2.0
//! Copies of passes for other people's trees, with a lock file that tells what has become of them.
//!
//! [`package`] gathers what passes need, [`install`] puts it into a folder, and [`verify`] compares a folder with its
//! lock file and with the library of today.

mod install;
mod lock;
mod verify;

use crate::{Definitions, Error, Library, Permutation, flat, wesl};
pub use install::{Installed, install};
pub use lock::{LOCK_FILE, Lock};
use serde::{Deserialize, Serialize};
use std::{
    collections::{BTreeMap, BTreeSet},
    fmt,
    fmt::Write as _,
    io,
    path::PathBuf,
};
pub use verify::{State, Status, verify};

/// The form in which passes are copied.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "snake_case")]
#[value(rename_all = "snake_case")]
pub enum Form {
    /// The passes and the modules they import, as they are, for a `naga_oil` composer.
    #[default]
    NagaOil,
    /// A stand-alone file for each permutation.
    Flat,
    /// The modules that the passes import, as a WESL package; those without a WESL form, such as callbacks, are left out.
    Wesl,
}

/// What can go wrong.
#[derive(Debug, thiserror::Error)]
pub enum Problem {
    /// An unknown pass or permutation, or one that does not compose.
    #[error("{0}")]
    Library(#[from] Error),
    /// A folder without a lock file.
    #[error("{} has no {LOCK_FILE}; `airlight-validate vendor` writes one", .0.display())]
    NoLock(PathBuf),
    /// A lock file that is none.
    #[error("{} is no lock file: {message}; remove it and vendor again with --force", path.display())]
    BrokenLock {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        message: String,
    },
    /// Files that would be lost.
    #[error("{}; nothing was written, --force overwrites", .0.join(", "))]
    InTheWay(Vec<String>),
    /// A file that cannot be read or written.
    #[error("cannot {what} {}: {source}", path.display())]
    File {
        /// What was tried.
        what: &'static str,
        /// The file.
        path: PathBuf,
        /// Why it failed.
        source: io::Error,
    },
}

/// A pass that is asked for, `<system>/<pass>` with all permutations or `<system>/<pass>:<permutation>`.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Request {
    /// The pass.
    pub pass: String,
    /// The permutation; none for all.
    pub permutation: Option<String>,
}

impl From<&str> for Request {
    fn from(text: &str) -> Self {
        match text.split_once(':') {
            Some((pass, permutation)) => {
                Self { pass: pass.to_owned(), permutation: Some(permutation.to_owned()) }
            }
            None => Self { pass: text.to_owned(), permutation: None },
        }
    }
}

impl fmt::Display for Request {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.pass)?;
        self.permutation.as_ref().map_or(Ok(()), |permutation| write!(f, ":{permutation}"))
    }
}

/// The files that passes need in a form, licences included: each file's path with `/`, and its text.
///
/// With [`Form::NagaOil`] these are a folder that [`Library::from_directory`] reads: the modules that any permutation
/// imports, and a `permutations` file a system with the permutations that are asked for and `default`. With [`Form::Wesl`]
/// they are a package of the modules that the passes import.
///
/// # Errors
/// An unknown pass or permutation; a pass that does not compose.
pub fn package(
    library: &Library,
    requests: &[Request],
    form: Form,
) -> Result<BTreeMap<String, String>, Error> {
    let mut chosen: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for request in requests {
        let pass = library.pass(&request.pass)?;
        let names = chosen.entry(pass.name.as_str()).or_default();
        match &request.permutation {
            Some(name) => {
                names.insert(library.permutation(&pass.name, name)?.name.as_str());
            }
            None => names.extend(library.permutations(&pass.name)?.iter().map(|other| other.name.as_str())),
        }
    }
    let mut files = match form {
        Form::NagaOil => sources(library, &chosen)?,
        Form::Flat => flat_files(library, &chosen)?,
        Form::Wesl => wesl_package(library, &chosen)?,
    };
    let licences = airlight_wgsl::LICENCES.iter();
    files.extend(licences.map(|(file, text)| ((*file).to_owned(), (*text).to_owned())));
    Ok(files)
}

/// Permutations that are asked for, by pass.
type Chosen<'a> = BTreeMap<&'a str, BTreeSet<&'a str>>;

fn flat_files(library: &Library, chosen: &Chosen) -> Result<BTreeMap<String, String>, Error> {
    let mut files = BTreeMap::new();
    for (pass, permutations) in chosen {
        for permutation in permutations {
            let text = flat::text(library, pass, permutation)?;
            files.insert(flat::file_name(pass, permutation), text);
        }
    }
    Ok(files)
}

/// Bindings and entry points are the engine's own in WESL, so the passes themselves stay behind.
fn wesl_package(library: &Library, chosen: &Chosen) -> Result<BTreeMap<String, String>, Error> {
    let mut imports = Vec::new();
    for pass in chosen.keys() {
        imports.extend(library.pass(pass)?.imports.iter().cloned());
    }
    let has_form: BTreeSet<&str> = wesl::modules(library).into_iter().collect();
    let needed = library.closure(&imports).into_iter().map(|module| module.path.as_str());
    let modules: Vec<&str> = needed.filter(|path| has_form.contains(path)).collect();
    Ok(wesl::package(library, &modules)?.into_iter().collect())
}

fn sources(library: &Library, chosen: &Chosen) -> Result<BTreeMap<String, String>, Error> {
    let mut files = BTreeMap::new();
    let mut listings: BTreeMap<String, String> = BTreeMap::new();
    for (name, permutations) in chosen {
        let pass = library.pass(name)?;
        files.insert(pass.file.clone(), pass.source.clone());
        for module in library.closure(&pass.imports) {
            files.insert(module.file.clone(), module.source.clone());
        }
        let (system, short) = name.split_once('/').unwrap_or(("", name));
        let listing = listings.entry(format!("{system}/permutations")).or_insert_with(|| {
            "# SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense\n# Of each pass the permutations that were vendored.\n"
                .to_owned()
        });
        let _ = write!(listing, "\n{short}\n");
        // A pass without `default` is none.
        let all = library.permutations(name)?.iter();
        let kept = all.filter(|other| other.name == "default" || permutations.contains(other.name.as_str()));
        for permutation in kept {
            listing.push_str(&line(permutation));
        }
    }
    files.extend(listings);
    Ok(files)
}

/// A line of a permutations file.
fn line(permutation: &Permutation) -> String {
    let definitions: &Definitions = &permutation.definitions;
    format!("+ {}: {definitions}", permutation.name).trim_end().to_owned() + "\n"
}

#[cfg(test)]
mod tests;
