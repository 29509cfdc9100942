// SPDX-License-Identifier: MIT OR Apache-2.0
//! Which pass, which entry points, over how much.

use super::Options;
use crate::Shaders;
use crate::command::CommandError;
use crate::command::error::{one_line, shader_error};
use airlight_validate::naga::valid::{ValidationFlags, Validator};
use airlight_validate::{
    Binding, Composed, EntryPoint, Interface, Library, Reflection, Stage, StructLayout, core_capabilities,
};
use std::collections::BTreeSet;

/// A composed pass and what is to be done with it.
pub struct Plan {
    /// The pass with only the entry points that run.
    pub composed: Composed,
    /// The bindings that these entry points use.
    pub bindings: Vec<Binding>,
    /// Structs of the buffers.
    pub structs: Vec<StructLayout>,
    /// What runs.
    pub work: Work,
}

/// What runs.
pub enum Work {
    /// A compute entry point over workgroups.
    Compute { entry: String, groups: [u32; 3] },
    /// One triangle over a target.
    Screen { vertex: String, fragment: String, target: wgpu::TextureFormat, size: [u32; 2] },
}

impl Work {
    /// The entry point that was asked for.
    pub fn entry(&self) -> &str {
        match self {
            Self::Compute { entry, .. } => entry,
            Self::Screen { fragment, .. } => fragment,
        }
    }
}

impl Plan {
    /// Composes the pass and chooses its entry points.
    pub fn new(options: &Options, shaders: &Shaders, limits: &wgpu::Limits) -> Result<Self, CommandError> {
        let composed = compose(options, shaders)?;
        let reflection = composed.reflect();
        let entry = choose(options, &composed.pass, &reflection)?;
        let work = match entry.stage {
            Stage::Compute => compute(options, entry, limits)?,
            _ => screen(options, &composed.pass, entry, &reflection, limits)?,
        };
        let used: Vec<&str> = match &work {
            Work::Compute { entry, .. } => vec![entry],
            Work::Screen { vertex, fragment, .. } => vec![vertex, fragment],
        };
        let composed = only(composed, &used)?;
        let Reflection { mut bindings, structs, .. } = composed.reflect();
        bindings.retain(|binding| !binding.entry_points.is_empty());
        Ok(Self { composed, bindings, structs, work })
    }

    /// The pass and its entry point, as errors call them.
    pub fn name(&self) -> String {
        format!("{} ({})", self.composed.pass, self.work.entry())
    }
}

fn compose(options: &Options, shaders: &Shaders) -> Result<Composed, CommandError> {
    let pass = &options.subject.pass;
    let library = shaders.library();
    let permutation = library.permutation(pass, &options.subject.permutation).map_err(shader_error)?;
    let known = known_definitions(library, pass)?;
    let mut definitions = permutation.definitions.clone();
    for definition in &options.define {
        for (name, _) in definition.iter() {
            if !known.contains(name) {
                let known: Vec<_> = known.iter().map(String::as_str).collect();
                let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
                return Err(CommandError::misuse(
                    "--define",
                    format!("{pass} has no definition `{name}`; it has {known}"),
                ));
            }
        }
        definitions = definitions.merge(definition);
    }
    let defined = |error: airlight_validate::Error| match shader_error(error) {
        CommandError::Failure(message) if !options.define.is_empty() => {
            CommandError::failure(format!("{message} (composed with {definitions})"))
        }
        error => error,
    };
    shaders.compose_with(pass, &definitions).map_err(defined)
}

/// The names that `#if`, `#ifdef` and `#{NAME}` ask for in a pass and in what it imports; `GROUP` is the host's.
fn known_definitions(library: &Library, pass: &str) -> Result<BTreeSet<String>, CommandError> {
    let pass = library.pass(pass).map_err(shader_error)?;
    let mut sources = vec![pass.source.as_str()];
    let mut open: Vec<&str> = pass.imports.iter().map(String::as_str).collect();
    let mut seen = BTreeSet::new();
    while let Some(path) = open.pop() {
        if seen.insert(path) {
            let module = library.module(path).map_err(shader_error)?;
            sources.push(&module.source);
            open.extend(module.imports.iter().map(String::as_str));
        }
    }
    let mut known = BTreeSet::new();
    for line in sources.iter().flat_map(|source| source.lines()) {
        let line = line.trim();
        if line.starts_with("#if") || line.starts_with("#else if") {
            let words = line.split(|letter: char| !letter.is_ascii_alphanumeric() && letter != '_');
            let names = words.filter(|word| {
                word.starts_with(|letter: char| letter.is_ascii_alphabetic() || letter == '_')
            });
            known.extend(
                names
                    .filter(|word| !["if", "ifdef", "ifndef", "else", "true", "false"].contains(word))
                    .map(str::to_owned),
            );
        }
        let used = line.split("#{").skip(1).filter_map(|rest| rest.split_once('}'));
        known.extend(used.map(|(name, _)| name.to_owned()));
    }
    known.remove("GROUP");
    Ok(known)
}

fn names<'a>(entries: impl Iterator<Item = &'a EntryPoint>) -> String {
    let names: Vec<_> = entries.map(|entry| format!("{} ({})", entry.name, entry.stage)).collect();
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}

fn choose<'a>(
    options: &Options,
    pass: &str,
    reflection: &'a Reflection,
) -> Result<&'a EntryPoint, CommandError> {
    let entries = &reflection.entry_points;
    let candidates = || entries.iter().filter(|entry| entry.stage != Stage::Vertex);
    let Some(name) = &options.entry else {
        let mut all = candidates();
        return match (all.next(), all.next()) {
            (Some(only), None) => Ok(only),
            (None, _) => {
                Err(CommandError::misuse("PASS", format!("{pass} has no compute or fragment entry point")))
            }
            (Some(_), Some(_)) => {
                let names = names(candidates());
                Err(CommandError::misuse(
                    "--entry",
                    format!("{pass} has several entry points; name one of {names}"),
                ))
            }
        };
    };
    candidates().find(|entry| entry.name == *name).ok_or_else(|| {
        let names = names(candidates());
        CommandError::misuse(
            "--entry",
            format!("{pass} has no compute or fragment entry point `{name}`; it has {names}"),
        )
    })
}

fn compute(options: &Options, entry: &EntryPoint, limits: &wgpu::Limits) -> Result<Work, CommandError> {
    if let Some(vertex) = &options.vertex {
        let problem = format!("`{vertex}` goes with a fragment entry point; {} is compute", entry.name);
        return Err(CommandError::misuse("--vertex", problem));
    }
    let (flag, given, groups) = match (options.dispatch, options.over) {
        (Some(groups), _) => ("--dispatch", groups, groups),
        (None, Some(size)) => (
            "--over",
            size,
            std::array::from_fn(|axis| size[axis].div_ceil(entry.workgroup_size[axis].max(1))),
        ),
        (None, None) => {
            let problem = format!(
                "{} is compute: say how many workgroups run, or --over how many invocations",
                entry.name
            );
            return Err(CommandError::misuse("--dispatch", problem));
        }
    };
    let limit = limits.max_compute_workgroups_per_dimension;
    if groups.iter().any(|count| *count > limit) {
        let [x, y, z] = given;
        let [gx, gy, gz] = groups;
        let problem =
            format!("{x},{y},{z} is {gx},{gy},{gz} workgroups; a device takes at most {limit} a dimension");
        return Err(CommandError::misuse(flag, problem));
    }
    Ok(Work::Compute { entry: entry.name.clone(), groups })
}

fn screen(
    options: &Options,
    pass: &str,
    fragment: &EntryPoint,
    reflection: &Reflection,
    limits: &wgpu::Limits,
) -> Result<Work, CommandError> {
    for (flag, given) in [("--dispatch", options.dispatch), ("--over", options.over)] {
        if let Some([x, y, z]) = given {
            let problem = format!(
                "{x},{y},{z} is for compute; {} is a fragment entry point and takes --size WxH",
                fragment.name
            );
            return Err(CommandError::misuse(flag, problem));
        }
    }
    let vertex = vertex(options, pass, reflection)?;
    let missing = fragment.inputs.iter().find(|input| {
        !vertex.outputs.iter().any(|output| output.location == input.location && output.ty == input.ty)
    });
    if let Some(Interface { location, name, ty }) = missing {
        let problem = format!(
            "{} does not write what {} reads at location {location} ({name}: {ty})",
            vertex.name, fragment.name
        );
        return Err(CommandError::misuse("--vertex", problem));
    }
    let [output] = &fragment.outputs[..] else {
        let problem =
            format!("{} writes {} targets; run draws to exactly one", fragment.name, fragment.outputs.len());
        return Err(CommandError::misuse("--entry", problem));
    };
    use wgpu::TextureFormat as Format;
    let target = match (output.location, output.ty.as_str()) {
        (0, "f32") => Format::R32Float,
        (0, "vec2<f32>") => Format::Rg32Float,
        (0, "vec4<f32>") => Format::Rgba32Float,
        (0, "u32") => Format::R32Uint,
        (0, "vec2<u32>") => Format::Rg32Uint,
        (0, "vec4<u32>") => Format::Rgba32Uint,
        (0, "i32") => Format::R32Sint,
        (0, "vec2<i32>") => Format::Rg32Sint,
        (0, "vec4<i32>") => Format::Rgba32Sint,
        (location, ty) => {
            let problem =
                format!("{} writes {ty} at location {location}; run has no target for that", fragment.name);
            return Err(CommandError::misuse("--entry", problem));
        }
    };
    let Some([width, height]) = options.size else {
        let problem =
            format!("{} is a fragment entry point: say how large its target is, WxH", fragment.name);
        return Err(CommandError::misuse("--size", problem));
    };
    let limit = limits.max_texture_dimension_2d;
    if width > limit || height > limit {
        let problem = format!("{width}x{height} is impossible: a device takes at most {limit}x{limit}");
        return Err(CommandError::misuse("--size", problem));
    }
    let (vertex, fragment) = (vertex.name.clone(), fragment.name.clone());
    Ok(Work::Screen { vertex, fragment, target, size: [width, height] })
}

fn vertex<'a>(
    options: &Options,
    pass: &str,
    reflection: &'a Reflection,
) -> Result<&'a EntryPoint, CommandError> {
    let vertices = || reflection.entry_points.iter().filter(|entry| entry.stage == Stage::Vertex);
    let misuse = |problem: String| CommandError::misuse("--vertex", problem);
    let Some(name) = &options.vertex else {
        let mut free = vertices().filter(|entry| entry.inputs.is_empty());
        return match (free.next(), free.next()) {
            (Some(only), None) => Ok(only),
            (None, _) => {
                Err(misuse(format!("{pass} has no vertex entry point that does without vertex buffers")))
            }
            (Some(_), Some(_)) => {
                Err(misuse(format!("{pass} has several; name one of {}", names(vertices()))))
            }
        };
    };
    let entry = vertices().find(|entry| entry.name == *name).ok_or_else(|| {
        misuse(format!("{pass} has no vertex entry point `{name}`; it has {}", names(vertices())))
    })?;
    if let Some(input) = entry.inputs.first() {
        let problem = format!(
            "`{name}` reads a vertex buffer ({}: {}); run draws from the vertex index alone",
            input.name, input.ty
        );
        return Err(misuse(problem));
    }
    Ok(entry)
}

/// The pass without its other entry points, so that it asks for nothing that only they use.
fn only(mut composed: Composed, used: &[&str]) -> Result<Composed, CommandError> {
    composed.module.entry_points.retain(|entry| used.contains(&entry.name.as_str()));
    let validated = Validator::new(ValidationFlags::all(), core_capabilities()).validate(&composed.module);
    let info = validated
        .map_err(|error| CommandError::failure(format!("{}: {}", composed.file, one_line(error))))?;
    Ok(Composed { info, ..composed })
}
