// SPDX-License-Identifier: MIT OR Apache-2.0
//! Every module alone and every pass in every permutation through every compiler at hand.

mod backends;
mod expected;
mod limits;
mod lint;
mod report;
mod tools;
mod unit;

pub use backends::Backend;
pub use expected::{Expected, Verdict, judge, shipped as shipped_expected_failures};
pub use limits::{Excess, Usage, excesses, implicit_padding, usage, violations};
pub use report::{Finding, Format, Report, Severity};
pub use tools::Tool;

use crate::{Definitions, Error, Library, Location, ModuleSource};
use std::{
    any::Any,
    collections::BTreeSet,
    ffi::OsString,
    sync::{
        Mutex,
        atomic::{AtomicUsize, Ordering},
    },
    thread,
};
use unit::{Context, Subject};

/// What to check beside the shaders themselves.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Programs that must be on the path.
    pub require: Vec<Tool>,
    /// Folders to look for programs in, joined as in `PATH`; `PATH` itself where there is none.
    pub path: Option<OsString>,
}

/// Checks a library.
///
/// # Errors
/// Only what has nothing to do with the shaders: a temporary folder that cannot be made.
pub fn run(library: &Library, options: &Options) -> Result<Report, Error> {
    let folder = tempfile::tempdir().map_err(|source| Error::Read { path: std::env::temp_dir(), source })?;
    let mut report = Report::default();
    let mut found = Vec::new();
    let path = options.path.clone().or_else(|| std::env::var_os("PATH"));
    for tool in Tool::ALL {
        match tools::find(tool, path.as_deref()) {
            Some(path) => found.push((tool, path)),
            None => report.skipped.push(format!("{tool}: not on the PATH; {}", tool.remedy())),
        }
        if options.require.contains(&tool) && !found.iter().any(|(there, _)| *there == tool) {
            report.findings.push(Finding::new(
                Severity::Error,
                Location::file(""),
                tool.name(),
                format!("{tool} is required and not on the PATH; {}", tool.remedy()),
            ));
        }
    }
    let expected = match expected::shipped() {
        Ok(expected) => expected,
        Err(error) => {
            report.findings.push(Finding::of("expected-failures", &error));
            Vec::new()
        }
    };
    report.findings.extend(lint::lint(library));

    let subjects = subjects(library);
    report.modules = library.modules().len();
    report.permutations = subjects.iter().filter(|subject| matches!(subject, Subject::Pass { .. })).count();
    let context = Context { library, expected: &expected, tools: &found, folder: folder.path() };
    report.findings.extend(run_all(&subjects, &context));
    report.tidy(library.root());
    Ok(report)
}

/// Every subject on a few threads; findings in the order of the subjects.
fn run_all(subjects: &[Subject], context: &Context) -> Vec<Finding> {
    let next = AtomicUsize::new(0);
    let results = Mutex::new(Vec::new());
    let threads = thread::available_parallelism().map_or(2, usize::from).min(8);
    thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let Some(subject) = subjects.get(index) else { break };
                    let findings = unit::check(context, subject, index);
                    // A poisoned lock still holds what the others found.
                    let mut results = results.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
                    results.push((index, findings));
                }
            });
        }
    });
    let mut results = results.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    results.sort_by_key(|(index, _)| *index);
    results.into_iter().flat_map(|(_, findings)| findings).collect()
}

/// Modules with each set of definitions that a permutation gives them, then the permutations.
fn subjects(library: &Library) -> Vec<Subject> {
    let mut subjects = Vec::new();
    for (module, sets) in definitions_of_modules(library) {
        for definitions in sets {
            subjects.push(Subject::Module { path: module.path.clone(), definitions });
        }
    }
    for pass in library.passes() {
        for permutation in library.permutations.get(&pass.name).into_iter().flatten() {
            subjects.push(Subject::Pass {
                name: pass.name.clone(),
                permutation: permutation.name.clone(),
                definitions: permutation.definitions.clone(),
            });
        }
    }
    subjects
}

/// Every permutation with the modules that it reaches.
fn importers(library: &Library) -> Vec<(&Definitions, BTreeSet<String>)> {
    let mut importers = Vec::new();
    for pass in library.passes() {
        for permutation in library.permutations.get(&pass.name).into_iter().flatten() {
            let definitions = &permutation.definitions;
            importers.push((definitions, library.reached(&pass.source, definitions)));
        }
    }
    importers
}

/// The sets of definitions that permutations give a module; the empty one where none imports it.
fn sets(
    library: &Library,
    importers: &[(&Definitions, BTreeSet<String>)],
    module: &ModuleSource,
) -> BTreeSet<Definitions> {
    let mut reads = BTreeSet::new();
    for other in library.closure(std::slice::from_ref(&module.path)) {
        reads.extend(lint::used_definitions(&other.source).into_keys());
    }
    let mut sets: BTreeSet<Definitions> = importers
        .iter()
        .filter(|(_, reached)| reached.contains(&module.path))
        .map(|(definitions, _)| definitions.iter().filter(|(name, _)| reads.contains(*name)).collect())
        .collect();
    if sets.is_empty() {
        sets.insert(Definitions::new());
    }
    sets
}

/// Every module with the sets of definitions that permutations give it.
pub(crate) fn definitions_of_modules(library: &Library) -> Vec<(&ModuleSource, BTreeSet<Definitions>)> {
    let importers = importers(library);
    library.modules().iter().map(|module| (module, sets(library, &importers, module))).collect()
}

/// What a panic said.
pub(crate) fn panic_text(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "?".to_owned())
}

#[cfg(test)]
mod tests;
