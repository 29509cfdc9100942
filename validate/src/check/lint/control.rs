// SPDX-License-Identifier: MIT OR Apache-2.0
//! Loops that nothing ends.

use super::{text::Text, tokens::closing};
use crate::check::{Finding, Severity};

/// `loop { … }` and `for (;;) { … }` without `break` or `return`.
pub(super) fn find(text: &Text, findings: &mut Vec<Finding>) {
    let tokens = &text.tokens;
    for (index, token) in tokens.iter().enumerate() {
        let body = match token.text {
            "loop" => tokens[index..].iter().take(64).position(|next| next.text == "{").map(|at| index + at),
            "for" if text.text(index + 1) == "(" => {
                let close = closing(tokens, index + 1);
                is_unconditional(text, index + 2, close).then_some(close + 1)
            }
            _ => None,
        };
        let Some(open) = body.filter(|&open| text.text(open) == "{") else { continue };
        let close = closing(tokens, open);
        // Braces that do not match are the compilers' to report.
        if close < tokens.len() && !exits(text, open, close) {
            let message =
                format!("`{}` without `break` or `return`: WGSL rejects a loop that cannot end", token.text);
            findings.push(text.at(token, Severity::Error, "endless-loop", message));
        }
    }
}

/// Whether the middle of `for (a; b; c)` is empty.
fn is_unconditional(text: &Text, start: usize, end: usize) -> bool {
    let header = text.tokens.get(start..end).unwrap_or_default();
    header
        .iter()
        .position(|token| token.text == ";")
        .is_some_and(|at| header.get(at + 1).is_some_and(|next| next.text == ";"))
}

fn exits(text: &Text, open: usize, close: usize) -> bool {
    let mut index = open + 1;
    while index < close {
        match text.text(index) {
            "return" | "break" => return true,
            // A `break` inside belongs to it.
            "loop" | "for" | "while" | "switch" => {
                let mut inner = index;
                while inner < close && text.text(inner) != "{" {
                    inner =
                        if text.text(inner) == "(" { closing(&text.tokens, inner) + 1 } else { inner + 1 };
                }
                let end = closing(&text.tokens, inner).min(close);
                if text.tokens[inner.min(end)..end].iter().any(|token| token.text == "return") {
                    return true;
                }
                index = end + 1;
            }
            _ => index += 1,
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::{super::text::places, *};

    #[test]
    fn loops_without_an_end_are_found() {
        let source = "fn f() {\n  loop { x(); }\n  for (var i = 0;; i++) { loop { break; } }\n loop { switch 1 { default { break; } } }\n}";
        assert_eq!(places(find, "endless-loop", source), ["2:3", "3:3", "4:2"]);
    }

    #[test]
    fn loops_with_an_end_are_left() {
        let source = "fn f() {\n  loop { if a { break; } }\n  loop { continuing { break if a; } }\n  loop { for (;;) { return; } }\n  for (var i = 0; i < 4; i++) {}\n  while true {}\n}\nfn g() { loop {";
        assert!(places(find, "endless-loop", source).is_empty());
    }
}
