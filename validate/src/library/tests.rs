// SPDX-License-Identifier: MIT OR Apache-2.0
//! Reading a folder.

#![allow(clippy::unwrap_used)]
use super::*;
use std::fs;

/// A folder with files.
fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (file, text) in files {
        let path = folder.path().join(file);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    folder
}

fn module(path: &str, imports: &[&str]) -> String {
    let imports: String = imports.iter().map(|import| format!("#import {import}\n")).collect();
    format!("#define_import_path {path}\n{imports}")
}

#[test]
fn modules_follow_what_they_import() {
    let folder = folder(&[
        ("core/a.wgsl", &module("airlight::core::a", &["airlight::core::z"])),
        ("core/z.wgsl", &module("airlight::core::z", &["airlight::late::m::item"])),
        ("late/m.wgsl", &module("airlight::late::m", &[])),
        ("core/passes/p.wgsl", "#import airlight::core::a\n"),
        ("core/permutations", "p\n+ default:\n"),
        ("core/flat/p.wgsl", "not a module"),
        ("flat/p.wgsl", "not a module"),
        ("src/lib.rs", "not a shader"),
    ]);
    let library = Library::from_directory(folder.path()).unwrap();
    let order: Vec<&str> = library.modules().iter().map(|module| module.path.as_str()).collect();
    assert_eq!(order, ["airlight::late::m", "airlight::core::z", "airlight::core::a"]);
    assert_eq!(library.passes().len(), 1);
    assert_eq!(library.passes()[0].name, "core/p");
    assert_eq!(library.passes()[0].file, "core/passes/p.wgsl");
    assert_eq!(library.permutations("core/p").unwrap()[0].name, "default");
    assert_eq!(library.unlisted, []);
    assert_eq!(library.closure(&library.passes()[0].imports).len(), 3);
}

#[test]
fn a_cycle_is_an_error_that_names_it() {
    let folder = folder(&[
        ("core/a.wgsl", &module("airlight::core::a", &["airlight::core::b"])),
        ("core/b.wgsl", &module("airlight::core::b", &["airlight::core::a"])),
    ]);
    let error = Library::from_directory(folder.path()).unwrap_err();
    assert_eq!(error.location().unwrap().file, "core/a.wgsl");
    assert!(
        error.message().contains("airlight::core::a -> airlight::core::b -> airlight::core::a"),
        "{error}"
    );
}

#[test]
fn broken_folders_are_errors() {
    let error = Library::from_directory(folder(&[("core/x.txt", "")]).path()).unwrap_err();
    assert!(matches!(error, Error::Empty(_)), "{error}");
    let error = Library::from_directory(Path::new("/no/such/folder")).unwrap_err();
    assert!(matches!(error, Error::Read { .. }), "{error}");
    let nameless = folder(&[("core/a.wgsl", "fn f() {}\n")]);
    let error = Library::from_directory(nameless.path()).unwrap_err();
    assert_eq!(error.location().unwrap().file, "core/a.wgsl");
    let listing = folder(&[("core/passes/p.wgsl", ""), ("core/permutations", "p\n+ half: A\n")]);
    let error = Library::from_directory(listing.path()).unwrap_err();
    assert_eq!(error.location().unwrap().to_string(), "core/permutations:1");
}

#[test]
fn an_unlisted_pass_still_has_its_default() {
    let folder = folder(&[("core/passes/p.wgsl", "")]);
    let library = Library::from_directory(folder.path()).unwrap();
    assert_eq!(library.permutations("core/p").unwrap().len(), 1);
    assert_eq!(library.unlisted.len(), 1);
}

#[test]
fn a_foreign_pass_is_composed_against_the_modules_of_the_library() {
    let folder = folder(&[
        ("core/a.wgsl", "#define_import_path airlight::core::a\nfn one() -> u32 { return 1u; }\n"),
        ("core/passes/p.wgsl", "#import airlight::core::a\n"),
        ("core/permutations", "p\n+ default:\n"),
    ]);
    let library = Library::from_directory(folder.path()).unwrap();
    let source = "#import airlight::core::a::one\n\
        @group(#{GROUP}) @binding(0) var<storage, read_write> out: array<u32>;\n\
        @compute @workgroup_size(1)\nfn main() { out[0] = one(); }\n";
    let library = library.with_pass("foreign", "p", source);
    assert_eq!(library.pass("foreign/p").unwrap().imports, ["airlight::core::a"]);
    assert_eq!(library.unlisted, []);
    let definitions = library.permutation("foreign/p", "default").unwrap().definitions.clone();
    let composed = library.compose("foreign/p", &definitions).unwrap();
    assert_eq!(composed.reflect().entry_points[0].name, "main");

    // A second one of the name takes its place, and an error in it is located in it.
    let library = library.with_pass("foreign", "p", "#import airlight::core::b\n");
    assert_eq!(library.passes().len(), 2);
    let error = library.compose("foreign/p", &definitions).unwrap_err();
    assert_eq!(error.location().unwrap().to_string(), "foreign/passes/p.wgsl:1:9");
}
