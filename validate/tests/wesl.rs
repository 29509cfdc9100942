// SPDX-License-Identifier: MIT OR Apache-2.0
//! The WESL package, compiled by the crate `wesl`: every module is the one that naga_oil composes, and what it computes is
//! what it should.
#![allow(clippy::unwrap_used, missing_docs)]

use airlight_validate::{
    Composed, Definitions, Library, core_capabilities, flat, naga,
    wesl::{modules, package},
};
use naga::valid::{ValidationFlags, Validator};
use std::{borrow::Cow, collections::BTreeMap};
use wesl::{
    CodegenModule, CodegenPkg, CompileOptions, CompileResult, Mangler, ModulePath, VirtualResolver, Wesl,
};

/// `airlight::core::phase` as `package::core::phase`.
fn inside(path: &str) -> ModulePath {
    path.replacen("airlight", "package", 1).parse().unwrap()
}

/// Names that tell their module and from which it can be taken off again.
struct Told;

impl Mangler for Told {
    fn mangle(&self, path: &ModulePath, item: &str) -> String {
        format!("{item}_of_{}_x", path.components.join("_"))
    }
}

/// Text without what [`Told`] added.
fn plain(library: &Library, text: &str) -> String {
    library.modules().iter().fold(text.to_owned(), |text, module| {
        let path = module.path.replacen("airlight::", "", 1);
        text.replace(&format!("_of_{}_x", path.replace("::", "_")), "")
    })
}

/// The whole package, with `root` compiled.
fn compiled(library: &Library, root: &ModulePath, options: CompileOptions) -> CompileResult {
    let mut resolver = VirtualResolver::new();
    for (file, text) in package(library, &modules(library)).unwrap().into_iter().skip(1) {
        let path = format!("package::{}", file.trim_end_matches(".wesl").replace('/', "::"));
        resolver.add_module(path.parse().unwrap(), Cow::Owned(text));
    }
    let mut compiler = Wesl::new_barebones().set_custom_resolver(resolver);
    compiler.set_options(options).use_sourcemap(true).set_custom_mangler(Told);
    compiler.compile(root).unwrap_or_else(|error| panic!("{root}: {error}"))
}

/// All that a module and its imports declare, with `definitions` as features.
fn whole(library: &Library, path: &str, definitions: &Definitions) -> Composed {
    let mut options = CompileOptions { strip: false, lazy: false, ..CompileOptions::default() };
    options.features.default = wesl::Feature::Disable;
    for (name, _) in definitions.iter() {
        options.features.flags.insert(name.to_owned(), wesl::Feature::Enable);
    }
    let text = compiled(library, &inside(path), options).to_string();
    let module = naga::front::wgsl::parse_str(&text)
        .unwrap_or_else(|error| panic!("{path}: {}", error.emit_to_string(&text)));
    let mut validator = Validator::new(ValidationFlags::all(), core_capabilities());
    let info = validator.validate(&module).unwrap_or_else(|error| panic!("{path}: {error:?}"));
    let (pass, file) = (path.to_owned(), path.to_owned());
    Composed { pass, file, definitions: definitions.clone(), module, info }
}

/// Each function as naga writes it, by name.
fn functions(library: &Library, composed: &Composed) -> BTreeMap<String, String> {
    let text = format!("\n{}", plain(library, &flat::write(composed).unwrap()));
    let functions = text.split("\nfn ").skip(1).map(|function| {
        let end = function.find("\n}").unwrap();
        let name = function.split('(').next().unwrap();
        (name.to_owned(), counted(&function[..end]))
    });
    functions.collect()
}

/// A function with the names that naga numbered counted anew, in the order in which they stand in it.
fn counted(function: &str) -> String {
    let mut counts: BTreeMap<String, Vec<String>> = BTreeMap::new();
    let mut output = String::new();
    let mut rest = function;
    while let Some(letter) = rest.chars().next() {
        let end = rest.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(rest.len());
        let (word, after) = rest.split_at(end.max(letter.len_utf8()));
        rest = after;
        // The one name that modules share, which `airlight-validate` puts the module's before.
        let word = if word.ends_with("_PI") { "PI" } else { word };
        let base = word.trim_end_matches(|c: char| c.is_ascii_digit());
        // Members are not numbered, but parts of vectors may look like locals that are.
        let member = output.ends_with('.');
        let numbered = !member && (base.ends_with('_') || base == "_e");
        let base = if numbered { base.trim_end_matches('_') } else { word };
        if member {
            output += word;
            continue;
        }
        let known = counts.entry(base.to_owned()).or_default();
        let count = known.iter().position(|other| other == word).unwrap_or_else(|| {
            known.push(word.to_owned());
            known.len() - 1
        });
        output += base;
        if count > 0 {
            output += &format!("_{count}");
        }
    }
    output
}

/// Each struct's layout, by name.
fn structs(library: &Library, composed: &Composed) -> BTreeMap<String, String> {
    let layouts = composed.reflect().structs.into_iter();
    layouts.map(|layout| (plain(library, &layout.name), plain(library, &format!("{layout:?}")))).collect()
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
            let (expected, found) = (structs(&library, &oil), structs(&library, &wesl));
            for (name, layout) in &expected {
                assert_eq!(found.get(name), Some(layout), "{path}: struct {name}");
            }
            let (expected, found) = (functions(&library, &oil), functions(&library, &wesl));
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

/// A module of a package as a build script would write it into a program.
fn leaked(module: &wesl::Module) -> &'static CodegenModule {
    let leak = |text: &str| -> &'static str { Box::leak(text.to_owned().into_boxed_str()) };
    let submodules: Vec<_> = module.submodules.iter().map(leaked).collect();
    let (name, source) = (leak(&module.name), leak(&module.source));
    Box::leak(Box::new(CodegenModule { name, source, submodules: submodules.leak() }))
}

#[test]
fn a_shader_elsewhere_imports_every_module() {
    let library = Library::builtin();
    let folder = tempfile::tempdir().unwrap();
    for (file, text) in package(&library, &modules(&library)).unwrap() {
        let file = folder.path().join(file);
        std::fs::create_dir_all(file.parent().unwrap()).unwrap();
        std::fs::write(file, text).unwrap();
    }
    // As a build script makes it of the folder and its `wesl.toml`.
    let package = wesl::PkgBuilder::new("airlight").scan_toml(folder.path()).unwrap().validate().unwrap();
    let root = leaked(&package.root);
    let package: &'static CodegenPkg =
        Box::leak(Box::new(CodegenPkg { crate_name: "airlight", root, dependencies: &[] }));

    let paths = modules(&library);
    let mut main = String::new();
    for (index, path) in paths.iter().enumerate() {
        let text = &library.module(path).unwrap().source;
        let item = text.lines().find_map(|line| {
            let rest = ["fn ", "struct ", "const "].iter().find_map(|word| line.strip_prefix(word))?;
            rest.split(|c: char| !(c.is_alphanumeric() || c == '_')).next()
        });
        let letters = char::from(b'a' + (index / 26) as u8).to_string()
            + &char::from(b'a' + (index % 26) as u8).to_string();
        main += &format!("import {path}::{} as item_{letters};\n", item.unwrap());
    }
    main += "@compute @workgroup_size(1) fn main() {}\n";
    let mut resolver = wesl::StandardResolver::new(folder.path());
    resolver.add_package(package);
    std::fs::write(folder.path().join("main.wesl"), main).unwrap();
    let mut compiler = Wesl::new_barebones().set_custom_resolver(resolver);
    let mut options = CompileOptions { strip: false, lazy: false, ..CompileOptions::default() };
    options.features.default = wesl::Feature::Disable;
    compiler.set_options(options).set_custom_mangler(wesl::EscapeMangler);
    let text = compiler.compile(&"package::main".parse().unwrap()).unwrap().to_string();
    let module = naga::front::wgsl::parse_str(&text).unwrap();
    Validator::new(ValidationFlags::all(), core_capabilities()).validate(&module).unwrap();

    // Conditional translation took the branches without features; every other function is there.
    let written: usize =
        paths.iter().map(|path| library.module(path).unwrap().source.matches("\nfn ").count()).sum();
    let doubled = library.module("airlight::inverse::channels").unwrap().source.matches("\nfn ").count() / 2;
    assert_eq!(module.functions.len(), written - doubled);
}

#[test]
fn positions_and_comments_stay() {
    let library = Library::builtin();
    for (file, text) in package(&library, &modules(&library)).unwrap().iter().skip(1) {
        let source =
            &library.modules().iter().find(|m| m.file == file.replace(".wesl", ".wgsl")).unwrap().source;
        assert_eq!(source.lines().count(), text.lines().count(), "{file}");
        assert_eq!(source.lines().next(), text.lines().next(), "{file}: licence");
        for (index, (before, after)) in source.lines().zip(text.lines()).enumerate() {
            let comment = before.find("//").map_or("", |at| &before[at..]);
            let out = after.is_empty() && !before.is_empty();
            assert!(after.contains(comment) || out, "{file}:{}: {after}", index + 1);
        }
    }
}

/// What an expression over the functions of a module comes to.
fn value(module: &wesl::syntax::TranslationUnit, expression: &str) -> f64 {
    let (value, _) = wesl::eval(&expression.parse().unwrap(), module);
    let text = value.unwrap_or_else(|error| panic!("{expression}: {error}")).to_string();
    text.trim_end_matches('f').parse().unwrap_or_else(|_| panic!("{expression} = {text}"))
}

/// A module that imports nothing, its functions callable in constants.
fn constant(library: &Library, path: &str) -> wesl::syntax::TranslationUnit {
    let text = compiled(library, &inside(path), CompileOptions { strip: false, ..CompileOptions::default() });
    format!("\n{text}").replace("\nfn ", "\n@const fn ").parse().unwrap()
}

#[test]
fn functions_have_their_closed_forms() {
    let library = Library::builtin();
    let phase = constant(&library, "airlight::core::phase");
    for g in [-0.6_f64, 0.0, 0.5] {
        // The midpoint rule over 400 parts has an error below 1e-4 for these.
        let (mut sum, mut mean) = (0.0, 0.0);
        for part in 0..400 {
            let cosine = (f64::from(part) + 0.5) / 200.0 - 1.0;
            let density = value(&phase, &format!("henyey_greenstein({cosine:.6}, {g:.1})"));
            sum += density * std::f64::consts::TAU / 200.0;
            mean += cosine * density * std::f64::consts::TAU / 200.0;
        }
        assert!((sum - 1.0).abs() < 2e-4, "g = {g}: integrates to {sum}");
        assert!((mean - g).abs() < 2e-4, "g = {g}: mean cosine {mean}");
    }
    let prefix = constant(&library, "airlight::core::prefix_sum");
    for depth in [1e-6_f64, 0.01, 0.3, 2.0, 20.0] {
        let found = value(&prefix, &format!("one_minus_exp({depth:.8})"));
        let expected = -(-depth).exp_m1();
        assert!((found / expected - 1.0).abs() < 2e-6, "1 - exp(-{depth}) = {found}");
    }
    let arc = constant(&library, "airlight::core::arc_cosine");
    for cosine in [-1.0_f64, -0.7, 0.0, 0.2, 0.999, 1.0] {
        let found = value(&arc, &format!("arc_cosine({cosine:.6})"));
        assert!((found - cosine.acos()).abs() < 1e-5, "arc cosine of {cosine} = {found}");
    }
}
