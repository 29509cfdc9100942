// SPDX-License-Identifier: MIT OR Apache-2.0
//! Text for the standard output: lines, headings, columns.

use std::fmt::Write;

/// Prints what was asked for. What is closed early, as by `head`, is no error.
pub(super) fn print(text: &str) {
    use std::io::Write as _;
    let _ = std::io::stdout().lock().write_all(text.as_bytes());
}

/// Begins a part of the text, unless it is `empty`; a blank line stands before all but the first.
pub(super) fn heading(text: &mut String, title: &str, empty: bool) {
    if !empty {
        let gap = if text.is_empty() { "" } else { "\n" };
        line(text, format_args!("{gap}{title}"));
    }
}

/// Adds a line, without the spaces at its end.
pub(super) fn line(text: &mut String, words: std::fmt::Arguments<'_>) {
    // Writing to a string cannot fail.
    let _ = text.write_fmt(words);
    while text.ends_with(' ') {
        text.pop();
    }
    text.push('\n');
}

/// Adds a part of names with what they mean, in two columns.
pub(super) fn pairs(text: &mut String, title: &str, pairs: &[(String, String)]) {
    heading(text, title, pairs.is_empty());
    let width = pairs.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    for (name, about) in pairs {
        line(text, format_args!("  {name:width$}  {about}"));
    }
}
