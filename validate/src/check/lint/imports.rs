// SPDX-License-Identifier: MIT OR Apache-2.0
//! Imports that do nothing, or that cannot work.

use super::text::Text;
use crate::{
    check::{Finding, Severity},
    imports,
    library::resolve,
};
use std::collections::{BTreeMap, BTreeSet};

/// Names of the pipeline overrides that each module declares, by its path.
pub(super) type Overrides = BTreeMap<String, BTreeSet<String>>;

/// Imports that the file names nowhere.
pub(super) fn unused(text: &Text, findings: &mut Vec<Finding>) {
    let words: BTreeSet<&str> = text.tokens.iter().map(|token| token.text).collect();
    for import in imports::declared(text.code) {
        if import.name == "*" || words.contains(import.name.as_str()) {
            continue;
        }
        let message = format!(
            "import of `{}`, which the file does not use; the composer drops it in silence, with any error in it",
            import.path
        );
        findings.push(text.place(import.line, import.column, Severity::Warning, "unused-import", message));
    }
}

/// Overrides of another module, which have no name there once it is composed.
pub(super) fn overrides(text: &Text, overrides: &Overrides, findings: &mut Vec<Finding>) {
    let known = |path: &str| overrides.contains_key(path);
    let has = |module: &str, item: &str| overrides.get(module).is_some_and(|names| names.contains(item));
    let message = |path: &str| {
        format!("`{path}` is a pipeline override, which cannot be imported by name; declare it in the pass")
    };
    let mut modules: BTreeMap<String, String> = BTreeMap::new();
    for import in imports::declared(text.code) {
        match resolve(&import.path, known) {
            // The whole module: its overrides are named after it.
            Some(module) if module == import.path => {
                modules.insert(import.name.clone(), module.to_owned());
            }
            Some(module) if import.path.rsplit("::").next().is_some_and(|item| has(module, item)) => {
                let message = message(&import.path);
                findings.push(text.place(
                    import.line,
                    import.column,
                    Severity::Error,
                    "imported-override",
                    message,
                ));
            }
            _ => {}
        }
    }
    for window in text.tokens.windows(3) {
        let [first, sign, item] = window else { continue };
        if sign.text == "::"
            && let Some(module) = modules.get(first.text)
            && has(module, item.text)
        {
            let message = message(&format!("{module}::{}", item.text));
            findings.push(text.at(item, Severity::Error, "imported-override", message));
        }
    }
}

/// The overrides that a text declares.
pub(super) fn declared_overrides(text: &Text) -> BTreeSet<String> {
    let declarations = text.declarations.iter();
    declarations.filter(|found| found.keyword == "override").map(|found| found.name.to_owned()).collect()
}

#[cfg(test)]
mod tests {
    use super::{super::text::places, *};

    #[test]
    fn imports_that_nothing_names_are_found() {
        let source = "#import a::b\n#import a::c::{\n  d,\n  e as f,\n}\nfn g() { d(); }\n";
        assert_eq!(places(unused, "unused-import", source), ["1:9", "4:3"]);
    }

    #[test]
    fn imports_that_are_named_are_left() {
        let source =
            "#import a::b\n#import a::c::{d, e as f}\n#import a::g::*\nfn g(x: d) { b::h(); f(); }\n";
        assert!(places(unused, "unused-import", source).is_empty());
    }

    #[test]
    fn overrides_of_other_modules_are_found() {
        let names: Overrides = [("m".to_owned(), ["SIZE".to_owned()].into())].into();
        let find = |text: &Text, findings: &mut Vec<Finding>| overrides(text, &names, findings);
        let source = "#import m as n\n#import m::{f, SIZE}\nfn g() { let a = n::SIZE; f(); }\n";
        assert_eq!(places(find, "imported-override", source), ["2:16", "3:21"]);
        let fine = "#import m as n\n#import m::f\nfn g() { let SIZE = n::f(); let x = o::SIZE; }\n";
        assert!(places(find, "imported-override", fine).is_empty());
    }
}
