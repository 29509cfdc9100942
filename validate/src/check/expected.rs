// SPDX-License-Identifier: MIT OR Apache-2.0
//! Failures that are known: what a back end cannot write, and why.
//!
//! An entry is narrow, and one that no longer fails is a finding, so that the list stays true.

use crate::{Error, Location, check::Backend};

/// A line of the list: `pass[:permutation][#entry_point] backend reason`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Expected {
    /// The pass.
    pub pass: String,
    /// Its permutation; any where none is named.
    pub permutation: Option<String>,
    /// The entry point; any where none is named.
    pub entry_point: Option<String>,
    /// What cannot write it.
    pub backend: Backend,
    /// Why.
    pub reason: String,
    /// Line of the list, from 1.
    pub line: u32,
}

/// Where the shipped list is, for reports.
pub const FILE: &str = "validate/expected_failures";

/// The list that ships with Airlight.
///
/// # Errors
/// A malformed line.
pub fn shipped() -> Result<Vec<Expected>, Error> {
    parse(include_str!("../../expected_failures"))
}

/// Reads a list.
///
/// # Errors
/// A malformed line.
pub fn parse(text: &str) -> Result<Vec<Expected>, Error> {
    let mut list = Vec::new();
    for (line, content) in (1..).zip(text.lines()) {
        let content = content.trim();
        if content.is_empty() || content.starts_with("# ") || content == "#" {
            continue;
        }
        let wrong = |message: &str| Error::Permutations {
            location: Location::line(FILE, line),
            message: message.to_owned(),
        };
        let mut words = content.splitn(3, char::is_whitespace);
        let (Some(subject), Some(backend), Some(reason)) = (words.next(), words.next(), words.next()) else {
            return Err(wrong("expected `pass[:permutation][#entry_point] backend reason`"));
        };
        let Some(backend) = Backend::ALL.into_iter().find(|known| known.name() == backend) else {
            return Err(wrong("the back end is spirv, msl, hlsl or glsl"));
        };
        let (subject, entry_point) = split(subject, '#');
        let (pass, permutation) = split(subject, ':');
        list.push(Expected {
            pass: pass.to_owned(),
            permutation,
            entry_point,
            backend,
            reason: reason.trim().to_owned(),
            line,
        });
    }
    Ok(list)
}

fn split(text: &str, at: char) -> (&str, Option<String>) {
    match text.split_once(at) {
        Some((head, tail)) => (head, Some(tail.to_owned())),
        None => (text, None),
    }
}

/// What came of writing one entry point of one permutation.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The entry point.
    pub entry_point: String,
    /// What wrote it.
    pub backend: Backend,
    /// What was wrong.
    pub error: Option<String>,
}

/// A judgement on the outcomes of one permutation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// A failure that the list does not have.
    Unexpected {
        /// The entry point.
        entry_point: String,
        /// What failed.
        backend: Backend,
        /// What was wrong.
        message: String,
    },
    /// An entry of the list that did not fail.
    Passed(Expected),
}

/// Compares the outcomes of a permutation with the list.
pub fn judge(list: &[Expected], pass: &str, permutation: &str, outcomes: &[Outcome]) -> Vec<Verdict> {
    let matches = |entry: &Expected, outcome: &Outcome| {
        entry.backend == outcome.backend
            && entry.entry_point.as_ref().is_none_or(|name| *name == outcome.entry_point)
    };
    let about: Vec<&Expected> = list
        .iter()
        .filter(|entry| entry.pass == pass)
        .filter(|entry| entry.permutation.as_ref().is_none_or(|name| name == permutation))
        .collect();
    let mut verdicts = Vec::new();
    for outcome in outcomes {
        if let Some(message) = &outcome.error
            && !about.iter().any(|entry| matches(entry, outcome))
        {
            verdicts.push(Verdict::Unexpected {
                entry_point: outcome.entry_point.clone(),
                backend: outcome.backend,
                message: message.clone(),
            });
        }
    }
    for entry in about {
        let failed = |outcome: &Outcome| matches(entry, outcome) && outcome.error.is_some();
        if !outcomes.iter().any(failed) {
            verdicts.push(Verdict::Passed(entry.clone()));
        }
    }
    verdicts
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn outcome(entry_point: &str, backend: Backend, error: Option<&str>) -> Outcome {
        Outcome { entry_point: entry_point.into(), backend, error: error.map(str::to_owned) }
    }

    #[test]
    fn the_list_is_read() {
        let list = parse("# head\n\na/b:c#d glsl two words\na/b hlsl why\n").unwrap();
        assert_eq!(list[0].pass, "a/b");
        assert_eq!(list[0].permutation.as_deref(), Some("c"));
        assert_eq!(list[0].entry_point.as_deref(), Some("d"));
        assert_eq!((list[0].backend, list[0].reason.as_str()), (Backend::Glsl, "two words"));
        assert_eq!((list[1].line, list[1].permutation.as_deref()), (4, None));
        let error = parse("a/b glsl why\na/b dxil why\n").unwrap_err();
        assert_eq!(error.location().unwrap().line, Some(2));
        assert!(parse("a/b glsl\n").is_err());
    }

    #[test]
    fn expected_failures_pass_and_others_do_not() {
        let list = parse("a/b#one glsl why\n").unwrap();
        let outcomes = [
            outcome("one", Backend::Glsl, Some("no")),
            outcome("two", Backend::Glsl, None),
            outcome("one", Backend::Msl, None),
        ];
        assert_eq!(judge(&list, "a/b", "default", &outcomes), []);
        let outcomes = [
            outcome("one", Backend::Glsl, Some("no")),
            outcome("two", Backend::Glsl, Some("neither")),
            outcome("one", Backend::Msl, Some("nor")),
        ];
        let verdicts = judge(&list, "a/b", "default", &outcomes);
        assert_eq!(verdicts.len(), 2);
        assert!(verdicts.iter().all(|verdict| matches!(verdict, Verdict::Unexpected { .. })));
    }

    #[test]
    fn an_unexpected_pass_is_reported_for_its_permutation_only() {
        let list = parse("a/b:half glsl why\n").unwrap();
        let fine = [outcome("one", Backend::Glsl, None)];
        assert_eq!(judge(&list, "a/b", "half", &fine), [Verdict::Passed(list[0].clone())]);
        assert_eq!(judge(&list, "a/b", "default", &fine), []);
        assert_eq!(judge(&list, "a/c", "half", &fine), []);
    }

    #[test]
    fn the_shipped_list_is_well_formed_and_about_shipped_passes() {
        let library = crate::Library::builtin();
        for entry in shipped().unwrap() {
            let permutation = entry.permutation.as_deref().unwrap_or("default");
            library.permutation(&entry.pass, permutation).unwrap();
        }
    }
}
