// SPDX-License-Identifier: MIT OR Apache-2.0
//! Directives, and what a composer drops.

use super::text::Text;
use crate::{
    check::{Finding, Severity},
    scan::{is_identifier, without_comments},
};
use std::collections::BTreeMap;

/// The directive on a line without comments: its word and the rest.
fn directive(line: &str) -> Option<(&str, &str)> {
    let rest = line.trim_start().strip_prefix('#')?.trim_start();
    let rest = match rest.strip_prefix("else") {
        Some(tail) if tail.starts_with(char::is_whitespace) && !tail.trim().is_empty() => tail.trim_start(),
        _ => rest,
    };
    let end = rest.find(|c: char| !is_identifier(c)).unwrap_or(rest.len());
    Some((&rest[..end], rest[end..].trim()))
}

/// Column of the first character that is no space, from 1.
fn indent(line: &str) -> u32 {
    line.chars().take_while(|letter| letter.is_whitespace()).count() as u32 + 1
}

/// Conditions of which naga_oil tests the first clause only; `source` is the whole file.
pub(super) fn conditions(source: &str, text: &Text, findings: &mut Vec<Finding>) {
    for (line, code) in (1..).zip(without_comments(source).lines()) {
        let Some((word, rest)) = directive(code) else { continue };
        if !matches!(word, "if" | "ifdef" | "ifndef") {
            continue;
        }
        let words = rest.split_whitespace().count();
        let too_long = match word {
            "if" => rest.contains("&&") || rest.contains("||") || words > 3,
            _ => words > 1,
        };
        if too_long {
            let message =
                format!("`#{word} {rest}`: the composer tests the first clause only; nest the conditions");
            findings.push(text.place(line, indent(code), Severity::Error, "condition", message));
        }
    }
}

/// Layout attributes, which do not survive an import.
pub(super) fn layout_attributes(text: &Text, findings: &mut Vec<Finding>) {
    if !text.is_module {
        return;
    }
    for (index, token) in text.tokens.iter().enumerate() {
        let attribute = text.text(index + 1);
        if token.text == "@" && matches!(attribute, "align" | "size") && text.text(index + 2) == "(" {
            let message =
                format!("`@{attribute}` is dropped where the struct is imported; use padding members");
            findings.push(text.at(token, Severity::Error, "layout-attribute", message));
        }
    }
}

/// Definitions that a source reads, with the first line of each.
pub(crate) fn used_definitions(source: &str) -> BTreeMap<String, u32> {
    let mut used = BTreeMap::new();
    for (line, text) in (1..).zip(without_comments(source).lines()) {
        if let Some(("if" | "ifdef" | "ifndef", rest)) = directive(text) {
            let end = rest.find(|c: char| !is_identifier(c)).unwrap_or(rest.len());
            if end > 0 {
                used.entry(rest[..end].to_owned()).or_insert(line);
            }
        }
        let mut rest = text;
        while let Some(at) = rest.find("#{") {
            rest = &rest[at + 2..];
            let Some(end) = rest.find('}') else { break };
            used.entry(rest[..end].trim().to_owned()).or_insert(line);
        }
    }
    used
}

#[cfg(test)]
mod tests {
    use super::{super::text::places, *};

    #[test]
    fn clauses_after_the_first_are_found() {
        let source = "#if A == 1 && B == 1\n#else if A == 2\n#endif\n  #ifdef A B\n// #if A == 1 && B == 1\n#if A\n#else\n#endif\n#if A > -1\n#endif\n";
        let find = |text: &Text, findings: &mut Vec<Finding>| conditions(source, text, findings);
        assert_eq!(places(find, "condition", source), ["1:1", "4:3"]);
    }

    #[test]
    fn layout_attributes_are_found() {
        let source = "#define_import_path a\nstruct S {\n  @align(16) a: f32,\n  // @size(16)\n  @size (32) b: f32,\n  @sizes c: f32,\n}";
        assert_eq!(places(layout_attributes, "layout-attribute", source), ["3:3", "5:3"]);
        // Nothing imports a pass.
        let own = source.replace("#define_import_path a", "");
        assert!(places(layout_attributes, "layout-attribute", &own).is_empty());
    }

    #[test]
    fn definitions_are_found() {
        let source = "#ifdef A\n#else ifdef B\n#else if C == 1\n#endif\nlet x = #{D} + #{E}; // #{F}\n#define_import_path g\n";
        let used = used_definitions(source);
        let names: Vec<(&str, u32)> = used.iter().map(|(name, line)| (name.as_str(), *line)).collect();
        assert_eq!(names, [("A", 1), ("B", 2), ("C", 3), ("D", 5), ("E", 5)]);
    }
}
