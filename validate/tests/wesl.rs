// SPDX-License-Identifier: MIT OR Apache-2.0
//! The WESL package, compiled by the crate `wesl`: every module is the one that naga_oil composes, and what it computes is
//! what it should.
#![allow(clippy::unwrap_used, missing_docs)]

use airlight_validate::{
    Composed, Definitions, Library, StructLayout, core_capabilities, flat, naga,
    wesl::{modules, package},
};
use naga::valid::{ValidationFlags, Validator};
use std::{borrow::Cow, collections::BTreeMap};
use wesl::{CompileOptions, CompileResult, ManglerKind, ModulePath, VirtualResolver, Wesl};

/// `airlight::core::phase` as `package::core::phase`.
fn inside(path: &str) -> ModulePath {
    path.replacen("airlight", "package", 1).parse().unwrap()
}

/// The whole package, and `main` beside it.
fn compiled(library: &Library, main: &str, root: &ModulePath, options: CompileOptions) -> CompileResult {
    let files = package(library, &modules(library)).unwrap();
    let mut resolver = VirtualResolver::new();
    for (file, text) in files.into_iter().skip(1) {
        let path = format!("package::{}", file.trim_end_matches(".wesl").replace('/', "::"));
        resolver.add_module(path.parse().unwrap(), Cow::Owned(text));
    }
    resolver.add_module("package::main".parse().unwrap(), Cow::Borrowed(main));
    let mut compiler = Wesl::new_barebones().set_custom_resolver(resolver);
    compiler.set_options(options).use_sourcemap(true).set_mangler(ManglerKind::None);
    compiler.compile(root).unwrap_or_else(|error| panic!("{root}: {error}"))
}

/// All that a module and its imports declare, with `definitions` as features.
fn whole(library: &Library, path: &str, definitions: &Definitions) -> Composed {
    let mut options = CompileOptions { strip: false, lazy: false, ..CompileOptions::default() };
    options.features.default = wesl::Feature::Disable;
    for (name, _) in definitions.iter() {
        options.features.flags.insert(name.to_owned(), wesl::Feature::Enable);
    }
    let text = compiled(library, "", &inside(path), options).to_string();
    let module = naga::front::wgsl::parse_str(&text)
        .unwrap_or_else(|error| panic!("{path}: {}", error.emit_to_string(&text)));
    let mut validator = Validator::new(ValidationFlags::all(), core_capabilities());
    let info = validator.validate(&module).unwrap_or_else(|error| panic!("{path}: {error:?}"));
    let (pass, file) = (path.to_owned(), path.to_owned());
    Composed { pass, file, definitions: definitions.clone(), module, info }
}

/// Each function as naga writes it, by name.
fn functions(composed: &Composed) -> BTreeMap<String, String> {
    let text = flat::write(composed).unwrap();
    let functions = text.split("\nfn ").skip(1).map(|function| {
        let end = function.find("\n}").unwrap();
        let name = function.split('(').next().unwrap();
        (name.to_owned(), function[..end].to_owned())
    });
    functions.collect()
}

fn structs(composed: &Composed) -> BTreeMap<String, StructLayout> {
    composed.reflect().structs.into_iter().map(|layout| (layout.name.clone(), layout)).collect()
}

/// Sets of definitions under which a module of the package is not one and the same.
fn definitions(library: &Library, path: &str) -> Vec<Definitions> {
    let text = package(library, &[path]).unwrap().into_iter().map(|(_, text)| text).collect::<String>();
    let mut names: Vec<&str> =
        text.split("@if(").skip(1).map(|rest| rest.split(')').next().unwrap()).collect();
    names.sort_unstable();
    names.dedup();
    names.retain(|name| !name.starts_with('!'));
    let each = names.into_iter().map(|name| Definitions::new().flag(name));
    [Definitions::new()].into_iter().chain(each).collect()
}

#[test]
fn every_module_is_the_one_that_naga_oil_composes() {
    let library = Library::builtin();
    let mut compared = 0;
    let mut variants = 0;
    for path in modules(&library) {
        for definitions in definitions(&library, path) {
            let oil = library.compose_module(path, &definitions).unwrap();
            let wesl = whole(&library, path, &definitions);
            let (expected, found) = (structs(&oil), structs(&wesl));
            for (name, layout) in &expected {
                assert_eq!(found.get(name), Some(layout), "{path}: struct {name}");
            }
            let (expected, found) = (functions(&oil), functions(&wesl));
            for (name, text) in &expected {
                assert_eq!(found.get(name), Some(text), "{path}: fn {name}");
                compared += 1;
            }
            variants += usize::from(!definitions.is_empty());
        }
    }
    assert!(compared > 300, "{compared} functions are too few to be the library");
    assert!(variants > 0, "no module was compiled with a feature");
}
