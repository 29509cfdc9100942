// SPDX-License-Identifier: MIT OR Apache-2.0
//! Every name that a finding may carry, and what there is to say about it.

mod compilers;
mod shaders;
mod trees;

use super::Severity;
use std::fmt::Write as _;

/// A kind of finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lint {
    /// Its name, which stays the same from version to version.
    pub name: &'static str,
    /// How bad most findings of the name are.
    pub severity: Severity,
    /// What it is, in a line.
    pub what: &'static str,
    /// Why it is a mistake, and why nothing else says so.
    pub why: &'static str,
    /// How to mend it.
    pub mend: &'static str,
    /// What it is about, in a few lines of code or text.
    pub example: &'static str,
}

/// Every kind of finding, by groups: reading a tree, compilers, shaders.
pub const LINTS: &[&[Lint]] = &[trees::LINTS, compilers::LINTS, shaders::LINTS];

impl Lint {
    /// All of them in order.
    pub fn all() -> impl Iterator<Item = &'static Self> {
        LINTS.iter().copied().flatten()
    }

    /// The one of a name.
    pub fn named(name: &str) -> Option<&'static Self> {
        Self::all().find(|lint| lint.name == name)
    }

    /// Everything there is to say.
    pub fn explanation(&self) -> String {
        let Self { name, severity, what, why, mend, example } = self;
        let indented: String = example.lines().map(|line| format!("    {line}\n")).collect();
        format!(
            "{name} ({}): {what}\n\nWhy: {why}\n\nMend: {mend}\n\nExample:\n\n{indented}",
            severity.name()
        )
    }

    /// All names with a line each.
    pub fn list() -> String {
        let width = Self::all().map(|lint| lint.name.len()).max().unwrap_or(0);
        let mut text = String::new();
        for lint in Self::all() {
            // A string never fails to be written to.
            let _ = writeln!(text, "{:width$}  {:7}  {}", lint.name, lint.severity.name(), lint.what);
        }
        text
    }

    /// The table of the documentation.
    pub fn table() -> String {
        let mut text = "| name | severity | what | mend |\n|---|---|---|---|\n".to_owned();
        for lint in Self::all() {
            let escaped = |text: &str| text.replace('|', "\\|");
            let (name, severity) = (lint.name, lint.severity.name());
            // A string never fails to be written to.
            let _ =
                writeln!(text, "| `{name}` | {severity} | {} | {} |", escaped(lint.what), escaped(lint.mend));
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn names_are_short_and_different_and_all_is_said() {
        let mut names = BTreeSet::new();
        for lint in Lint::all() {
            assert!(names.insert(lint.name), "{}", lint.name);
            assert!(lint.name.len() <= 20 && lint.name.chars().all(|c| c.is_ascii_lowercase() || c == '-'));
            for text in [lint.what, lint.why, lint.mend, lint.example] {
                assert!(!text.is_empty(), "{}", lint.name);
            }
            assert!(
                !lint.what.ends_with('.') && lint.why.ends_with('.') && lint.mend.ends_with('.'),
                "{}",
                lint.name
            );
            assert!(
                Lint::list().contains(lint.name)
                    && lint.explanation().contains(lint.example.lines().next().unwrap_or(""))
            );
        }
    }

    /// Every name that the sources give to a finding is explained.
    #[test]
    fn every_name_in_the_sources_is_explained() {
        let sources = [
            include_str!("../lint/mod.rs"),
            include_str!("../lint/directives.rs"),
            include_str!("../lint/names.rs"),
            include_str!("../lint/imports.rs"),
            include_str!("../lint/constants.rs"),
            include_str!("../lint/index.rs"),
            include_str!("../lint/operators.rs"),
            include_str!("../lint/control.rs"),
            include_str!("../unit.rs"),
            include_str!("../form.rs"),
            include_str!("../plain.rs"),
            include_str!("../watch.rs"),
            include_str!("../../tree/mod.rs"),
            include_str!("../../tree/walk.rs"),
            include_str!("../../tree/resolve.rs"),
        ];
        let mut seen = 0;
        for source in sources {
            for mark in [
                "Severity::Error, \"",
                "Severity::Warning, \"",
                "location, \"",
                "line), \"",
                "location(source)), \"",
            ] {
                for (at, _) in source.match_indices(mark) {
                    let name = source[at + mark.len()..].split('"').next().unwrap_or_default();
                    assert!(Lint::named(name).is_some(), "{name}");
                    seen += 1;
                }
            }
        }
        assert!(seen > 20, "{seen}");
    }
}
