// SPDX-License-Identifier: MIT OR Apache-2.0
//! The page of a module.

use super::{
    Book, Cost, Header, Item, Kind, costs, described, header, items,
    text::{GENERATED, names, prose, section, short, table},
};
use crate::{Composed, Member, ModuleSource, reflect};

pub(super) fn page(book: &Book, module: &ModuleSource) -> String {
    let header = header(&module.source);
    let items = items(&module.source);
    let name = short(&module.path);
    let mut page = format!("{GENERATED}# {name}\n\n{}\n\n", prose(&header.summary));
    page += &format!("Import path `{}`, file `wgsl/{}`.\n\n", module.path, module.file);
    page += &book.pictures.markdown(&name, 2);
    page += &section("Source", &prose(&header.source));
    page += &equations(&header);
    page += &section("Notes", &prose(&header.notes.join("\n")));
    page += &section("Error", &errors(&header));
    page += &section("Definitions", &entries(&header.definitions, "definition"));
    page += &section("Bindings", &entries(&header.bindings, "binding"));
    let composed = book.modules.get(&module.path);
    page += &section("Structs", &structs(&items, composed));
    page += &section("Constants", &constants(&items));
    page += &section("Functions", &functions(book, module, &items, &header));
    page += &section("Cost", &composed.map(|composed| cost(&items, composed)).unwrap_or_default());
    page += &section("Imports", &links(book, &module.imports, 2));
    page += &section("Used by", &users(book, &module.path));
    page.trim_end().to_owned() + "\n"
}

/// Formulas as they stand in the header.
pub(super) fn equations(header: &Header) -> String {
    let text = header.equations.join("\n");
    section("Equations", &if text.is_empty() { text } else { format!("```text\n{text}\n```") })
}

/// Error bounds with their tests.
pub(super) fn errors(header: &Header) -> String {
    let mut lines = String::new();
    for error in &header.errors {
        lines += &format!("- {}", prose(&error.bound));
        if let Some((file, test)) = error.test.as_deref().and_then(|test| test.split_once("::")) {
            lines += &format!(" (`tests/tests/{file}.rs`, `{test}`)");
        }
        lines.push('\n');
    }
    lines
}

/// Names with what they are.
pub(super) fn entries(entries: &[(String, String)], head: &str) -> String {
    let rows: Vec<_> = entries.iter().map(|(name, text)| vec![format!("`{name}`"), prose(text)]).collect();
    table(&[head, "what it is"], &rows)
}

fn condition(item: &Item) -> String {
    let lines: Vec<String> = item.conditions.iter().map(|line| format!("`{line}`")).collect();
    if lines.is_empty() { String::new() } else { format!("Only within {}.\n\n", lines.join(", ")) }
}

/// Structs with their members; with offsets where memory can hold them.
fn structs(items: &[Item], composed: Option<&Composed>) -> String {
    let mut text = String::new();
    for item in items.iter().filter(|item| item.kind == Kind::Struct) {
        let layout = composed.and_then(|composed| reflect::layout_of(&composed.module, &item.name));
        let rows = item.parts.iter().map(|part| {
            // Of members that directives choose between, the one that is there.
            let alone = item.parts.iter().filter(|other| other.name == part.name).count() == 1;
            let same = |member: &&Member| member.name == part.name && (alone || member.ty == part.ty);
            let member = layout.iter().flat_map(|layout| &layout.members).find(same);
            let offset = member.map_or_else(|| "-".to_owned(), |member| member.offset.to_string());
            vec![format!("`{}`", part.name), format!("`{}`", part.ty), offset, prose(&part.docs)]
        });
        text += &format!("### {}\n\n{}{}\n\n", item.name, condition(item), prose(&item.docs));
        text += &table(&["member", "type", "offset", "what it is"], &rows.collect::<Vec<_>>());
        if let Some(layout) = layout {
            text += &format!("{} bytes, aligned to {}.\n\n", layout.size, layout.align);
        }
    }
    text
}

fn constants(items: &[Item]) -> String {
    let constants = items.iter().filter(|item| item.kind == Kind::Constant);
    let rows: Vec<_> = constants
        .map(|item| {
            let (declared, value) = item.declaration.split_once('=').unwrap_or((&item.declaration, ""));
            let ty = declared.split_once(':').map_or("", |(_, ty)| ty.trim());
            vec![
                format!("`{}`", item.name),
                format!("`{ty}`"),
                format!("`{}`", value.trim()),
                prose(&item.docs),
            ]
        })
        .collect();
    table(&["name", "type", "value", "what it is"], &rows)
}

/// Functions with their parameters.
fn functions(book: &Book, module: &ModuleSource, items: &[Item], header: &Header) -> String {
    let mut text = String::new();
    for item in items.iter().filter(|item| item.kind == Kind::Function) {
        text += &format!("### {}\n\n{}", item.name, condition(item));
        text += &format!("```text\n{}\n```\n\n{}\n\n", item.declaration, prose(&item.docs));
        let rows = item.parts.iter().map(|part| {
            let said = described(&item.docs, &part.name).filter(|text| !text.is_empty());
            let shared = header.parameters.iter().find(|(name, _)| *name == part.name);
            let shared = shared.map(|(_, text)| text.trim_end_matches('.').to_owned());
            let text = said.or(shared).map(|text| prose(&text));
            let text = text.or_else(|| members(book, module, &part.ty)).unwrap_or_default();
            vec![format!("`{}`", part.name), format!("`{}`", part.ty), text]
        });
        text += &table(&["parameter", "type", "unit and range"], &rows.collect::<Vec<_>>());
    }
    text
}

/// Where the members of a struct are told of.
fn members(book: &Book, module: &ModuleSource, ty: &str) -> Option<String> {
    let name = ty.trim_start_matches("ptr<function, ").trim_end_matches('>');
    let own = std::slice::from_ref(&module.path);
    let (path, _) = book.struct_of(own, name)?;
    let page = if path == module.path { String::new() } else { format!("../../modules/{}.md", short(&path)) };
    Some(format!("see [{name}]({page}#{})", name.to_lowercase()))
}

/// What stands above every table of counts.
pub(super) const STATIC: &str = "Counted in the code, not measured: every statement once, loops and both sides of branches \
    as well, with all functions that are called. An operation on a vector counts once.";

/// The counts of a row.
pub(super) fn counts(cost: &Cost) -> Vec<String> {
    let counts = [cost.arithmetic, cost.transcendental, cost.texture_reads, cost.buffer_reads, cost.loops];
    counts.map(|count| count.to_string()).to_vec()
}

/// Heads of the columns of `counts`.
pub(super) const COUNTED: [&str; 5] =
    ["arithmetic", "roots, exponentials, angles", "texture reads", "buffer reads", "loops"];

fn cost(items: &[Item], composed: &Composed) -> String {
    let (functions, _) = costs(&composed.module);
    let mut seen = Vec::new();
    let mut rows = Vec::new();
    for item in items.iter().filter(|item| item.kind == Kind::Function) {
        let found = functions.iter().find(|(name, _)| *name == item.name);
        if let Some((name, cost)) = found.filter(|_| !seen.contains(&&item.name)) {
            rows.push([vec![format!("`{name}`")], counts(cost)].concat());
            seen.push(&item.name);
        }
    }
    if rows.is_empty() {
        return String::new();
    }
    let with = match composed.definitions.to_string() {
        none if none.is_empty() => String::new(),
        some => format!(" With `{some}`."),
    };
    format!("{STATIC}{with}\n\n{}", table(&[&["function"], &COUNTED[..]].concat(), &rows))
}

/// Links to modules by their paths, from a page `depth` folders down.
pub(super) fn links(book: &Book, paths: &[String], depth: usize) -> String {
    let known = |path: &String| book.library.module(path).is_ok();
    let link = |path: &String| {
        let name = short(path);
        format!("[{name}]({}modules/{name}.md)", "../".repeat(depth))
    };
    paths.iter().filter(|path| known(path)).map(link).collect::<Vec<_>>().join(", ")
}

/// Modules and passes that import it.
fn users(book: &Book, path: &str) -> String {
    let imports = |imports: &[String]| imports.iter().any(|import| import == path);
    let modules = book.library.modules().iter().filter(|other| imports(&other.imports));
    let modules: Vec<String> = modules.map(|other| other.path.clone()).collect();
    let passes = book.library.passes().iter().filter(|pass| imports(&pass.imports));
    let passes: Vec<String> = passes
        .filter_map(|pass| pass.name.split_once('/'))
        .map(|(system, name)| format!("[{system}/{name}](../../modules/{system}/passes/{name}.md)"))
        .collect();
    let mut text = String::new();
    if !modules.is_empty() {
        text += &format!("Modules: {}.\n\n", links(book, &modules, 2));
    }
    if !passes.is_empty() {
        text += &format!("Passes: {}.\n\n", passes.join(", "));
    }
    if text.is_empty() { format!("{}: nothing of the library imports it.", names([])) } else { text }
}
