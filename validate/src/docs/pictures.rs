// SPDX-License-Identifier: MIT OR Apache-2.0
//! Which picture of the book shows what a module, pass or system does.

use std::collections::BTreeMap;

/// Pictures with captions, by `system/name` of a module or pass, or by the name of a system.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Pictures {
    by_name: BTreeMap<String, (String, String)>,
}

impl Pictures {
    /// Reads lines `NAME = FILE | CAPTION`; `#` begins a comment.
    ///
    /// # Errors
    /// The first line that is none of these, or that says a name again, with its number.
    pub fn parse(text: &str) -> Result<Self, String> {
        let mut by_name = BTreeMap::new();
        for (number, line) in (1..).zip(text.lines()) {
            let line = line.trim();
            if line.is_empty() || line.starts_with('#') {
                continue;
            }
            let entry = line.split_once(" = ").and_then(|(name, rest)| Some((name, rest.split_once(" | ")?)));
            let Some((name, (file, caption))) = entry else {
                return Err(format!("line {number}: `{line}` is not `NAME = FILE | CAPTION`"));
            };
            let before =
                by_name.insert(name.trim().to_owned(), (file.trim().to_owned(), caption.trim().to_owned()));
            if before.is_some() {
                return Err(format!("line {number}: `{name}` has a picture already"));
            }
        }
        Ok(Self { by_name })
    }

    /// File and caption for `system/name`, else those of the system.
    pub fn of(&self, name: &str) -> Option<(&str, &str)> {
        let system = name.split('/').next().unwrap_or(name);
        let found = self.by_name.get(name).or_else(|| self.by_name.get(system))?;
        Some((&found.0, &found.1))
    }

    /// Names and files, in the order of the names.
    pub fn entries(&self) -> impl Iterator<Item = (&str, &str)> {
        self.by_name.iter().map(|(name, (file, _))| (name.as_str(), file.as_str()))
    }

    /// The picture as Markdown for a page `depth` folders below that of the book.
    pub(super) fn markdown(&self, name: &str, depth: usize) -> String {
        let Some((file, caption)) = self.of(name) else { return String::new() };
        format!("![{caption}]({}pictures/{file})\n\n*{caption}*\n\n", "../".repeat(depth))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn names_fall_back_on_their_system() {
        let pictures = Pictures::parse("# c\ncore = a.png | A.\n\ncore/x = b.png | B.\n").unwrap();
        assert_eq!(pictures.of("core/x"), Some(("b.png", "B.")));
        assert_eq!(pictures.of("core/y"), Some(("a.png", "A.")));
        assert_eq!(pictures.of("other/y"), None);
        assert!(Pictures::parse("core a.png").unwrap_err().contains("line 1"));
        assert!(Pictures::parse("a = b | c\na = d | e").unwrap_err().contains("line 2"));
    }
}
