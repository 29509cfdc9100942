// SPDX-License-Identifier: MIT OR Apache-2.0
//! The `#import` declarations of a file, with the place of each.
//!
//! naga_oil drops an import that nothing uses, and with it the error that it names no module; and
//! its positions shift where a definition was replaced earlier. So declarations are read here.

use crate::Definitions;
use crate::scan::{is_identifier, without_comments};

/// One imported path: a module, or an item of one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Import {
    /// Full path, `airlight::core::camera` or `airlight::core::camera::Camera`.
    pub path: String,
    /// Line of its last part, from 1.
    pub line: u32,
    /// Column of its last part, from 1.
    pub column: u32,
    /// What the file calls it; `*` for all items of a module.
    pub name: String,
}

/// A word, `::`-joined, or a single character, with its line and column.
type Token = (String, u32, u32);

/// Every import that a file declares, in conditional parts too.
pub(crate) fn declared(source: &str) -> Vec<Import> {
    let text = without_comments(source);
    let lines: Vec<&str> = text.lines().collect();
    let mut imports = Vec::new();
    let mut index = 0;
    while index < lines.len() {
        let Some(offset) = statement(lines[index]) else {
            index += 1;
            continue;
        };
        // A statement goes on until its braces are closed.
        let mut tokens = Vec::new();
        let mut open = 0_i32;
        let mut skip = offset;
        loop {
            let line = lines[index];
            tokenize(line, skip, index as u32 + 1, &mut tokens);
            open += line.matches('{').count() as i32 - line.matches('}').count() as i32;
            skip = 0;
            index += 1;
            if open <= 0 || index >= lines.len() {
                break;
            }
        }
        read(&tokens, &mut imports);
    }
    imports
}

/// A source without the parts that `definitions` leave out; both sides of `#if`, which compares values, stay.
// What is checked is part of the command.
#[cfg_attr(not(feature = "command"), allow(dead_code))]
pub(crate) fn active(source: &str, definitions: &Definitions) -> String {
    let defined = |name: &str| definitions.iter().any(|(known, _)| known == name.trim());
    // Of each condition around a line: whether this branch holds, and whether one before it did.
    let mut around: Vec<(bool, bool)> = Vec::new();
    let mut kept = String::new();
    for line in without_comments(source).lines() {
        let mut words = line.trim().splitn(2, char::is_whitespace);
        let (word, mut rest) = (words.next().unwrap_or_default(), words.next().unwrap_or_default().trim());
        let mut opens = word;
        if word == "#else" {
            let (other, name) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
            opens = other;
            rest = name;
        }
        let holds = match opens.trim_start_matches('#') {
            "ifdef" => defined(rest),
            "ifndef" => !defined(rest),
            _ => true,
        };
        match word {
            "#ifdef" | "#ifndef" => around.push((holds, holds)),
            "#if" => around.push((true, false)),
            "#else" => {
                if let Some((now, before)) = around.last_mut() {
                    *now = holds && !*before;
                    *before |= *now && opens != "if";
                }
            }
            "#endif" => {
                around.pop();
            }
            _ if around.iter().all(|(now, _)| *now) => kept += line,
            _ => {}
        }
        kept.push('\n');
    }
    kept
}

/// Where the path begins, in characters, if the line is an import statement.
fn statement(line: &str) -> Option<usize> {
    let rest = line.trim_start().strip_prefix('#')?.trim_start().strip_prefix("import")?;
    rest.starts_with(char::is_whitespace).then(|| line.chars().count() - rest.chars().count())
}

fn tokenize(line: &str, skip: usize, number: u32, tokens: &mut Vec<Token>) {
    let letters: Vec<char> = line.chars().collect();
    let mut at = skip;
    while at < letters.len() {
        let start = at;
        while at < letters.len() {
            if letters[at] == '"' {
                // A file's name, whatever it holds.
                let end = letters[at + 1..].iter().position(|&letter| letter == '"');
                at = end.map_or(letters.len(), |end| at + end + 2);
            } else if is_identifier(letters[at]) || letters[at] == ':' {
                at += 1;
            } else {
                break;
            }
        }
        if at > start {
            tokens.push((letters[start..at].iter().collect(), number, start as u32 + 1));
        } else {
            if !letters[at].is_whitespace() {
                tokens.push((letters[at].to_string(), number, at as u32 + 1));
            }
            at += 1;
        }
    }
}

fn read(tokens: &[Token], imports: &mut Vec<Import>) {
    let mut prefixes: Vec<String> = Vec::new();
    let mut renamed = false;
    for (index, (word, line, column)) in tokens.iter().enumerate() {
        match word.as_str() {
            "{" | "," | ";" => {}
            "}" => {
                prefixes.pop();
            }
            "as" => renamed = true,
            _ if renamed => {
                renamed = false;
                if let Some(last) = imports.last_mut() {
                    last.name = word.clone();
                }
            }
            "*" => {
                if let Some(last) = imports.last_mut() {
                    last.path.truncate(last.path.trim_end_matches("::").len());
                    last.name = word.clone();
                }
            }
            _ => {
                let path = format!("{}{word}", prefixes.concat());
                let next = tokens.get(index + 1).map_or("", |next| next.0.as_str());
                if next == "{" {
                    prefixes.push(word.clone());
                } else if next.starts_with(is_identifier) && next != "as" {
                    // The old form `#import module item, item`.
                    prefixes.push(format!("{word}::"));
                } else {
                    let name = path.rsplit("::").next().unwrap_or_default().to_owned();
                    imports.push(Import { path, line: *line, column: *column, name });
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paths(source: &str) -> Vec<(String, u32, u32)> {
        declared(source).into_iter().map(|i| (i.path, i.line, i.column)).collect()
    }

    #[test]
    fn parts_that_definitions_leave_out_are_gone() {
        let source = "#ifdef A\na\n#else ifdef B\nb\n#ifndef C\nc\n#endif\n#else\nd\n#endif\n#if A == 1\ne\n#else\nf\n#endif\n";
        let words =
            |definitions: Definitions| active(source, &definitions).split_whitespace().collect::<String>();
        assert_eq!(words(Definitions::new()), "def");
        assert_eq!(words(Definitions::new().flag("A").flag("B")), "aef");
        assert_eq!(words(Definitions::new().flag("B")), "bcef");
        assert_eq!(words(Definitions::new().set("B", 1).flag("C")), "bef");
    }

    #[test]
    fn every_form_is_read() {
        let source = "// #import no::no\n#import a::b\n#import a::c as d\n#import a::e::{\n  f, // x\n  g as h,\n  i::{j}\n}\nfn import_() {}\n";
        let expected =
            [("a::b", 2, 9), ("a::c", 3, 9), ("a::e::f", 5, 3), ("a::e::g", 6, 3), ("a::e::i::j", 7, 7)];
        let expected: Vec<_> = expected.map(|(path, line, column)| (path.to_owned(), line, column)).to_vec();
        assert_eq!(paths(source), expected);
        let names: Vec<String> = declared(source).into_iter().map(|import| import.name).collect();
        assert_eq!(names, ["b", "d", "f", "h", "j"]);
    }

    #[test]
    fn files_globs_and_the_old_form_are_read() {
        let source = "#import \"a b/c.wgsl\"::{f, g} as x\n#import m::*\n#import a::b item, other\n";
        let found: Vec<String> = declared(source).into_iter().map(|import| import.path).collect();
        assert_eq!(found, ["\"a b/c.wgsl\"::f", "\"a b/c.wgsl\"::g", "m", "a::b::item", "a::b::other"]);
    }
}
