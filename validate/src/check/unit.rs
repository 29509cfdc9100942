// SPDX-License-Identifier: MIT OR Apache-2.0
//! The checks of one module or one permutation of a pass.

use crate::{
    BindingKind, Composed, Definitions, Library, Location, Reflection, StructLayout,
    check::{
        Finding, Severity, Tool,
        backends::{self, Backend, Written},
        expected::{self, Expected, Outcome, Verdict},
        form, limits, origin, plain, tools,
    },
    compose::validate,
    locate,
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

impl Subject {
    /// The path of a module that is checked alone.
    pub fn module(&self) -> Option<&str> {
        match self {
            Self::Module { path, .. } => Some(path),
            Self::Pass { .. } => None,
        }
    }

    /// The path of the module, or the name of the pass.
    pub fn name(&self) -> &str {
        match self {
            Self::Module { path, .. } => path,
            Self::Pass { name, .. } => name,
        }
    }

    pub fn definitions(&self) -> &Definitions {
        match self {
            Self::Module { definitions, .. } | Self::Pass { definitions, .. } => definitions,
        }
    }
}

/// What all subjects share.
pub(crate) struct Context {
    pub library: Library,
    pub expected: Vec<Expected>,
    pub tools: Vec<(Tool, PathBuf)>,
    pub folder: tempfile::TempDir,
}

impl Context {
    /// Whether the shaders are somebody else's: then Airlight's own rules do not hold.
    pub fn is_foreign(&self) -> bool {
        self.library.foreign.is_some()
    }

    /// A temporary file of a subject.
    pub fn file(&self, number: usize, extension: &str) -> PathBuf {
        self.folder.path().join(format!("{number}.{extension}"))
    }

    pub fn tool(&self, wanted: Tool) -> Option<&Path> {
        self.tools.iter().find(|(tool, _)| *tool == wanted).map(|(_, path)| path.as_path())
    }
}

/// All findings about a subject; `number` makes its temporary files its own.
pub(crate) fn check(context: &Context, subject: &Subject, number: usize) -> Vec<Finding> {
    let (pass, permutation, composed) = match subject {
        Subject::Module { path, definitions } => {
            (path.as_str(), None, context.library.compose_module(path, definitions))
        }
        Subject::Pass { name, .. } if context.library.is_plain(name) => {
            return plain::check(context, name, number);
        }
        Subject::Pass { name, permutation, definitions } => {
            (name.as_str(), Some(permutation.as_str()), context.library.compose(name, definitions))
        }
    };
    let mut findings = match composed {
        Ok(composed) => match permutation {
            // A file of others that no composer reads and that has no path is a module as well.
            Some(_) if context.is_foreign() && composed.module.entry_points.is_empty() => {
                check_module(context, composed, number)
            }
            Some(permutation) => check_pass(context, &composed, permutation, number),
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
    form::check(context, &composed, &composed.reflect(), number, &mut findings);
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

fn check_pass(context: &Context, composed: &Composed, permutation: &str, number: usize) -> Vec<Finding> {
    let mut findings = Vec::new();
    let reflection = composed.reflect();
    if reflection.entry_points.is_empty() {
        let message = "a pass needs an entry point".to_owned();
        findings.push(about(composed, Severity::Error, "compose", message));
    }
    let place = |name: &str| origin::of_declaration(&context.library, composed, name);
    check_limits(&reflection, permutation, place, &mut findings);
    // How a struct is padded is a rule of Airlight's.
    for layout in uniform_structs(&reflection).into_iter().filter(|_| !context.is_foreign()) {
        if let Some(message) = limits::implicit_padding(layout) {
            findings.push(Finding::new(Severity::Error, place(&layout.name), "padding", message));
        }
    }
    form::check(context, composed, &reflection, number, &mut findings);
    form::check_shipped(context, composed, permutation, number, &mut findings);
    check_backends(context, composed, &reflection, permutation, number, &mut findings);
    findings
}

/// Limits and formats; `place` says where a name is declared.
pub(super) fn check_limits(
    reflection: &Reflection,
    permutation: &str,
    place: impl Fn(&str) -> Location,
    findings: &mut Vec<Finding>,
) {
    // Only a permutation that says so in its name may want more than every device has.
    let severity = if permutation == "default" { Severity::Error } else { Severity::Warning };
    for excess in limits::excesses(reflection) {
        let location = place(&excess.entry_point);
        findings.push(Finding::new(severity, location, "limits", excess.to_string()));
    }
    for (name, message) in limits::violations(reflection) {
        findings.push(Finding::new(Severity::Error, place(&name), "formats", message));
    }
}

/// Every entry point through every back end, and what the list of expected failures says of that.
pub(super) fn check_backends(
    context: &Context,
    composed: &Composed,
    reflection: &Reflection,
    permutation: &str,
    number: usize,
    findings: &mut Vec<Finding>,
) {
    let place = |name: &str| origin::of_declaration(&context.library, composed, name);
    let mut outcomes = Vec::new();
    for (index, entry) in composed.module.entry_points.iter().enumerate() {
        let suffix = match entry.stage {
            naga::ShaderStage::Vertex => "vert",
            naga::ShaderStage::Fragment => "frag",
            _ => "comp",
        };
        for backend in Backend::ALL {
            let result = backends::write(backend, composed, reflection, index);
            let result = result.and_then(|written| compile(context, backend, &written, suffix, number));
            let entry_point = entry.name.clone();
            outcomes.push(Outcome { entry_point, backend, error: result.err() });
        }
    }
    for verdict in expected::judge(&context.expected, &composed.pass, permutation, &outcomes) {
        findings.push(match verdict {
            Verdict::Unexpected { entry_point, backend, message } => {
                // WebGPU never takes GLSL; only a fallback to OpenGL does.
                let is_minor = context.is_foreign() && backend == Backend::Glsl;
                let severity = if is_minor { Severity::Warning } else { Severity::Error };
                let message = format!("`{entry_point}`: {message}");
                Finding::new(severity, place(&entry_point), backend.name(), message)
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
            Some(program) => tools::spirv_val(program, words, &context.file(number, "spv")),
            None => Ok(()),
        },
        (Backend::Glsl, Written::Text(text)) => match context.tool(Tool::Glslang) {
            Some(program) => tools::glslang(program, text, &context.file(number, suffix)),
            None => Ok(()),
        },
        (Backend::Hlsl, Written::Named { text, entry_point }) => match context.tool(Tool::Dxc) {
            Some(program) => {
                let stage = match suffix {
                    "vert" => "vs",
                    "frag" => "ps",
                    _ => "cs",
                };
                let file = context.folder.path().join(format!("{number}.hlsl"));
                tools::dxc(program, (text, entry_point), stage, &file)
            }
            None => Ok(()),
        },
        _ => Ok(()),
    }
}

pub(super) fn about(composed: &Composed, severity: Severity, check: &str, message: String) -> Finding {
    Finding::new(severity, Location::file(&composed.file), check, message)
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
