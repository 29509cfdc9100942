// SPDX-License-Identifier: MIT OR Apache-2.0
//! Resources bound by name: the layout of a pass's bind group, and groups of that layout.

use super::watch::Held;
use super::{Pass, PassError, caught};
use crate::gpu::Gpu;
use crate::layout::{kind_text, layout_entry, mismatch};
use crate::resource::{Buffer, Sampler, Texture};
use airlight_validate::{Binding, Reflection};
use std::sync::Arc;

/// A resource to bind.
#[derive(Clone, Copy)]
pub enum Resource<'a> {
    /// A uniform or storage buffer.
    Buffer(&'a Buffer),
    /// A sampled or storage texture.
    Texture(&'a Texture),
    /// A sampler.
    Sampler(&'a Sampler),
}

impl<'a> From<&'a Buffer> for Resource<'a> {
    fn from(buffer: &'a Buffer) -> Self {
        Self::Buffer(buffer)
    }
}

impl<'a> From<&'a Texture> for Resource<'a> {
    fn from(texture: &'a Texture) -> Self {
        Self::Texture(texture)
    }
}

impl<'a> From<&'a Sampler> for Resource<'a> {
    fn from(sampler: &'a Sampler) -> Self {
        Self::Sampler(sampler)
    }
}

impl Resource<'_> {
    fn held(self) -> Held {
        match self {
            Self::Buffer(buffer) => Held::Buffer(buffer.clone()),
            Self::Texture(texture) => Held::Texture(texture.clone()),
            Self::Sampler(sampler) => Held::Sampler(sampler.clone()),
        }
    }
}

/// Resources bound to a pass.
pub struct Bound {
    pub(super) group: wgpu::BindGroup,
    /// What is bound, on a device that is watched.
    pub(super) held: Option<Arc<[(Binding, Held)]>>,
}

impl Pass {
    /// What the pass expects, in one line.
    pub fn expects(&self) -> String {
        let list: Vec<_> = self
            .bindings
            .iter()
            .map(|binding| format!("`{}` ({})", binding.name, kind_text(&binding.kind)))
            .collect();
        if list.is_empty() { "no bindings".to_owned() } else { list.join(", ") }
    }

    /// The bindings that the pass's entry points use.
    pub fn bindings(&self) -> &[Binding] {
        &self.bindings
    }

    /// Binds resources by name.
    ///
    /// # Errors
    /// [`PassError`] for an unknown, missing or ill-typed name.
    pub fn bind(&self, gpu: &Gpu, resources: &[(&str, Resource<'_>)]) -> Result<Bound, PassError> {
        if let Some((name, _)) =
            resources.iter().find(|(name, _)| !self.bindings.iter().any(|b| b.name == **name))
        {
            return Err(PassError::UnknownBinding {
                pass: self.name.clone(),
                name: (*name).to_owned(),
                expected: self.expects(),
            });
        }
        self.bind_known(gpu, resources)
    }

    /// Like [`Pass::bind`], but passes over names that this permutation does not have.
    ///
    /// # Errors
    /// [`PassError`] for a missing or ill-typed name.
    pub fn bind_known(&self, gpu: &Gpu, resources: &[(&str, Resource<'_>)]) -> Result<Bound, PassError> {
        let mut entries = Vec::new();
        let mut held = Vec::new();
        for binding in &self.bindings {
            let found = resources.iter().find(|(name, _)| *name == binding.name);
            let Some((_, resource)) = found else {
                return Err(PassError::MissingBinding {
                    pass: self.name.clone(),
                    name: binding.name.clone(),
                    expected: self.expects(),
                });
            };
            if let Some(given) = mismatch(&binding.kind, *resource) {
                return Err(PassError::WrongResource {
                    pass: self.name.clone(),
                    name: binding.name.clone(),
                    wanted: kind_text(&binding.kind),
                    given,
                });
            }
            if self.watched.is_some() {
                held.push((binding.clone(), resource.held()));
            }
            entries.push(wgpu::BindGroupEntry {
                binding: binding.binding,
                resource: match resource {
                    Resource::Buffer(buffer) => buffer.raw.as_entire_binding(),
                    Resource::Texture(texture) => wgpu::BindingResource::TextureView(&texture.view),
                    Resource::Sampler(sampler) => wgpu::BindingResource::Sampler(&sampler.raw),
                },
            });
        }
        let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(&self.name),
            layout: &self.layout,
            entries: &entries,
        });
        caught(scope)?;
        Ok(Bound { group, held: self.watched.is_some().then(|| held.into()) })
    }
}

/// The bindings that some entry points use, the layout of their group and that of a pipeline over it.
pub(super) fn layouts(
    gpu: &Gpu,
    reflection: &Reflection,
    entry_points: &[&str],
    visibility: wgpu::ShaderStages,
) -> (Vec<Binding>, wgpu::BindGroupLayout, wgpu::PipelineLayout) {
    let bindings: Vec<Binding> = reflection
        .bindings
        .iter()
        .filter(|binding| binding.entry_points.iter().any(|name| entry_points.contains(&name.as_str())))
        .cloned()
        .collect();
    let entries: Vec<_> = bindings.iter().map(|binding| layout_entry(binding, visibility)).collect();
    let layout = gpu
        .device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries });
    let pipeline_layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &[Some(&layout)],
        immediate_size: 0,
    });
    (bindings, layout, pipeline_layout)
}
