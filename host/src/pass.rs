// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pipelines and layouts built from reflection; resources bound by name.

mod bind;
mod build;
mod error;
mod target;

pub use bind::{Bound, Resource};
pub use build::RenderStages;
pub use error::PassError;
pub(crate) use target::begin_target;

use crate::gpu::GpuError;
use crate::resource::{Buffer, Texture};
use airlight_validate::Binding;

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
}

impl Pass {
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
