// SPDX-License-Identifier: MIT OR Apache-2.0
//! The book says what is so: generated pages are fresh, pictures and tests that it names exist, its Rust is compiled and
//! its WGSL composes.
#![allow(clippy::unwrap_used)]

use airlight_validate::{
    Definitions, Library,
    docs::{self, Pictures, header},
    files_below,
};
use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn read(path: &str) -> String {
    fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// Every chapter: path from `docs/src`, and text.
fn chapters() -> Vec<(String, String)> {
    let names = files_below(&root().join("docs/src"), "md").unwrap();
    names.into_iter().map(|name| (name.clone(), read(&format!("docs/src/{name}")))).collect()
}

/// Fenced blocks of a chapter: the line before the fence, what stands behind it, and the text.
fn blocks(text: &str) -> Vec<(&str, &str, String)> {
    let lines: Vec<&str> = text.lines().collect();
    let mut found = Vec::new();
    let mut at = 0;
    while at < lines.len() {
        if let Some(kind) = lines[at].strip_prefix("```") {
            let end = (at + 1..lines.len()).find(|&line| lines[line] == "```").expect("a fence is closed");
            let before = if at > 0 { lines[at - 1] } else { "" };
            found.push((before, kind, lines[at + 1..end].join("\n") + "\n"));
            at = end;
        }
        at += 1;
    }
    found
}

#[test]
fn generated_pages_are_fresh() {
    let library = Library::from_directory(&root().join("wgsl")).unwrap();
    let pictures = Pictures::parse(&read("docs/src/pictures/modules.txt")).unwrap();
    let pages = docs::pages(&library, &pictures).unwrap();
    for (page, text) in &pages {
        let there = fs::read_to_string(root().join("docs/src").join(page)).unwrap_or_default();
        assert!(there == *text, "docs/src/{page} is stale; run `airlight-validate docs`");
    }
    let generated = |name: &str| name.starts_with("modules/");
    let there: BTreeSet<String> =
        chapters().into_iter().map(|(name, _)| name).filter(|name| generated(name)).collect();
    let written: BTreeSet<String> = pages.into_keys().filter(|name| generated(name)).collect();
    assert_eq!(there, written);
    let contents = read("docs/src/SUMMARY.md");
    assert_eq!(docs::summary(&library, &contents).unwrap(), contents);
}

#[test]
fn the_lists_of_the_crate_are_fresh() {
    let library = Library::from_directory(&root().join("wgsl")).unwrap();
    let written = airlight_validate::list::render(&library);
    assert!(written == read("wgsl/src/list.rs"), "wgsl/src/list.rs is stale; run `airlight-validate list`");
}

#[test]
fn every_module_says_what_there_is_to_say() {
    let unsaid = docs::unsaid(&Library::builtin());
    assert!(unsaid.is_empty(), "{}", unsaid.join("\n"));
}

#[test]
fn error_bounds_name_tests_that_exist() {
    let mut named = 0;
    for module in airlight_wgsl::MODULES {
        for error in header(module.source).errors {
            let test =
                error.test.unwrap_or_else(|| panic!("{}: `{}` names no test", module.file, error.bound));
            let (file, name) = test.split_once("::").unwrap_or_else(|| panic!("{}: `{test}`", module.file));
            let source = read(&format!("tests/tests/{file}.rs"));
            let lines: Vec<&str> = source.lines().map(str::trim).collect();
            let at = lines.iter().position(|line| line.starts_with(&format!("fn {name}(")));
            let at = at.unwrap_or_else(|| panic!("{}: tests/tests/{file}.rs has no `{name}`", module.file));
            let above = lines[..at].iter().rev().take_while(|line| line.starts_with("#["));
            assert!(above.into_iter().any(|line| *line == "#[test]"), "{}: `{test}` is no test", module.file);
            named += 1;
        }
    }
    assert!(named >= airlight_wgsl::MODULES.len());
}

#[test]
fn pictures_of_modules_exist_and_each_belongs_to_something() {
    let pictures = Pictures::parse(&read("docs/src/pictures/modules.txt")).unwrap();
    let library = Library::builtin();
    let modules = library.modules().iter().map(|module| module.file.trim_end_matches(".wgsl").to_owned());
    let passes = library.passes().iter().map(|pass| pass.name.clone());
    let mut known: BTreeSet<String> = modules.chain(passes).collect();
    for name in &known {
        assert!(pictures.of(name).is_some(), "{name} has no picture");
    }
    known.extend(airlight_wgsl::SYSTEMS.iter().map(|system| system.name.to_owned()));
    for (name, file) in pictures.entries() {
        assert!(known.contains(name), "a picture of `{name}`, which is neither module nor pass nor system");
        assert!(root().join("docs/src/pictures").join(file).is_file(), "{file}");
    }
}

#[test]
fn links_between_chapters_lead_somewhere() {
    let book = root().join("docs/src");
    let mut links = 0;
    for (name, text) in chapters() {
        let folder = book.join(&name);
        let folder = folder.parent().unwrap();
        let outside: String = text.split("```").step_by(2).collect();
        for (_, rest) in outside.match_indices("](").map(|(at, _)| outside.split_at(at + 2)) {
            let target = rest.split(')').next().unwrap().split('#').next().unwrap();
            if target.is_empty() || target.contains("://") {
                continue;
            }
            assert!(folder.join(target).is_file(), "{name} links to {target}");
            links += 1;
        }
    }
    assert!(links > 300, "{links}");
}

#[test]
fn rust_of_the_book_is_compiled() {
    let compiled = read("tests/src/book.rs");
    let mut found = 0;
    for (name, text) in chapters() {
        let listed = compiled.contains(&format!("include_str!(\"../../docs/src/{name}\")"));
        let rust = blocks(&text).iter().filter(|(_, kind, _)| kind.starts_with("rust")).count();
        assert_eq!(listed, rust > 0, "{name} has Rust if and only if tests/src/book.rs lists it");
        for (before, kind, _) in blocks(&text).iter().filter(|(_, kind, _)| kind.contains("ignore")) {
            let reason = before.starts_with("<!-- ") && before.ends_with(" -->") && before.len() > 20;
            assert!(reason, "{name}: a block `{kind}` needs a comment above it that says why");
        }
        found += rust;
    }
    assert!(found >= 5);
}

#[test]
fn wgsl_of_the_book_composes() {
    let mut found = 0;
    for (name, text) in chapters() {
        for (_, kind, source) in blocks(&text) {
            if kind != "wgsl" {
                assert!(!kind.starts_with("wgsl") || kind == "wgsl,ignore", "{name}: `{kind}`");
                continue;
            }
            let library = Library::builtin().with_pass("core", "of_the_book", &source);
            let composed = library.compose("core/of_the_book", &Definitions::new());
            let composed = composed.unwrap_or_else(|error| panic!("{name}: {error}\n{source}"));
            let something = !composed.module.functions.is_empty() || !composed.module.entry_points.is_empty();
            assert!(something, "{name}: a block without a function proves nothing\n{source}");
            found += 1;
        }
    }
    assert!(found >= 2);
}

#[test]
fn wgsl_that_is_wrong_does_not_compose() {
    for source in [
        "#import airlight::core::phase::no_such_function\nfn f() -> f32 { return no_such_function(); }\n",
        "#import airlight::core::phase::henyey_greenstein\nfn f() -> f32 { return henyey_greenstein(1.0); }\n",
    ] {
        let library = Library::builtin().with_pass("core", "of_the_book", source);
        assert!(library.compose("core/of_the_book", &Definitions::new()).is_err(), "{source}");
    }
}
