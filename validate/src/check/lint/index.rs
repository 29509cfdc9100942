// SPDX-License-Identifier: MIT OR Apache-2.0
//! Index arithmetic that `select` does not guard.

use super::{text::Text, tokens::closing};
use crate::check::{Finding, Severity};

/// `select(a[i - 1u], 0.0, i == 0u)`: both values are computed before one is taken.
pub(super) fn find(text: &Text, findings: &mut Vec<Finding>) {
    let tokens = &text.tokens;
    for (index, token) in tokens.iter().enumerate() {
        if token.text != "select" || text.text(index + 1) != "(" {
            continue;
        }
        let close = closing(tokens, index + 1);
        let mut at = index + 2;
        let (mut depth, mut commas) = (0_usize, 0);
        // The condition is evaluated whatever comes of it.
        while at < close && commas < 2 {
            match text.text(at) {
                "(" => depth += 1,
                ")" => depth = depth.saturating_sub(1),
                "," if depth == 0 => commas += 1,
                _ => {}
            }
            if text.text(at) == "[" {
                let end = closing(tokens, at).min(close);
                if let Some(sign) = unguarded(text, at + 1, end) {
                    let message = "index arithmetic inside `select`: both sides are evaluated, so that the index \
                                   leaves the array where the condition excludes it; clamp the index or use `if`"
                        .to_owned();
                    findings.push(text.at(&tokens[sign], Severity::Warning, "select-index", message));
                }
                at = end;
            }
            at += 1;
        }
    }
}

/// The first binary `-`, or `+` with a number, of an index that neither a clamp, nor a remainder, nor a mask holds in range.
fn unguarded(text: &Text, start: usize, end: usize) -> Option<usize> {
    let tokens = &text.tokens[start..end];
    let holds = |word: &str| matches!(word, "min" | "max" | "clamp" | "select" | "%" | "&");
    if tokens.iter().any(|token| holds(token.text)) {
        return None;
    }
    let at = (1..tokens.len()).find(|&at| {
        let (before, sign, step) = (tokens[at - 1], tokens[at].text, tokens.get(at + 1));
        let is_operand = before.is_word() || before.is_number() || matches!(before.text, ")" | "]");
        // `i + 1` steps over the edge; `BEGIN + i` goes to a part of the array.
        let is_step = step.is_some_and(|step| step.is_number())
            && tokens.get(at + 2).is_none_or(|next| !matches!(next.text, "*" | "/" | "<<"));
        is_operand && (sign == "-" || sign == "+" && is_step)
    })?;
    // Arithmetic of constants is known to the compilers.
    let is_constant = tokens.iter().all(|token| !token.is_word());
    (!is_constant).then_some(start + at)
}

#[cfg(test)]
mod tests {
    use super::{super::text::places, *};

    #[test]
    fn arithmetic_in_an_index_is_found() {
        let source = "fn f() {\n  let a = select(b[i - 1u], 0.0, i == 0u);\n  let c = select(0.0, g(b[2u * i].x, h[i].y[k + 1]), d);\n}";
        assert_eq!(places(find, "select-index", source), ["2:22", "3:47"]);
    }

    #[test]
    fn guarded_and_plain_indices_are_left() {
        let source = "fn f() {\n  let a = select(b[max(i, 1u) - 1u], 0.0, i == 0u);\n  let c = select(b[i], b[2], i - 1u == 0u);\n  let d = b[i - 1u];\n  let e = select(b[(i + 1u) % 4u], b[3 - 1], c);\n  let g = select(b[BEGIN + i], b[BEGIN + 8u * i], c);\n  let h = select(1, 2, b[i - 1u] > 0.5);\n}";
        assert!(places(find, "select-index", source).is_empty());
    }
}
