// SPDX-License-Identifier: MIT OR Apache-2.0
//! The pass `core/geometry`: what a deferred renderer stores of surfaces.

use super::raster::{MESH_VERTEX, begin};
use super::{Camera, MeshBuffers};
use crate::gpu::Gpu;
use crate::pass::{Pass, PassError, RenderStages};
use crate::resource::{Buffer, Texture};
use crate::shaders::Shaders;
use wgpu::TextureFormat::{Depth32Float, Rgba16Float};

/// What is seen of meshes, a texel a pixel.
pub struct Geometry {
    /// Depth as the camera has it, depth32float; the far plane's where nothing is.
    pub depth: Texture,
    /// Unit normals in the world, rgba16float; 0 where nothing is.
    pub normals: Texture,
    /// Linear RGB albedo, rgba16float; 0 where nothing is.
    pub albedos: Texture,
}

/// Draws the geometry of meshes.
pub struct GeometryPass {
    /// Forward and reversed depth, each of normals and of albedos.
    passes: [[Pass; 2]; 2],
}

impl GeometryPass {
    /// Composes the pass and builds its pipelines.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn new(gpu: &Gpu, shaders: &Shaders) -> Result<Self, PassError> {
        let composed = shaders.compose("core/geometry", "default")?;
        let pass = |nearer, fragment| {
            let stages = RenderStages {
                vertex: "vertex_geometry",
                fragment: Some(fragment),
                vertices: Some(MESH_VERTEX),
                target: Some(Rgba16Float),
                depth: Some((nearer, true)),
                samples: 1,
            };
            Pass::render(gpu, &composed, &stages)
        };
        let both =
            |nearer| Ok::<_, PassError>([pass(nearer, "fragment_normal")?, pass(nearer, "fragment_albedo")?]);
        let passes = [both(wgpu::CompareFunction::Less)?, both(wgpu::CompareFunction::Greater)?];
        Ok(Self { passes })
    }

    /// Draws meshes from a camera, any projection and depth convention.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn draw(&self, gpu: &Gpu, camera: &Camera, meshes: &[MeshBuffers]) -> Result<Geometry, PassError> {
        let size = [camera.viewport.x as u32, camera.viewport.y as u32];
        let target = |format| Texture::target(gpu, size, format);
        let geometry = Geometry {
            depth: target(Depth32Float),
            normals: target(Rgba16Float),
            albedos: target(Rgba16Float),
        };
        let uniform = Buffer::uniform(gpu, camera);
        let mut encoder = gpu.encoder();
        let passes = &self.passes[usize::from(camera.is_reversed())];
        for (pass, image) in passes.iter().zip([&geometry.normals, &geometry.albedos]) {
            let bound = pass.bind(gpu, &[("camera", (&uniform).into())])?;
            let color = (image, None, wgpu::Color::TRANSPARENT);
            let mut render = begin(&mut encoder, Some(color), &geometry.depth, camera.far_depth);
            render.set(pass, &bound);
            meshes.iter().for_each(|mesh| mesh.draw(&mut render, 0));
        }
        gpu.submit(encoder)?;
        Ok(geometry)
    }
}
