// SPDX-License-Identifier: MIT OR Apache-2.0
//! The `permutations` file of a system: each pass, then its named sets of definitions.
//!
//! ```text
//! # a comment
//! filter
//! + default: BASES=32
//! + rgba16float: BASES=32 RGBA16FLOAT
//! ```

use crate::{Definitions, Error, Location};

/// A shipped set of definitions of a pass.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Permutation {
    /// Its name; every pass has one called `default`.
    pub name: String,
    /// What it defines.
    pub definitions: Definitions,
    /// Its line in the permutations file, from 1; 0 where the file does not list the pass.
    pub line: u32,
}

/// A pass in a permutations file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Entry {
    pub pass: String,
    pub line: u32,
    pub permutations: Vec<Permutation>,
}

/// Reads a permutations file; `file` is what errors call it.
pub(crate) fn parse(file: &str, text: &str) -> Result<Vec<Entry>, Error> {
    let entries = read(file, text, is_name)?;
    for entry in &entries {
        if !entry.permutations.iter().any(|permutation| permutation.name == "default") {
            return Err(Error::Permutations {
                location: Location::line(file, entry.line),
                message: format!("pass `{}` has no permutation `default`", entry.pass),
            });
        }
    }
    Ok(entries)
}

/// Reads a file that lists files and import paths instead of passes; none of them needs a `default`.
// What is checked is part of the command.
#[cfg_attr(not(feature = "command"), allow(dead_code))]
pub(crate) fn parse_paths(file: &str, text: &str) -> Result<Vec<Entry>, Error> {
    read(file, text, |_| true)
}

fn read(file: &str, text: &str, is_subject: impl Fn(&str) -> bool) -> Result<Vec<Entry>, Error> {
    let mut entries: Vec<Entry> = Vec::new();
    for (line, content) in (1..).zip(text.lines()) {
        let content = content.split('#').next().unwrap_or_default().trim();
        if content.is_empty() {
            continue;
        }
        let wrong = |message: String| Error::Permutations { location: Location::line(file, line), message };
        let Some(permutation) = content.strip_prefix('+') else {
            if !is_subject(content) {
                return Err(wrong(format!(
                    "`{content}` is neither a pass name nor `+ name: DEFINITION DEFINITION=VALUE`"
                )));
            }
            if let Some(earlier) = entries.iter().find(|entry| entry.pass == content) {
                let earlier = earlier.line;
                return Err(wrong(format!("pass `{content}` is already on line {earlier}")));
            }
            entries.push(Entry { pass: content.to_owned(), line, permutations: Vec::new() });
            continue;
        };
        let Some(entry) = entries.last_mut() else {
            return Err(wrong("a permutation before the first pass name".to_owned()));
        };
        let Some((name, definitions)) = permutation.split_once(':') else {
            return Err(wrong(format!("`{content}` lacks the `:` after the permutation's name")));
        };
        let name = name.trim();
        if !is_name(name) {
            return Err(wrong(format!(
                "`{name}` is no permutation name: lower-case letters, digits and `_`"
            )));
        }
        if entry.permutations.iter().any(|permutation| permutation.name == name) {
            let pass = &entry.pass;
            return Err(wrong(format!("pass `{pass}` already has a permutation `{name}`")));
        }
        let definitions = definitions.parse().map_err(|error: Error| wrong(error.to_string()))?;
        entry.permutations.push(Permutation { name: name.to_owned(), definitions, line });
    }
    Ok(entries)
}

fn is_name(text: &str) -> bool {
    !text.is_empty() && text.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_')
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn passes_and_permutations_are_read() {
        let text =
            "# head\nfilter\n+ default: BASES=32 # tail\n+ half: BASES=32 HALF\n\nslices\n+ default:\n";
        let entries = parse("s/permutations", text).unwrap();
        assert_eq!(entries.len(), 2);
        assert_eq!(entries[0].pass, "filter");
        assert_eq!(entries[0].permutations.len(), 2);
        assert_eq!(entries[0].permutations[1].name, "half");
        assert_eq!(entries[0].permutations[1].line, 4);
        assert_eq!(entries[0].permutations[1].definitions, Definitions::new().set("BASES", 32).flag("HALF"));
        assert!(entries[1].permutations[0].definitions.is_empty());
    }

    #[test]
    fn errors_name_file_and_line() {
        let cases = [
            ("+ default:\n", 1, "before the first pass"),
            ("filter\n+ default\n", 2, "lacks the `:`"),
            ("filter\n+ default: A=x\n", 2, "A=x"),
            ("filter\n+ default:\n+ default: A\n", 3, "already has"),
            ("filter\n+ default:\nfilter\n+ default:\n", 3, "already on line 1"),
            ("filter\n+ half: A\n", 1, "no permutation `default`"),
            ("filter default\n", 1, "neither a pass name"),
            ("filter\n+ De fault:\n", 2, "no permutation name"),
        ];
        for (text, line, part) in cases {
            let error = parse("s/permutations", text).unwrap_err();
            assert_eq!(error.location(), Some(&Location::line("s/permutations", line)), "{text}");
            assert!(error.message().contains(part), "{text}: {error}");
        }
    }
}
