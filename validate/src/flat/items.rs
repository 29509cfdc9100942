// SPDX-License-Identifier: MIT OR Apache-2.0
//! The items of a WGSL text without directives: functions, structs, constants and variables, each with
//! the comments above it, and taken apart into names that may refer to an item and all the rest.

use crate::names;

/// A piece of an item's text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Piece {
    /// A name that refers to an item, a local variable or something of WGSL's own.
    Name(String),
    /// Anything else: punctuation, numbers, members, comments, space.
    Text(String),
}

/// An item.
#[derive(Clone, Debug, Default)]
pub(super) struct Item {
    /// What it declares; none for `const_assert` and directives.
    pub name: Option<String>,
    /// Whether it is `enable`, `requires` or `diagnostic`, which must come first in a file.
    pub is_directive: bool,
    /// Whether it has a `@binding`.
    pub is_binding: bool,
    /// Whether a blank line stands before it.
    pub spaced: bool,
    /// Its text with the comments above it, without the line break at its end.
    pub pieces: Vec<Piece>,
}

/// A virtual function or its override: more than putting sources together.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Unsupported;

/// The items of a text.
pub(super) fn split(text: &str) -> Result<Vec<Item>, Unsupported> {
    let tokens = tokens(text);
    let mut items = Vec::new();
    let mut at = 0;
    while at < tokens.len() {
        let end = end_of_item(&tokens, at);
        if let Some(item) = item(&tokens[at..end])? {
            items.push(item);
        }
        at = end;
    }
    Ok(items)
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Word,
    Number,
    Mark,
    Comment,
    Space,
}

type Token<'a> = (Kind, &'a str);

fn tokens(text: &str) -> Vec<Token<'_>> {
    let mut tokens = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let run = |keep: &dyn Fn(char) -> bool| rest.find(|c| !keep(c)).unwrap_or(rest.len());
        let is_word = |c: char| c.is_alphanumeric() || c == '_';
        let (kind, length) = if rest.starts_with("//") {
            (Kind::Comment, run(&|c| c != '\n'))
        } else if rest.starts_with("/*") {
            (Kind::Comment, block_comment(rest))
        } else if first.is_whitespace() {
            (Kind::Space, run(&char::is_whitespace))
        } else if first.is_ascii_digit() {
            (Kind::Number, run(&|c| is_word(c) || c == '.'))
        } else if is_word(first) {
            (Kind::Word, run(&is_word))
        } else {
            (Kind::Mark, first.len_utf8())
        };
        tokens.push((kind, &rest[..length]));
        rest = &rest[length..];
    }
    tokens
}

/// Length of the block comment, which may hold others, at the start of a text.
fn block_comment(text: &str) -> usize {
    let mut depth = 0_u32;
    let mut at = 0;
    while at < text.len() {
        let rest = &text[at..];
        if rest.starts_with("/*") {
            depth += 1;
            at += 2;
        } else if rest.starts_with("*/") {
            depth -= 1;
            at += 2;
            if depth == 0 {
                return at;
            }
        } else {
            at += rest.chars().next().map_or(1, char::len_utf8);
        }
    }
    text.len()
}

/// Past the item that begins at `start`, with a comment that follows it on its line.
fn end_of_item(tokens: &[Token], start: usize) -> usize {
    let mut depth = 0_i32;
    let mut at = start;
    while let Some(&(kind, text)) = tokens.get(at) {
        at += 1;
        if kind != Kind::Mark {
            continue;
        }
        match text {
            "{" | "(" | "[" => depth += 1,
            "}" | ")" | "]" => depth -= 1,
            _ => {}
        }
        if depth <= 0 && (text == ";" || text == "}") {
            break;
        }
    }
    let beside = |space: &Token| space.0 == Kind::Space && !space.1.contains('\n');
    let gap = usize::from(tokens.get(at).is_some_and(beside));
    match tokens.get(at + gap) {
        Some((Kind::Comment, _)) => at + gap + 1,
        _ => at,
    }
}

fn item(tokens: &[Token]) -> Result<Option<Item>, Unsupported> {
    let code: Vec<usize> =
        (0..tokens.len()).filter(|&at| !matches!(tokens[at].0, Kind::Space | Kind::Comment)).collect();
    let code_text = |index: usize| code.get(index).map(|&at| tokens[at].1).unwrap_or_default();
    // Past the attributes, each `@name` or `@name(…)`.
    let mut index = 0;
    let mut is_binding = false;
    while code_text(index) == "@" {
        is_binding |= code_text(index + 1) == "binding";
        index += 2;
        if code_text(index) == "(" {
            index = past_pair(index, "(", ")", code_text, code.len());
        }
    }
    let keyword = code_text(index);
    if keyword.is_empty() || keyword == ";" {
        return Ok(None);
    }
    if keyword == "virtual" || (keyword == "override" && code_text(index + 1) == "fn") {
        return Err(Unsupported);
    }
    let is_directive = ["enable", "requires", "diagnostic"].contains(&keyword);
    let name = match keyword {
        "fn" | "struct" | "const" | "override" | "alias" => Some(code_text(index + 1).to_owned()),
        "var" if code_text(index + 1) == "<" => {
            Some(code_text(past_pair(index + 1, "<", ">", code_text, code.len())).to_owned())
        }
        "var" => Some(code_text(index + 1).to_owned()),
        _ => None,
    };
    let first = tokens.iter().position(|(kind, _)| *kind != Kind::Space).unwrap_or(0);
    let before: String = tokens[..first].iter().map(|(_, text)| *text).collect();
    let spaced = before.matches('\n').count() > 1;
    let pieces = pieces(&tokens[first..], keyword == "struct");
    Ok(Some(Item { name, is_directive, is_binding, spaced, pieces }))
}

/// Past the bracket that closes the one at `start`.
fn past_pair<'a>(start: usize, open: &str, close: &str, at: impl Fn(usize) -> &'a str, end: usize) -> usize {
    let mut depth = 0_i32;
    for index in start..end {
        depth += i32::from(at(index) == open) - i32::from(at(index) == close);
        if depth == 0 {
            return index + 1;
        }
    }
    end
}

fn pieces(tokens: &[Token], is_struct: bool) -> Vec<Piece> {
    let mut pieces: Vec<Piece> = Vec::new();
    // The last two tokens of code, and the depth in braces.
    let mut before = ["", ""];
    let mut depth = 0_i32;
    for (index, &(kind, text)) in tokens.iter().enumerate() {
        let next = tokens[index + 1..].iter().find(|(kind, _)| !matches!(kind, Kind::Space | Kind::Comment));
        let is_member = is_struct && depth == 1 && next.is_some_and(|(_, text)| *text == ":");
        let is_fixed = [".", "@"].contains(&before[1])
            || (before[1] == "(" && ["builtin", "interpolate"].contains(&before[0]));
        match kind {
            Kind::Word if !is_member && !is_fixed => pieces.push(Piece::Name(text.to_owned())),
            Kind::Word => pieces.push(Piece::Text(names::item_of(text))),
            Kind::Comment => pieces.push(Piece::Text(plain(text))),
            Kind::Number | Kind::Mark | Kind::Space => pieces.push(Piece::Text(text.to_owned())),
        }
        if !matches!(kind, Kind::Space | Kind::Comment) {
            depth += i32::from(text == "{") - i32::from(text == "}");
            before = [before[1], text];
        }
    }
    pieces
}

/// A comment with the names of items as they are written in the source.
fn plain(comment: &str) -> String {
    tokens_of_comment(comment).map(names::item_of).collect()
}

fn tokens_of_comment(comment: &str) -> impl Iterator<Item = &str> {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let mut rest = comment;
    std::iter::from_fn(move || {
        let first = rest.chars().next()?;
        let length = match is_word(first) {
            true => rest.find(|c| !is_word(c)).unwrap_or(rest.len()),
            false => rest.find(is_word).unwrap_or(rest.len()),
        };
        let (token, after) = rest.split_at(length);
        rest = after;
        Some(token)
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn text(item: &Item) -> String {
        let text = |piece: &Piece| match piece {
            Piece::Name(text) | Piece::Text(text) => text.clone(),
        };
        item.pieces.iter().map(text).collect()
    }

    fn references(item: &Item) -> Vec<&str> {
        let mut names = Vec::new();
        for piece in &item.pieces {
            if let Piece::Name(name) = piece {
                names.push(name.as_str());
            }
        }
        names
    }

    #[test]
    fn items_are_told_apart() {
        let source = "/// A.\nstruct A { /// x.\n  x: f32, @location(1) y: B }\nconst C: u32 = 3u; // beside\n\n\
            @group(0) @binding(1) var<storage, read_write> d: array<A, C>;\n\
            /* a ; b /* } */ */\n@compute @workgroup_size(8, C)\nfn main(@builtin(position) p: vec3<u32>) { if a { d[0].x = 1e-5; } }\n";
        let items = split(source).unwrap();
        let names: Vec<_> = items.iter().map(|item| item.name.clone().unwrap()).collect();
        assert_eq!(names, ["A", "C", "d", "main"]);
        assert_eq!(items.iter().map(|item| item.spaced).collect::<Vec<_>>(), [false, false, true, false]);
        assert_eq!(items.iter().map(|item| item.is_binding).collect::<Vec<_>>(), [false, false, true, false]);
        assert!(text(&items[0]).starts_with("/// A.\nstruct A {"));
        assert!(text(&items[1]).ends_with("// beside"));
        assert!(text(&items[3]).starts_with("/* a"));
        assert!(!references(&items[0]).contains(&"x") && references(&items[0]).contains(&"B"));
        let main = references(&items[3]);
        assert!(main.contains(&"C") && main.contains(&"d"));
        assert!(!main.contains(&"position") && !main.contains(&"x") && !main.contains(&"e"), "{main:?}");
    }

    #[test]
    fn what_cannot_be_put_together_is_said() {
        assert!(split("virtual fn f() {}\n").is_err());
        assert!(split("override fn a::f() {}\n").is_err());
        assert_eq!(split("override width: u32 = 1u;").unwrap()[0].name.as_deref(), Some("width"));
    }

    #[test]
    fn no_text_is_lost_or_fatal() {
        for source in ["", "}", "fn", "@", "@a(", "/* /* */", "var<", "é ü;", "a{b(c[;", "//"] {
            let length: usize = split(source).unwrap().iter().map(|item| text(item).len()).sum();
            assert!(length <= source.len(), "{source}");
        }
    }
}
