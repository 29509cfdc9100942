// SPDX-License-Identifier: MIT OR Apache-2.0
//! Shaders of any folder: naga_oil modules and plain WGSL, whoever wrote them.
//!
//! [`open`] reads every `.wgsl` file below a folder, finds import paths, works out the order of the
//! modules, and makes a [`Library`] that the check takes like Airlight's own. What cannot be read
//! or resolved is a finding of the check; everything else goes on.

mod bounds;
mod resolve;
mod walk;

use crate::{
    Definitions, Error, Library, Location, ModuleSource, PassSource, Permutation,
    check::{Finding, Severity, watch::on_large_stack},
    permutations,
    scan::without_comments,
};
use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};

/// How a tree is read.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Definitions that every file is checked with.
    pub definitions: Definitions,
    /// A file that lists files and import paths with their permutations.
    pub permutations: Option<PathBuf>,
    /// Folders with modules that may be imported and are not checked themselves.
    pub module_dirs: Vec<PathBuf>,
}

/// What a check has to know of a tree beside its modules and shaders.
#[derive(Clone, Debug, Default)]
pub(crate) struct Foreign {
    /// Definitions that every file is checked with.
    pub base: Definitions,
    /// Files that no composer reads.
    pub plain: BTreeSet<String>,
    /// Files of module folders: not checked themselves.
    pub external: BTreeSet<String>,
    /// Files that are not composed, since something that they import is not there.
    pub unchecked: BTreeSet<String>,
    pub findings: Vec<Finding>,
    pub skipped: Vec<String>,
}

impl Foreign {
    /// Whether a file is composed and compiled.
    pub fn is_checked(&self, file: &str) -> bool {
        !self.external.contains(file) && !self.unchecked.contains(file)
    }

    /// A finding of the reader.
    fn report(&mut self, location: Location, check: &str, message: impl Into<String>) {
        self.findings.push(Finding::new(Severity::Error, location, check, message.into()));
    }
}

/// A file of the tree.
#[derive(Clone, Debug)]
struct File {
    /// As messages call it: the folder as given, and what follows.
    name: String,
    /// Relative to its folder, with `/`.
    relative: String,
    text: String,
    is_external: bool,
}

/// Whether a folder is laid out as Airlight's own: some `<system>/permutations` stands in it.
pub fn is_airlight_layout(dir: &Path) -> bool {
    let Ok(entries) = fs::read_dir(dir) else { return false };
    entries.flatten().any(|entry| entry.path().join("permutations").is_file())
}

/// Reads a folder, or one file.
///
/// # Errors
/// What the caller asked wrongly, as a sentence: a folder that is not there or holds no `.wgsl`
/// file, an unreadable list of permutations. What is wrong in a shader is a finding of the check.
pub fn open(dir: &Path, options: &Options) -> Result<Library, String> {
    let mut foreign = Foreign { base: options.definitions.clone(), ..Foreign::default() };
    let mut files = walk::read(dir, "DIR", false, &mut foreign)?;
    for folder in &options.module_dirs {
        files.extend(walk::read(folder, "--module-dir", true, &mut foreign)?);
    }
    let listing = match &options.permutations {
        Some(path) => {
            let text = fs::read_to_string(path)
                .map_err(|error| format!("cannot read --permutations `{}`: {error}", path.display()))?;
            Some((path.display().to_string(), text))
        }
        None => None,
    };
    Ok(from_files(files, listing, foreign))
}

/// A library of files in memory.
fn from_files(mut files: Vec<File>, listing: Option<(String, String)>, mut foreign: Foreign) -> Library {
    files.retain(|file| match bounds::excess(&file.text) {
        Some((line, column, message)) => {
            let location = Location { file: file.name.clone(), line: Some(line), column: Some(column) };
            // A file of others is not there at all.
            if !file.is_external {
                foreign.report(location, "nesting", message);
            }
            false
        }
        None => true,
    });
    let sets =
        listing.map(|(name, text)| permutation_sets(&name, &text, &files, &mut foreign)).unwrap_or_default();
    foreign.external.extend(files.iter().filter(|file| file.is_external).map(|file| file.name.clone()));
    // Reading imports recurses in naga_oil's own reader as well.
    let resolved = on_large_stack(|| {
        let resolved = resolve::resolve(&files, &mut foreign);
        (resolved, foreign)
    });
    let Some((resolved, foreign)) = resolved else {
        let mut foreign = Foreign::default();
        foreign.report(Location::file(""), "internal", "the imports of the tree could not be read");
        return library(Vec::new(), Vec::new(), BTreeMap::new(), foreign);
    };
    let mut permutations = BTreeMap::new();
    let base =
        || vec![Permutation { name: "default".to_owned(), definitions: foreign.base.clone(), line: 0 }];
    for pass in &resolved.passes {
        // A module with an entry point may be listed by its path.
        let by_path =
            resolved.modules.iter().find(|module| module.file == pass.file).map(|module| &module.path);
        let own = sets.get(&pass.name).or_else(|| sets.get(by_path?));
        permutations.insert(pass.name.clone(), own.cloned().unwrap_or_else(base));
    }
    for module in &resolved.modules {
        if let Some(own) = sets.get(&module.path).or_else(|| sets.get(&module.file)) {
            permutations.entry(module.path.clone()).or_insert_with(|| own.clone());
        }
    }
    library(resolved.modules, resolved.passes, permutations, foreign)
}

fn library(
    modules: Vec<ModuleSource>,
    passes: Vec<PassSource>,
    permutations: BTreeMap<String, Vec<Permutation>>,
    foreign: Foreign,
) -> Library {
    let mut library = Library::new(Vec::new(), Vec::new(), permutations, None);
    (library.modules, library.passes) = (modules, passes);
    library.foreign = Some(Box::new(foreign));
    library
}

/// Sets of definitions by the name of a file or the path of a module.
fn permutation_sets(
    name: &str,
    text: &str,
    files: &[File],
    foreign: &mut Foreign,
) -> BTreeMap<String, Vec<Permutation>> {
    let entries = match permutations::parse_paths(name, text) {
        Ok(entries) => entries,
        Err(error) => {
            foreign.findings.push(Finding::of("permutations", &error));
            return BTreeMap::new();
        }
    };
    let mut sets = BTreeMap::new();
    for entry in entries {
        let path =
            |file: &&File| crate::library::import_path(&file.text).as_deref() == Some(entry.pass.as_str());
        let by_name = files.iter().find(|file| file.relative == entry.pass || file.name == entry.pass);
        let key = match by_name {
            Some(file) => file.name.clone(),
            None if files.iter().any(|file| path(&file)) => entry.pass.clone(),
            None => {
                let message =
                    format!("`{}` is neither a file of the tree nor the path of a module", entry.pass);
                foreign.report(Location::line(name, entry.line), "permutations", message);
                continue;
            }
        };
        let merged = entry.permutations.into_iter().map(|mut permutation| {
            permutation.definitions = foreign.base.clone().merge(&permutation.definitions);
            permutation
        });
        sets.insert(key, merged.collect());
    }
    sets
}

/// Whether a text has an entry point.
fn has_entry_point(code: &str) -> bool {
    code.match_indices('@').any(|(at, _)| {
        let rest = code[at + 1..].trim_start();
        let end = rest.find(|letter: char| !crate::scan::is_identifier(letter)).unwrap_or(rest.len());
        matches!(&rest[..end], "vertex" | "fragment" | "compute")
    })
}

/// Whether a text has something that only a composer reads.
fn has_directives(code: &str) -> bool {
    code.lines().any(|line| line.trim_start().starts_with('#')) || code.contains("#{")
}

/// The text without comments.
fn code(text: &str) -> String {
    without_comments(text)
}

/// One definition as the command takes it.
///
/// # Errors
/// Text that is no `NAME` or `NAME=VALUE`.
pub fn define(definitions: &mut Definitions, text: &str) -> Result<(), Error> {
    let one: Definitions = text.parse()?;
    if one.len() != 1 {
        return Err(Error::Definition {
            text: text.to_owned(),
            message: "give one NAME or NAME=VALUE for each --define".to_owned(),
        });
    }
    *definitions = std::mem::take(definitions).merge(&one);
    Ok(())
}

#[cfg(test)]
mod fuzz;
#[cfg(test)]
mod tests;
