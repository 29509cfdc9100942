// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pipelines and layouts built from reflection; resources bound by name.

mod bind;
mod build;
mod error;
mod render;
pub mod watch;

pub use bind::{Bound, Resource};
pub use build::RenderStages;
pub use error::PassError;
pub(crate) use render::Render;
pub use render::{ColorTarget, DepthTarget, Draw, DrawExtent};

use crate::gpu::GpuError;
use crate::resource::{Buffer, Texture};
use airlight_validate::Binding;
use std::sync::Arc;
use watch::{Call, Groups, Run, Watched};

struct ComputeEntry {
    name: String,
    workgroup: [u32; 3],
    pipeline: wgpu::ComputePipeline,
}

enum Pipelines {
    Compute(Vec<ComputeEntry>),
    Render(wgpu::RenderPipeline),
}

/// A pass of the library with its pipelines and the layout of its resources.
pub struct Pass {
    name: String,
    bindings: Vec<Binding>,
    layout: wgpu::BindGroupLayout,
    pipelines: Pipelines,
    watched: Option<Arc<Watched>>,
}

impl Pass {
    /// Records the only compute entry point over at least `size` invocations.
    pub fn dispatch(&self, encoder: &mut wgpu::CommandEncoder, bound: &Bound, size: [u32; 3]) {
        if let Pipelines::Compute(entries) = &self.pipelines
            && let Some(entry) = entries.first()
        {
            let groups = std::array::from_fn(|axis| size[axis].div_ceil(entry.workgroup[axis].max(1)));
            self.record(encoder, entry, bound, Groups::Direct(groups));
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
        self.record(encoder, self.entry(entry_point)?, bound, Groups::Direct(groups));
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
        self.record(encoder, self.entry(entry_point)?, bound, Groups::Indirect(groups, offset));
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
        let colors = targets.iter().map(|target| ColorTarget::cleared(target, wgpu::Color::BLACK)).collect();
        let mut render = Render::new(encoder, colors, None);
        render.set(self, bound);
        render.draw(0..3, 0..1);
    }

    fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        entry: &ComputeEntry,
        bound: &Bound,
        groups: Groups<'_>,
    ) {
        let mut record = |encoder: &mut wgpu::CommandEncoder| {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&entry.pipeline);
            pass.set_bind_group(0, &bound.group, &[]);
            match groups {
                Groups::Direct([x, y, z]) => pass.dispatch_workgroups(x, y, z),
                Groups::Indirect(buffer, offset) => pass.dispatch_workgroups_indirect(&buffer.raw, offset),
            }
        };
        match self.watched.as_ref().zip(self.call(bound)) {
            None => record(encoder),
            Some((watched, call)) => {
                let run = Run::Compute { call: &call, entry_point: &entry.name, groups };
                watched.watcher.run(encoder, &run, &mut record);
            }
        }
    }

    /// What a watcher is shown of a use of this pass, if there is one.
    fn call(&self, bound: &Bound) -> Option<Call> {
        let (shader, pass) = (self.watched.as_ref()?.shader, self.name.clone());
        Some(Call { shader, pass, resources: bound.held.clone()? })
    }

    /// Sets the render pipeline and its resources; the caller draws.
    pub fn set(&self, render: &mut wgpu::RenderPass<'_>, bound: &Bound) {
        if let Pipelines::Render(pipeline) = &self.pipelines {
            render.set_pipeline(pipeline);
            render.set_bind_group(0, &bound.group, &[]);
        }
    }
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
