// SPDX-License-Identifier: MIT OR Apache-2.0
//! Operators that WGSL wants parentheses between and naga mixes without.

use super::text::Text;
use crate::check::{Finding, Severity};

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Logic,
    Bits,
    Relation,
    Shift,
    Arithmetic,
}

/// Operators of an expression so far, outside the brackets in it: sign and kind.
#[derive(Default)]
struct Run<'a> {
    logic: Option<&'a str>,
    /// Since the last `&&` or `||`.
    bits: Option<&'a str>,
    other: Option<&'a str>,
    /// Since the last comparison.
    shift: Option<&'a str>,
    arithmetic: Option<&'a str>,
}

impl<'a> Run<'a> {
    /// The earlier operator that a sign must not stand beside.
    fn clash(&mut self, sign: &'a str, kind: Kind) -> Option<&'a str> {
        match kind {
            Kind::Logic => {
                let clash = self.logic.filter(|before| *before != sign).or(self.bits);
                *self = Self { logic: Some(sign), ..Self::default() };
                clash
            }
            Kind::Bits => {
                let clash = self.bits.filter(|before| *before != sign).or(self.other).or(self.logic);
                self.bits = Some(sign);
                clash
            }
            Kind::Relation => {
                let clash = self.bits;
                self.other = Some(sign);
                (self.shift, self.arithmetic) = (None, None);
                clash
            }
            Kind::Shift => {
                let clash = self.bits.or(self.shift).or(self.arithmetic);
                (self.other, self.shift) = (Some(sign), Some(sign));
                clash
            }
            Kind::Arithmetic => {
                let clash = self.bits.or(self.shift);
                (self.other, self.arithmetic) = (Some(sign), Some(sign));
                clash
            }
        }
    }
}

/// `i << 1u + i`, `a || b && c` and the like.
pub(super) fn find(text: &Text, findings: &mut Vec<Finding>) {
    let mut runs = vec![Run::default()];
    for (index, token) in text.tokens.iter().enumerate() {
        let before = index.checked_sub(1).map(|before| text.tokens[before]);
        // An operator between two operands, not a sign before one.
        let is_binary = before.is_some_and(|before| {
            let ends = matches!(before.text, ")" | "]") || before.is_template && before.text == ">";
            ends || before.is_number() || before.is_word() && before.text != "return"
        });
        let kind = match token.text {
            "(" | "[" => {
                runs.push(Run::default());
                continue;
            }
            ")" | "]" => {
                runs.pop();
                if runs.is_empty() {
                    runs.push(Run::default());
                }
                continue;
            }
            // An attribute has no operators beside it.
            "," | ";" | "{" | "}" | "=" | ":" | "@" | "return" | "if" | "while" | "->" => {
                if let Some(run) = runs.last_mut() {
                    *run = Run::default();
                }
                continue;
            }
            sign if sign.len() > 1 && sign.ends_with('=') && !matches!(sign, "==" | "!=" | "<=" | ">=") => {
                if let Some(run) = runs.last_mut() {
                    *run = Run::default();
                }
                continue;
            }
            _ if token.is_template || !is_binary => continue,
            "&&" | "||" => Kind::Logic,
            "&" | "|" | "^" => Kind::Bits,
            "==" | "!=" | "<" | ">" | "<=" | ">=" => Kind::Relation,
            "<<" | ">>" => Kind::Shift,
            "+" | "-" | "*" | "/" | "%" => Kind::Arithmetic,
            _ => continue,
        };
        if let Some(earlier) = runs.last_mut().and_then(|run| run.clash(token.text, kind)) {
            let message =
                format!("`{earlier}` and `{}` without parentheses: WGSL has no order for them", token.text);
            findings.push(text.at(token, Severity::Error, "precedence", message));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{super::text::places, *};

    fn found(expression: &str) -> Vec<String> {
        places(find, "precedence", &format!("fn f() {{ let r = {expression}; }}"))
    }

    #[test]
    fn what_the_grammar_rejects_is_found() {
        assert_eq!(found("a || b && c"), ["1:25"]);
        assert_eq!(found("i << 1u + i"), ["1:26"]);
        assert_eq!(found("i + 1u << i"), ["1:25"]);
        for clash in [
            "a & b && c",
            "i & j | i",
            "i & j + i",
            "i & j == i",
            "i << j << i",
            "i << j & i",
            "a | b || c",
            "i & j << i",
        ] {
            assert_eq!(found(clash).len(), 1, "{clash}");
        }
    }

    #[test]
    fn what_the_grammar_takes_is_left() {
        for fine in [
            "(i << 1u) + i",
            "i << (1u + i)",
            "(a || b) && c",
            "a || b || c",
            "i << j < i + 1",
            "-i32(i) + 1 < -2",
            "(i & j) == i",
            "i & j & i",
            "array<vec2<f32>, 4>()[1] + x",
            "a < b && c > d",
            "a + b * c < d && e",
            "f(&x, a - b) - g(-1)",
            "vec2<u32>(a >> 1u, b & 1u)",
            "x[i << 1u] + y[a & b]",
        ] {
            assert!(found(fine).is_empty(), "{fine}");
        }
    }
}
