// SPDX-License-Identifier: MIT OR Apache-2.0
//! Render passes into one picture.

use crate::resource::Texture;

/// A render pass into `target`, which is cleared or kept.
pub(crate) fn begin_target<'e>(
    encoder: &'e mut wgpu::CommandEncoder,
    target: &Texture,
    load: wgpu::LoadOp<wgpu::Color>,
) -> wgpu::RenderPass<'e> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: None,
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &target.view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
        })],
        ..Default::default()
    })
}
