// SPDX-License-Identifier: MIT OR Apache-2.0
//! Import paths, what they lead to, and the order of the modules.

use super::{File, Foreign, code, has_directives, has_entry_point};
use crate::{
    Location, ModuleSource, PassSource,
    imports::{self, Import},
    library,
};
use std::{
    collections::{BTreeMap, BTreeSet},
    panic::{AssertUnwindSafe, catch_unwind},
};

/// Modules, each after those that it imports where that is possible, and shaders.
#[derive(Debug, Default)]
pub(super) struct Resolved {
    pub modules: Vec<ModuleSource>,
    pub passes: Vec<PassSource>,
}

/// Finds what every file imports; what is not there is reported, and what depends on it left out.
pub(super) fn resolve(files: &[File], foreign: &mut Foreign) -> Resolved {
    let declared: Vec<Vec<Import>> = files.iter().map(|file| imports::declared(&file.text)).collect();
    // The file of each path, by index.
    let mut paths: BTreeMap<String, usize> = BTreeMap::new();
    for (index, file) in files.iter().enumerate() {
        let Some(path) = library::import_path(&file.text) else { continue };
        match paths.get(&path) {
            Some(&first) if !file.is_external => {
                let message = format!("`{path}` is the path of {} already; not checked", files[first].name);
                foreign.report(definition(file), "duplicate-module", message);
                foreign.unchecked.insert(file.name.clone());
            }
            // The tree's own module goes before one of a module folder.
            Some(_) => {}
            None => {
                paths.insert(path, index);
            }
        }
    }
    let named = quoted(files, &declared);
    paths.extend(named);

    let known: BTreeSet<String> = paths.keys().cloned().collect();
    let mut broken: BTreeMap<String, String> = BTreeMap::new();
    for (file, imports) in files.iter().zip(&declared) {
        for import in imports {
            if library::resolve(&import.path, |path| known.contains(path)).is_some()
                || begins(&import.path, &known)
            {
                continue;
            }
            let path = &import.path;
            let message =
                format!("import of `{path}`, which is no module of the tree; add its folder by --module-dir");
            if !file.is_external {
                foreign.report(place(file, import), "unresolved-import", message);
            }
            foreign.unchecked.insert(file.name.clone());
            broken
                .entry(file.name.clone())
                .or_insert_with(|| format!("imports `{path}`, which is not there"));
        }
    }
    let used = |file: &File, own: &str| {
        let read = AssertUnwindSafe(|| library::used(&file.text, &known, own));
        // naga_oil's reader may panic; then its composer says so of the file.
        catch_unwind(read).unwrap_or_default()
    };
    let modules: Vec<ModuleSource> = paths
        .iter()
        .map(|(path, &index)| {
            let file = &files[index];
            let (path, source) = (path.clone(), file.text.clone());
            ModuleSource { imports: used(file, &path), path, file: file.name.clone(), source }
        })
        .collect();
    let modules = ordered(modules, files, &declared, &mut broken, foreign);

    let mut passes = Vec::new();
    for (index, file) in files.iter().enumerate().filter(|(_, file)| !file.is_external) {
        let code = code(&file.text);
        let imports = used(file, &library::import_path(&file.text).unwrap_or_default());
        let is_plain = !has_directives(&code) && imports.is_empty();
        let is_module =
            paths.values().any(|&other| other == index) || library::import_path(&file.text).is_some();
        if is_plain {
            foreign.plain.insert(file.name.clone());
        }
        if has_entry_point(&code) || is_plain || !is_module {
            let (name, source) = (file.name.clone(), file.text.clone());
            passes.push(PassSource { file: name.clone(), name, source, imports });
        }
    }
    spread(&modules, &passes, &broken, foreign);
    Resolved { modules, passes }
}

/// The line of `#define_import_path`.
fn definition(file: &File) -> Location {
    let code = code(&file.text);
    let found =
        (1..).zip(code.lines()).find(|(_, line)| line.trim_start().starts_with("#define_import_path"));
    match found {
        Some((line, content)) => {
            let column = content.chars().take_while(|letter| letter.is_whitespace()).count() as u32 + 1;
            Location { file: file.name.clone(), line: Some(line), column: Some(column) }
        }
        None => Location::file(&file.name),
    }
}

fn place(file: &File, import: &Import) -> Location {
    Location { file: file.name.clone(), line: Some(import.line), column: Some(import.column) }
}

/// Whether a path is the beginning of paths that are there.
fn begins(path: &str, known: &BTreeSet<String>) -> bool {
    let prefix = format!("{path}::");
    known.range(prefix.clone()..).next().is_some_and(|next| next.starts_with(&prefix))
}

/// The file of every import in quotes, by the text with its quotes: beside the importer, or by its
/// path from the folder or from one above it, as long as there is one such file.
fn quoted(files: &[File], declared: &[Vec<Import>]) -> BTreeMap<String, usize> {
    let mut named = BTreeMap::new();
    for (file, imports) in files.iter().zip(declared) {
        for import in imports {
            let Some(target) = import.path.strip_prefix('"').and_then(|rest| rest.split('"').next()) else {
                continue;
            };
            let path = target.split_once("://").map_or(target, |(_, path)| path);
            let path = path.trim_start_matches("./").trim_start_matches('/');
            if path.is_empty() {
                continue;
            }
            let folder = file.relative.rsplit_once('/').map_or("", |(folder, _)| folder);
            let beside = if folder.is_empty() { path.to_owned() } else { format!("{folder}/{path}") };
            let exact = |wanted: &str| files.iter().position(|file| file.relative == wanted);
            let ends = || {
                let tail = format!("/{path}");
                let is_tail = |name: &str| name.ends_with(&tail);
                let mut fitting = (0..files.len()).filter(|&index| is_tail(&files[index].relative));
                fitting.next().filter(|_| fitting.next().is_none())
            };
            if let Some(index) = exact(path).or_else(|| exact(&beside)).or_else(ends) {
                named.insert(format!("\"{target}\""), index);
            }
        }
    }
    named
}

/// Each module after those that it imports; one of each circle is reported and the circle left open.
fn ordered(
    modules: Vec<ModuleSource>,
    files: &[File],
    declared: &[Vec<Import>],
    broken: &mut BTreeMap<String, String>,
    foreign: &mut Foreign,
) -> Vec<ModuleSource> {
    let mut waiting: Vec<ModuleSource> = modules;
    let mut done: BTreeSet<String> = BTreeSet::new();
    let mut order = Vec::with_capacity(waiting.len());
    while !waiting.is_empty() {
        let before = order.len();
        let mut left = Vec::new();
        for module in waiting {
            if module.imports.iter().all(|import| done.contains(import)) {
                done.insert(module.path.clone());
                order.push(module);
            } else {
                left.push(module);
            }
        }
        waiting = left;
        if order.len() > before || waiting.is_empty() {
            continue;
        }
        let circle = circle(&waiting, &done);
        let first = &waiting[circle[0]];
        let next = &waiting[circle[1 % circle.len()]];
        let mut shown: Vec<&str> = circle.iter().map(|&index| waiting[index].path.as_str()).collect();
        shown.push(&first.path);
        let message = format!("import cycle {}; the modules of it are not checked", shown.join(" -> "));
        let index = files.iter().position(|file| file.name == first.file);
        let location = index.and_then(|index| {
            let leads = |import: &&Import| {
                import.path == next.path || import.path.starts_with(&format!("{}::", next.path))
            };
            declared[index].iter().find(leads).map(|import| place(&files[index], import))
        });
        foreign.report(location.unwrap_or_else(|| Location::line(&first.file, 1)), "import-cycle", message);
        for &index in &circle {
            let module = &waiting[index];
            foreign.unchecked.insert(module.file.clone());
            broken.entry(module.file.clone()).or_insert_with(|| "is part of an import cycle".to_owned());
            done.insert(module.path.clone());
        }
        let (inside, outside): (Vec<_>, Vec<_>) =
            waiting.into_iter().partition(|module| done.contains(&module.path));
        order.extend(inside);
        waiting = outside;
    }
    order
}

/// Modules that import each other in a circle, by index; every one waits for another.
fn circle(waiting: &[ModuleSource], done: &BTreeSet<String>) -> Vec<usize> {
    let indices: BTreeMap<&str, usize> =
        waiting.iter().enumerate().map(|(index, module)| (module.path.as_str(), index)).collect();
    let mut trail: Vec<usize> = Vec::new();
    let mut at = 0;
    loop {
        if let Some(start) = trail.iter().position(|&earlier| earlier == at) {
            return trail.split_off(start);
        }
        trail.push(at);
        let blocking = waiting[at].imports.iter().find(|import| !done.contains(*import));
        match blocking.and_then(|import| indices.get(import.as_str())) {
            Some(&next) => at = next,
            None => return vec![at],
        }
    }
}

/// Leaves out what imports something broken, and says why.
fn spread(
    modules: &[ModuleSource],
    passes: &[PassSource],
    broken: &BTreeMap<String, String>,
    foreign: &mut Foreign,
) {
    // By path: the file that is broken, however far away.
    let mut reasons: BTreeMap<&str, (&str, &str)> = BTreeMap::new();
    for module in modules {
        if let Some((file, reason)) = broken.get_key_value(&module.file) {
            reasons.insert(&module.path, (file, reason));
        }
    }
    let reach = |imports: &[String], reasons: &BTreeMap<&str, (&str, &str)>| {
        let found = imports.iter().find_map(|import| reasons.get_key_value(import.as_str()));
        found.map(|(path, (file, reason))| format!("`{path}` of {file} {reason}"))
    };
    // Modules come after what they import, so one turn suffices.
    for module in modules {
        if let Some((file, reason)) =
            module.imports.iter().find_map(|import| reasons.get(import.as_str()).copied())
        {
            reasons.entry(&module.path).or_insert((file, reason));
        }
    }
    let modules = modules.iter().map(|module| (&module.file, &module.imports));
    let passes = passes.iter().map(|pass| (&pass.file, &pass.imports));
    let mut skipped = BTreeSet::new();
    for (file, imports) in modules.chain(passes) {
        if foreign.external.contains(file) || foreign.unchecked.contains(file) {
            continue;
        }
        if let Some(reason) = reach(imports, &reasons) {
            skipped.insert((file.clone(), format!("{file}: not checked, because {reason}")));
        }
    }
    for (file, message) in skipped {
        foreign.unchecked.insert(file);
        foreign.skipped.push(message);
    }
}
