// SPDX-License-Identifier: MIT OR Apache-2.0
//! Polygons in the same picture: the pass `splatting/surfaces`.

use super::SplattingError;
use crate::core::{MESH_VERTEX, MeshBuffers, begin};
use crate::data::Mesh;
use crate::gpu::Gpu;
use crate::pass::{Bound, Pass, PassError, RenderStages};
use crate::resource::{Buffer, Texture};
use crate::shaders::Shaders;
use glam::Vec3;
use wgpu::TextureFormat::{self, Depth32Float, R32Float, Rgba16Float};

/// Height where a ray meets no surface, metres: `NO_SURFACE` of `splatting/surface_shadow`.
const NO_SURFACE: f64 = 1e30;

/// Opaque polygons, on the GPU.
pub struct Surfaces {
    meshes: Vec<MeshBuffers>,
    /// Points in the world, metres, whose convex hull holds all polygons.
    pub(super) corners: Vec<Vec3>,
}

impl Surfaces {
    /// Uploads meshes, in the world.
    ///
    /// # Errors
    /// [`SplattingError::NoPolygons`] where none of them has a triangle.
    pub fn new(gpu: &Gpu, meshes: &[Mesh]) -> Result<Self, SplattingError> {
        let filled = || meshes.iter().filter(|mesh| mesh.triangle_count() > 0);
        let bounds = filled().filter_map(Mesh::bounds);
        let bounds = bounds.reduce(|all, bounds| all.union(&bounds)).ok_or(SplattingError::NoPolygons)?;
        Ok(Self {
            meshes: filled().map(|mesh| MeshBuffers::new(gpu, mesh)).collect(),
            corners: bounds.corners().to_vec(),
        })
    }

    /// Corners of the box that holds all polygons, metres.
    pub fn corners(&self) -> &[Vec3] {
        &self.corners
    }
}

/// One picture of the polygons.
struct Drawn {
    /// For forward and for reversed depth.
    passes: [Pass; 2],
    bound: Bound,
    target: Texture,
    clear: f64,
}

impl Drawn {
    fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        meshes: &[MeshBuffers],
        depth: &Texture,
        reversed: bool,
    ) {
        let clear = wgpu::Color { r: self.clear, ..wgpu::Color::TRANSPARENT };
        let far = if reversed { 0.0 } else { 1.0 };
        let color = (&self.target, None, clear);
        let mut render = begin(encoder, Some(color), depth, far);
        render.set(&self.passes[usize::from(reversed)], &self.bound);
        meshes.iter().for_each(|mesh| mesh.draw(&mut render, 0));
    }
}

/// What the other passes know of polygons.
pub(super) struct SurfacePictures<'a> {
    surfaces: &'a Surfaces,
    eye_depth: Texture,
    light_depth: Texture,
    heights: Drawn,
    albedo: Drawn,
    normal: Drawn,
    light_heights: Drawn,
    light_exit_heights: Option<Drawn>,
}

impl<'a> SurfacePictures<'a> {
    /// `exits`: whether it is wanted as well where light rays leave solids.
    pub(super) fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        surfaces: &'a Surfaces,
        [camera, light_camera, sheets]: [&Buffer; 3],
        [size, light_size]: [[u32; 2]; 2],
        exits: bool,
    ) -> Result<Self, SplattingError> {
        let composed = shaders.compose("splatting/surfaces", "default").map_err(PassError::from)?;
        let drawn = |fragment: &str, camera: &Buffer, size, format: TextureFormat| {
            let pass = |nearer| {
                let stages = RenderStages {
                    vertex: "vertex_surface",
                    fragment: Some(fragment),
                    vertices: Some(MESH_VERTEX),
                    target: Some(format),
                    depth: Some((nearer, true)),
                    samples: 1,
                };
                Pass::render(gpu, &composed, &stages)
            };
            let passes = [pass(wgpu::CompareFunction::Less)?, pass(wgpu::CompareFunction::Greater)?];
            let bound = passes[0].bind_known(gpu, &[("camera", camera.into()), ("sheets", sheets.into())])?;
            let clear = if format == R32Float { NO_SURFACE } else { 0.0 };
            Ok::<_, SplattingError>(Drawn {
                passes,
                bound,
                target: Texture::target(gpu, size, format),
                clear,
            })
        };
        let exits = exits.then(|| drawn("fragment_exit_height", light_camera, light_size, R32Float));
        Ok(Self {
            surfaces,
            eye_depth: Texture::target(gpu, size, Depth32Float),
            light_depth: Texture::target(gpu, light_size, Depth32Float),
            heights: drawn("fragment_height", camera, size, R32Float)?,
            albedo: drawn("fragment_albedo", camera, size, Rgba16Float)?,
            normal: drawn("fragment_normal", camera, size, Rgba16Float)?,
            light_heights: drawn("fragment_height", light_camera, light_size, R32Float)?,
            light_exit_heights: exits.transpose()?,
        })
    }

    /// Records all pictures. `reversed`: the depths of the eye's camera and of the light's.
    pub(super) fn record(&self, encoder: &mut wgpu::CommandEncoder, reversed: [bool; 2]) {
        let meshes = &self.surfaces.meshes;
        for drawn in [&self.heights, &self.albedo, &self.normal] {
            drawn.record(encoder, meshes, &self.eye_depth, reversed[0]);
        }
        self.light_heights.record(encoder, meshes, &self.light_depth, reversed[1]);
        if let Some(exits) = &self.light_exit_heights {
            exits.record(encoder, meshes, &self.light_depth, reversed[1]);
        }
    }

    pub(super) fn corners(&self) -> &[Vec3] {
        &self.surfaces.corners
    }

    pub(super) fn eye_heights(&self) -> &Texture {
        &self.heights.target
    }

    pub(super) fn light_heights(&self) -> &Texture {
        &self.light_heights.target
    }

    /// Of where each light ray leaves the first solid.
    pub(super) fn light_exit_heights(&self) -> Option<&Texture> {
        self.light_exit_heights.as_ref().map(|exits| &exits.target)
    }

    pub(super) fn albedo(&self) -> &Texture {
        &self.albedo.target
    }

    pub(super) fn normal(&self) -> &Texture {
        &self.normal.target
    }
}
