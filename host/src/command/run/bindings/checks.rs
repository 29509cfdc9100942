// SPDX-License-Identifier: MIT OR Apache-2.0
//! Whether what was asked for fits a pass: names, what is missing, sizes.

use super::TARGET;
use super::place::{input_flag, output_flag};
use super::textures::side_names;
use crate::command::CommandError;
use crate::command::run::Options;
use crate::command::run::plan::{Plan, Work};
use crate::command::run::spelling::Output;
use crate::layout::kind_text;
use airlight_validate::{Access, Binding, BindingKind, Sample, TextureDimension};

/// A binding with its kind.
pub(super) fn described(binding: &Binding) -> String {
    format!("`{}` ({})", binding.name, kind_text(&binding.kind))
}

/// Words with commas between them.
pub(super) fn listed(words: impl Iterator<Item = String>) -> String {
    let words: Vec<_> = words.collect();
    if words.is_empty() { "none".to_owned() } else { words.join(", ") }
}

fn list<'a>(bindings: impl Iterator<Item = &'a Binding>) -> String {
    listed(bindings.map(described))
}

fn writable(binding: &Binding) -> bool {
    match &binding.kind {
        BindingKind::Storage { writable, .. } => *writable,
        BindingKind::StorageTexture { access, .. } => *access != Access::Read,
        _ => false,
    }
}

/// Every `--in` and `--out` names a binding once, of a kind that it can be for.
pub(super) fn check_names(options: &Options, plan: &Plan) -> Result<(), CommandError> {
    let find = |name: &str| plan.bindings.iter().find(|binding| binding.name == name);
    let unknown = |flag: String, name: &str| {
        let known = list(plan.bindings.iter());
        CommandError::misuse(&flag, format!("{} has no binding `{name}`; it has {known}", plan.name()))
    };
    for (index, input) in options.input.iter().enumerate() {
        let flag = input_flag(input);
        let binding = find(&input.name).ok_or_else(|| unknown(flag.clone(), &input.name))?;
        if options.input[..index].iter().any(|earlier| earlier.name == input.name) {
            return Err(CommandError::misuse(&flag, format!("`{}` is given twice", input.name)));
        }
        let problem = match &binding.kind {
            BindingKind::Sampler { .. } => "a sampler is made by itself and takes no array",
            BindingKind::Texture { sample: Sample::Depth, .. } => {
                "a depth texture cannot be filled from an array"
            }
            _ => continue,
        };
        return Err(CommandError::misuse(&flag, problem));
    }
    let screen = matches!(plan.work, Work::Screen { .. });
    for (index, output) in options.output.iter().enumerate() {
        let flag = output_flag(output);
        let earlier = &options.output[..index];
        if earlier.iter().any(|earlier| earlier.name == output.name) {
            return Err(CommandError::misuse(&flag, format!("`{}` is given twice", output.name)));
        }
        if earlier.iter().any(|earlier| earlier.file == output.file) {
            return Err(CommandError::misuse(&flag, "another --out has the same file"));
        }
        let outputs = || {
            let mut known = list(plan.bindings.iter().filter(|binding| writable(binding)));
            if screen {
                known = format!("`{TARGET}` (the render target)");
            }
            known
        };
        match find(&output.name) {
            _ if screen && output.name == TARGET => {}
            Some(binding) if writable(binding) => {}
            Some(binding) => {
                let problem = format!(
                    "{} is not written by {}; written are {}",
                    described(binding),
                    plan.name(),
                    outputs()
                );
                return Err(CommandError::misuse(&flag, problem));
            }
            None if screen => {
                let problem =
                    format!("{} writes no `{}`; written are {}", plan.name(), output.name, outputs());
                return Err(CommandError::misuse(&flag, problem));
            }
            None => return Err(unknown(flag, &output.name)),
        }
    }
    Ok(())
}

/// Every resource that must be given is; samplers and uniforms need not be.
pub(super) fn missing(options: &Options, plan: &Plan) -> Result<(), CommandError> {
    let mut wanted = Vec::new();
    for binding in &plan.bindings {
        let name = &binding.name;
        let given = options.input.iter().any(|input| input.name == *name)
            || options.output.iter().any(|output| output.name == *name);
        let shape = match &binding.kind {
            BindingKind::Uniform { .. } | BindingKind::Sampler { .. } => continue,
            _ if given => continue,
            BindingKind::Texture { sample: Sample::Depth, .. } => {
                let problem =
                    format!("{} needs {}, which no array can fill", plan.name(), described(binding));
                return Err(CommandError::Misuse(problem));
            }
            BindingKind::StorageTexture { dimension, .. } => side_names(*dimension),
            _ => "COUNT",
        };
        let kind = kind_text(&binding.kind);
        wanted.push(if writable(binding) {
            format!("`--out {name}=FILE.npy:{shape}` ({kind})")
        } else {
            format!("`--in {name}=FILE.npy` ({kind})")
        });
    }
    if matches!(plan.work, Work::Screen { .. }) && !options.output.iter().any(|output| output.name == TARGET)
    {
        wanted.push(format!("`--out {TARGET}=FILE.npy` (the render target)"));
    }
    if !wanted.is_empty() {
        return Err(CommandError::Misuse(format!("{} needs {}", plan.name(), wanted.join(" and "))));
    }
    if options.output.is_empty() {
        let known = list(plan.bindings.iter().filter(|binding| writable(binding)));
        return Err(CommandError::misuse(
            "--out",
            format!("nothing would be kept; {} writes {known}", plan.name()),
        ));
    }
    Ok(())
}

/// `--size` is for targets, and for flat storage textures that are neither given nor sized otherwise.
pub(super) fn check_size(options: &Options, plan: &Plan) -> Result<(), CommandError> {
    let (Some([width, height]), Work::Compute { .. }) = (options.size, &plan.work) else { return Ok(()) };
    let takes = |binding: &Binding| {
        let flat =
            matches!(binding.kind, BindingKind::StorageTexture { dimension: TextureDimension::D2, .. });
        let given = options.input.iter().any(|input| input.name == binding.name);
        let open = |output: &Output| output.name == binding.name && output.shape.is_none();
        flat && !given && options.output.iter().any(open)
    };
    if plan.bindings.iter().any(takes) {
        return Ok(());
    }
    let problem = format!("{} has no 2d storage texture among --out that lacks a SHAPE", plan.name());
    Err(CommandError::misuse(&format!("--size {width}x{height}"), problem))
}
