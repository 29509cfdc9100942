// SPDX-License-Identifier: MIT OR Apache-2.0
//! The pass `core/raster`: shadow maps, lit pictures and skies.

use super::{Camera, Light, POINT, ShadowViews};
use crate::data::Mesh;
use crate::gpu::Gpu;
use crate::pass::{ColorTarget, DepthTarget, Pass, PassError, Render, RenderStages, Resource};
use crate::resource::{Buffer, Sampler, Texture};
use crate::shaders::Shaders;
use airlight_validate::Composed;
use encase::ShaderType;
use glam::Vec3;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};
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

    /// Draws the mesh as the instance `instance`.
    pub(crate) fn draw(&self, render: &mut Render<'_>, instance: u32) {
        render.set_mesh(&self.vertices, &self.indices);
        render.draw_indexed(0..self.count, instance..instance + 1);
    }
}

/// What the pipelines of a picture depend on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Variant {
    permutation: usize,
    reversed: bool,
    samples: u32,
}

/// Surfaces and what is behind them.
struct PicturePasses {
    surface: Pass,
    background: Pass,
}

/// The permutations of the pass: bit 0 is an array of shadow maps, bit 1 a light texture.
const PERMUTATIONS: [&str; 4] = ["default", "shadow_array", "light_texture", "shadow_array_light_texture"];

/// Rasterises meshes from the light and from the camera.
pub struct Raster {
    composed: [Composed; 4],
    shadow: Pass,
    shadow_array: Pass,
    /// Built when they are first asked for.
    pictures: Mutex<BTreeMap<Variant, Arc<PicturePasses>>>,
    shadow_sampler: Sampler,
    light_sampler: Sampler,
}

/// Layout of the vertices of [`MeshBuffers`].
pub(crate) const MESH_VERTEX: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: 36,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32x3],
};

/// A picture to be drawn.
#[derive(Clone, Copy)]
pub struct Drawing<'a> {
    /// The camera, any projection and depth convention.
    pub camera: &'a Camera,
    /// The light; its shadow maps have forward depth.
    pub light: &'a Light,
    /// Sky and ground.
    pub sky: &'a Sky,
    /// What is drawn and casts shadows.
    pub meshes: &'a [MeshBuffers],
    /// Size of the standard shadow map in texels, which a point light has none of.
    pub shadow_map: [u32; 2],
    /// Views of an array of shadow maps, and the size of its layers; surfaces then take their shadows from it.
    pub views: Option<(&'a ShadowViews, [u32; 2])>,
    /// Colours a directional light or a spot.
    pub light_texture: Option<&'a Texture>,
    /// Samples a pixel, 1 or 4.
    pub samples: u32,
}

impl Raster {
    /// Composes the pass and builds the pipelines of shadow maps.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn new(gpu: &Gpu, shaders: &Shaders) -> Result<Self, PassError> {
        let compose = |permutation| shaders.compose("core/raster", permutation);
        let [plain, array, texture, both] = PERMUTATIONS;
        let composed = [compose(plain)?, compose(array)?, compose(texture)?, compose(both)?];
        let shadow = |composed| {
            let stages = RenderStages {
                vertex: "vertex_shadow",
                fragment: None,
                vertices: Some(MESH_VERTEX),
                target: None,
                depth: Some((wgpu::CompareFunction::Less, true)),
                samples: 1,
            };
            Pass::render(gpu, composed, &stages)
        };
        Ok(Self {
            shadow: shadow(&composed[0])?,
            shadow_array: shadow(&composed[1])?,
            composed,
            pictures: Mutex::default(),
            shadow_sampler: Sampler::shadow(gpu),
            light_sampler: Sampler::linear(gpu),
        })
    }

    fn passes(&self, gpu: &Gpu, variant: Variant) -> Result<Arc<PicturePasses>, PassError> {
        // Building twice is all that a poisoned lock could lead to.
        let mut pictures = self.pictures.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(passes) = pictures.get(&variant) {
            return Ok(passes.clone());
        }
        let nearer =
            if variant.reversed { wgpu::CompareFunction::Greater } else { wgpu::CompareFunction::Less };
        let build = |vertex, fragment, vertices, depth| {
            let stages = RenderStages {
                vertex,
                fragment: Some(fragment),
                vertices,
                target: Some(Rgba16Float),
                depth: Some(depth),
                samples: variant.samples,
            };
            Pass::render(gpu, &self.composed[variant.permutation], &stages)
        };
        let passes = Arc::new(PicturePasses {
            surface: build("vertex_surface", "fragment_surface", Some(MESH_VERTEX), (nearer, true))?,
            background: build(
                "vertex_background",
                "fragment_background",
                None,
                (wgpu::CompareFunction::Always, false),
            )?,
        });
        pictures.insert(variant, passes.clone());
        Ok(passes)
    }

    /// Records the shadow map of `meshes` as seen from a directional light or a spot.
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
        let mut render = begin(encoder, None, shadow_map, 1.0);
        render.set(&self.shadow, &bound);
        meshes.iter().for_each(|mesh| mesh.draw(&mut render, 0));
        Ok(())
    }

    /// Records the shadow maps of `meshes` in the first `count` views of the uniform `shadow_views`, one a layer.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn record_shadow_maps(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        shadow_views: &Buffer,
        count: u32,
        meshes: &[MeshBuffers],
        shadow_maps: &Texture,
    ) -> Result<(), PassError> {
        let bound = self.shadow_array.bind(gpu, &[("shadow_views", shadow_views.into())])?;
        for layer in 0..count.min(shadow_maps.size()[2]) {
            let mut render = begin(encoder, None, &shadow_maps.of_layer(layer), 1.0);
            render.set(&self.shadow_array, &bound);
            meshes.iter().for_each(|mesh| mesh.draw(&mut render, layer));
        }
        Ok(())
    }

    /// A shadow map and a picture of `meshes`, one sample a pixel.
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
        let drawing = Drawing {
            camera,
            light,
            sky,
            meshes,
            shadow_map: map,
            views: None,
            light_texture: None,
            samples: 1,
        };
        self.draw(gpu, &drawing)
    }

    /// The shadow maps and the picture of a drawing: surfaces before the sky, with their depth.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn draw(&self, gpu: &Gpu, drawing: &Drawing<'_>) -> Result<Pictures, PassError> {
        let Drawing { camera, light, meshes, samples, .. } = *drawing;
        let viewport = [camera.viewport.x as u32, camera.viewport.y as u32];
        let several = samples > 1;
        let target = |format| Texture::multisampled(gpu, viewport, format, samples);
        // What rays of a point light meet is in the array alone.
        let single = light.kind != POINT;
        let pictures = Pictures {
            shadow_map: Texture::target(gpu, if single { drawing.shadow_map } else { [1, 1] }, Depth32Float),
            shadow_maps: drawing.views.map(|(views, [width, height])| {
                Texture::target_array(gpu, [width, height, views.count], Depth32Float)
            }),
            surface: Texture::target(gpu, viewport, Rgba16Float),
            depth: if several { target(Depth32Float) } else { Texture::target(gpu, viewport, Depth32Float) },
        };
        let samples_of_surface = several.then(|| target(Rgba16Float));
        let light_buffer = Buffer::uniform(gpu, light);
        let mut encoder = gpu.encoder();
        let casters = if single { meshes } else { &[] };
        self.record_shadow_map(gpu, &mut encoder, &light_buffer, casters, &pictures.shadow_map)?;
        let views = drawing.views.map(|(views, _)| (Buffer::uniform(gpu, views), views.count));
        if let (Some((views, count)), Some(maps)) = (&views, &pictures.shadow_maps) {
            self.record_shadow_maps(gpu, &mut encoder, views, *count, meshes, maps)?;
        }

        let (camera_buffer, sky) = (Buffer::uniform(gpu, camera), Buffer::uniform(gpu, drawing.sky));
        let mut resources: Vec<(&str, Resource<'_>)> = vec![
            ("camera", (&camera_buffer).into()),
            ("light", (&light_buffer).into()),
            ("sky", (&sky).into()),
            ("shadow_map", (&pictures.shadow_map).into()),
            ("shadow_sampler", (&self.shadow_sampler).into()),
            ("light_sampler", (&self.light_sampler).into()),
        ];
        let mut permutation = 0;
        if let (Some((views, _)), Some(maps)) = (&views, &pictures.shadow_maps) {
            resources.extend([("shadow_views", views.into()), ("shadow_maps", maps.into())]);
            permutation |= 1;
        }
        if let Some(texture) = drawing.light_texture {
            resources.push(("light_texture", texture.into()));
            permutation |= 2;
        }
        let variant = Variant { permutation, reversed: camera.is_reversed(), samples };
        let passes = self.passes(gpu, variant)?;
        let background = passes.background.bind_known(gpu, &resources)?;
        let lit = passes.surface.bind_known(gpu, &resources)?;
        let color = match &samples_of_surface {
            Some(samples) => (samples, Some(&pictures.surface), wgpu::Color::BLACK),
            None => (&pictures.surface, None, wgpu::Color::BLACK),
        };
        let mut render = begin(&mut encoder, Some(color), &pictures.depth, camera.far_depth);
        render.set(&passes.background, &background);
        render.draw(0..3, 0..1);
        render.set(&passes.surface, &lit);
        meshes.iter().for_each(|mesh| mesh.draw(&mut render, 0));
        drop(render);
        gpu.submit(encoder)?;
        Ok(pictures)
    }
}

/// What an engine has before it asks for light shafts.
pub struct Pictures {
    /// Depth from a directional light or a spot; one empty texel for a point light.
    pub shadow_map: Texture,
    /// Depth in the views of an array of shadow maps, a layer each.
    pub shadow_maps: Option<Texture>,
    /// Linear RGB radiance of surfaces and sky, one sample a pixel.
    pub surface: Texture,
    /// Depth from the camera, multisampled where the picture was drawn so.
    pub depth: Texture,
}

/// A render pass that clears its targets, depth to `far_depth`. `color`: the target, what it is resolved into, what it is cleared to.
pub(crate) fn begin<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    color: Option<(&Texture, Option<&Texture>, wgpu::Color)>,
    depth: &Texture,
    far_depth: f32,
) -> Render<'a> {
    let color = color.map(|(texture, resolve, clear)| ColorTarget {
        resolve: resolve.cloned(),
        ..ColorTarget::cleared(texture, clear)
    });
    let depth = DepthTarget { texture: depth.clone(), far_depth };
    Render::new(encoder, color.into_iter().collect(), Some(depth))
}
