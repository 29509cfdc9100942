// SPDX-License-Identifier: MIT OR Apache-2.0
//! The pass `core/raster`: shadow maps, lit pictures and skies.

use super::{Camera, Light};
use crate::data::Mesh;
use crate::gpu::Gpu;
use crate::pass::{Pass, PassError, RenderStages};
use crate::resource::{Buffer, Sampler, Texture};
use crate::shaders::Shaders;
use encase::ShaderType;
use glam::Vec3;
use wgpu::TextureFormat::{Depth32Float, Rgba16Float};

/// The uniform `Sky` of the pass: linear RGB radiance of the surroundings.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct Sky {
    /// Straight up.
    pub zenith: Vec3,
    /// Padding.
    pub reserved_a: f32,
    /// At the horizon.
    pub horizon: Vec3,
    /// Padding.
    pub reserved_b: f32,
    /// From below.
    pub ground: Vec3,
    /// Padding.
    pub reserved_c: f32,
}

impl Sky {
    /// A sky from its three radiances.
    pub fn new(zenith: Vec3, horizon: Vec3, ground: Vec3) -> Self {
        Self { zenith, reserved_a: 0.0, horizon, reserved_b: 0.0, ground, reserved_c: 0.0 }
    }
}

/// A mesh on the GPU.
pub struct MeshBuffers {
    vertices: Buffer,
    indices: Buffer,
    count: u32,
}

impl MeshBuffers {
    /// Uploads a mesh: position, normal, albedo interleaved.
    pub fn new(gpu: &Gpu, mesh: &Mesh) -> Self {
        let mut bytes = Vec::with_capacity(mesh.positions.len() * 36);
        for ((position, normal), albedo) in mesh.positions.iter().zip(&mesh.normals).zip(&mesh.albedos) {
            for vector in [position, normal, albedo] {
                bytes.extend(vector.to_array().iter().flat_map(|value| value.to_le_bytes()));
            }
        }
        let indices: Vec<u8> = mesh.indices.iter().flat_map(|index| index.to_le_bytes()).collect();
        Self {
            vertices: Buffer::with_bytes(gpu, &bytes, wgpu::BufferUsages::VERTEX),
            indices: Buffer::with_bytes(gpu, &indices, wgpu::BufferUsages::INDEX),
            count: mesh.indices.len() as u32,
        }
    }

    pub(crate) fn draw(&self, render: &mut wgpu::RenderPass<'_>) {
        render.set_vertex_buffer(0, self.vertices.raw.slice(..));
        render.set_index_buffer(self.indices.raw.slice(..), wgpu::IndexFormat::Uint32);
        render.draw_indexed(0..self.count, 0, 0..1);
    }
}

/// Rasterises meshes from the light and from the camera.
pub struct Raster {
    shadow: Pass,
    surface: Pass,
    background: Pass,
    sampler: Sampler,
}

/// Layout of the vertices of [`MeshBuffers`].
pub(crate) const MESH_VERTEX: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: 36,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32x3],
};

impl Raster {
    /// Builds the pipelines, for cameras with forward depth.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn new(gpu: &Gpu, shaders: &Shaders) -> Result<Self, PassError> {
        let composed = shaders.compose("core/raster", "default")?;
        let less = Some((wgpu::CompareFunction::Less, true));
        let build = |vertex, fragment, vertices, target, depth| {
            Pass::render(gpu, &composed, &RenderStages { vertex, fragment, vertices, target, depth })
        };
        Ok(Self {
            shadow: build("vertex_shadow", None, Some(MESH_VERTEX), None, less)?,
            surface: build(
                "vertex_surface",
                Some("fragment_surface"),
                Some(MESH_VERTEX),
                Some(Rgba16Float),
                less,
            )?,
            background: build(
                "vertex_background",
                Some("fragment_background"),
                None,
                Some(Rgba16Float),
                Some((wgpu::CompareFunction::Always, false)),
            )?,
            sampler: Sampler::shadow(gpu),
        })
    }

    /// Records the shadow map of `meshes` as seen from the light.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn record_shadow_map(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        light: &Buffer,
        meshes: &[MeshBuffers],
        shadow_map: &Texture,
    ) -> Result<(), PassError> {
        let bound = self.shadow.bind(gpu, &[("light", light.into())])?;
        let mut render = begin(encoder, None, shadow_map);
        self.shadow.set(&mut render, &bound);
        meshes.iter().for_each(|mesh| mesh.draw(&mut render));
        Ok(())
    }

    /// Records the lit picture of `meshes` before the sky, with its depth buffer.
    ///
    /// # Errors
    /// [`PassError`].
    #[allow(clippy::too_many_arguments)]
    pub fn record_surface(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        [camera, light, sky]: [&Buffer; 3],
        meshes: &[MeshBuffers],
        shadow_map: &Texture,
        surface: &Texture,
        depth: &Texture,
    ) -> Result<(), PassError> {
        let resources = [
            ("camera", camera.into()),
            ("light", light.into()),
            ("sky", sky.into()),
            ("shadow_map", shadow_map.into()),
            ("shadow_sampler", (&self.sampler).into()),
        ];
        let background = self.background.bind_known(gpu, &resources)?;
        let lit = self.surface.bind_known(gpu, &resources)?;
        let mut render = begin(encoder, Some(surface), depth);
        self.background.set(&mut render, &background);
        render.draw(0..3, 0..1);
        self.surface.set(&mut render, &lit);
        meshes.iter().for_each(|mesh| mesh.draw(&mut render));
        Ok(())
    }

    /// A shadow map and a picture of `meshes`: shadow map (depth), surface radiance, depth buffer.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn render(
        &self,
        gpu: &Gpu,
        camera: &Camera,
        light: &Light,
        sky: &Sky,
        meshes: &[MeshBuffers],
        map: [u32; 2],
    ) -> Result<Pictures, PassError> {
        let viewport = [camera.viewport.x as u32, camera.viewport.y as u32];
        let pictures = Pictures {
            shadow_map: Texture::target(gpu, map, Depth32Float),
            surface: Texture::target(gpu, viewport, Rgba16Float),
            depth: Texture::target(gpu, viewport, Depth32Float),
        };
        let (camera, light, sky) =
            (Buffer::uniform(gpu, camera), Buffer::uniform(gpu, light), Buffer::uniform(gpu, sky));
        let mut encoder = gpu.encoder();
        self.record_shadow_map(gpu, &mut encoder, &light, meshes, &pictures.shadow_map)?;
        self.record_surface(
            gpu,
            &mut encoder,
            [&camera, &light, &sky],
            meshes,
            &pictures.shadow_map,
            &pictures.surface,
            &pictures.depth,
        )?;
        gpu.submit(encoder)?;
        Ok(pictures)
    }
}

/// What an engine has before it asks for light shafts.
pub struct Pictures {
    /// Depth from the light.
    pub shadow_map: Texture,
    /// Linear RGB radiance of surfaces and sky.
    pub surface: Texture,
    /// Depth from the camera.
    pub depth: Texture,
}

/// A render pass that clears its targets; depth to 1.
pub(crate) fn begin<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    color: Option<&Texture>,
    depth: &Texture,
) -> wgpu::RenderPass<'a> {
    let color = color.map(|texture| wgpu::RenderPassColorAttachment {
        view: &texture.view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store },
    });
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: None,
        color_attachments: if color.is_some() { std::slice::from_ref(&color) } else { &[] },
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &depth.view,
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Store }),
            stencil_ops: None,
        }),
        ..Default::default()
    })
}
