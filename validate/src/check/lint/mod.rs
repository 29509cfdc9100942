// SPDX-License-Identifier: MIT OR Apache-2.0
//! What the composer accepts in silence and gets wrong, and what the permutations leave out.

mod constants;
mod control;
mod directives;
mod imports;
mod index;
mod names;
mod operators;
pub(crate) mod text;
pub(crate) mod tokens;
pub(crate) mod uniformity;

pub(crate) use directives::used_definitions;

use crate::{
    Definitions, Library, Location,
    check::{Finding, Severity},
    scan::without_comments,
};
use imports::Overrides;
use std::collections::BTreeSet;
use text::Text;

/// The most permutations of a pass that are shipped.
const MOST_PERMUTATIONS: usize = 12;

/// What the folder says: paths of modules, listed permutations, definitions.
pub(crate) fn layout(library: &Library) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut report = |severity, location: Location, check: &str, message: String| {
        findings.push(Finding::new(severity, location, check, message));
    };
    for (location, message) in &library.unlisted {
        report(Severity::Error, location.clone(), "permutations", message.clone());
    }
    for module in library.modules() {
        let expected = module.file.trim_end_matches(".wgsl").replace('/', "::");
        if module.path.starts_with("airlight::") && module.path != format!("airlight::{expected}") {
            let message =
                format!("`{}` should be `airlight::{expected}`, as the file is called", module.path);
            report(Severity::Error, Location::line(&module.file, 1), "import-path", message);
        }
    }
    for pass in library.passes() {
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
                report(Severity::Warning, Location::line(&pass.file, line), "unset-definition", message);
            }
        }
    }
    findings
}

/// What the shaders themselves say, in every set of definitions that they are checked with.
pub(crate) fn shaders<'a>(
    library: &Library,
    texts: impl Iterator<Item = (&'a str, &'a Definitions)>,
) -> Vec<Finding> {
    let mut overrides = Overrides::new();
    for module in library.modules() {
        let code = text::active(&module.source, &Definitions::new());
        let names = imports::declared_overrides(&Text::new(&module.file, &code, true, true));
        overrides.insert(module.path.clone(), names);
    }
    let mut seen = BTreeSet::new();
    let mut files = BTreeSet::new();
    let mut findings = Vec::new();
    for (file, definitions) in texts {
        if !seen.insert((file, definitions)) {
            continue;
        }
        let Some(source) = library.text(file) else { continue };
        let code = text::active(source, definitions);
        let is_module = library.modules().iter().any(|module| module.file == file);
        let text = Text::new(file, &code, is_module, !library.is_plain(file));
        let mut own = Vec::new();
        if text.is_composed && files.insert(file) {
            // An import may serve another set of definitions: all branches count.
            let whole = without_comments(source);
            imports::unused(&Text::new(file, &whole, is_module, true), &mut own);
            directives::conditions(source, &text, &mut own);
        }
        if text.is_composed {
            imports::overrides(&text, &overrides, &mut own);
        }
        directives::layout_attributes(&text, &mut own);
        names::find(&text, &mut own);
        constants::find(&text, &mut own);
        operators::find(&text, &mut own);
        control::find(&text, &mut own);
        index::find(&text, &mut own);
        own.sort_by_key(|finding| (finding.line, finding.column));
        findings.append(&mut own);
    }
    findings
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let findings = layout(&library);
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
