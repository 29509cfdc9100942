// SPDX-License-Identifier: MIT OR Apache-2.0
//! A lit scene on the GPU, with everything that a system of light shafts is given by an engine.

use crate::core::{
    Camera, CameraError, Light, LightError, MeshBuffers, PerspectiveView, Pictures, Raster, Sky,
};
use crate::data::{Bounds, Mesh};
use crate::gpu::Gpu;
use crate::pass::PassError;
use crate::resource::Buffer;
use crate::scattering::{Inputs, Medium, SettingsError, check_size};
use glam::Vec3;

/// Why a scene could not be put on the GPU.
#[derive(Debug, thiserror::Error)]
pub enum StageError {
    /// The camera.
    #[error(transparent)]
    Camera(#[from] CameraError),
    /// The light.
    #[error(transparent)]
    Light(#[from] LightError),
    /// The size of a picture or of the shadow map.
    #[error(transparent)]
    Size(#[from] SettingsError),
    /// A pass.
    #[error(transparent)]
    Pass(#[from] PassError),
}

/// A scene in the words of a person.
#[derive(Clone, Copy)]
pub struct Setting<'a> {
    /// What is drawn and what casts shadows.
    pub mesh: &'a Mesh,
    /// The camera.
    pub view: PerspectiveView,
    /// Direction TOWARDS the light.
    pub light: Vec3,
    /// Radiance of the light, linear RGB.
    pub radiance: Vec3,
    /// Sky and ground.
    pub sky: Sky,
    /// The air.
    pub medium: Medium,
}

/// A scene on the GPU: uniforms, shadow map, picture and depth.
pub struct Stage {
    /// The camera.
    pub camera: Camera,
    /// The light, its shadow map fitted to the mesh.
    pub light: Light,
    /// The air.
    pub medium: Medium,
    /// Uniform of the camera.
    pub camera_buffer: Buffer,
    /// Uniform of the light.
    pub light_buffer: Buffer,
    /// Uniform of the medium.
    pub medium_buffer: Buffer,
    /// Shadow map, surface radiance, depth.
    pub pictures: Pictures,
}

impl Stage {
    /// Renders the shadow map and the picture of a scene.
    ///
    /// # Errors
    /// [`StageError`].
    pub fn new(
        gpu: &Gpu,
        raster: &Raster,
        setting: &Setting<'_>,
        viewport: [u32; 2],
        shadow_map: [u32; 2],
    ) -> Result<Self, StageError> {
        check_size(gpu, "a picture", viewport)?;
        check_size(gpu, "a shadow map", shadow_map)?;
        let camera = Camera::perspective(&setting.view, viewport)?;
        let bounds = setting.mesh.bounds().unwrap_or(Bounds { min: Vec3::ZERO, max: Vec3::ZERO });
        let light = Light::directional(setting.light, setting.radiance, bounds.min, bounds.max)?;
        let meshes = [MeshBuffers::new(gpu, setting.mesh)];
        let pictures = raster.render(gpu, &camera, &light, &setting.sky, &meshes, shadow_map)?;
        Ok(Self {
            camera,
            light,
            medium: setting.medium,
            camera_buffer: Buffer::uniform(gpu, &camera),
            light_buffer: Buffer::uniform(gpu, &light),
            medium_buffer: Buffer::uniform(gpu, &setting.medium),
            pictures,
        })
    }

    /// What the passes are given.
    pub fn inputs(&self) -> Inputs<'_> {
        Inputs {
            camera: &self.camera_buffer,
            light: &self.light_buffer,
            medium: &self.medium_buffer,
            depth: &self.pictures.depth,
            shadow_map: &self.pictures.shadow_map,
        }
    }
}
