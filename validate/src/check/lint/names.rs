// SPDX-License-Identifier: MIT OR Apache-2.0
//! Names that a composer or a writer of WGSL changes.

use super::{
    text::Text,
    tokens::{Token, closing},
};
use crate::check::{Finding, Severity};

/// Names that end in a digit or hold `__`: naga appends `_` to the one and folds the other.
pub(super) fn find(text: &Text, findings: &mut Vec<Finding>) {
    if !text.is_composed {
        return;
    }
    let mut judge = |token: &Token, what: &str, is_outer: bool| {
        let name = token.text;
        let why = if name.ends_with(|letter: char| letter.is_ascii_digit()) {
            "ends in a digit"
        } else if name.contains("__") {
            "holds `__`"
        } else {
            return;
        };
        let severity = if is_outer { Severity::Error } else { Severity::Warning };
        let message = format!(
            "{what} `{name}` {why}, so that it has another name once it is composed or written again"
        );
        findings.push(text.at(token, severity, "renamed-name", message));
    };
    for declaration in &text.declarations {
        let tokens = &text.tokens[declaration.range.clone()];
        let is_entry_point = declaration.keyword == "fn" && is_entry_point(text, declaration.range.start);
        let what = match (declaration.keyword, is_entry_point) {
            (_, true) => "entry point",
            ("fn", _) => "function",
            ("struct", _) => "struct",
            ("const", _) => "constant",
            ("override", _) => "override",
            ("alias", _) => "alias",
            _ => "variable",
        };
        judge(&text.tokens[declaration.at], what, text.is_module && !is_entry_point);
        match declaration.keyword {
            "struct" => {
                for member in members(tokens) {
                    judge(member, "member", text.is_module);
                }
            }
            "fn" => locals(tokens).into_iter().for_each(|local| judge(local, "local", false)),
            _ => {}
        }
    }
}

/// Whether the attributes before a function name a stage.
pub(super) fn is_entry_point(text: &Text, function: usize) -> bool {
    let before = text.tokens[..function].iter().rev();
    before
        .take_while(|token| !matches!(token.text, "}" | ";"))
        .any(|token| matches!(token.text, "vertex" | "fragment" | "compute"))
}

/// Names before a `:` directly inside the braces of a struct.
fn members<'a, 'b>(tokens: &'b [Token<'a>]) -> Vec<&'b Token<'a>> {
    let open = tokens.iter().position(|token| token.text == "{").unwrap_or(tokens.len());
    tokens
        .get(open..)
        .unwrap_or_default()
        .windows(2)
        .filter(|pair| pair[0].is_word() && pair[1].text == ":")
        .map(|pair| &pair[0])
        .collect()
}

/// Arguments, `let`, `var` and `const` of a function.
fn locals<'a, 'b>(tokens: &'b [Token<'a>]) -> Vec<&'b Token<'a>> {
    let open = tokens.iter().position(|token| token.text == "(").unwrap_or(tokens.len());
    let close = closing(tokens, open).min(tokens.len());
    let arguments = tokens.get(open..close).unwrap_or_default();
    let mut found: Vec<&Token> = arguments
        .windows(2)
        .filter(|pair| pair[0].is_word() && pair[1].text == ":")
        .map(|pair| &pair[0])
        .collect();
    let body = &tokens[close..];
    for (index, token) in body.iter().enumerate() {
        if !matches!(token.text, "let" | "var" | "const") {
            continue;
        }
        let mut at = index + 1;
        if body.get(at).is_some_and(|next| next.text == "<") {
            at += body[at..].iter().take(32).position(|next| next.text == ">").unwrap_or(0) + 1;
        }
        found.extend(body.get(at).filter(|next| next.is_word()));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::{super::text::places, *};

    #[test]
    fn names_that_change_are_found() {
        let source = "#define_import_path m\nstruct S {\n  uv1: vec2<f32>,\n  uv: vec4<f32>,\n}\nconst A__B: f32 = 1.0;\nfn f2(p0: f32) -> f32 {\n  let a9 = p0; var<function> b8 = 1u;\n  return a9;\n}\n@compute @workgroup_size(1) fn main3() {}\n";
        let found = places(find, "renamed-name", source);
        assert_eq!(found, ["3:3", "6:7", "7:4", "7:7", "8:7", "8:30", "11:32"]);
    }

    #[test]
    fn other_names_and_plain_files_are_left() {
        let source = "#define_import_path m\nstruct S { uv_1_: vec2<f32>, b: mat3x3<f32> }\nfn f(p: vec3f) -> f32 { let a = p.x * 2.0; return a; }\n";
        assert!(places(find, "renamed-name", source).is_empty());
        assert!(places(find, "renamed-name", "struct S { uv1: f32 }\n").is_empty());
    }
}
