// SPDX-License-Identifier: MIT OR Apache-2.0
//! What a text may nest before it is handed to compilers that recurse with it.

use super::code;
use crate::check::lint::tokens::tokens;

/// The most levels that are open at a place: brackets, and operators before it in each of them.
pub(super) const MOST_LEVELS: usize = 2_000;

/// Where a text nests more than compilers bear, and why that is.
pub(super) fn excess(text: &str) -> Option<(u32, u32, String)> {
    // Operators so far in each open bracket: a chain `a + b + c` is as deep as it is long.
    let mut open: Vec<usize> = vec![0];
    let mut levels = 0;
    let mut before = "";
    let code = code(text);
    for token in tokens(&code) {
        let innermost = open.len() - 1;
        match token.text {
            "(" | "[" | "{" => {
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
            _ => {
                levels += 1;
                open[innermost] += 1;
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
        assert!(excess(&format!("fn f() {{ if a {{}} {} }}", "else if a {}".repeat(1_500))).is_some());
        for long in ["1, ", "a; ", "if a { b(); } ", "for (;;) { } ", "{ } "] {
            assert_eq!(excess(&expression(long)), None, "{long}");
        }
        assert_eq!(
            excess(&"@group(0) @binding(0) var<storage> a: array<f32>;\nfn f() -> f32 { }\n".repeat(1_000)),
            None
        );
        assert_eq!(excess(&"}".repeat(100)), None);
    }
}
