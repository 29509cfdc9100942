// SPDX-License-Identifier: MIT OR Apache-2.0
//! Names and Markdown.

use crate::Library;
use std::collections::BTreeSet;

/// `core/phase` of `airlight::core::phase`.
pub(super) fn short(path: &str) -> String {
    path.split_once("::").map_or(path, |(_, rest)| rest).replace("::", "/")
}

/// The systems of a library, sorted.
pub(super) fn systems(library: &Library) -> BTreeSet<&str> {
    let files = library.modules().iter().map(|module| &module.file);
    files
        .chain(library.passes().iter().map(|pass| &pass.file))
        .filter_map(|file| file.split('/').next())
        .collect()
}

/// A comment as Markdown: what would be a tag, outside of code, is text.
pub(super) fn prose(text: &str) -> String {
    let mut code = false;
    let mut output = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '`' => {
                code = !code;
                output.push(letter);
            }
            '<' if !code => output.push_str("&lt;"),
            '*' if !code => output.push_str("\\*"),
            _ => output.push(letter),
        }
    }
    output
}

/// Markdown in a cell of a table.
pub(super) fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}

/// A table; nothing without rows.
pub(super) fn table(heads: &[&str], rows: &[Vec<String>]) -> String {
    if rows.is_empty() {
        return String::new();
    }
    let mut output = format!("| {} |\n|{}\n", heads.join(" | "), "---|".repeat(heads.len()));
    for row in rows {
        let cells: Vec<String> = row.iter().map(|text| cell(text)).collect();
        output += &format!("| {} |\n", cells.join(" | "));
    }
    output + "\n"
}

/// A section with a heading; nothing where it is empty.
pub(super) fn section(heading: &str, body: &str) -> String {
    if body.trim().is_empty() { String::new() } else { format!("## {heading}\n\n{}\n\n", body.trim_end()) }
}

/// `a`, `b` or "none".
pub(super) fn names<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    let names: Vec<String> = names.into_iter().map(|name| format!("`{name}`")).collect();
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}

/// The first line of every generated page.
pub(super) const GENERATED: &str =
    "<!-- SPDX-License-Identifier: MIT OR Apache-2.0; written by `airlight-validate docs` -->\n";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_are_markdown() {
        assert_eq!(prose("<Wx, y> of `a < b` * 2"), "&lt;Wx, y> of `a < b` \\* 2");
        assert_eq!(short("airlight::core::phase"), "core/phase");
        assert_eq!(table(&["a"], &[]), "");
        assert_eq!(table(&["a"], &[vec!["x|y".to_owned()]]), "| a |\n|---|\n| x\\|y |\n\n");
        assert_eq!((section("A", " \n").as_str(), section("A", "b\n").as_str()), ("", "## A\n\nb\n\n"));
    }
}
