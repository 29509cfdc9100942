// SPDX-License-Identifier: MIT OR Apache-2.0
//! What a text may nest before it is handed to compilers that recurse with it.

use super::code;
use crate::check::lint::tokens::tokens;

/// The most levels that are open at a place: brackets, and operators before it in each of them.
pub(super) const MOST_LEVELS: usize = 2_000;

/// The most conditions, and the most braces of an import, that are open at a line.
const MOST_DIRECTIVES: usize = 200;

/// Where a text nests more than compilers bear, and why that is.
pub(super) fn excess(text: &str) -> Option<(u32, u32, String)> {
    let code = code(text);
    directives(&code).or_else(|| levels(&code))
}

/// Conditions and lists of imports, which the composer reads line by line.
fn directives(code: &str) -> Option<(u32, u32, String)> {
    let mut conditions = 0_usize;
    for (line, content) in (1..).zip(code.lines()) {
        let Some(directive) = content.trim_start().strip_prefix('#') else { continue };
        let directive = directive.trim_start();
        if directive.starts_with("endif") {
            conditions = conditions.saturating_sub(1);
        } else if directive.starts_with("if") {
            conditions += 1;
        }
        let braces = if directive.starts_with("import") { directive.matches('{').count() } else { 0 };
        if conditions.max(braces) > MOST_DIRECTIVES {
            return Some((line, 1, format!("nests more than {MOST_DIRECTIVES} directives; not checked")));
        }
    }
    None
}

/// Brackets and operators.
fn levels(code: &str) -> Option<(u32, u32, String)> {
    // Operators so far in each open bracket: a chain `a + b + c` is as deep as it is long.
    let mut open: Vec<usize> = vec![0];
    let mut levels = 0;
    let mut before = "";
    for token in tokens(code) {
        let innermost = open.len() - 1;
        match token.text {
            "(" | "[" | "{" => {
                // A block after a block goes on with nothing.
                if before == "}" {
                    levels -= std::mem::take(&mut open[innermost]);
                }
                open.push(0);
                levels += 1;
            }
            ")" | "]" | "}" => {
                if innermost > 0 {
                    levels -= 1 + open.pop().unwrap_or(0);
                }
                // What follows a bracket may go on with it: `a[0][0]`, `} else {`.
                levels += 1;
                *open.last_mut()? += 1;
            }
            ";" | "," => levels -= std::mem::take(&mut open[innermost]),
            word if token.is_word() => {
                if before == "}" && word != "else" {
                    levels -= std::mem::take(&mut open[innermost]);
                }
            }
            _ if token.is_number() => {}
            sign => {
                // `--` may be two signs before an operand.
                levels += sign.len();
                open[innermost] += sign.len();
            }
        }
        if levels > MOST_LEVELS {
            let message = format!("nests more than {MOST_LEVELS} brackets and operators; not checked");
            return Some((token.line, token.column, message));
        }
        before = token.text;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deep_texts_are_found_and_long_ones_are_not() {
        let expression = |part: &str| format!("fn f() {{ let a = {}1; }}", part.repeat(3_000));
        for deep in ["(", "1 + ", "-", "a[0].b", "array<", "f(1, "] {
            let found = excess(&expression(deep));
            assert_eq!(found.map(|(line, _, _)| line), Some(1), "{deep}");
        }
        assert!(excess(&format!("fn f() {{ if a {{}} {} }}", "else if a {}".repeat(2_500))).is_some());
        for long in ["1, ", "a; ", "if a { b(); } ", "for (;;) { } ", "{ } "] {
            assert_eq!(excess(&expression(long)), None, "{long}");
        }
        assert_eq!(
            excess(&"@group(0) @binding(0) var<storage> a: array<f32>;\nfn f() -> f32 { }\n".repeat(1_000)),
            None
        );
        assert_eq!(excess(&"}".repeat(100)), None);
        assert!(
            excess(&"#ifdef A\n".repeat(300)).is_some()
                && excess(&"#ifdef A\n#endif\n".repeat(300)).is_none()
        );
        assert!(excess(&format!("#import {}", "a::{".repeat(300))).is_some());
    }
}
