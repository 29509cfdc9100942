// SPDX-License-Identifier: MIT OR Apache-2.0
//! Reading WGSL text line by line without its comments.

/// The text with comments replaced by spaces: the same lines, the same columns.
pub(crate) fn without_comments(text: &str) -> String {
    let mut output = String::with_capacity(text.len());
    let mut letters = text.chars().peekable();
    let mut depth = 0_u32;
    let mut in_line_comment = false;
    while let Some(letter) = letters.next() {
        if letter == '\n' {
            in_line_comment = false;
            output.push('\n');
            continue;
        }
        let pair = letters.peek().copied();
        if in_line_comment {
            output.push(' ');
        } else if depth > 0 {
            if (letter, pair) == ('*', Some('/')) {
                depth -= 1;
                letters.next();
                output.push(' ');
            } else if (letter, pair) == ('/', Some('*')) {
                depth += 1;
                letters.next();
                output.push(' ');
            }
            output.push(' ');
        } else if (letter, pair) == ('/', Some('/')) {
            in_line_comment = true;
            output.push(' ');
        } else if (letter, pair) == ('/', Some('*')) {
            depth = 1;
            letters.next();
            output.push_str("  ");
        } else {
            output.push(letter);
        }
    }
    output
}

/// Whether a character may be part of a WGSL identifier.
pub(crate) fn is_identifier(letter: char) -> bool {
    letter.is_alphanumeric() || letter == '_'
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_become_spaces() {
        let text = "a // b\n/* c\n/* d */ e */ f\ng /é/ h";
        assert_eq!(
            without_comments(text),
            "a     \n    \n            f\ng /é/ h".replace("            f", "             f")
        );
        for (before, after) in text.lines().zip(without_comments(text).lines()) {
            assert_eq!(before.chars().count(), after.chars().count());
        }
    }
}
