// SPDX-License-Identifier: MIT OR Apache-2.0
//! Passes made from composed shaders: compute and render pipelines with their layouts.

use super::bind::layouts;
use super::watch::{Shape, Watched};
use super::{ComputeEntry, Pass, PassError, Pipelines, caught};
use crate::gpu::Gpu;
use crate::shaders::Shaders;
use airlight_validate::{Composed, Definitions, Stage};
use std::borrow::Cow;
use std::sync::Arc;

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
        let (name, watched) = (composed.pass.clone(), watched(gpu, composed, None));
        Ok(Self { name, bindings, layout, pipelines: Pipelines::Compute(pipelines), watched })
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

    /// Like [`Pass::render`] into targets of any formats and blending, one a location; the format in `stages` is not read.
    ///
    /// # Errors
    /// As [`Pass::render`].
    pub fn render_to(
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
        let shape = || Shape {
            vertex: stages.vertex.to_owned(),
            fragment: stages.fragment.map(str::to_owned),
            vertices: stages
                .vertices
                .as_ref()
                .map(|layout| (layout.array_stride, layout.attributes.to_vec())),
            targets: targets.to_vec(),
            depth: stages.depth,
            samples: stages.samples,
        };
        let (name, watched) = (composed.pass.clone(), watched(gpu, composed, Some(&shape)));
        Ok(Self { name, bindings, layout, pipelines: Pipelines::Render(pipeline), watched })
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
}

/// Shows the shader of a pass to the watcher of its device, if there is one.
fn watched(gpu: &Gpu, composed: &Composed, shape: Option<&dyn Fn() -> Shape>) -> Option<Arc<Watched>> {
    let watcher = gpu.watcher()?.clone();
    Some(Arc::new(Watched { shader: watcher.built(composed), watcher, shape: shape.map(|shape| shape()) }))
}

fn shader_module(gpu: &Gpu, composed: &Composed) -> wgpu::ShaderModule {
    gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(&composed.pass),
        source: wgpu::ShaderSource::Naga(Cow::Owned(composed.module.clone())),
    })
}
