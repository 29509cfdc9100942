// SPDX-License-Identifier: MIT OR Apache-2.0
//! What each permutation of each pass needs of a device.

use super::{
    Book,
    text::{GENERATED, systems, table},
};
use crate::{BindingKind, Composed, EntryPoint, Reflection, Stage, check, format_name};

const INTRODUCTION: &str = "# What each pass needs

A row an entry point, from the reflection of the composed pass. No pass needs an optional feature: all are validated as core
WebGPU. What an entry point uses of the limits by stage stands in brackets behind WebGPU's default; the last column is what is
more than that, and empty where a device with default limits will do. `wgsl/manifest.json` has the same for programs.

";

pub(super) fn page(book: &Book) -> String {
    let heads = [
        "pass".to_owned(),
        "entry point".to_owned(),
        "workgroup".to_owned(),
        "uniform buffers (12)".to_owned(),
        "storage buffers (8)".to_owned(),
        "sampled textures (16)".to_owned(),
        "storage textures (4)".to_owned(),
        "samplers (16)".to_owned(),
        "workgroup bytes (16384)".to_owned(),
        "storage formats".to_owned(),
        "beyond the defaults".to_owned(),
    ];
    let mut page = format!("{GENERATED}{INTRODUCTION}");
    for system in systems(book.library) {
        let mut rows = Vec::new();
        for (pass, permutations) in
            book.passes.iter().filter(|(pass, _)| pass.split('/').next() == Some(system))
        {
            for (name, composed) in permutations {
                rows.extend(self::rows(pass, name, composed));
            }
        }
        if !rows.is_empty() {
            let heads: Vec<&str> = heads.iter().map(String::as_str).collect();
            page += &format!("## {system}\n\n{}", table(&heads, &rows));
        }
    }
    page.trim_end().to_owned() + "\n"
}

fn rows(pass: &str, permutation: &str, composed: &Composed) -> Vec<Vec<String>> {
    let reflection = composed.reflect();
    let excesses = check::excesses(&reflection);
    let subject = match permutation {
        "default" => format!("`{pass}`"),
        other => format!("`{pass}:{other}`"),
    };
    let entries = reflection.entry_points.iter().map(|entry| {
        let usage = check::usage(&reflection, entry);
        let counted = [
            usage.uniform_buffers,
            usage.storage_buffers,
            usage.sampled_textures,
            usage.storage_textures,
            usage.samplers,
            usage.workgroup_memory,
        ];
        let own = excesses.iter().filter(|excess| excess.entry_point == entry.name);
        let beyond: Vec<String> = own.map(|excess| format!("{} = {}", excess.limit, excess.used)).collect();
        let mut row = vec![subject.clone(), format!("`{}`, {}", entry.name, entry.stage), workgroup(entry)];
        row.extend(counted.map(|count| count.to_string()));
        row.extend([formats(&reflection, entry), beyond.join(", ")]);
        row
    });
    entries.collect()
}

fn workgroup(entry: &EntryPoint) -> String {
    let [x, y, z] = entry.workgroup_size;
    if entry.stage == Stage::Compute { format!("{x} x {y} x {z}") } else { "-".to_owned() }
}

/// Formats of the storage textures of an entry point, each once.
fn formats(reflection: &Reflection, entry: &EntryPoint) -> String {
    let mut found: Vec<String> = Vec::new();
    for binding in reflection.bindings.iter().filter(|binding| entry.bindings.contains(&binding.name)) {
        if let BindingKind::StorageTexture { format, access, .. } = binding.kind {
            let text = format!("{} {access}", format_name(format));
            if !found.contains(&text) {
                found.push(text);
            }
        }
    }
    found.join(", ")
}
