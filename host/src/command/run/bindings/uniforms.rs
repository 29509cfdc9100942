// SPDX-License-Identifier: MIT OR Apache-2.0
//! Uniform buffers, and the numbers that are set in them.

use super::checks::{described, listed};
use super::place::{Place, shape_text};
use crate::command::CommandError;
use crate::command::run::Options;
use crate::command::run::fields::{self, Type};
use crate::command::run::plan::Plan;
use crate::command::run::spelling::{Scalar, Setting};
use airlight_validate::BindingKind;

/// What is wrong with a `--set`.
pub(super) fn set_error(setting: &Setting, problem: String) -> CommandError {
    CommandError::misuse(&format!("--set {}={}", setting.path, setting.value), problem)
}

/// Each `--set` with the path inside its uniform and the name of that uniform, found by name or by struct.
pub(super) fn settings<'a>(
    options: &'a Options,
    plan: &'a Plan,
) -> Result<Vec<(&'a Setting, &'a str, &'a str)>, CommandError> {
    let mut found = Vec::new();
    for setting in &options.set {
        let end = setting.path.find(['.', '[']).unwrap_or(setting.path.len());
        let (name, field) = setting.path.split_at(end);
        let field = field.strip_prefix('.').unwrap_or(field);
        let uniforms = || {
            plan.bindings.iter().filter_map(|binding| match &binding.kind {
                BindingKind::Uniform { ty, .. } => Some((binding, ty)),
                _ => None,
            })
        };
        let known = || listed(uniforms().map(|(binding, ty)| format!("{} ({ty})", binding.name)));
        if let Some((binding, ty)) = uniforms().find(|(binding, _)| binding.name == name) {
            check_field(setting, ty, field, plan)?;
            found.push((setting, field, binding.name.as_str()));
            continue;
        }
        if let Some(binding) = plan.bindings.iter().find(|binding| binding.name == name) {
            let problem =
                format!("{} is no uniform; uniforms of {} are {}", described(binding), plan.name(), known());
            return Err(set_error(setting, problem));
        }
        let typed: Vec<_> = uniforms().filter(|(_, ty)| *ty == name).collect();
        match typed[..] {
            [(binding, ty)] => {
                check_field(setting, ty, field, plan)?;
                found.push((setting, field, binding.name.as_str()));
            }
            [] => {
                let problem = format!("{} has no uniform `{name}`; it has {}", plan.name(), known());
                return Err(set_error(setting, problem));
            }
            _ => {
                let problem = format!("several uniforms are a {name}; name one of {}", known());
                return Err(set_error(setting, problem));
            }
        }
    }
    Ok(found)
}

/// Writes into a copy, so that a wrong field is found before files are read.
fn check_field(setting: &Setting, ty: &str, field: &str, plan: &Plan) -> Result<(), CommandError> {
    let size = plan.bindings.iter().find_map(|binding| match &binding.kind {
        BindingKind::Uniform { ty: of, size } if of == ty => Some(*size as usize),
        _ => None,
    });
    let mut bytes = vec![0; size.unwrap_or(0)];
    fields::set(&mut bytes, ty, field, &setting.value, &plan.structs)
        .map_err(|problem| set_error(setting, problem))
}

impl Place<'_> {
    /// The bytes of a uniform: zeros where nothing is given.
    pub(super) fn uniform(&self, ty: &str, size: u64, plan: &Plan) -> Result<Vec<u8>, CommandError> {
        let limit = self.limits.max_uniform_buffer_binding_size;
        if size > limit {
            return Err(self.impossible(&format!("{ty} is {size} bytes; a device takes at most {limit}")));
        }
        let Some(given) = self.given()? else { return Ok(vec![0; size as usize]) };
        let (_, bytes) = self.words(&given, ty, uniform_scalar(ty, plan))?;
        if bytes.len() as u64 != size {
            let (given_words, words) = (bytes.len() / 4, size / 4);
            return Err(given.wrong(format!(
                "{given_words} numbers in {}; {ty} takes {words}",
                shape_text(&given.shape)
            )));
        }
        Ok(bytes)
    }
}

fn uniform_scalar(ty: &str, plan: &Plan) -> Option<Scalar> {
    // Structs travel as raw words: what `--out` of a struct writes, `--in` takes back.
    match Type::new(ty, &plan.structs) {
        Type::Struct(_) => None,
        other => other.scalar(&plan.structs),
    }
}
