// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight list`: passes and modules with what their headers say.

mod header;

use super::CommandError;
use super::error::{named, one_line, shader_error};
use super::text::{heading, line, pairs, print};
use crate::Shaders;
use crate::layout::kind_text;
use airlight_validate::{Library, ModuleSource, PassSource, Reflection, Stage};
use header::{Header, items};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Lists what there is.
#[derive(clap::Args)]
pub struct ListOptions {
    /// A system, a pass (in a permutation) or the import path of a module; all without it.
    #[arg(value_name = "SYSTEM[/PASS[:PERMUTATION]]")]
    subject: Option<String>,
    /// As JSON.
    #[arg(long)]
    json: bool,
    /// A folder laid out like `wgsl/`, in place of the built-in shaders.
    #[arg(long, value_name = "DIR")]
    shaders: Option<PathBuf>,
}

/// The shaders of a folder, or those built in.
pub(super) fn shaders(folder: Option<&Path>) -> Result<Shaders, CommandError> {
    let Some(folder) = folder else { return Ok(Shaders::builtin()) };
    let library = Library::from_directory(folder)
        .map_err(|error| CommandError::failure(format!("--shaders {}", named(folder, one_line(error)))))?;
    Ok(Shaders::from_library(library))
}

/// Lists passes and modules.
pub fn list(options: &ListOptions) -> Result<(), CommandError> {
    let shaders = shaders(options.shaders.as_deref())?;
    let library = shaders.library();
    let (text, value) = match options.subject.as_deref() {
        Some(path) if path.contains("::") => one_module(library.module(path).map_err(shader_error)?),
        Some(pass) if pass.contains('/') => one_pass(&shaders, pass)?,
        system => several(library, system)?,
    };
    if options.json {
        print(&format!("{value:#}\n"));
    } else {
        print(&text);
    }
    Ok(())
}

fn system_of(file: &str) -> &str {
    file.split('/').next().unwrap_or_default()
}

fn several(library: &Library, system: Option<&str>) -> Result<(String, Value), CommandError> {
    let here = |file: &str| system.is_none_or(|system| system_of(file) == system);
    let passes: Vec<&PassSource> = library.passes().iter().filter(|pass| here(&pass.file)).collect();
    let modules: Vec<&ModuleSource> = library.modules().iter().filter(|module| here(&module.file)).collect();
    if let (Some(system), true, true) = (system, passes.is_empty(), modules.is_empty()) {
        let files = library.passes().iter().map(|pass| &pass.file);
        let mut known: Vec<&str> = files
            .chain(library.modules().iter().map(|module| &module.file))
            .map(|file| system_of(file))
            .collect();
        known.sort_unstable();
        known.dedup();
        return Err(CommandError::Misuse(format!("no system `{system}`; there are {}", known.join(", "))));
    }
    let mut text = String::new();
    let mut pass_values = Vec::new();
    let width = passes.iter().map(|pass| pass.name.len()).max().unwrap_or(0);
    heading(&mut text, "Passes", passes.is_empty());
    for pass in passes {
        let header = Header::new(&pass.source);
        let permutations = library.permutations(&pass.name).map_err(shader_error)?;
        line(&mut text, format_args!("  {:width$}  {}", pass.name, header.summary));
        if permutations.len() > 1 {
            let names: Vec<_> = permutations.iter().map(|permutation| permutation.name.as_str()).collect();
            line(&mut text, format_args!("  {:width$}  permutations: {}", "", names.join(", ")));
        }
        let names: Vec<_> = permutations.iter().map(|permutation| permutation.name.clone()).collect();
        pass_values.push(json!({ "name": pass.name, "summary": header.summary, "permutations": names }));
    }
    let width = modules.iter().map(|module| module.path.len()).max().unwrap_or(0);
    heading(&mut text, "Modules", modules.is_empty());
    let mut module_values = Vec::new();
    for module in modules {
        let summary = Header::new(&module.source).summary;
        line(&mut text, format_args!("  {:width$}  {summary}", module.path));
        module_values.push(json!({ "path": module.path, "summary": summary }));
    }
    Ok((text, json!({ "passes": pass_values, "modules": module_values })))
}

fn head(text: &mut String, name: &str, header: &Header) {
    line(text, format_args!("{name}"));
    for part in [&header.summary, &header.source].into_iter().filter(|part| !part.is_empty()) {
        line(text, format_args!("  {part}"));
    }
    for note in &header.notes {
        line(text, format_args!("  {note}"));
    }
}

fn one_module(module: &ModuleSource) -> (String, Value) {
    let header = Header::new(&module.source);
    let mut text = String::new();
    head(&mut text, &module.path, &header);
    heading(&mut text, "Imports", module.imports.is_empty());
    for import in &module.imports {
        line(&mut text, format_args!("  {import}"));
    }
    let items = items(&module.source);
    heading(&mut text, "Items", items.is_empty());
    for (item, comment) in &items {
        line(&mut text, format_args!("  {item}"));
        if !comment.is_empty() {
            line(&mut text, format_args!("      {comment}"));
        }
    }
    let items: Vec<_> = items.iter().map(|(item, text)| json!({ "item": item, "text": text })).collect();
    let value = json!({
        "path": module.path,
        "file": module.file,
        "summary": header.summary,
        "source": header.source,
        "notes": header.notes,
        "imports": module.imports,
        "items": items,
    });
    (text, value)
}

fn one_pass(shaders: &Shaders, subject: &str) -> Result<(String, Value), CommandError> {
    let (name, chosen) = subject.split_once(':').unwrap_or((subject, "default"));
    let library = shaders.library();
    let pass = library.pass(name).map_err(shader_error)?;
    let permutations = library.permutations(name).map_err(shader_error)?;
    let header = Header::new(&pass.source);
    let reflection = shaders.compose(name, chosen).map_err(shader_error)?.reflect();

    let mut text = String::new();
    head(&mut text, &format!("{name}:{chosen}"), &header);
    heading(&mut text, "Permutations", permutations.is_empty());
    let width = permutations.iter().map(|permutation| permutation.name.len()).max().unwrap_or(0);
    for permutation in permutations {
        line(&mut text, format_args!("  {:width$}  {}", permutation.name, permutation.definitions));
    }
    pairs(&mut text, "Definitions", &header.definitions);
    entry_points(&mut text, &reflection);
    heading(&mut text, "Bindings", reflection.bindings.is_empty());
    for binding in &reflection.bindings {
        let (group, number) = (binding.group, binding.binding);
        let kind = kind_text(&binding.kind);
        line(&mut text, format_args!("  {group}.{number}  {}: {kind}", binding.name));
        let about = header.binding(&binding.name);
        if !about.is_empty() {
            line(&mut text, format_args!("       {about}"));
        }
    }
    let absent: Vec<(String, String)> = header
        .bindings
        .iter()
        .filter(|(name, _)| !reflection.bindings.iter().any(|binding| binding.name == *name))
        .cloned()
        .collect();
    pairs(&mut text, "Bindings of other permutations", &absent);
    for layout in &reflection.structs {
        heading(&mut text, &format!("{} ({} bytes)", layout.name, layout.size), false);
        let width = layout.members.iter().map(|member| member.name.len()).max().unwrap_or(0);
        for member in &layout.members {
            line(&mut text, format_args!("  {:4}  {:width$}  {}", member.offset, member.name, member.ty));
        }
    }
    let value = pass_value(pass, chosen, permutations, &header, &reflection);
    Ok((text, value))
}

fn entry_points(text: &mut String, reflection: &Reflection) {
    heading(text, "Entry points", reflection.entry_points.is_empty());
    for entry in &reflection.entry_points {
        let [x, y, z] = entry.workgroup_size;
        let about = match entry.stage {
            Stage::Compute => format!("compute, workgroups of {x},{y},{z}"),
            stage => stage.to_string(),
        };
        line(text, format_args!("  {} ({about}): {}", entry.name, entry.bindings.join(", ")));
    }
}

fn pass_value(
    pass: &PassSource,
    chosen: &str,
    permutations: &[airlight_validate::Permutation],
    header: &Header,
    reflection: &Reflection,
) -> Value {
    let pair = |(name, text): &(String, String)| json!({ "name": name, "text": text });
    let permutations: Vec<_> = permutations
        .iter()
        .map(|permutation| json!({ "name": permutation.name, "definitions": permutation.definitions.to_string() }))
        .collect();
    let entry_points: Vec<_> = reflection
        .entry_points
        .iter()
        .map(|entry| {
            json!({
                "name": entry.name,
                "stage": entry.stage.to_string(),
                "workgroup_size": entry.workgroup_size,
                "bindings": entry.bindings,
            })
        })
        .collect();
    let bindings: Vec<_> = reflection
        .bindings
        .iter()
        .map(|binding| {
            json!({
                "group": binding.group,
                "binding": binding.binding,
                "name": binding.name,
                "kind": kind_text(&binding.kind),
                "text": header.binding(&binding.name),
                "entry_points": binding.entry_points,
            })
        })
        .collect();
    let structs: Vec<_> = reflection
        .structs
        .iter()
        .map(|layout| {
            let members: Vec<_> = layout
                .members
                .iter()
                .map(|member| json!({ "name": member.name, "type": member.ty, "offset": member.offset }))
                .collect();
            json!({ "name": layout.name, "size": layout.size, "members": members })
        })
        .collect();
    json!({
        "name": pass.name,
        "file": pass.file,
        "permutation": chosen,
        "summary": header.summary,
        "source": header.source,
        "notes": header.notes,
        "permutations": permutations,
        "definitions": header.definitions.iter().map(pair).collect::<Vec<_>>(),
        "entry_points": entry_points,
        "bindings": bindings,
        "structs": structs,
    })
}
