// SPDX-License-Identifier: MIT OR Apache-2.0
//! Render passes of the library's passes.

use super::watch::{Call, Run, Shape, Watcher};
use super::{Bound, Pass, Pipelines};
use crate::resource::{Buffer, Texture};
use std::ops::Range;
use std::sync::Arc;

/// A colour target of a render pass.
#[derive(Clone)]
pub struct ColorTarget {
    /// What is drawn into.
    pub texture: Texture,
    /// Whether it is cleared before, and to what.
    pub load: wgpu::LoadOp<wgpu::Color>,
    /// What several samples a pixel are resolved into; they are not kept then.
    pub resolve: Option<Texture>,
}

impl ColorTarget {
    /// A target of one sample a pixel that is cleared.
    pub fn cleared(texture: &Texture, color: wgpu::Color) -> Self {
        Self { texture: texture.clone(), load: wgpu::LoadOp::Clear(color), resolve: None }
    }
}

/// The depth target of a render pass.
#[derive(Clone)]
pub struct DepthTarget {
    /// What is drawn into.
    pub texture: Texture,
    /// The depth that it is cleared to.
    pub far_depth: f32,
}

/// A draw with all that was set before it.
#[derive(Clone)]
pub struct Draw {
    pipeline: wgpu::RenderPipeline,
    group: wgpu::BindGroup,
    /// Vertices, if any.
    pub vertices: Option<Buffer>,
    /// Indices of 32 bits, if any.
    pub indices: Option<Buffer>,
    /// Left, top, width, height in pixels; depth from 0 to 1. None for the whole target.
    pub viewport: Option<[f32; 4]>,
    /// Left, top, width, height in pixels. None for the whole target.
    pub scissor: Option<[u32; 4]>,
    /// How much.
    pub extent: DrawExtent,
    watched: Option<(Arc<super::watch::Watched>, Call)>,
}

/// How much is drawn.
#[derive(Clone)]
pub enum DrawExtent {
    /// Vertices, instances.
    Vertices(Range<u32>, Range<u32>),
    /// Indices, instances.
    Indices(Range<u32>, Range<u32>),
    /// Four words of a buffer, from a byte on.
    Indirect(Buffer, u64),
}

impl Draw {
    /// Shader, resources and pipeline. None where the pass was built before its device was watched.
    pub fn watched(&self) -> Option<(&Call, &Shape)> {
        let (watched, call) = self.watched.as_ref()?;
        Some((call, watched.shape.as_ref()?))
    }
}

/// A render pass, which is recorded when it is dropped.
pub(crate) struct Render<'e> {
    encoder: &'e mut wgpu::CommandEncoder,
    recorded: Recorded,
    next: Next,
}

/// Attachments and draws.
struct Recorded {
    label: Option<String>,
    colors: Vec<ColorTarget>,
    depth: Option<DepthTarget>,
    draws: Vec<Draw>,
}

/// What is set for the next draw.
#[derive(Clone, Default)]
struct Next {
    pass: Option<(wgpu::RenderPipeline, wgpu::BindGroup)>,
    vertices: Option<Buffer>,
    indices: Option<Buffer>,
    viewport: Option<[f32; 4]>,
    scissor: Option<[u32; 4]>,
    watched: Option<(Arc<super::watch::Watched>, Call)>,
}

impl<'e> Render<'e> {
    /// A render pass into some targets.
    pub(crate) fn new(
        encoder: &'e mut wgpu::CommandEncoder,
        colors: Vec<ColorTarget>,
        depth: Option<DepthTarget>,
    ) -> Self {
        let recorded = Recorded { label: None, colors, depth, draws: Vec::new() };
        Self { encoder, recorded, next: Next::default() }
    }

    /// A render pass into `target`, which is cleared or kept.
    pub(crate) fn onto(
        encoder: &'e mut wgpu::CommandEncoder,
        target: &Texture,
        load: wgpu::LoadOp<wgpu::Color>,
    ) -> Self {
        Self::new(encoder, vec![ColorTarget { texture: target.clone(), load, resolve: None }], None)
    }

    /// Sets a pass that was built for rendering, and its resources.
    pub(crate) fn set(&mut self, pass: &Pass, bound: &Bound) {
        if let Pipelines::Render(pipeline) = &pass.pipelines {
            self.recorded.label.get_or_insert_with(|| pass.name.clone());
            self.next.pass = Some((pipeline.clone(), bound.group.clone()));
            self.next.watched = pass.watched.clone().zip(pass.call(bound));
        }
    }

    /// Sets vertices and their indices of 32 bits.
    pub(crate) fn set_mesh(&mut self, vertices: &Buffer, indices: &Buffer) {
        self.next.vertices = Some(vertices.clone());
        self.next.indices = Some(indices.clone());
    }

    /// Sets the part of the target that clip space is mapped to: left, top, width, height.
    pub(crate) fn set_viewport(&mut self, viewport: [f32; 4]) {
        self.next.viewport = Some(viewport);
    }

    /// Sets the part of the target that may change: left, top, width, height.
    pub(crate) fn set_scissor(&mut self, scissor: [u32; 4]) {
        self.next.scissor = Some(scissor);
    }

    /// Draws vertices.
    pub(crate) fn draw(&mut self, vertices: Range<u32>, instances: Range<u32>) {
        self.push(DrawExtent::Vertices(vertices, instances));
    }

    /// Draws indices of the mesh.
    pub(crate) fn draw_indexed(&mut self, indices: Range<u32>, instances: Range<u32>) {
        self.push(DrawExtent::Indices(indices, instances));
    }

    /// Draws what four words of a buffer say, from byte `offset` on.
    pub(crate) fn draw_indirect(&mut self, buffer: &Buffer, offset: u64) {
        self.push(DrawExtent::Indirect(buffer.clone(), offset));
    }

    fn push(&mut self, extent: DrawExtent) {
        let Next { pass, vertices, indices, viewport, scissor, watched } = self.next.clone();
        if let Some((pipeline, group)) = pass {
            let draw = Draw { pipeline, group, vertices, indices, viewport, scissor, extent, watched };
            self.recorded.draws.push(draw);
        }
    }
}

impl Drop for Render<'_> {
    fn drop(&mut self) {
        let Recorded { colors, depth, draws, .. } = &self.recorded;
        let watcher: Option<Arc<dyn Watcher>> =
            draws.iter().find_map(|draw| draw.watched.as_ref()).map(|(watched, _)| watched.watcher.clone());
        match watcher {
            None => self.recorded.record(self.encoder),
            Some(watcher) => {
                let run = Run::Render { colors, depth: depth.as_ref(), draws };
                watcher.run(self.encoder, &run, &mut |encoder| self.recorded.record(encoder));
            }
        }
    }
}

impl Recorded {
    fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        let store = |resolved| if resolved { wgpu::StoreOp::Discard } else { wgpu::StoreOp::Store };
        let colors: Vec<_> = self
            .colors
            .iter()
            .map(|target| {
                Some(wgpu::RenderPassColorAttachment {
                    view: &target.texture.view,
                    depth_slice: None,
                    resolve_target: target.resolve.as_ref().map(|texture| &texture.view),
                    // Samples are of no use once they are resolved.
                    ops: wgpu::Operations { load: target.load, store: store(target.resolve.is_some()) },
                })
            })
            .collect();
        let depth = self.depth.as_ref().map(|target| wgpu::RenderPassDepthStencilAttachment {
            view: &target.texture.view,
            depth_ops: Some(wgpu::Operations {
                load: wgpu::LoadOp::Clear(target.far_depth),
                store: wgpu::StoreOp::Store,
            }),
            stencil_ops: None,
        });
        let mut render = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: self.label.as_deref(),
            color_attachments: &colors,
            depth_stencil_attachment: depth,
            ..Default::default()
        });
        for draw in &self.draws {
            draw.record(&mut render);
        }
    }
}

impl Draw {
    fn record(&self, render: &mut wgpu::RenderPass<'_>) {
        render.set_pipeline(&self.pipeline);
        render.set_bind_group(0, &self.group, &[]);
        if let Some([left, top, width, height]) = self.viewport {
            render.set_viewport(left, top, width, height, 0.0, 1.0);
        }
        if let Some([left, top, width, height]) = self.scissor {
            render.set_scissor_rect(left, top, width, height);
        }
        if let Some(vertices) = &self.vertices {
            render.set_vertex_buffer(0, vertices.raw.slice(..));
        }
        if let Some(indices) = &self.indices {
            render.set_index_buffer(indices.raw.slice(..), wgpu::IndexFormat::Uint32);
        }
        match &self.extent {
            DrawExtent::Vertices(vertices, instances) => render.draw(vertices.clone(), instances.clone()),
            DrawExtent::Indices(indices, instances) => {
                render.draw_indexed(indices.clone(), 0, instances.clone());
            }
            DrawExtent::Indirect(buffer, offset) => render.draw_indirect(&buffer.raw, *offset),
        }
    }
}
