// SPDX-License-Identifier: MIT OR Apache-2.0
//! WGSL as words and signs with their places, and what is easily read from those.

use crate::scan::is_identifier;
use std::ops::Range;

/// A word, a number or a sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Token<'a> {
    pub text: &'a str,
    /// Line, from 1.
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
    /// Whether it is `<` or `>` around template arguments, such as those of `array<f32>`.
    pub is_template: bool,
}

impl Token<'_> {
    /// Whether it is an identifier, a keyword or `#{NAME}`.
    pub fn is_word(&self) -> bool {
        self.text.starts_with(|letter: char| letter == '#' || is_identifier(letter) && !letter.is_numeric())
    }

    /// Whether it is a number.
    pub fn is_number(&self) -> bool {
        self.text.starts_with(|letter: char| letter.is_ascii_digit())
            || self.text.len() > 1 && self.text.starts_with('.')
    }
}

/// Signs of several characters, longest first.
const SIGNS: [&str; 22] = [
    "<<=", ">>=", "::", "<<", ">>", "&&", "||", "==", "!=", "<=", ">=", "->", "++", "--", "+=", "-=", "*=",
    "/=", "%=", "&=", "|=", "^=",
];

/// Whether `<` after a word begins template arguments.
fn takes_template(word: &str) -> bool {
    matches!(
        word,
        "array" | "atomic" | "binding_array" | "bitcast" | "ptr" | "var" | "vec2" | "vec3" | "vec4"
    ) || word.starts_with("texture_")
        || word.len() == 6 && word.starts_with("mat") && word.as_bytes()[4] == b'x'
}

/// Words and signs of a text without comments; lines that are directives are left out.
pub(crate) fn tokens(code: &str) -> Vec<Token<'_>> {
    let mut tokens: Vec<Token> = Vec::new();
    // Depth of parentheses at each open template.
    let mut templates: Vec<u32> = Vec::new();
    let mut depth = 0_u32;
    let mut in_import = 0_i32;
    for (number, line) in (1..).zip(code.lines()) {
        let start = line.trim_start();
        if in_import > 0 || start.starts_with('#') && !start.starts_with("#{") {
            if in_import > 0 || start[1..].trim_start().starts_with("import") {
                in_import += line.matches('{').count() as i32 - line.matches('}').count() as i32;
            }
            continue;
        }
        let mut rest = line;
        let mut column = 1;
        while let Some(first) = rest.chars().next() {
            let length = length(rest, first);
            let text = &rest[..length];
            let (head, is_template) = match text.as_bytes()[0] {
                b'<' if tokens.last().is_some_and(|last| takes_template(last.text)) && text != "<=" => {
                    templates.push(depth);
                    ("<", true)
                }
                b'>' if templates.last() == Some(&depth) => {
                    templates.pop();
                    (">", true)
                }
                _ => (text, false),
            };
            match head {
                "(" | "[" | "{" => depth += 1,
                ")" | "]" | "}" => depth = depth.saturating_sub(1),
                // A comparison that looked like a template.
                ";" => templates.clear(),
                _ => {}
            }
            let text = &rest[..head.len()];
            if !first.is_whitespace() {
                tokens.push(Token { text, line: number, column, is_template });
            }
            column += text.chars().count() as u32;
            rest = &rest[text.len()..];
        }
    }
    tokens
}

/// Bytes of the token at the start of a text that is not empty.
fn length(rest: &str, first: char) -> usize {
    let second = rest[first.len_utf8()..].chars().next();
    // A bound, so that a line of nothing else is read in time.
    if rest.starts_with("#{")
        && let Some(end) = rest.bytes().take(256).position(|letter| letter == b'}')
    {
        return end + 1;
    }
    if first.is_ascii_digit() || first == '.' && second.is_some_and(|c| c.is_ascii_digit()) {
        let is_hexadecimal = rest.starts_with("0x") || rest.starts_with("0X");
        let mut last = first;
        let end = rest.find(|c: char| {
            let exponent = if is_hexadecimal { "pP" } else { "eE" };
            let goes_on = is_identifier(c) || c == '.' || "+-".contains(c) && exponent.contains(last);
            last = c;
            !goes_on
        });
        return end.unwrap_or(rest.len());
    }
    if is_identifier(first) {
        return rest.find(|c: char| !is_identifier(c)).unwrap_or(rest.len());
    }
    if first == '"' {
        return rest[1..].find('"').map_or(rest.len(), |end| end + 2);
    }
    SIGNS.into_iter().find(|sign| rest.starts_with(sign)).map_or(first.len_utf8(), str::len)
}

/// Where the bracket at `open` is closed; the end where it is not.
pub(crate) fn closing(tokens: &[Token], open: usize) -> usize {
    let mut depth = 0_usize;
    for (index, token) in tokens.iter().enumerate().skip(open) {
        match token.text {
            "(" | "[" | "{" => depth += 1,
            ")" | "]" | "}" => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth == 0 {
            return index;
        }
    }
    tokens.len()
}

/// A declaration at module scope.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Declaration<'a> {
    /// `fn`, `struct`, `var`, `const`, `override` or `alias`.
    pub keyword: &'a str,
    pub name: &'a str,
    /// Index of the name.
    pub at: usize,
    /// All of it, from the keyword to its end.
    pub range: Range<usize>,
}

/// Everything that is declared at module scope.
pub(crate) fn declarations<'a>(tokens: &[Token<'a>]) -> Vec<Declaration<'a>> {
    let mut found = Vec::new();
    let mut index = 0;
    while index < tokens.len() {
        let keyword = tokens[index].text;
        let is_declaration = match keyword {
            // `override fn` is naga_oil's.
            "override" => tokens.get(index + 1).is_none_or(|next| next.text != "fn"),
            "fn" | "struct" | "var" | "const" | "alias" => true,
            _ => false,
        };
        if !is_declaration {
            index = if matches!(keyword, "{" | "(") { closing(tokens, index) + 1 } else { index + 1 };
            continue;
        }
        let start = index;
        let mut at = index + 1;
        // `var<storage, read_write> name`
        if tokens.get(at).is_some_and(|token| token.text == "<") {
            at += tokens[at..].iter().take(32).position(|token| token.text == ">").unwrap_or(0) + 1;
        }
        let stop = |text: &str| match keyword {
            "fn" | "struct" => text == "{",
            _ => text == ";",
        };
        index = at;
        while index < tokens.len() && !stop(tokens[index].text) {
            index =
                if matches!(tokens[index].text, "(" | "{") { closing(tokens, index) + 1 } else { index + 1 };
        }
        if matches!(keyword, "fn" | "struct") {
            index = closing(tokens, index.min(tokens.len()));
        }
        index = (index + 1).min(tokens.len());
        if let Some(name) = tokens.get(at).filter(|token| token.is_word()) {
            found.push(Declaration { keyword, name: name.text, at, range: start..index });
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_and_signs_have_places() {
        let code = "#import a::{\n  b\n}\nlet é = vec2<f32>(1.5e-3, #{N}) >> 2u;\narray<vec2<f32>, 4> a<b;";
        let found: Vec<(&str, u32, u32)> =
            tokens(code).iter().map(|token| (token.text, token.line, token.column)).collect();
        assert_eq!(found[0], ("let", 4, 1));
        assert_eq!(found[3], ("vec2", 4, 9));
        assert!(found.contains(&("1.5e-3", 4, 19)), "{found:?}");
        assert!(found.contains(&("#{N}", 4, 27)), "{found:?}");
        assert!(found.contains(&(">>", 4, 33)), "{found:?}");
        let templates = tokens(code).iter().filter(|token| token.is_template).count();
        assert_eq!(templates, 6);
    }

    #[test]
    fn declarations_have_names_and_ends() {
        let code = "override n: u32 = 2;\n@group(0) @binding(1) var<storage, read_write> b: array<u32>;\nstruct S { a: f32 }\n@compute @workgroup_size(n) fn main(@builtin(x) y: u32) -> S { let z = 1; if y > 1u { z(); } }\nconst c = 1;";
        let tokens = tokens(code);
        let found: Vec<(&str, &str)> =
            declarations(&tokens).iter().map(|found| (found.keyword, found.name)).collect();
        let expected = [("override", "n"), ("var", "b"), ("struct", "S"), ("fn", "main"), ("const", "c")];
        assert_eq!(found, expected);
        assert!(declarations(&super::tokens("fn f( { ( struct")).len() <= 1);
    }
}
