// SPDX-License-Identifier: MIT OR Apache-2.0
//! Every module alone and every pass in every permutation through every compiler at hand.

mod backends;
mod catalogue;
mod expected;
mod form;
mod limits;
pub(crate) mod lint;
mod origin;
mod plain;
mod report;
mod tools;
mod unit;
pub(crate) mod watch;

pub use backends::Backend;
pub use catalogue::{LINTS, Lint};
pub use expected::{Expected, Verdict, judge, shipped as shipped_expected_failures};
pub use limits::{Excess, Usage, excesses, implicit_padding, usage, violations};
pub use report::{Finding, Format, Report, Severity};
pub use tools::Tool;

use crate::{Definitions, Error, Library, Location, ModuleSource};
use std::{any::Any, collections::BTreeSet, ffi::OsString};
use unit::{Context, Subject};

/// What to check beside the shaders themselves.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Programs that must be on the path.
    pub require: Vec<Tool>,
    /// Folders to look for programs in, joined as in `PATH`; `PATH` itself where there is none.
    pub path: Option<OsString>,
    /// Names of [`LINTS`] whose findings are left out.
    pub allow: Vec<String>,
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
            None => {
                let less = match tool {
                    Tool::Tint => "; `uniformity` sees the plainest cases only without it",
                    _ => "",
                };
                report.skipped.push(format!("{tool}: not on the PATH; {}{less}", tool.remedy()));
            }
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
    let mut expected = Vec::new();
    match &library.foreign {
        Some(foreign) => {
            report.findings.extend(foreign.findings.iter().cloned());
            report.skipped.extend(foreign.skipped.iter().cloned());
        }
        None => {
            match expected::shipped() {
                Ok(list) => expected = list,
                Err(error) => report.findings.push(Finding::of("expected-failures", &error)),
            }
            report.findings.extend(lint::layout(library));
        }
    }
    let subjects = subjects(library);
    let modules: BTreeSet<&str> = subjects.iter().filter_map(Subject::module).collect();
    report.modules = modules.len();
    report.permutations = subjects.iter().filter(|subject| subject.module().is_none()).count();
    let texts = lint_texts(library, &subjects);
    report.findings.extend(lint::shaders(library, texts.into_iter()));

    let context = Context { library: library.clone(), expected, tools: found, folder };
    let found = watch::run_all(subjects, context, watch::PATIENCE);
    let mut found: Vec<Finding> = found.into_iter().flatten().collect();
    name_unused(library, &mut found);
    report.findings.append(&mut found);
    // What is not there cannot be used either.
    let place = |finding: &Finding| (finding.file.clone(), finding.line, finding.column);
    let absent: BTreeSet<_> =
        report.findings.iter().filter(|finding| finding.check == "unresolved-import").map(place).collect();
    report.findings.retain(|finding| finding.check != "unused-import" || !absent.contains(&place(finding)));
    report.findings.retain(|finding| !options.allow.contains(&finding.check));
    report.tidy(library.root());
    if library.foreign.is_some() {
        report.sort();
    }
    Ok(report)
}

/// Files with the definitions that they are checked with; what cannot be checked is still read.
fn lint_texts<'a>(library: &'a Library, subjects: &'a [Subject]) -> Vec<(&'a str, &'a Definitions)> {
    let mut texts = Vec::new();
    for subject in subjects {
        let file = match subject {
            Subject::Module { path, .. } => library.module(path).map(|module| module.file.as_str()),
            Subject::Pass { name, .. } => library.pass(name).map(|pass| pass.file.as_str()),
        };
        texts.extend(file.ok().map(|file| (file, subject.definitions())));
    }
    if let Some(foreign) = &library.foreign {
        texts.extend(foreign.unchecked.iter().map(|file| (file.as_str(), &foreign.base)));
    }
    texts
}

/// Gives an error its own name that only shows where the module is checked alone: what imports the
/// module composes, since the composer drops what is not used.
fn name_unused(library: &Library, findings: &mut [Finding]) {
    let reached: BTreeSet<&str> = library
        .passes()
        .iter()
        .flat_map(|pass| library.closure(&pass.imports))
        .map(|module| module.file.as_str())
        .collect();
    let place = |finding: &Finding| (finding.file.clone(), finding.line, finding.column);
    let in_pass: BTreeSet<_> =
        findings.iter().filter(|f| f.check == "compose" && f.permutation.is_some()).map(place).collect();
    for finding in findings.iter_mut().filter(|finding| finding.check == "compose") {
        if reached.contains(finding.file.as_str()) && !in_pass.contains(&place(finding)) {
            finding.check = "unused-broken".to_owned();
            finding.message +=
                "; no shader that imports it shows this, since the composer drops what is not used";
        }
    }
}

/// Modules with each set of definitions that a permutation gives them, then the permutations.
fn subjects(library: &Library) -> Vec<Subject> {
    let mut subjects = Vec::new();
    let is_checked = |file: &str| library.foreign.as_ref().is_none_or(|foreign| foreign.is_checked(file));
    for (module, sets) in definitions_of_modules(library) {
        // With an entry point it is checked as a shader.
        let is_shader = library.foreign.is_some() && library.pass(&module.file).is_ok();
        if is_shader || !is_checked(&module.file) {
            continue;
        }
        for definitions in sets {
            subjects.push(Subject::Module { path: module.path.clone(), definitions });
        }
    }
    for pass in library.passes().iter().filter(|pass| is_checked(&pass.file)) {
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

/// Every module with the sets of definitions that permutations give it; one without any where none imports it.
pub(crate) fn definitions_of_modules(library: &Library) -> Vec<(&ModuleSource, BTreeSet<Definitions>)> {
    // Every permutation, and the modules that it reaches.
    let mut importers = Vec::new();
    for pass in library.passes() {
        for permutation in library.permutations.get(&pass.name).into_iter().flatten() {
            let definitions = &permutation.definitions;
            importers.push((definitions, library.reached(&pass.source, definitions)));
        }
    }
    let sets = |module: &ModuleSource| {
        let own = library.permutations.get(&module.path).filter(|_| library.foreign.is_some());
        if let Some(own) = own {
            return own.iter().map(|permutation| permutation.definitions.clone()).collect();
        }
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
            let base = library.foreign.as_ref().map(|foreign| foreign.base.iter());
            sets.insert(base.into_iter().flatten().filter(|(name, _)| reads.contains(*name)).collect());
        }
        sets
    };
    library.modules().iter().map(|module| (module, sets(module))).collect()
}

/// What a panic said.
pub(crate) fn panic_text(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "?".to_owned())
}

#[cfg(test)]
mod tests;
