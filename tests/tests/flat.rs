// SPDX-License-Identifier: MIT OR Apache-2.0
//! `wgsl/flat/` is what the sources say: fresh, valid as core WebGPU, and with the interface of the composed passes.
#![allow(clippy::unwrap_used)]

use airlight_tests::parallel;
use airlight_validate::{Library, Reflection, core_capabilities, flat};
use airlight_wgsl::FLAT;
use naga::valid::{ValidationFlags, Validator};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

fn wgsl() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../wgsl")
}

#[test]
fn the_folder_is_fresh() {
    let library = Library::from_directory(&wgsl()).unwrap();
    let files = flat::render(&library).unwrap();
    assert!(
        files == flat::render(&Library::builtin()).unwrap(),
        "it matters where the shaders are read from"
    );
    let nothing = |_: &Path, _: &str| -> std::io::Result<()> { unreachable!("nothing is written") };
    let stale = flat::sync(&wgsl().join("flat"), &files, flat::Kept::Compared, nothing);
    assert_eq!(stale, Ok(()), "run `airlight-validate flatten`");
    let list = BTreeMap::from([("flat.rs".to_owned(), flat::list(&library))]);
    let stale = flat::sync_files(&wgsl().join("src"), &list, flat::Kept::Compared, nothing);
    assert_eq!(stale, Ok(()), "run `airlight-validate flatten`");
}

#[test]
fn the_crate_holds_every_permutation() {
    let library = Library::builtin();
    let mut expected = BTreeSet::new();
    for pass in library.passes() {
        for permutation in library.permutations(&pass.name).unwrap() {
            expected.insert((pass.name.clone(), permutation.name.clone()));
        }
    }
    let held: BTreeSet<_> = FLAT.iter().map(|f| (f.pass.to_owned(), f.permutation.to_owned())).collect();
    assert_eq!(held, expected);
    assert_eq!(FLAT.len(), expected.len());
    for flat in FLAT {
        assert_eq!(flat.source, std::fs::read_to_string(wgsl().join(flat.file)).unwrap(), "{}", flat.file);
    }
}

/// Sizes of a function: statements of its body's blocks, local variables, arguments.
fn shape(function: &naga::Function) -> [usize; 3] {
    fn statements(block: &naga::Block) -> usize {
        // How expressions are gathered into ranges (`Emit`) is the front end's affair.
        let inner = |statement: &naga::Statement| match statement {
            naga::Statement::Block(block) => statements(block),
            naga::Statement::If { accept, reject, .. } => statements(accept) + statements(reject),
            naga::Statement::Loop { body, continuing, .. } => statements(body) + statements(continuing),
            _ => 0,
        };
        let counted = |statement: &&naga::Statement| !matches!(statement, naga::Statement::Emit(_));
        block.iter().map(inner).sum::<usize>() + block.iter().filter(counted).count()
    }
    [statements(&function.body), function.local_variables.len(), function.arguments.len()]
}

/// Functions and entry points by name.
fn functions(module: &naga::Module) -> BTreeMap<String, [usize; 3]> {
    let functions = module.functions.iter().map(|(_, f)| (f.name.clone().unwrap(), shape(f)));
    let entry_points = module.entry_points.iter().map(|entry| (entry.name.clone(), shape(&entry.function)));
    functions.chain(entry_points).collect()
}

#[test]
fn flat_and_composed_passes_have_equal_interfaces_and_functions() {
    let library = Library::builtin();
    let wrong: Vec<String> = parallel::rows(FLAT.len(), |index| {
        let flat = &FLAT[index];
        let module = match naga::front::wgsl::parse_str(flat.source) {
            Ok(module) => module,
            Err(error) => return vec![error.emit_to_string_with_path(flat.source, flat.file)],
        };
        let mut validator = Validator::new(ValidationFlags::all(), core_capabilities());
        let info = match validator.validate(&module) {
            Ok(info) => info,
            Err(error) => return vec![format!("{}: {error:?}", flat.file)],
        };
        let definitions = &library.permutation(flat.pass, flat.permutation).unwrap().definitions;
        let composed = library.compose(flat.pass, definitions).unwrap();
        let mut wrong = Vec::new();
        if Reflection::new(&module, &info) != composed.reflect() {
            wrong.push(format!("{}: another interface than the composed pass", flat.file));
        }
        // The composer keeps functions that nothing calls; what is called is there, or it would not validate.
        let (own, others) = (functions(&module), functions(&composed.module));
        let different: Vec<_> = own.iter().filter(|pair| others.get(pair.0) != Some(pair.1)).collect();
        if !different.is_empty() {
            wrong.push(format!("{}: functions unlike the composed ones: {different:?}", flat.file));
        }
        wrong
    })
    .into_iter()
    .flatten()
    .collect();
    assert!(wrong.is_empty(), "{} of {}:\n{}", wrong.len(), FLAT.len(), wrong.join("\n"));
}

#[test]
fn every_file_says_what_it_is() {
    let version = env!("CARGO_PKG_VERSION");
    for flat in FLAT {
        let lines: Vec<&str> = flat.source.lines().collect();
        assert_eq!(lines[0], "// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense", "{}", flat.file);
        let title = format!("// Airlight {version}: {}, permutation {}", flat.pass, flat.permutation);
        assert!(lines[1].starts_with(&title), "{}: {}", flat.file, lines[1]);
        // The summary and source of the pass and of each module that something is taken from.
        let parts = lines.iter().filter(|line| line.starts_with("// ---- airlight::")).count() + 1;
        for key in ["// summary: ", "// source: "] {
            assert_eq!(lines.iter().filter(|line| line.starts_with(key)).count(), parts, "{}", flat.file);
        }
        assert!(!flat.source.contains("naga_oil") && !flat.source.contains("\n\n\n"), "{}", flat.file);
        assert!(lines.iter().all(|line| !line.trim_start().starts_with('#')), "{}: a directive", flat.file);
        assert!(flat.source.ends_with("}\n"), "{}", flat.file);
    }
}
