// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pipelines and layouts built from reflection; resources bound by name.

mod bind;
mod target;

pub use bind::{Bound, Resource};
pub(crate) use target::begin_target;

use crate::gpu::{Gpu, GpuError};
use crate::resource::{Buffer, Texture};
use crate::shaders::Shaders;
use airlight_validate::{Binding, Composed, Definitions, Stage};
use bind::layouts;
use std::borrow::Cow;

/// Why a pass could not be built or bound.
#[derive(Debug, thiserror::Error)]
pub enum PassError {
    /// The shader does not compose, or there is no such pass or permutation.
    #[error(transparent)]
    Shader(#[from] airlight_validate::Error),
    /// The device refused.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// A resource was named that the pass does not have.
    #[error("{pass} has no binding `{name}`; it expects {expected}")]
    UnknownBinding {
        /// The pass.
        pass: String,
        /// The unknown name.
        name: String,
        /// All that it expects.
        expected: String,
    },
    /// A resource was not given.
    #[error("{pass} needs the binding `{name}`; it expects {expected}")]
    MissingBinding {
        /// The pass.
        pass: String,
        /// The missing name.
        name: String,
        /// All that it expects.
        expected: String,
    },
    /// A resource of the wrong type.
    #[error("{pass}: binding `{name}` is {wanted}, not {given}")]
    WrongResource {
        /// The pass.
        pass: String,
        /// The binding.
        name: String,
        /// What the shader declares.
        wanted: String,
        /// What was given.
        given: String,
    },
    /// An entry point that the pass does not have.
    #[error("{pass} has no entry point `{name}`; it has {expected}")]
    UnknownEntryPoint {
        /// The pass.
        pass: String,
        /// The unknown name.
        name: String,
        /// Those it has.
        expected: String,
    },
}

struct ComputeEntry {
    name: String,
    workgroup: [u32; 3],
    pipeline: wgpu::ComputePipeline,
}

enum Pipelines {
    Compute(Vec<ComputeEntry>),
    Render(wgpu::RenderPipeline),
}

/// How a render pipeline is made from the entry points of a pass.
pub struct RenderStages<'a> {
    /// Vertex entry point.
    pub vertex: &'a str,
    /// Fragment entry point, none for depth only.
    pub fragment: Option<&'a str>,
    /// Layout of the vertex buffer, none where the vertex index is enough.
    pub vertices: Option<wgpu::VertexBufferLayout<'a>>,
    /// Format of the colour target.
    pub target: Option<wgpu::TextureFormat>,
    /// Depth test and write.
    pub depth: Option<(wgpu::CompareFunction, bool)>,
    /// Samples a pixel, 1 or 4.
    pub samples: u32,
}

/// A pass of the library with its pipelines and the layout of its resources.
pub struct Pass {
    name: String,
    bindings: Vec<Binding>,
    layout: wgpu::BindGroupLayout,
    pipelines: Pipelines,
}

impl Pass {
    /// All compute entry points of a pass in one of its shipped permutations.
    ///
    /// # Errors
    /// [`PassError::Shader`], [`PassError::Gpu`].
    pub fn compute(gpu: &Gpu, shaders: &Shaders, pass: &str, permutation: &str) -> Result<Self, PassError> {
        Self::compute_from(gpu, &shaders.compose(pass, permutation)?)
    }

    /// All compute entry points of a pass with definitions of the caller's.
    ///
    /// # Errors
    /// As [`Pass::compute`].
    pub fn compute_with(
        gpu: &Gpu,
        shaders: &Shaders,
        pass: &str,
        definitions: &Definitions,
    ) -> Result<Self, PassError> {
        Self::compute_from(gpu, &shaders.compose_with(pass, definitions)?)
    }

    /// All compute entry points of a composed pass.
    ///
    /// # Errors
    /// [`PassError::Gpu`].
    pub fn compute_from(gpu: &Gpu, composed: &Composed) -> Result<Self, PassError> {
        let reflection = composed.reflect();
        let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let entries: Vec<_> =
            reflection.entry_points.iter().filter(|entry| entry.stage == Stage::Compute).collect();
        let used: Vec<&str> = entries.iter().map(|entry| entry.name.as_str()).collect();
        let (bindings, layout, pipeline_layout) =
            layouts(gpu, &reflection, &used, wgpu::ShaderStages::COMPUTE);
        let module = shader_module(gpu, composed);
        let pipelines = entries
            .iter()
            .map(|entry| ComputeEntry {
                name: entry.name.clone(),
                workgroup: entry.workgroup_size,
                pipeline: gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                    label: Some(&composed.pass),
                    layout: Some(&pipeline_layout),
                    module: &module,
                    entry_point: Some(&entry.name),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    cache: None,
                }),
            })
            .collect();
        caught(scope)?;
        Ok(Self { name: composed.pass.clone(), bindings, layout, pipelines: Pipelines::Compute(pipelines) })
    }

    /// A render pipeline of two entry points of a composed pass. Triangles, both faces.
    ///
    /// # Errors
    /// [`PassError::UnknownEntryPoint`], [`PassError::Gpu`].
    pub fn render(gpu: &Gpu, composed: &Composed, stages: &RenderStages<'_>) -> Result<Self, PassError> {
        let targets = [stages.target.map(wgpu::ColorTargetState::from)];
        Self::render_to(gpu, composed, stages, if stages.target.is_some() { &targets } else { &[] })
    }

    /// Like [`Pass::render`] into `count` targets of the format of `stages`, added to what is there.
    ///
    /// # Errors
    /// As [`Pass::render`].
    pub fn additive(
        gpu: &Gpu,
        composed: &Composed,
        stages: &RenderStages<'_>,
        count: usize,
    ) -> Result<Self, PassError> {
        let component = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::One,
            dst_factor: wgpu::BlendFactor::One,
            operation: wgpu::BlendOperation::Add,
        };
        let blend = wgpu::BlendState { color: component, alpha: component };
        Self::blended(gpu, composed, stages, blend, count)
    }

    /// Like [`Pass::render`] into `count` targets of the format of `stages`, blended with what is there.
    ///
    /// # Errors
    /// As [`Pass::render`].
    pub fn blended(
        gpu: &Gpu,
        composed: &Composed,
        stages: &RenderStages<'_>,
        blend: wgpu::BlendState,
        count: usize,
    ) -> Result<Self, PassError> {
        let target = stages.target.map(|format| wgpu::ColorTargetState {
            format,
            blend: Some(blend),
            write_mask: wgpu::ColorWrites::ALL,
        });
        Self::render_to(gpu, composed, stages, &vec![target; count])
    }

    fn render_to(
        gpu: &Gpu,
        composed: &Composed,
        stages: &RenderStages<'_>,
        targets: &[Option<wgpu::ColorTargetState>],
    ) -> Result<Self, PassError> {
        let reflection = composed.reflect();
        let mut used = vec![stages.vertex];
        used.extend(stages.fragment);
        for name in &used {
            if !reflection.entry_points.iter().any(|entry| entry.name == **name) {
                let names: Vec<_> = reflection.entry_points.iter().map(|entry| entry.name.as_str()).collect();
                return Err(PassError::UnknownEntryPoint {
                    pass: composed.pass.clone(),
                    name: (*name).to_owned(),
                    expected: names.join(", "),
                });
            }
        }
        let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let (bindings, layout, pipeline_layout) =
            layouts(gpu, &reflection, &used, wgpu::ShaderStages::VERTEX_FRAGMENT);
        let module = shader_module(gpu, composed);
        let pipeline = gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(&composed.pass),
            layout: Some(&pipeline_layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some(stages.vertex),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: if stages.vertices.is_some() { std::slice::from_ref(&stages.vertices) } else { &[] },
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: stages.depth.map(|(compare, write)| wgpu::DepthStencilState {
                format: wgpu::TextureFormat::Depth32Float,
                depth_write_enabled: Some(write),
                depth_compare: Some(compare),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            }),
            multisample: wgpu::MultisampleState { count: stages.samples, ..Default::default() },
            fragment: stages.fragment.map(|fragment| wgpu::FragmentState {
                module: &module,
                entry_point: Some(fragment),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets,
            }),
            multiview_mask: None,
            cache: None,
        });
        caught(scope)?;
        Ok(Self { name: composed.pass.clone(), bindings, layout, pipelines: Pipelines::Render(pipeline) })
    }

    /// A pass that fills a picture of `format` by its entry points `vertex_picture` and `fragment`.
    ///
    /// # Errors
    /// As [`Pass::render`], and as [`Pass::compute`] for the composition.
    pub fn picture(
        gpu: &Gpu,
        shaders: &Shaders,
        pass: &str,
        definitions: &Definitions,
        fragment: &str,
        format: wgpu::TextureFormat,
    ) -> Result<Self, PassError> {
        let stages = RenderStages {
            vertex: "vertex_picture",
            fragment: Some(fragment),
            vertices: None,
            target: Some(format),
            depth: None,
            samples: 1,
        };
        Self::render(gpu, &shaders.compose_with(pass, definitions)?, &stages)
    }

    /// Like [`Pass::picture`] for several pictures at once, one format a location.
    ///
    /// # Errors
    /// As [`Pass::picture`].
    pub fn pictures(
        gpu: &Gpu,
        shaders: &Shaders,
        pass: &str,
        definitions: &Definitions,
        fragment: &str,
        formats: &[wgpu::TextureFormat],
    ) -> Result<Self, PassError> {
        let stages = RenderStages {
            vertex: "vertex_picture",
            fragment: Some(fragment),
            vertices: None,
            target: None,
            depth: None,
            samples: 1,
        };
        let targets: Vec<_> =
            formats.iter().map(|format| Some(wgpu::ColorTargetState::from(*format))).collect();
        Self::render_to(gpu, &shaders.compose_with(pass, definitions)?, &stages, &targets)
    }

    /// Records the only compute entry point over at least `size` invocations.
    pub fn dispatch(&self, encoder: &mut wgpu::CommandEncoder, bound: &Bound, size: [u32; 3]) {
        if let Pipelines::Compute(entries) = &self.pipelines
            && let Some(entry) = entries.first()
        {
            let groups = std::array::from_fn(|axis| size[axis].div_ceil(entry.workgroup[axis].max(1)));
            record(encoder, &entry.pipeline, bound, groups);
        }
    }

    /// Records the named compute entry point over `groups` workgroups.
    ///
    /// # Errors
    /// [`PassError::UnknownEntryPoint`].
    pub fn dispatch_groups(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        bound: &Bound,
        entry_point: &str,
        groups: [u32; 3],
    ) -> Result<(), PassError> {
        record(encoder, &self.entry(entry_point)?.pipeline, bound, groups);
        Ok(())
    }

    /// Like [`Pass::dispatch_groups`] over as many groups as three words in `groups` say, from byte `offset` on, a multiple of 4.
    ///
    /// # Errors
    /// [`PassError::UnknownEntryPoint`].
    pub fn dispatch_indirect(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        bound: &Bound,
        entry_point: &str,
        (groups, offset): (&Buffer, u64),
    ) -> Result<(), PassError> {
        let entry = self.entry(entry_point)?;
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&entry.pipeline);
        pass.set_bind_group(0, &bound.group, &[]);
        pass.dispatch_workgroups_indirect(&groups.raw, offset);
        Ok(())
    }

    fn entry(&self, name: &str) -> Result<&ComputeEntry, PassError> {
        let entries: &[ComputeEntry] =
            if let Pipelines::Compute(entries) = &self.pipelines { entries } else { &[] };
        entries.iter().find(|entry| entry.name == name).ok_or_else(|| {
            let names: Vec<_> = entries.iter().map(|entry| entry.name.as_str()).collect();
            let (pass, name) = (self.name.clone(), name.to_owned());
            PassError::UnknownEntryPoint { pass, name, expected: names.join(", ") }
        })
    }

    /// Records a pass built by [`Pass::picture`] over all pixels of `target`.
    pub fn fill(&self, encoder: &mut wgpu::CommandEncoder, bound: &Bound, target: &Texture) {
        self.fill_all(encoder, bound, &[target]);
    }

    /// Records a pass built by [`Pass::pictures`] over all pixels of its targets, which have one size.
    pub fn fill_all(&self, encoder: &mut wgpu::CommandEncoder, bound: &Bound, targets: &[&Texture]) {
        let ops =
            wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store };
        let attachments: Vec<_> = targets
            .iter()
            .map(|target| {
                Some(wgpu::RenderPassColorAttachment {
                    view: &target.view,
                    depth_slice: None,
                    resolve_target: None,
                    ops,
                })
            })
            .collect();
        let mut render = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(&self.name),
            color_attachments: &attachments,
            ..Default::default()
        });
        self.set(&mut render, bound);
        render.draw(0..3, 0..1);
    }

    /// Sets the render pipeline and its resources; the caller draws.
    pub fn set(&self, render: &mut wgpu::RenderPass<'_>, bound: &Bound) {
        if let Pipelines::Render(pipeline) = &self.pipelines {
            render.set_pipeline(pipeline);
            render.set_bind_group(0, &bound.group, &[]);
        }
    }
}

fn record(
    encoder: &mut wgpu::CommandEncoder,
    pipeline: &wgpu::ComputePipeline,
    bound: &Bound,
    groups: [u32; 3],
) {
    let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
    pass.set_pipeline(pipeline);
    pass.set_bind_group(0, &bound.group, &[]);
    pass.dispatch_workgroups(groups[0], groups[1], groups[2]);
}

fn shader_module(gpu: &Gpu, composed: &Composed) -> wgpu::ShaderModule {
    gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(&composed.pass),
        source: wgpu::ShaderSource::Naga(Cow::Owned(composed.module.clone())),
    })
}

/// The error that a scope caught. On native back ends it is known at once; a browser reports it as uncaptured later.
fn caught(scope: wgpu::ErrorScopeGuard) -> Result<(), GpuError> {
    use std::future::Future;
    let mut future = std::pin::pin!(scope.pop());
    let mut context = std::task::Context::from_waker(std::task::Waker::noop());
    match future.as_mut().poll(&mut context) {
        std::task::Poll::Ready(Some(error)) => Err(GpuError::Refused(error.to_string())),
        std::task::Poll::Ready(None) | std::task::Poll::Pending => Ok(()),
    }
}
