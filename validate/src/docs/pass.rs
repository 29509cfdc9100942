// SPDX-License-Identifier: MIT OR Apache-2.0
//! The page of a pass.

use super::{
    Book, Kind, costs, header, items,
    module::{COUNTED, STATIC, counts, entries, equations, errors, links},
    text::{GENERATED, names, prose, section, table},
};
use crate::{Binding, BindingKind, Composed, PassSource, Reflection, format_name};

pub(super) fn page(book: &Book, pass: &PassSource) -> String {
    let header = header(&pass.source);
    let permutations = book.passes.get(&pass.name).map(Vec::as_slice).unwrap_or_default();
    let mut page = format!("{GENERATED}# {}\n\n{}\n\n", pass.name, prose(&header.summary));
    page += &format!("A pass, file `wgsl/{}`. ", pass.file);
    page +=
        "[What it needs](../../../needs.md) of a device, and [which files](../../../vendoring/files.md).\n\n";
    page += &book.pictures.markdown(&pass.name, 3);
    page += &section("Source", &prose(&header.source));
    page += &equations(&header);
    page += &section("Notes", &prose(&header.notes.join("\n")));
    page += &section("Error", &errors(&header));
    page += &section("Permutations", &listing(pass, permutations));
    page += &section("Definitions", &entries(&header.definitions, "definition"));
    page += &section("Bindings", &bindings(&header.bindings, permutations));
    page += &section("Structs", &structs(book, pass, permutations));
    page += &section("Cost", &cost(permutations));
    page += &section("Imports", &links(book, &pass.imports, 3));
    page.trim_end().to_owned() + "\n"
}

/// Permutations with their definitions, entry points and flat files.
fn listing(pass: &PassSource, permutations: &[(String, Composed)]) -> String {
    let rows: Vec<_> = permutations
        .iter()
        .map(|(name, composed)| {
            let definitions = composed.definitions.to_string();
            let reflection = composed.reflect();
            let entries =
                reflection.entry_points.iter().map(|entry| format!("`{}` ({})", entry.name, entry.stage));
            let flat = match name.as_str() {
                "default" => format!("`{}.wgsl`", pass.name),
                other => format!("`{}.{other}.wgsl`", pass.name),
            };
            let definitions =
                if definitions.is_empty() { "none".to_owned() } else { format!("`{definitions}`") };
            vec![format!("`{name}`"), definitions, entries.collect::<Vec<_>>().join(", "), flat]
        })
        .collect();
    table(&["permutation", "definitions", "entry points", "in `wgsl/flat/`"], &rows)
}

/// What is bound, in one table for all permutations.
fn bindings(said: &[(String, String)], permutations: &[(String, Composed)]) -> String {
    let reflections: Vec<(&str, Reflection)> =
        permutations.iter().map(|(name, composed)| (name.as_str(), composed.reflect())).collect();
    // By number, name and kind, with the permutations that have it.
    let mut found: Vec<(Binding, Vec<&str>)> = Vec::new();
    for (name, reflection) in &reflections {
        for binding in &reflection.bindings {
            let same = |other: &Binding| {
                other.binding == binding.binding && other.name == binding.name && other.kind == binding.kind
            };
            match found.iter_mut().find(|(other, _)| same(other)) {
                Some((_, names)) => names.push(name),
                None => found.push((binding.clone(), vec![name])),
            }
        }
    }
    found.sort_by_key(|(binding, _)| binding.binding);
    let rows: Vec<_> = found
        .iter()
        .map(|(binding, having)| {
            let what = said.iter().find(|(name, _)| *name == binding.name).map_or("", |(_, text)| text);
            let all = having.len() == reflections.len();
            let having = if all { "all".to_owned() } else { names(having.iter().copied()) };
            vec![
                binding.binding.to_string(),
                format!("`{}`", binding.name),
                kind(&binding.kind),
                prose(what),
                having,
            ]
        })
        .collect();
    table(&["number", "name", "kind", "what it is", "permutations"], &rows)
}

/// What may be bound, in words.
pub(super) fn kind(kind: &BindingKind) -> String {
    match kind {
        BindingKind::Uniform { ty, size } => format!("uniform `{ty}`, {size} bytes"),
        BindingKind::Storage { writable, ty, min_size } => {
            let access = if *writable { "read and written" } else { "read" };
            format!("storage `{ty}`, {access}, from {min_size} bytes")
        }
        BindingKind::Texture { dimension, sample, filtered, multisampled } => {
            let filtered = if *filtered { ", filtered" } else { "" };
            let multisampled = if *multisampled { ", multisampled" } else { "" };
            format!("texture {dimension}, {sample}{filtered}{multisampled}")
        }
        BindingKind::StorageTexture { dimension, format, access } => {
            format!("storage texture {dimension}, {}, {access}", format_name(*format))
        }
        BindingKind::Sampler { comparison: true } => "comparison sampler".to_owned(),
        BindingKind::Sampler { comparison: false } => "sampler".to_owned(),
        BindingKind::Other { ty } => ty.clone(),
    }
}

/// The structs of all permutations, each once.
fn structs(book: &Book, pass: &PassSource, permutations: &[(String, Composed)]) -> String {
    let mut text = String::new();
    let mut seen: Vec<String> = Vec::new();
    for layout in permutations.iter().flat_map(|(_, composed)| composed.reflect().structs) {
        if seen.contains(&layout.name) {
            continue;
        }
        let own = items(&pass.source).into_iter();
        let own = own.filter(|item| item.kind == Kind::Struct).find(|item| item.name == layout.name);
        let declared = own.or_else(|| book.struct_of(&pass.imports, &layout.name).map(|(_, item)| item));
        let parts = declared.map(|item| item.parts).unwrap_or_default();
        let rows = layout.members.iter().map(|member| {
            let said =
                parts.iter().find(|part| part.name == member.name).map_or("", |part| part.docs.as_str());
            let of = [member.offset.to_string(), format!("`{}`", member.name), format!("`{}`", member.ty)];
            [of.to_vec(), vec![member.size.to_string(), prose(said)]].concat()
        });
        text += &format!("### {}\n\n{} bytes, aligned to {}.\n\n", layout.name, layout.size, layout.align);
        text += &table(&["offset", "member", "type", "bytes", "what it is"], &rows.collect::<Vec<_>>());
        seen.push(layout.name);
    }
    text
}

/// Counts of the entry points of each permutation.
fn cost(permutations: &[(String, Composed)]) -> String {
    let rows: Vec<_> = permutations
        .iter()
        .flat_map(|(name, composed)| {
            let (_, entries) = costs(&composed.module);
            entries.into_iter().map(move |(entry, cost)| {
                [vec![format!("`{name}`"), format!("`{entry}`")], counts(&cost)].concat()
            })
        })
        .collect();
    format!("{STATIC}\n\n{}", table(&[&["permutation", "entry point"], &COUNTED[..]].concat(), &rows))
}
