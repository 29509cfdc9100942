// SPDX-License-Identifier: MIT OR Apache-2.0
//! What the composer accepts in silence and gets wrong, and what the permutations leave out.

use crate::{
    Library, Location,
    check::{Finding, Severity},
    scan::{is_identifier, without_comments},
};
use std::collections::{BTreeMap, BTreeSet};

/// The most permutations of a pass that are shipped.
const MOST_PERMUTATIONS: usize = 12;

/// Findings that need no composition.
pub(crate) fn lint(library: &Library) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut report = |severity, location: Location, check: &str, message: String| {
        findings.push(Finding::new(severity, location, check, message));
    };
    for (location, message) in &library.unlisted {
        report(Severity::Error, location.clone(), "permutations", message.clone());
    }
    for module in library.modules() {
        for (line, message) in directives(&module.source) {
            report(Severity::Error, Location::line(&module.file, line), "lint", message);
        }
        for (line, message) in layout_attributes(&module.source) {
            report(Severity::Error, Location::line(&module.file, line), "lint", message);
        }
        let expected = module.file.trim_end_matches(".wgsl").replace('/', "::");
        if module.path.starts_with("airlight::") && module.path != format!("airlight::{expected}") {
            let message =
                format!("`{}` should be `airlight::{expected}`, as the file is called", module.path);
            report(Severity::Error, Location::file(&module.file), "lint", message);
        }
    }
    for pass in library.passes() {
        for (line, message) in directives(&pass.source) {
            report(Severity::Error, Location::line(&pass.file, line), "lint", message);
        }
        let Some(permutations) = library.permutations.get(&pass.name) else { continue };
        let system = pass.name.split('/').next().unwrap_or_default();
        let listing = format!("{system}/permutations");
        if permutations.len() > MOST_PERMUTATIONS {
            let (count, line) = (permutations.len(), permutations[MOST_PERMUTATIONS].line);
            let message = format!(
                "pass `{}` has {count} permutations; at most {MOST_PERMUTATIONS} are shipped",
                pass.name
            );
            report(Severity::Error, Location::line(&listing, line), "permutations", message);
        }
        // A definition that nothing reads is most likely misspelt.
        let own = used_definitions(&pass.source);
        let mut read: BTreeSet<String> = own.keys().cloned().collect();
        for module in library.closure(&pass.imports) {
            read.extend(used_definitions(&module.source).into_keys());
        }
        for permutation in permutations {
            for (name, _) in permutation.definitions.iter().filter(|(name, _)| !read.contains(*name)) {
                let message = format!(
                    "permutation `{}` of `{}` defines `{name}`, which nothing in it reads",
                    permutation.name, pass.name
                );
                report(Severity::Error, Location::line(&listing, permutation.line), "permutations", message);
            }
        }
        // One that no permutation sets is never checked both ways.
        for (name, line) in own {
            let set = permutations.iter().any(|permutation| permutation.definitions.contains(&name));
            if !set && name != "GROUP" {
                let message =
                    format!("no permutation of `{}` defines `{name}`, so it is not checked", pass.name);
                report(Severity::Warning, Location::line(&pass.file, line), "lint", message);
            }
        }
    }
    findings
}

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

/// Conditions of which naga_oil tests the first clause only.
fn directives(source: &str) -> Vec<(u32, String)> {
    let mut found = Vec::new();
    for (line, text) in (1..).zip(without_comments(source).lines()) {
        let Some((word, rest)) = directive(text) else { continue };
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
            found.push((line, message));
        }
    }
    found
}

/// Layout attributes, which do not survive an import.
fn layout_attributes(source: &str) -> Vec<(u32, String)> {
    let mut found = Vec::new();
    for (line, text) in (1..).zip(without_comments(source).lines()) {
        for attribute in ["@align", "@size"] {
            let follows = text
                .match_indices(attribute)
                .any(|(at, _)| text[at + attribute.len()..].trim_start().starts_with('('));
            if follows {
                let message =
                    format!("`{attribute}` is dropped where the struct is imported; use padding members");
                found.push((line, message));
            }
        }
    }
    found
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
    use super::*;

    #[test]
    fn clauses_after_the_first_are_found() {
        let source = "#if A == 1 && B == 1\n#else if A == 2\n#endif\n#ifdef A B\n// #if A == 1 && B == 1\n#if A\n#else\n#endif\n";
        let lines: Vec<u32> = directives(source).into_iter().map(|(line, _)| line).collect();
        assert_eq!(lines, [1, 4]);
    }

    #[test]
    fn layout_attributes_are_found() {
        let source =
            "struct S {\n  @align(16) a: f32,\n  // @size(16)\n  @size (32) b: f32,\n  @sizes c: f32,\n}";
        let lines: Vec<u32> = layout_attributes(source).into_iter().map(|(line, _)| line).collect();
        assert_eq!(lines, [2, 4]);
    }

    #[test]
    fn definitions_are_found() {
        let source = "#ifdef A\n#else ifdef B\n#else if C == 1\n#endif\nlet x = #{D} + #{E}; // #{F}\n#define_import_path g\n";
        let used = used_definitions(source);
        let names: Vec<(&str, u32)> = used.iter().map(|(name, line)| (name.as_str(), *line)).collect();
        assert_eq!(names, [("A", 1), ("B", 2), ("C", 3), ("D", 5), ("E", 5)]);
    }

    #[test]
    fn permutations_are_held_to_the_pass() {
        let pass = "#ifdef USED\n#endif\n#ifdef NEVER\n#endif\n@compute @workgroup_size(1) fn main() {}";
        let many: String = (0..12).map(|i| format!("+ p{i}: USED\n")).collect();
        let listing = format!("one\n+ default: USD\n{many}gone\n+ default:\n");
        let library = Library::from_text(
            &[("core/a.wgsl", "#define_import_path airlight::core::b\n")],
            &[("core/passes/one.wgsl", pass), ("core/passes/two.wgsl", "")],
            &[("core", &listing)],
        );
        let findings = lint(&library);
        let has = |part: &str| findings.iter().any(|finding| finding.message.contains(part));
        assert!(has("should be `airlight::core::a`"));
        assert!(has("13 permutations"));
        assert!(has("defines `USD`"));
        assert!(has("defines `NEVER`"));
        assert!(has("there is no core/passes/gone.wgsl"));
        assert!(has("pass `two` is not listed"));
        assert_eq!(findings.len(), 6, "{findings:#?}");
    }
}
