// SPDX-License-Identifier: MIT OR Apache-2.0
//! The checks of one module or one permutation of a pass.

use crate::{
    BindingKind, Composed, Definitions, EntryPoint, Library, Location, Reflection, StructLayout,
    check::{
        Finding, Severity, Tool,
        backends::{self, Backend, Written},
        expected::{self, Expected, Outcome, Verdict},
        limits, tools,
    },
    compose::validate,
    flat, locate,
};
use std::path::{Path, PathBuf};

/// What is checked.
#[derive(Clone, Debug)]
pub(crate) enum Subject {
    /// A module alone.
    Module { path: String, definitions: Definitions },
    /// A pass in a permutation.
    Pass { name: String, permutation: String, definitions: Definitions },
}

/// What all subjects share.
pub(crate) struct Context<'a> {
    pub library: &'a Library,
    pub expected: &'a [Expected],
    pub tools: &'a [(Tool, PathBuf)],
    pub folder: &'a Path,
}

impl Context<'_> {
    fn tool(&self, wanted: Tool) -> Option<&Path> {
        self.tools.iter().find(|(tool, _)| *tool == wanted).map(|(_, path)| path.as_path())
    }
}

/// All findings about a subject; `number` makes its temporary files its own.
pub(crate) fn check(context: &Context, subject: &Subject, number: usize) -> Vec<Finding> {
    let (pass, permutation, composed) = match subject {
        Subject::Module { path, definitions } => {
            (path.as_str(), None, context.library.compose_module(path, definitions))
        }
        Subject::Pass { name, permutation, definitions } => {
            (name.as_str(), Some(permutation.as_str()), context.library.compose(name, definitions))
        }
    };
    let mut findings = match composed {
        Ok(composed) => match permutation {
            Some(permutation) => check_pass(context, composed, permutation, number),
            None => check_module(context, composed, number),
        },
        Err(error) => vec![Finding::of("compose", &error)],
    };
    for finding in &mut findings {
        finding.pass = Some(pass.to_owned());
        finding.permutation = permutation.map(str::to_owned);
    }
    findings
}

/// A module has no entry point; an empty one lets the back ends write its functions.
fn check_module(context: &Context, mut composed: Composed, number: usize) -> Vec<Finding> {
    let mut findings = Vec::new();
    check_flat(context, &composed, &composed.reflect(), number, &mut findings);
    composed.module.entry_points.push(naga::EntryPoint {
        name: "airlight_check".to_owned(),
        stage: naga::ShaderStage::Compute,
        early_depth_test: None,
        workgroup_size: [1, 1, 1],
        workgroup_size_overrides: None,
        function: naga::Function::default(),
        mesh_info: None,
        task_payload: None,
        incoming_ray_payload: None,
    });
    match validate(&composed.module) {
        Ok(info) => composed.info = info,
        Err(error) => {
            let message = locate::chain(error.as_inner());
            findings.push(about(&composed, Severity::Error, "compose", message));
            return findings;
        }
    }
    let reflection = composed.reflect();
    // GLSL writes only what an entry point reaches.
    for backend in [Backend::Spirv, Backend::Msl, Backend::Hlsl] {
        let result = backends::write(backend, &composed, &reflection, 0);
        let result = result.and_then(|written| compile(context, backend, &written, "comp", number));
        if let Err(message) = result {
            findings.push(about(&composed, Severity::Error, backend.name(), message));
        }
    }
    findings
}

fn check_pass(context: &Context, composed: Composed, permutation: &str, number: usize) -> Vec<Finding> {
    let mut findings = Vec::new();
    let reflection = composed.reflect();
    if reflection.entry_points.is_empty() {
        let message = "a pass needs an entry point".to_owned();
        findings.push(about(&composed, Severity::Error, "compose", message));
    }
    // Only a permutation that says so in its name may want more than every device has.
    let severity = if permutation == "default" { Severity::Error } else { Severity::Warning };
    for excess in limits::excesses(&reflection) {
        findings.push(about(&composed, severity, "limits", excess.to_string()));
    }
    for (name, message) in limits::violations(&reflection) {
        let source = context.library.text(&composed.file).unwrap_or_default();
        let mut finding = about(&composed, Severity::Error, "formats", message);
        finding.line = locate::line_with(source, &name, "var");
        findings.push(finding);
    }
    for layout in uniform_structs(&reflection) {
        if let Some(message) = limits::implicit_padding(layout) {
            findings.push(about(&composed, Severity::Error, "padding", message));
        }
    }
    check_flat(context, &composed, &reflection, number, &mut findings);

    let mut outcomes = Vec::new();
    for (index, entry) in composed.module.entry_points.iter().enumerate() {
        let suffix = match entry.stage {
            naga::ShaderStage::Vertex => "vert",
            naga::ShaderStage::Fragment => "frag",
            _ => "comp",
        };
        for backend in Backend::ALL {
            let result = backends::write(backend, &composed, &reflection, index);
            let result = result.and_then(|written| compile(context, backend, &written, suffix, number));
            let entry_point = entry.name.clone();
            outcomes.push(Outcome { entry_point, backend, error: result.err() });
        }
    }
    for verdict in expected::judge(context.expected, &composed.pass, permutation, &outcomes) {
        findings.push(match verdict {
            Verdict::Unexpected { entry_point, backend, message } => {
                let message = format!("`{entry_point}`: {message}");
                about(&composed, Severity::Error, backend.name(), message)
            }
            Verdict::Passed(entry) => {
                let message = format!(
                    "{} is listed as an expected failure ({}) and passes; take the entry out",
                    entry.backend.name(),
                    entry.reason
                );
                let location = Location::line(expected::FILE, entry.line);
                let mut finding = Finding::new(Severity::Error, location, "expected-failures", message);
                finding.is_own_file = true;
                finding
            }
        });
    }
    findings
}

/// A real compiler or validator of the language, where there is one on the path.
fn compile(
    context: &Context,
    backend: Backend,
    written: &Written,
    suffix: &str,
    number: usize,
) -> Result<(), String> {
    match (backend, written) {
        (Backend::Spirv, Written::Words(words)) => match context.tool(Tool::SpirvVal) {
            Some(program) => tools::spirv_val(program, words, &context.folder.join(format!("{number}.spv"))),
            None => Ok(()),
        },
        (Backend::Glsl, Written::Text(text)) => match context.tool(Tool::Glslang) {
            Some(program) => {
                tools::glslang(program, text, &context.folder.join(format!("{number}.{suffix}")))
            }
            None => Ok(()),
        },
        (Backend::Hlsl, Written::Named { text, entry_point }) => match context.tool(Tool::Dxc) {
            Some(program) => {
                let stage = match suffix {
                    "vert" => "vs",
                    "frag" => "ps",
                    _ => "cs",
                };
                let file = context.folder.join(format!("{number}.hlsl"));
                tools::dxc(program, (text, entry_point), stage, &file)
            }
            None => Ok(()),
        },
        _ => Ok(()),
    }
}

/// The flat form parses, validates, has the same interface, and passes the other compiler.
fn check_flat(
    context: &Context,
    composed: &Composed,
    reflection: &Reflection,
    number: usize,
    findings: &mut Vec<Finding>,
) {
    let text = match flat::write(composed) {
        Ok(text) => text,
        Err(error) => return findings.push(Finding::of("flat", &error)),
    };
    let place = |line: Option<u32>| origin(context.library, composed, &text, line);
    match naga::front::wgsl::parse_str(&text) {
        Err(error) => {
            let line = error.location(&text).map(|location| location.line_number);
            let message = quoted(error.message(), &text, line);
            findings.push(Finding::new(Severity::Error, place(line), "flat", message));
        }
        Ok(module) => match validate(&module) {
            Err(error) => {
                let line = error.location(&text).map(|location| location.line_number);
                let message = quoted(&locate::chain(error.as_inner()), &text, line);
                findings.push(Finding::new(Severity::Error, place(line), "flat", message));
            }
            Ok(info) => {
                let again = Reflection::new(&module, &info);
                if let Some(message) = difference(reflection, &again) {
                    findings.push(about(composed, Severity::Error, "flat", message));
                }
            }
        },
    }
    if let Some(program) = context.tool(Tool::Tint) {
        let path = context.folder.join(format!("{number}.wgsl"));
        // Tint wants an entry point.
        let entry_point = match reflection.entry_points.is_empty() {
            true => "\n@compute @workgroup_size(1)\nfn airlight_check() {}\n",
            false => "",
        };
        for diagnostic in tools::tint(program, &format!("{text}{entry_point}"), &path) {
            let message = quoted(&diagnostic.message, &text, diagnostic.line);
            let location = place(diagnostic.line);
            findings.push(Finding::new(diagnostic.severity, location, Tool::Tint.name(), message));
        }
    }
}

fn about(composed: &Composed, severity: Severity, check: &str, message: String) -> Finding {
    Finding::new(severity, Location::file(&composed.file), check, message)
}

/// The message with the line of the flat file that it is about, which no one has open.
fn quoted(message: &str, text: &str, line: Option<u32>) -> String {
    let code = line.and_then(|line| text.lines().nth(line.saturating_sub(1) as usize));
    match code {
        Some(code) => format!("{message}; in `{}`", code.trim()),
        None => message.to_owned(),
    }
}

/// The own file and line of the function around a line of the flat file.
fn origin(library: &Library, composed: &Composed, text: &str, line: Option<u32>) -> Location {
    let unknown = Location::file(&composed.file);
    let Some(line) = line else { return unknown };
    let above: Vec<&str> = text.lines().take(line as usize).collect();
    let name = above.iter().rev().find_map(|line| {
        let rest = line.split_once("fn ")?.1;
        line.trim_start().starts_with(['f', '@']).then(|| rest.split('(').next())?
    });
    let Some(name) = name else { return unknown };
    let imports = match library.pass(&composed.pass) {
        Ok(pass) => pass.imports.clone(),
        Err(_) => vec![composed.pass.clone()],
    };
    let modules = library.closure(&imports);
    let own = library.text(&composed.file).map(|source| (composed.file.as_str(), "", source));
    let modules = modules.iter().map(|module| {
        let short = module.path.rsplit("::").next().unwrap_or_default();
        (module.file.as_str(), short, module.source.as_str())
    });
    for (file, module, source) in own.into_iter().chain(modules) {
        // An ambiguous name has its module's before it.
        let short = name.strip_prefix(module).and_then(|name| name.strip_prefix('_'));
        for candidate in [Some(name), short].into_iter().flatten() {
            let declaration = format!("fn {candidate}(");
            if let Some(index) = source.lines().position(|line| line.contains(&declaration)) {
                return Location::line(file, index as u32 + 1);
            }
        }
    }
    unknown
}

/// What the flat form lost, if anything.
fn difference(before: &Reflection, after: &Reflection) -> Option<String> {
    for binding in &before.bindings {
        if !after.bindings.contains(binding) {
            return Some(format!("the flat form does not keep the binding {binding:?}"));
        }
    }
    for layout in &before.structs {
        if !after.structs.contains(layout) {
            let name = &layout.name;
            return Some(format!(
                "the flat form does not keep the names or the layout of struct `{name}`: use \
                 padding members instead of `@size` and `@align`, and no name that ends in a digit"
            ));
        }
    }
    // Arguments are told apart by their locations; the writer numbers names that come twice.
    let nameless = |entry: &EntryPoint| {
        let mut entry = entry.clone();
        entry.inputs.iter_mut().for_each(|input| input.name.clear());
        entry
    };
    let kept: Vec<EntryPoint> = after.entry_points.iter().map(nameless).collect();
    for entry in &before.entry_points {
        if !kept.contains(&nameless(entry)) {
            let name = &entry.name;
            return Some(format!("the flat form does not keep the entry point `{name}` as it is"));
        }
    }
    None
}

/// Structs of uniform buffers and those inside them.
fn uniform_structs(reflection: &Reflection) -> Vec<&StructLayout> {
    let mut open: Vec<&str> = reflection
        .bindings
        .iter()
        .filter_map(|binding| match &binding.kind {
            BindingKind::Uniform { ty, .. } => Some(ty.as_str()),
            _ => None,
        })
        .collect();
    let mut found: Vec<&StructLayout> = Vec::new();
    while let Some(ty) = open.pop() {
        let mut name = ty;
        while let Some(inner) = name.strip_prefix("array<") {
            name = inner.split([',', '>']).next().unwrap_or(inner);
        }
        if let Some(layout) = reflection.layout(name)
            && !found.iter().any(|known| known.name == layout.name)
        {
            found.push(layout);
            open.extend(layout.members.iter().map(|member| member.ty.as_str()));
        }
    }
    found
}
