// SPDX-License-Identifier: MIT OR Apache-2.0
//! Reading a folder that is laid out like `wgsl/`.

use super::{Library, ModuleSource, import_path};
use crate::{Error, Location, permutations};
use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

impl Library {
    /// A folder laid out like `wgsl/`: `<system>/<module>.wgsl`, `<system>/passes/<pass>.wgsl`,
    /// `<system>/permutations`. Modules are ordered so that each follows what it imports.
    ///
    /// # Errors
    /// An unreadable file, a malformed permutations file, a module without an import path, modules
    /// that import each other, or a folder without shaders.
    pub fn from_directory(directory: &Path) -> Result<Self, Error> {
        let mut modules = Vec::new();
        let mut passes = Vec::new();
        let mut systems = BTreeMap::new();
        for (system, folder) in folders(directory)? {
            if system == "flat" || system.starts_with('.') {
                continue;
            }
            for (module, path) in shaders(&folder)? {
                let file = format!("{system}/{module}.wgsl");
                let source = read(&path)?;
                let path = import_path(&source).ok_or_else(|| Error::Shader {
                    location: Location::line(&file, 1),
                    message: format!("a module needs `#define_import_path airlight::{system}::{module}`"),
                })?;
                modules.push(ModuleSource { path, file, source, imports: Vec::new() });
            }
            for (pass, path) in shaders(&folder.join("passes"))? {
                let file = format!("{system}/passes/{pass}.wgsl");
                passes.push((format!("{system}/{pass}"), file, read(&path)?));
            }
            let listing = folder.join("permutations");
            if listing.is_file() {
                systems.insert(system, read(&listing)?);
            }
        }
        if modules.is_empty() && passes.is_empty() {
            return Err(Error::Empty(directory.to_owned()));
        }
        let mut library = Self::new(modules, passes, BTreeMap::new(), Some(directory.to_owned()));
        library.modules = sorted(std::mem::take(&mut library.modules))?;
        for (system, text) in systems {
            let entries = permutations::parse(&format!("{system}/permutations"), &text)?;
            library.list(&system, entries);
        }
        library.complete();
        Ok(library)
    }
}

/// Depth-first by imports; otherwise in the order given.
fn sorted(modules: Vec<ModuleSource>) -> Result<Vec<ModuleSource>, Error> {
    fn visit(
        index: usize,
        modules: &[ModuleSource],
        trail: &mut Vec<usize>,
        order: &mut Vec<usize>,
    ) -> Result<(), Error> {
        if order.contains(&index) {
            return Ok(());
        }
        if let Some(start) = trail.iter().position(|&earlier| earlier == index) {
            let cycle = trail[start..].iter().chain([&index]);
            return Err(Error::Cycle {
                location: Location::file(&modules[index].file),
                cycle: cycle.map(|&at| modules[at].path.clone()).collect(),
            });
        }
        trail.push(index);
        for import in &modules[index].imports {
            if let Some(next) = modules.iter().position(|module| module.path == *import) {
                visit(next, modules, trail, order)?;
            }
        }
        trail.pop();
        order.push(index);
        Ok(())
    }
    let mut order = Vec::with_capacity(modules.len());
    for index in 0..modules.len() {
        visit(index, &modules, &mut Vec::new(), &mut order)?;
    }
    let mut slots: Vec<Option<ModuleSource>> = modules.into_iter().map(Some).collect();
    Ok(order.into_iter().filter_map(|index| slots[index].take()).collect())
}

fn read(path: &Path) -> Result<String, Error> {
    fs::read_to_string(path).map_err(|source| Error::Read { path: path.to_owned(), source })
}

/// Names and paths in a folder, sorted, so that the result does not depend on the file system.
fn entries(directory: &Path) -> Result<Vec<(String, PathBuf)>, Error> {
    let failed = |source| Error::Read { path: directory.to_owned(), source };
    let mut entries = Vec::new();
    for entry in fs::read_dir(directory).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        if let Some(name) = path.file_name().and_then(|name| name.to_str()) {
            entries.push((name.to_owned(), path));
        }
    }
    entries.sort();
    Ok(entries)
}

fn folders(directory: &Path) -> Result<Vec<(String, PathBuf)>, Error> {
    let entries = entries(directory)?;
    Ok(entries.into_iter().filter(|(_, path)| path.is_dir()).collect())
}

/// Stems and paths of the `.wgsl` files in a folder; none where there is no folder.
fn shaders(directory: &Path) -> Result<Vec<(String, PathBuf)>, Error> {
    if !directory.is_dir() {
        return Ok(Vec::new());
    }
    let entries = entries(directory)?.into_iter();
    Ok(entries.filter_map(|(name, path)| Some((name.strip_suffix(".wgsl")?.to_owned(), path))).collect())
}
