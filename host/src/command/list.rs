// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight list`: passes and modules with what their headers say. `airlight info`: the machine.

use super::CommandError;
use crate::layout::kind_text;
use crate::{Gpu, Shaders};
use airlight_validate::{Error, Library, ModuleSource, PassSource, Reflection, Stage};
use serde_json::{Value, json};
use std::fmt::{Display, Write};
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

/// What an error says, on one line.
pub(super) fn one_line(error: impl Display) -> String {
    let text = error.to_string();
    let words: Vec<_> = text.split_whitespace().collect();
    words.join(" ")
}

/// A problem with the path that it is about, unless it names that itself.
pub(super) fn named(path: &Path, problem: String) -> String {
    let path = path.display().to_string();
    if problem.contains(&path) { problem } else { format!("{path}: {problem}") }
}

/// Misuse where a name is unknown, a failure where a shader is broken.
pub(super) fn shader_error(error: Error) -> CommandError {
    match error {
        Error::UnknownPass { .. }
        | Error::UnknownModule { .. }
        | Error::UnknownPermutation { .. }
        | Error::Definition { .. } => CommandError::Misuse(one_line(error)),
        other => CommandError::failure(one_line(other)),
    }
}

/// The shaders of a folder, or those built in.
pub(super) fn shaders(folder: Option<&Path>) -> Result<Shaders, CommandError> {
    let Some(folder) = folder else { return Ok(Shaders::builtin()) };
    let library = Library::from_directory(folder)
        .map_err(|error| CommandError::failure(format!("--shaders {}", named(folder, one_line(error)))))?;
    Ok(Shaders::from_library(library))
}

/// The header of a shader file: `// key: text` and `// key NAME: text` before the first line of code.
#[derive(Debug, Default, PartialEq)]
struct Header {
    summary: String,
    source: String,
    notes: Vec<String>,
    /// Names with their meaning.
    definitions: Vec<(String, String)>,
    /// Names with their meaning.
    bindings: Vec<(String, String)>,
}

impl Header {
    fn new(source: &str) -> Self {
        let mut header = Self::default();
        for line in source.lines() {
            let line = line.trim();
            if line.is_empty() || line.starts_with('#') {
                continue;
            }
            let Some(text) = line.strip_prefix("//").map(str::trim_start) else { break };
            let Some((key, text)) = text.split_once(':') else { continue };
            let text = text.trim().to_owned();
            let append = |to: &mut String| {
                let space = if to.is_empty() { "" } else { " " };
                to.push_str(space);
                to.push_str(&text);
            };
            match key.split_once(' ') {
                None if key == "summary" => append(&mut header.summary),
                None if key == "source" => append(&mut header.source),
                None if key == "note" => header.notes.push(text),
                Some(("definition", name)) => header.definitions.push((name.to_owned(), text)),
                Some(("binding", name)) => header.bindings.push((name.to_owned(), text)),
                _ => {}
            }
        }
        header
    }

    fn binding(&self, name: &str) -> &str {
        self.bindings.iter().find(|(of, _)| of == name).map_or("", |(_, text)| text)
    }
}

/// The items of a module: what is written before them and their first line.
fn items(source: &str) -> Vec<(String, String)> {
    let mut items = Vec::new();
    let mut comment = Vec::new();
    let mut lines = source.lines();
    while let Some(line) = lines.next() {
        if let Some(text) = line.strip_prefix("///") {
            comment.push(text.trim());
        } else if ["fn ", "struct ", "const "].iter().any(|start| line.starts_with(start)) {
            let mut item = line.to_owned();
            // A signature may go over several lines.
            while line.starts_with("fn ") && !item.contains('{') {
                let Some(next) = lines.next() else { break };
                item.push(' ');
                item.push_str(next.trim());
            }
            let end = item.find('{').unwrap_or(item.len());
            items.push((item[..end].trim().to_owned(), comment.join(" ")));
            comment.clear();
        } else if !line.starts_with('@') {
            comment.clear();
        }
    }
    items
}

/// Prints what was asked for. What is closed early, as by `head`, is no error.
fn print(text: &str) {
    use std::io::Write as _;
    let _ = std::io::stdout().lock().write_all(text.as_bytes());
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

fn heading(text: &mut String, title: &str, empty: bool) {
    if !empty {
        let gap = if text.is_empty() { "" } else { "\n" };
        line(text, format_args!("{gap}{title}"));
    }
}

fn line(text: &mut String, words: std::fmt::Arguments<'_>) {
    // Writing to a string cannot fail.
    let _ = text.write_fmt(words);
    while text.ends_with(' ') {
        text.pop();
    }
    text.push('\n');
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

fn pairs(text: &mut String, title: &str, pairs: &[(String, String)]) {
    heading(text, title, pairs.is_empty());
    let width = pairs.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    for (name, about) in pairs {
        line(text, format_args!("  {name:width$}  {about}"));
    }
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

/// Says which adapter there is and what may be asked of it.
pub fn info() -> Result<(), CommandError> {
    let gpu = pollster::block_on(Gpu::new())?;
    let adapter = &gpu.adapter;
    let limits = &gpu.limits;
    let mut text = String::new();
    let driver = one_line(format!("{} {}", adapter.driver, adapter.driver_info));
    for (name, value) in [
        ("adapter", adapter.name.clone()),
        ("type", format!("{:?}", adapter.device_type)),
        ("back end", adapter.backend.to_string()),
        ("driver", driver),
        ("airlight", env!("CARGO_PKG_VERSION").to_owned()),
    ] {
        line(&mut text, format_args!("{name:10}{value}"));
    }
    line(&mut text, format_args!("\nLimits in force: WebGPU's defaults, no optional feature"));
    let [x, y, z] = [
        limits.max_compute_workgroup_size_x,
        limits.max_compute_workgroup_size_y,
        limits.max_compute_workgroup_size_z,
    ];
    let mebibytes = |bytes: u64| format!("{} MiB", bytes >> 20);
    for (name, value) in [
        ("width and height of a texture", limits.max_texture_dimension_2d.to_string()),
        ("layers of a texture", limits.max_texture_array_layers.to_string()),
        ("sides of a 3D texture", limits.max_texture_dimension_3d.to_string()),
        ("buffer", mebibytes(limits.max_buffer_size)),
        ("storage buffer", mebibytes(limits.max_storage_buffer_binding_size)),
        ("uniform buffer", format!("{} KiB", limits.max_uniform_buffer_binding_size >> 10)),
        ("workgroup", format!("{x},{y},{z}, {} in all", limits.max_compute_invocations_per_workgroup)),
        ("workgroup memory", format!("{} KiB", limits.max_compute_workgroup_storage_size >> 10)),
        ("workgroups a dimension", limits.max_compute_workgroups_per_dimension.to_string()),
        ("storage textures a stage", limits.max_storage_textures_per_shader_stage.to_string()),
        ("storage buffers a stage", limits.max_storage_buffers_per_shader_stage.to_string()),
        ("sampled textures a stage", limits.max_sampled_textures_per_shader_stage.to_string()),
    ] {
        line(&mut text, format_args!("  {name:31}{value}"));
    }
    print(&text);
    Ok(())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn headers_are_read() {
        let header = Header::new(
            "// SPDX-License-Identifier: MIT\n#define_import_path a::b\n\
             // summary: Does it.\n// source: a: b.\n// note: one\n\
             // note: two\n// definition M: how many.\n// binding x: out, metres.\nfn f() {}\n// summary: not this\n",
        );
        assert_eq!(header.summary, "Does it.");
        assert_eq!(header.source, "a: b.");
        assert_eq!(header.notes, ["one", "two"]);
        assert_eq!(header.definitions, [("M".to_owned(), "how many.".to_owned())]);
        assert_eq!(header.binding("x"), "out, metres.");
        assert_eq!(header.binding("y"), "");
    }

    #[test]
    fn every_builtin_pass_and_module_is_described() {
        let shaders = Shaders::builtin();
        for pass in shaders.library().passes() {
            let header = Header::new(&pass.source);
            assert!(!header.summary.is_empty(), "{}", pass.name);
            for permutation in shaders.library().permutations(&pass.name).unwrap() {
                let reflection = shaders.compose(&pass.name, &permutation.name).unwrap().reflect();
                for binding in reflection.bindings {
                    assert!(!header.binding(&binding.name).is_empty(), "{} {}", pass.name, binding.name);
                }
            }
        }
        for module in shaders.library().modules() {
            assert!(!Header::new(&module.source).summary.is_empty(), "{}", module.path);
            assert!(!items(&module.source).is_empty(), "{}", module.path);
        }
    }

    #[test]
    fn items_carry_their_comments() {
        let source = "// head\n/// What a is.\nconst A: u32 = 1u;\n\nfn f(\n    x: f32\n) -> f32 {\n    return x;\n}\n";
        let expected = [("const A: u32 = 1u;", "What a is."), ("fn f( x: f32 ) -> f32", "")];
        assert_eq!(items(source), expected.map(|(item, text)| (item.to_owned(), text.to_owned())));
    }
}
