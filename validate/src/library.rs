// SPDX-License-Identifier: MIT OR Apache-2.0
//! A library of shader modules, passes and permutations.

mod folder;

use crate::{Definitions, Error, Location, Permutation, imports, permutations};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
};

/// An algorithm module.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ModuleSource {
    /// Import path, `airlight::<system>::<module>`.
    pub path: String,
    /// File, relative to the root of the library, with `/`.
    pub file: String,
    /// WGSL text with naga_oil directives.
    pub source: String,
    /// Import paths of the modules that it uses, sorted.
    pub imports: Vec<String>,
}

/// A pass.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PassSource {
    /// Name, `<system>/<pass>`.
    pub name: String,
    /// File, relative to the root of the library, with `/`.
    pub file: String,
    /// WGSL text with naga_oil directives.
    pub source: String,
    /// Import paths of the modules that it uses, sorted.
    pub imports: Vec<String>,
}

/// Modules, passes and permutations.
#[derive(Clone, Debug)]
pub struct Library {
    pub(crate) modules: Vec<ModuleSource>,
    pub(crate) passes: Vec<PassSource>,
    /// Permutations by the name of the pass.
    pub(crate) permutations: BTreeMap<String, Vec<Permutation>>,
    /// Passes that no permutations file lists, and listed ones that have no file.
    pub(crate) unlisted: Vec<(Location, String)>,
    root: Option<PathBuf>,
    /// What is known of a tree that is not laid out as Airlight is.
    #[cfg(feature = "command")]
    pub(crate) foreign: Option<Box<crate::tree::Foreign>>,
}

impl Library {
    /// The library that this version of Airlight ships.
    pub fn builtin() -> Self {
        let modules = airlight_wgsl::MODULES.iter().map(|module| ModuleSource {
            path: module.path.to_owned(),
            file: module.file.to_owned(),
            source: module.source.to_owned(),
            imports: Vec::new(),
        });
        let passes = airlight_wgsl::PASSES
            .iter()
            .map(|pass| (pass.name.to_owned(), pass.file.to_owned(), pass.source.to_owned()));
        let systems = airlight_wgsl::SYSTEMS
            .iter()
            .map(|system| (system.name.to_owned(), system.permutations.to_owned()));
        let mut library = Self::new(modules.collect(), passes.collect(), BTreeMap::new(), None);
        // What ships was parsed by this crate's tests; a broken file is a finding, not a panic.
        for (system, text) in systems {
            match permutations::parse(&format!("{system}/permutations"), &text) {
                Ok(entries) => library.list(&system, entries),
                Err(error) => library.unlisted.push(listing_error(&error)),
            }
        }
        library.complete();
        library
    }

    /// The library with one more pass, `<system>/<name>`, that is not its own: it may import every module. It has
    /// the one permutation `default`, without definitions, and takes the place of a pass of the same name.
    #[must_use]
    pub fn with_pass(mut self, system: &str, name: &str, source: &str) -> Self {
        let pass = format!("{system}/{name}");
        let paths: BTreeSet<String> = self.modules.iter().map(|module| module.path.clone()).collect();
        let default = Permutation { name: "default".to_owned(), definitions: Default::default(), line: 0 };
        self.passes.retain(|other| other.name != pass);
        self.permutations.insert(pass.clone(), vec![default]);
        self.passes.push(PassSource {
            name: pass,
            file: format!("{system}/passes/{name}.wgsl"),
            source: source.to_owned(),
            imports: used(source, &paths, ""),
        });
        self
    }

    /// From text in memory: `(file, source)` of modules in order and of passes, and permutations.
    #[cfg(test)]
    pub(crate) fn from_text(
        modules: &[(&str, &str)],
        passes: &[(&str, &str)],
        systems: &[(&str, &str)],
    ) -> Self {
        let modules = modules.iter().map(|(file, source)| ModuleSource {
            path: import_path(source).unwrap_or_default(),
            file: (*file).to_owned(),
            source: (*source).to_owned(),
            imports: Vec::new(),
        });
        let passes = passes.iter().map(|(file, source)| {
            let name = file.replace("/passes/", "/").replace(".wgsl", "");
            (name, (*file).to_owned(), (*source).to_owned())
        });
        let mut library = Self::new(modules.collect(), passes.collect(), BTreeMap::new(), None);
        for (system, text) in systems {
            match permutations::parse(&format!("{system}/permutations"), text) {
                Ok(entries) => library.list(system, entries),
                Err(error) => library.unlisted.push(listing_error(&error)),
            }
        }
        library.complete();
        library
    }

    pub(crate) fn new(
        mut modules: Vec<ModuleSource>,
        passes: Vec<(String, String, String)>,
        permutations: BTreeMap<String, Vec<Permutation>>,
        root: Option<PathBuf>,
    ) -> Self {
        let paths: BTreeSet<String> = modules.iter().map(|module| module.path.clone()).collect();
        for module in &mut modules {
            module.imports = used(&module.source, &paths, &module.path);
        }
        let passes = passes
            .into_iter()
            .map(|(name, file, source)| {
                let imports = used(&source, &paths, "");
                PassSource { name, file, source, imports }
            })
            .collect();
        Self {
            modules,
            passes,
            permutations,
            unlisted: Vec::new(),
            root,
            #[cfg(feature = "command")]
            foreign: None,
        }
    }

    fn list(&mut self, system: &str, entries: Vec<permutations::Entry>) {
        for entry in entries {
            let name = format!("{system}/{}", entry.pass);
            if !self.passes.iter().any(|pass| pass.name == name) {
                self.unlisted.push((
                    Location::line(format!("{system}/permutations"), entry.line),
                    format!("there is no {system}/passes/{}.wgsl", entry.pass),
                ));
            }
            self.permutations.insert(name, entry.permutations);
        }
    }

    /// Gives a pass that no file lists the permutation `default`, and remembers that as a finding.
    fn complete(&mut self) {
        for pass in &self.passes {
            if self.permutations.contains_key(&pass.name) {
                continue;
            }
            let (system, short) = pass.name.split_once('/').unwrap_or(("", &pass.name));
            self.unlisted.push((
                Location::file(format!("{system}/permutations")),
                format!("pass `{short}` is not listed; it needs at least `+ default:`"),
            ));
            let default =
                Permutation { name: "default".to_owned(), definitions: Default::default(), line: 0 };
            self.permutations.insert(pass.name.clone(), vec![default]);
        }
    }

    /// Every module, each after those that it imports.
    pub fn modules(&self) -> &[ModuleSource] {
        &self.modules
    }

    /// Every pass.
    pub fn passes(&self) -> &[PassSource] {
        &self.passes
    }

    /// The folder that the library was read from; none for the built-in one.
    pub fn root(&self) -> Option<&Path> {
        self.root.as_deref()
    }

    /// A pass by its name, `<system>/<pass>`.
    ///
    /// # Errors
    /// An unknown pass; the error lists the known ones.
    pub fn pass(&self, name: &str) -> Result<&PassSource, Error> {
        self.passes.iter().find(|pass| pass.name == name).ok_or_else(|| Error::UnknownPass {
            name: name.to_owned(),
            known: self.passes.iter().map(|pass| pass.name.clone()).collect(),
        })
    }

    /// A module by its import path.
    ///
    /// # Errors
    /// An unknown module; the error lists the known ones.
    pub fn module(&self, path: &str) -> Result<&ModuleSource, Error> {
        self.modules.iter().find(|module| module.path == path).ok_or_else(|| Error::UnknownModule {
            path: path.to_owned(),
            known: self.modules.iter().map(|module| module.path.clone()).collect(),
        })
    }

    /// The permutations of a pass; at least `default`.
    ///
    /// # Errors
    /// An unknown pass.
    pub fn permutations(&self, pass: &str) -> Result<&[Permutation], Error> {
        let pass = self.pass(pass)?;
        Ok(self.permutations.get(&pass.name).map(Vec::as_slice).unwrap_or_default())
    }

    /// One permutation of a pass.
    ///
    /// # Errors
    /// An unknown pass or permutation; the error lists the known ones.
    pub fn permutation(&self, pass: &str, name: &str) -> Result<&Permutation, Error> {
        let permutations = self.permutations(pass)?;
        permutations.iter().find(|permutation| permutation.name == name).ok_or_else(|| {
            Error::UnknownPermutation {
                pass: pass.to_owned(),
                name: name.to_owned(),
                known: permutations.iter().map(|permutation| permutation.name.clone()).collect(),
            }
        })
    }

    /// The modules that `imports` leads to, in the order of the library.
    pub(crate) fn closure(&self, imports: &[String]) -> Vec<&ModuleSource> {
        let mut wanted: BTreeSet<&str> = BTreeSet::new();
        let mut open: Vec<&str> = imports.iter().map(String::as_str).collect();
        while let Some(path) = open.pop() {
            if wanted.insert(path)
                && let Some(module) = self.modules.iter().find(|module| module.path == path)
            {
                open.extend(module.imports.iter().map(String::as_str));
            }
        }
        self.modules.iter().filter(|module| wanted.contains(module.path.as_str())).collect()
    }

    /// Paths of the modules that a source imports with `definitions`, and those that these import.
    // What is checked is part of the command.
    #[cfg_attr(not(feature = "command"), allow(dead_code))]
    pub(crate) fn reached(&self, source: &str, definitions: &Definitions) -> BTreeSet<String> {
        let paths: BTreeSet<String> = self.modules.iter().map(|module| module.path.clone()).collect();
        let mut reached = BTreeSet::new();
        let mut open = vec![source];
        while let Some(source) = open.pop() {
            for path in used(&imports::active(source, definitions), &paths, "") {
                if let Some(module) = self.modules.iter().find(|module| module.path == path)
                    && reached.insert(path)
                {
                    open.push(&module.source);
                }
            }
        }
        reached
    }

    /// Whether a path is the beginning of paths of modules, which a tree of others may import.
    pub(crate) fn is_namespace(&self, path: &str) -> bool {
        let begins =
            |module: &ModuleSource| module.path.strip_prefix(path).is_some_and(|rest| rest.starts_with("::"));
        self.is_foreign() && self.modules.iter().any(begins)
    }

    /// Whether the library is a tree that is not laid out as Airlight is.
    fn is_foreign(&self) -> bool {
        #[cfg(feature = "command")]
        return self.foreign.is_some();
        #[cfg(not(feature = "command"))]
        false
    }

    /// Whether a file is read by no composer.
    #[cfg(feature = "command")]
    pub(crate) fn is_plain(&self, file: &str) -> bool {
        self.foreign.as_ref().is_some_and(|foreign| foreign.plain.contains(file))
    }

    /// The text of a file of the library.
    pub(crate) fn text(&self, file: &str) -> Option<&str> {
        let module = self.modules.iter().find(|module| module.file == file);
        let pass = self.passes.iter().find(|pass| pass.file == file);
        module.map(|m| m.source.as_str()).or_else(|| pass.map(|p| p.source.as_str()))
    }
}

/// The module that an imported path belongs to: itself, or all but its last part.
pub(crate) fn resolve(path: &str, known: impl Fn(&str) -> bool) -> Option<&str> {
    if known(path) {
        return Some(path);
    }
    path.rsplit_once("::").map(|(module, _)| module).filter(|module| known(module))
}

/// Modules that a source imports or names in full, but for itself.
pub(crate) fn used(source: &str, paths: &BTreeSet<String>, own: &str) -> Vec<String> {
    let known = |path: &str| paths.contains(path);
    let mut modules: BTreeSet<String> = imports::declared(source)
        .iter()
        .filter_map(|import| resolve(&import.path, known).map(str::to_owned))
        .collect();
    let (_, named, _) = naga_oil::compose::get_preprocessor_data(source);
    modules.extend(named.into_iter().map(|import| import.import).filter(|path| known(path)));
    modules.remove(own);
    modules.into_iter().collect()
}

/// The path in `#define_import_path`.
pub(crate) fn import_path(source: &str) -> Option<String> {
    let text = crate::scan::without_comments(source);
    text.lines()
        .find_map(|line| line.trim().strip_prefix("#define_import_path"))
        .and_then(|rest| rest.split_whitespace().next())
        .map(str::to_owned)
}

fn listing_error(error: &Error) -> (Location, String) {
    (error.location().cloned().unwrap_or_else(|| Location::file("permutations")), error.message())
}

#[cfg(all(test, feature = "command"))]
mod tests;
