// SPDX-License-Identifier: MIT OR Apache-2.0
//! A composed module through naga's back ends, with a real place for every binding.

use crate::{Access, Binding, BindingKind, Composed, Reflection, check::panic_text};
use naga::{
    ResourceBinding,
    back::{PipelineConstants, glsl, hlsl, msl, pipeline_constants::process_overrides, spv},
    proc::BoundsCheckPolicies,
};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// A language that naga writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Backend {
    /// SPIR-V 1.3, for Vulkan.
    Spirv,
    /// Metal Shading Language 2.4.
    Msl,
    /// HLSL for shader model 6.0.
    Hlsl,
    /// Desktop GLSL 4.50.
    Glsl,
}

impl Backend {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Spirv, Self::Msl, Self::Hlsl, Self::Glsl];

    /// Its name in reports and in the list of expected failures.
    pub fn name(self) -> &'static str {
        match self {
            Self::Spirv => "spirv",
            Self::Msl => "msl",
            Self::Hlsl => "hlsl",
            Self::Glsl => "glsl",
        }
    }
}

/// What a back end wrote.
#[derive(Clone, Debug)]
pub enum Written {
    /// SPIR-V words.
    Words(Vec<u32>),
    /// Source text.
    Text(String),
    /// Source text whose entry point may have had to take another name.
    Named {
        /// The text.
        text: String,
        /// The name of the entry point in it.
        entry_point: String,
    },
}

/// Writes one entry point.
///
/// # Errors
/// What the back end says, or what it panicked with.
pub fn write(
    backend: Backend,
    composed: &Composed,
    reflection: &Reflection,
    entry: usize,
) -> Result<Written, String> {
    let writing = AssertUnwindSafe(|| write_unguarded(backend, composed, reflection, entry));
    catch_unwind(writing)
        .unwrap_or_else(|panic| Err(format!("naga panicked: {}", panic_text(panic.as_ref()))))
}

fn write_unguarded(
    backend: Backend,
    composed: &Composed,
    reflection: &Reflection,
    entry: usize,
) -> Result<Written, String> {
    let entry = &composed.module.entry_points[entry];
    let (stage, name) = (entry.stage, entry.name.clone());
    let processed = process_overrides(
        &composed.module,
        &composed.info,
        Some((stage, name.as_str())),
        &values(&composed.module),
    );
    let (module, info) = processed.map_err(|error| error.to_string())?;
    let (module, info) = (module.as_ref(), info.as_ref());
    match backend {
        Backend::Spirv => {
            let pipeline = spv::PipelineOptions { shader_stage: stage, entry_point: name };
            spv::write_vec(module, info, &spirv_options(reflection), Some(&pipeline))
                .map(Written::Words)
                .map_err(|error| error.to_string())
        }
        Backend::Msl => {
            let pipeline = msl::PipelineOptions {
                entry_point: Some((stage, name.clone())),
                allow_and_force_point_size: false,
                vertex_pulling_transform: false,
                vertex_buffer_mappings: Vec::new(),
                binding_array_length_map: Default::default(),
            };
            let options = msl_options(reflection, &name);
            let (text, translation) =
                msl::write_string(module, info, &options, &pipeline).map_err(|error| error.to_string())?;
            // A missing binding is not an error of the whole.
            for name in translation.entry_point_names {
                name.map_err(|error| error.to_string())?;
            }
            Ok(Written::Text(text))
        }
        Backend::Hlsl => {
            let pipeline = hlsl::PipelineOptions { entry_point: Some((stage, name)) };
            let options = hlsl_options(reflection);
            let mut text = String::new();
            let names = hlsl::Writer::new(&mut text, &options, &pipeline)
                .write(module, info, None)
                .map_err(|error| error.to_string())?
                .entry_point_names;
            let names: Result<Vec<String>, _> = names.into_iter().collect();
            let entry_point = names.map_err(|error| error.to_string())?.pop().unwrap_or_default();
            Ok(Written::Named { text, entry_point })
        }
        Backend::Glsl => {
            let pipeline = glsl::PipelineOptions { shader_stage: stage, entry_point: name, multiview: None };
            let options = glsl_options(reflection)?;
            let mut text = String::new();
            let policies = BoundsCheckPolicies::default();
            glsl::Writer::new(&mut text, module, info, &options, &pipeline, policies)
                .and_then(|mut writer| writer.write())
                .map_err(|error| error.to_string())?;
            Ok(Written::Text(text))
        }
    }
}

/// A value for each pipeline override that has none; which one does not matter to a back end.
fn values(module: &naga::Module) -> PipelineConstants {
    let without = module.overrides.iter().filter(|(_, constant)| constant.init.is_none());
    without
        .filter_map(|(_, constant)| match constant.id {
            Some(id) => Some((id.to_string(), 1.0)),
            None => Some((constant.name.clone()?, 1.0)),
        })
        .collect()
}

fn resource(binding: &Binding) -> ResourceBinding {
    ResourceBinding { group: binding.group, binding: binding.binding }
}

fn spirv_options(reflection: &Reflection) -> spv::Options<'static> {
    let places = reflection.bindings.iter().map(|binding| {
        let info = spv::BindingInfo {
            descriptor_set: binding.group,
            binding: binding.binding,
            binding_array_size: None,
        };
        (resource(binding), info)
    });
    spv::Options {
        lang_version: (1, 3),
        fake_missing_bindings: false,
        binding_map: places.collect(),
        ..Default::default()
    }
}

/// Slots count up by kind, as a Metal argument table has them.
fn msl_options(reflection: &Reflection, entry_point: &str) -> msl::Options {
    let (mut buffers, mut textures, mut samplers) = (0, 0, 0);
    let next = |counter: &mut u8| {
        *counter += 1;
        *counter - 1
    };
    let resources = reflection.bindings.iter().map(|binding| {
        let mut target = msl::BindTarget::default();
        match &binding.kind {
            BindingKind::Uniform { .. } | BindingKind::Other { .. } => {
                target.buffer = Some(next(&mut buffers));
            }
            BindingKind::Storage { writable, .. } => {
                target.buffer = Some(next(&mut buffers));
                target.mutable = *writable;
            }
            BindingKind::Texture { .. } => target.texture = Some(next(&mut textures)),
            BindingKind::StorageTexture { access, .. } => {
                target.texture = Some(next(&mut textures));
                target.mutable = *access != Access::Read;
            }
            BindingKind::Sampler { .. } => {
                target.sampler = Some(msl::BindSamplerTarget::Resource(next(&mut samplers)));
            }
        }
        (resource(binding), target)
    });
    let resources = msl::EntryPointResources {
        resources: resources.collect(),
        immediates_buffer: None,
        // The last but one of Metal's 31 buffers.
        sizes_buffer: Some(29),
    };
    msl::Options {
        lang_version: (2, 4),
        per_entry_point_map: [(entry_point.to_owned(), resources)].into_iter().collect(),
        fake_missing_bindings: false,
        ..Default::default()
    }
}

fn hlsl_options(reflection: &Reflection) -> hlsl::Options {
    let place = |space: u8, register: u32| hlsl::BindTarget {
        space,
        register,
        binding_array_size: None,
        dynamic_storage_buffer_offsets_index: None,
        restrict_indexing: false,
    };
    let space = |group: u32| u8::try_from(group).unwrap_or(u8::MAX);
    let bindings = reflection
        .bindings
        .iter()
        .map(|binding| (resource(binding), place(space(binding.group), binding.binding)));
    // Each group's sampler indices, in spaces that no group has.
    let samplers = reflection.bindings.iter().map(|binding| {
        let key = hlsl::SamplerIndexBufferKey { group: binding.group };
        (key, place(255, binding.group))
    });
    hlsl::Options {
        shader_model: hlsl::ShaderModel::V6_0,
        binding_map: bindings.collect(),
        fake_missing_bindings: false,
        special_constants_binding: Some(place(254, 0)),
        sampler_buffer_binding_map: samplers.collect(),
        ..Default::default()
    }
}

fn glsl_options(reflection: &Reflection) -> Result<glsl::Options, String> {
    let mut binding_map = glsl::BindingMap::default();
    // OpenGL counts by kind, over all groups.
    let mut counters = [0_u8; 4];
    for binding in &reflection.bindings {
        let kind = match binding.kind {
            BindingKind::Uniform { .. } | BindingKind::Other { .. } => 0,
            BindingKind::Storage { .. } => 1,
            BindingKind::Texture { .. } => 2,
            BindingKind::StorageTexture { .. } => 3,
            // GLSL has texture and sampler in one.
            BindingKind::Sampler { .. } => continue,
        };
        binding_map.insert(resource(binding), counters[kind]);
        counters[kind] = counters[kind].checked_add(1).ok_or("more than 255 bindings")?;
    }
    Ok(glsl::Options { version: glsl::Version::Desktop(450), binding_map, ..Default::default() })
}
