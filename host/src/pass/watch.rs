// SPDX-License-Identifier: MIT OR Apache-2.0
//! Passes shown, with all that they are given, to whoever wants to see them on their way to the device.

use super::render::{ColorTarget, DepthTarget, Draw};
use crate::gpu::Gpu;
use crate::resource::{Buffer, Sampler, Texture};
use airlight_validate::{Binding, Composed};
use std::sync::Arc;

/// Sees every pass of a device, see [`Gpu::watched_by`].
pub trait Watcher: Send + Sync {
    /// A pass is built from `composed`. The number that is returned names the shader in [`Call::shader`].
    fn built(&self, composed: &Composed) -> usize;

    /// Calls `record` once, which puts the commands of `run` into `encoder`; may put other commands before and after them.
    fn run(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        run: &Run<'_>,
        record: &mut dyn FnMut(&mut wgpu::CommandEncoder),
    );

    /// Commands were submitted.
    fn submitted(&self, gpu: &Gpu);

    /// The contents of a resource were read: of a texture the rows of its first level, one after the other.
    fn read(&self, resource: Held, contents: &[u8]);
}

/// A resource kept with what is bound.
#[derive(Clone)]
pub enum Held {
    /// A uniform or storage buffer.
    Buffer(Buffer),
    /// A sampled or storage texture.
    Texture(Texture),
    /// A sampler.
    Sampler(Sampler),
}

/// A shader with its resources.
#[derive(Clone)]
pub struct Call {
    /// What [`Watcher::built`] returned.
    pub shader: usize,
    /// Name of the pass.
    pub pass: String,
    /// All that is bound, in the order of the bindings.
    pub resources: Arc<[(Binding, Held)]>,
}

/// The size of a dispatch.
#[derive(Clone, Copy)]
pub enum Groups<'a> {
    /// Workgroups in x, y, z.
    Direct([u32; 3]),
    /// Three words of a buffer, from a byte on.
    Indirect(&'a Buffer, u64),
}

/// What is recorded.
pub enum Run<'a> {
    /// A dispatch.
    Compute {
        /// Shader and resources.
        call: &'a Call,
        /// Its entry point.
        entry_point: &'a str,
        /// Its size.
        groups: Groups<'a>,
    },
    /// A render pass of one or more draws.
    Render {
        /// Colour targets by location.
        colors: &'a [ColorTarget],
        /// Depth target.
        depth: Option<&'a DepthTarget>,
        /// What is drawn, in order.
        draws: &'a [Draw],
    },
}

/// How a pass was built on a device that is watched.
pub(super) struct Watched {
    pub(super) watcher: Arc<dyn Watcher>,
    pub(super) shader: usize,
    /// Of a render pipeline.
    pub(super) shape: Option<Shape>,
}

/// How a render pipeline was made.
#[derive(Clone)]
pub struct Shape {
    /// Vertex entry point.
    pub vertex: String,
    /// Fragment entry point.
    pub fragment: Option<String>,
    /// Bytes of a vertex and what they hold.
    pub vertices: Option<(u64, Vec<wgpu::VertexAttribute>)>,
    /// Colour targets by location.
    pub targets: Vec<Option<wgpu::ColorTargetState>>,
    /// Depth test and write.
    pub depth: Option<(wgpu::CompareFunction, bool)>,
    /// Samples a pixel.
    pub samples: u32,
}
