// SPDX-License-Identifier: MIT OR Apache-2.0
//! The crate `airlight-wgsl` is the folder `wgsl/`, and every shader says of itself what an engine
//! has to know: licence, summary, source, and each function, member, binding and definition.
#![allow(clippy::unwrap_used)]

use airlight_wgsl::{MODULES, PASSES, SYSTEMS};
use naga_oil::compose::{ComposableModuleDescriptor, Composer, NagaModuleDescriptor, ShaderDefValue};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::{Path, PathBuf};

const LICENCE: &str = "// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense";

fn wgsl() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../wgsl")
}

/// Names of the entries of a folder; none where it does not exist.
fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).into_iter().flatten();
    entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
}

/// What is on disk: systems, modules and passes as files relative to `wgsl/`.
fn on_disk() -> [BTreeSet<String>; 3] {
    let [mut systems, mut modules, mut passes] = [const { BTreeSet::new() }; 3];
    for system in names(&wgsl()) {
        let folder = wgsl().join(&system);
        if !folder.is_dir() || ["src", "flat", "npm"].contains(&system.as_str()) {
            continue;
        }
        let shaders = |folder: &Path| names(folder).into_iter().filter(|name| name.ends_with(".wgsl"));
        modules.extend(shaders(&folder).map(|name| format!("{system}/{name}")));
        passes.extend(shaders(&folder.join("passes")).map(|name| format!("{system}/passes/{name}")));
        systems.insert(system);
    }
    [systems, modules, passes]
}

/// Every shader: file and source.
fn shaders() -> impl Iterator<Item = (&'static str, &'static str)> {
    MODULES.iter().map(|m| (m.file, m.source)).chain(PASSES.iter().map(|p| (p.file, p.source)))
}

/// Import paths that a source names, items taken off, in any of naga_oil's spellings.
fn imported(source: &str) -> BTreeSet<String> {
    let code: String =
        source.lines().map(|line| line.split("//").next().unwrap().to_owned() + "\n").collect();
    code.match_indices("airlight::")
        .filter(|(at, _)| !code[..*at].ends_with("#define_import_path "))
        .map(|(at, _)| {
            let rest = &code[at..];
            let end =
                rest.find(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':')).unwrap_or(rest.len());
            rest[..end].split("::").take(3).collect::<Vec<_>>().join("::")
        })
        .collect()
}

#[test]
fn the_lists_are_the_files() {
    let [systems, modules, passes] = on_disk();
    let listed = |files: Vec<&str>| -> BTreeSet<String> {
        let set: BTreeSet<String> = files.iter().map(|file| (*file).to_owned()).collect();
        assert_eq!(set.len(), files.len(), "something is listed twice");
        set
    };
    assert_eq!(listed(SYSTEMS.iter().map(|s| s.name).collect()), systems);
    assert_eq!(listed(MODULES.iter().map(|m| m.file).collect()), modules);
    assert_eq!(listed(PASSES.iter().map(|p| p.file).collect()), passes);
    for (file, source) in shaders() {
        assert_eq!(source, std::fs::read_to_string(wgsl().join(file)).unwrap(), "{file}");
    }
    for system in SYSTEMS {
        let path = wgsl().join(system.name).join("permutations");
        assert_eq!(system.permutations, std::fs::read_to_string(path).unwrap(), "{}", system.name);
        assert!(system.permutations.starts_with("# SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense"));
    }
}

#[test]
fn names_follow_from_files() {
    for module in MODULES {
        let path = format!("airlight::{}", module.file.trim_end_matches(".wgsl").replace('/', "::"));
        assert_eq!(module.path, path);
        let line = format!("#define_import_path {path}");
        assert_eq!(module.source.lines().nth(1), Some(line.as_str()), "{}", module.file);
    }
    for pass in PASSES {
        assert_eq!(pass.name, pass.file.trim_end_matches(".wgsl").replace("/passes/", "/"));
        let system = pass.name.split('/').next().unwrap();
        assert!(SYSTEMS.iter().any(|s| s.name == system), "{}", pass.name);
    }
}

#[test]
fn imports_are_those_of_the_source_and_listed_earlier() {
    for (index, module) in MODULES.iter().enumerate() {
        let listed: BTreeSet<String> = module.imports.iter().map(|path| (*path).to_owned()).collect();
        assert_eq!(listed, imported(module.source), "{}", module.file);
        for import in module.imports {
            let at = MODULES.iter().position(|other| other.path == *import);
            assert!(
                at.is_some_and(|at| at < index),
                "{} imports {import}, which is not listed before it",
                module.path
            );
        }
    }
    let known: BTreeSet<String> = MODULES.iter().map(|module| module.path.to_owned()).collect();
    for pass in PASSES {
        let imports = imported(pass.source);
        assert!(imports.is_subset(&known), "{}: {imports:?}", pass.file);
    }
}

#[test]
fn systems_know_only_whom_they_may() {
    // DESIGN.md, "Who may know whom".
    let may = |system: &str| -> &[&str] {
        match system {
            "core" => &["core"],
            "transmittance" => &["core", "transmittance"],
            "painterly" => &["core", "painterly"],
            "ambient" => &["core", "ambient"],
            "scattering" => &["core", "transmittance", "scattering"],
            "stylize" => &["core", "transmittance", "scattering", "stylize"],
            "splatting" => &["core", "transmittance", "splatting"],
            "inverse" => &["core", "transmittance", "inverse"],
            _ => &[],
        }
    };
    for (file, source) in shaders() {
        let system = file.split('/').next().unwrap();
        for import in imported(source) {
            let other = import.split("::").nth(1).unwrap();
            assert!(may(system).contains(&other), "{file} imports {import}");
        }
    }
}

/// Lines of the header that start with a key, without it.
fn header<'a>(source: &'a str, key: &str) -> Vec<&'a str> {
    let start = format!("// {key}");
    source
        .lines()
        .take_while(|line| line.starts_with("//") || line.starts_with("#define_import_path"))
        .filter_map(|line| line.strip_prefix(start.as_str()))
        .collect()
}

#[test]
fn every_shader_has_its_header() {
    for (file, source) in shaders() {
        assert_eq!(source.lines().next(), Some(LICENCE), "{file}");
        for key in ["summary: ", "source: "] {
            let lines = header(source, key);
            assert_eq!(lines.len(), 1, "{file} needs one line `// {key}`");
            assert!(lines[0].len() > 10 && lines[0].ends_with('.'), "{file}: `{}` is no sentence", lines[0]);
        }
        assert!(source.ends_with('\n') && !source.contains('\t') && !source.contains('\r'), "{file}");
    }
}

/// Entry `NAME: text` of a header: the name, if there is text.
fn entry(line: &str) -> Option<&str> {
    let (name, text) = line.split_once(": ")?;
    (text.len() > 5 && !name.contains(' ')).then_some(name)
}

/// Whether a module holds what several passes bind; it says so in its summary.
fn is_callback(source: &str) -> bool {
    header(source, "summary: ").iter().any(|summary| summary.to_lowercase().contains("callback"))
}

#[test]
fn every_binding_and_definition_is_explained() {
    let mut shared: BTreeMap<String, (BTreeSet<&str>, BTreeSet<&str>)> = BTreeMap::new();
    // Callbacks, like all modules, come before passes.
    for (file, source) in shaders() {
        let mut bindings = BTreeSet::new();
        let mut definitions = BTreeSet::new();
        for line in source.lines().filter(|line| !line.trim_start().starts_with("//")) {
            if line.contains("@binding(") {
                // `var name: …` or `var<space> name: …`
                let name = line.split_once("var").unwrap().1;
                let name = if name.starts_with('<') { name.split_once('>').unwrap().1 } else { name };
                let name = name.split(':').next().unwrap().trim();
                assert!(line.contains("@group(#{GROUP})"), "{file}: `{name}` lies in a group of its own");
                bindings.insert(name);
            }
            let mut rest = line;
            while let Some((_, after)) = rest.split_once("#{") {
                let (name, after) = after.split_once('}').unwrap();
                definitions.insert(name);
                rest = after;
            }
            for directive in ["#ifdef ", "#ifndef ", "#else ifdef ", "#else ifndef ", "#if "] {
                if let Some(name) = line.trim_start().strip_prefix(directive) {
                    definitions.insert(name.split_whitespace().next().unwrap());
                }
            }
        }
        definitions.remove("GROUP");
        let explained = |key: &str| -> BTreeSet<&str> {
            let lines = header(source, key);
            lines
                .iter()
                .map(|line| entry(line).unwrap_or_else(|| panic!("{file}: `// {key}{line}`")))
                .collect()
        };
        let module = !file.contains("/passes/");
        let callback = module && is_callback(source);
        assert!(!module || callback || bindings.is_empty(), "{file}: an algorithm module holds resources");
        // A pass explains its own, and those of its callbacks that its permutations reach.
        let of_callbacks = imported(source).into_iter().filter_map(|path| shared.get(&path));
        let (mut possible, mut read) = (bindings.clone(), definitions.clone());
        for (bound, used) in of_callbacks {
            possible.extend(bound);
            read.extend(used);
        }
        let explained = [explained("binding "), explained("definition ")];
        for (what, own, all, explained) in [
            ("bindings", &bindings, &possible, &explained[0]),
            ("definitions", &definitions, &read, &explained[1]),
        ] {
            let missing: Vec<_> = own.difference(explained).collect();
            let needless: Vec<_> = explained.difference(all).collect();
            assert!(missing.is_empty(), "{file}: {what} that are not explained: {missing:?}");
            assert!(needless.is_empty(), "{file}: {what} that are not there: {needless:?}");
        }
        if callback {
            let path = format!("airlight::{}", file.trim_end_matches(".wgsl").replace('/', "::"));
            // With those of the callbacks that it imports itself.
            shared.insert(path, (possible, read));
        }
        assert!(
            !module || !source.contains("\n@compute") && !source.contains("\n@fragment"),
            "{file}: entry points"
        );
    }
}

#[test]
fn every_function_and_member_of_a_module_is_documented() {
    for (file, source) in shaders() {
        let module = !file.contains("/passes/");
        let lines: Vec<&str> = source.lines().collect();
        let documented = |index: usize| {
            let above = lines[..index].iter().rev().find(|line| !line.trim_start().starts_with('@'));
            above.is_some_and(|line| line.trim_start().starts_with("///"))
        };
        let mut inside = "";
        for (index, line) in lines.iter().enumerate() {
            let place = format!("{file}:{}", index + 1);
            if line.starts_with("fn ") && module {
                assert!(documented(index), "{place}: `{line}` lacks `///`");
            }
            if line.starts_with("struct ") {
                inside = line;
                assert!(!module || documented(index), "{place}: `{line}` lacks `///`");
            } else if *line == "}" {
                inside = "";
            } else if !inside.is_empty() && line.contains(':') && !line.trim_start().starts_with("///") {
                // Padding explains itself; what passes between stages of one file is not shared.
                let name = line.trim().split(':').next().unwrap();
                let private = line.contains("@location") || line.contains("@builtin");
                assert!(
                    name.starts_with("reserved") || private || documented(index),
                    "{place}: member `{name}` of `{inside}` lacks `///`"
                );
                assert!(
                    !name.ends_with(|c: char| c.is_ascii_digit()),
                    "{place}: naga appends `_` to `{name}`"
                );
            }
        }
    }
}

#[test]
fn a_composer_is_filled_in_five_lines() {
    // As the documentation of `airlight-wgsl` says.
    let mut composer = Composer::default();
    for module in airlight_wgsl::MODULES {
        let descriptor = ComposableModuleDescriptor {
            source: module.source,
            file_path: module.file,
            ..Default::default()
        };
        composer.add_composable_module(descriptor).unwrap();
    }
    for pass in PASSES {
        let definitions = [("GROUP", 1), ("BASES", 32), ("BASES_PER_THREAD", 8), ("COEFFICIENTS", 4)];
        // Rank queries take the place of bases: only the pass that makes their structure is told.
        let ranks = ["scattering/rank", "scattering/rank_weights", "scattering/wavelet"];
        let rank = ranks.contains(&pass.name).then_some(("RANK", 12));
        let weights = (pass.name == "scattering/rank_weights").then_some(("WEIGHT_BITS", 8));
        let shader_defs: HashMap<_, _> = definitions
            .into_iter()
            .chain(rank)
            .chain(weights)
            .map(|(name, value)| (name.to_owned(), ShaderDefValue::Int(value)))
            .collect();
        let descriptor = NagaModuleDescriptor {
            source: pass.source,
            file_path: pass.file,
            shader_defs,
            ..Default::default()
        };
        let module = composer.make_naga_module(descriptor).unwrap();
        assert!(!module.entry_points.is_empty(), "{}", pass.name);
        // In a group of the engine's choice.
        let mut places = module.global_variables.iter().filter_map(|(_, variable)| variable.binding.as_ref());
        assert!(places.all(|place| place.group == 1), "{}", pass.name);
    }
}

/// Every module that a shader's text names, with what these name in turn; import paths.
fn reached(source: &str, into: &mut BTreeSet<String>) {
    for path in imported(source) {
        if into.insert(path.clone()) {
            let module = MODULES.iter().find(|module| module.path == path);
            reached(module.unwrap_or_else(|| panic!("no module {path}")).source, into);
        }
    }
}

/// The row of a pass in the table of vendoring.
fn row(pass: &str, source: &str) -> String {
    let mut all = BTreeSet::new();
    reached(source, &mut all);
    let mut cells = [const { Vec::new() }; 3];
    for path in &all {
        let name = path.trim_start_matches("airlight::").replace("::", "/");
        let cell = match () {
            () if MODULES.iter().any(|module| module.path == *path && is_callback(module.source)) => 0,
            () if name.starts_with("core/") => 1,
            () => 2,
        };
        let own = pass.split_once('/').unwrap().0;
        let short = name.trim_start_matches("core/").trim_start_matches(&format!("{own}/"));
        cells[cell].push(short.to_owned());
    }
    let cells = cells.map(|names| if names.is_empty() { "none".to_owned() } else { names.join(", ") });
    format!("| `{pass}` | {} |", cells.join(" | "))
}

#[test]
fn the_book_says_what_each_pass_needs() {
    let book = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/src/vendoring/files.md");
    let book = std::fs::read_to_string(book).unwrap();
    let found: Vec<&str> = book.lines().filter(|line| line.starts_with("| `")).collect();
    let expected: Vec<String> = PASSES.iter().map(|pass| row(pass.name, pass.source)).collect();
    let mut missing = String::new();
    for row in expected.iter().filter(|row| !found.contains(&row.as_str())) {
        missing += &format!("{row}\n");
    }
    assert!(missing.is_empty(), "docs/src/vendoring/files.md lacks these rows:\n{missing}");
    let needless: Vec<_> = found.iter().filter(|row| !expected.iter().any(|e| e == *row)).collect();
    assert!(needless.is_empty(), "docs/src/vendoring/files.md has rows of its own: {needless:#?}");
}
