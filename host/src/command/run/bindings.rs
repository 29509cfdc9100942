// SPDX-License-Identifier: MIT OR Apache-2.0
//! What each binding of a pass is given, decided before any GPU is asked.

mod checks;
mod place;
mod storage;
mod textures;
mod uniforms;

pub use textures::{copy_row, copy_size};

use super::plan::{Plan, Work};
use super::spelling::Scalar;
use super::{Options, fields};
use crate::command::CommandError;
use crate::layout::texture_format;
use airlight_validate::BindingKind;
use place::Place;
use std::path::PathBuf;

/// The name of the target that a full-screen pass draws to.
pub const TARGET: &str = "color";

/// How a resource is made.
pub enum Recipe {
    /// A uniform buffer.
    Uniform(Vec<u8>),
    /// A storage buffer.
    Storage(Vec<u8>),
    /// A texture.
    Texture(TextureRecipe),
    /// A sampler.
    Sampler { comparison: bool },
}

/// How a texture is made.
pub struct TextureRecipe {
    /// Width, height, layers or depth.
    pub size: [u32; 3],
    pub dimension: wgpu::TextureViewDimension,
    pub format: wgpu::TextureFormat,
    pub usage: wgpu::TextureUsages,
    /// Its texels; zeros where there are none.
    pub bytes: Option<Vec<u8>>,
}

/// Where the contents of a resource go.
pub struct Written {
    /// The text of the flag up to the file.
    pub flag: String,
    pub file: PathBuf,
    /// Without the channels of texels.
    pub shape: Vec<usize>,
    /// What a word of a buffer means.
    pub scalar: Scalar,
}

/// A resource and what becomes of it.
pub struct Planned {
    pub name: String,
    pub recipe: Recipe,
    pub written: Option<Written>,
}

/// The resources of a plan, the target of a full-screen pass last.
pub fn resources(
    options: &Options,
    plan: &Plan,
    limits: &wgpu::Limits,
) -> Result<Vec<Planned>, CommandError> {
    checks::check_names(options, plan)?;
    let settings = uniforms::settings(options, plan)?;
    checks::missing(options, plan)?;
    checks::check_size(options, plan)?;
    let mut all = Vec::new();
    for binding in &plan.bindings {
        let place = Place {
            name: &binding.name,
            input: options.input.iter().find(|input| input.name == binding.name),
            output: options.output.iter().find(|output| output.name == binding.name),
            pass: plan.name(),
            size: options.size,
            limits,
        };
        let (recipe, written) = match &binding.kind {
            BindingKind::Uniform { ty, size } => {
                let mut bytes = place.uniform(ty, *size, plan)?;
                for (setting, field, _) in settings.iter().filter(|(_, _, name)| *name == binding.name) {
                    fields::set(&mut bytes, ty, field, &setting.value, &plan.structs)
                        .map_err(|problem| uniforms::set_error(setting, problem))?;
                }
                (Recipe::Uniform(bytes), None)
            }
            BindingKind::Storage { ty, min_size, .. } => place.storage(ty, *min_size, plan)?,
            BindingKind::Texture { dimension, sample, filtered, multisampled } => {
                if *multisampled {
                    return Err(place.impossible("a multisampled texture cannot be filled from an array"));
                }
                (Recipe::Texture(place.sampled(*dimension, *sample, *filtered)?), None)
            }
            BindingKind::StorageTexture { dimension, format, .. } => {
                let format = texture_format(*format)
                    .ok_or_else(|| place.impossible("its format is not one of core WebGPU"))?;
                place.storage_texture(*dimension, format)?
            }
            BindingKind::Sampler { comparison } => (Recipe::Sampler { comparison: *comparison }, None),
            BindingKind::Other { ty } => return Err(place.impossible(&format!("{ty} cannot be bound"))),
        };
        all.push(Planned { name: binding.name.clone(), recipe, written });
    }
    if let Work::Screen { target, size, .. } = plan.work {
        all.push(textures::target(options, target, size, limits)?);
    }
    Ok(all)
}
