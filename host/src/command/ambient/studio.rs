// SPDX-License-Identifier: MIT OR Apache-2.0
//! The passes: geometry, bent normals, light.

use super::flags::Options;
use super::shown::Seen;
use crate::ambient::{
    BentForm, BentPasses, ConeLight, ConeLightForm, Method, OcclusionSettings, ShadePass, SurfaceImages,
};
use crate::command::CommandError;
use crate::core::{Camera, Geometry, GeometryPass, MeshBuffers};
use crate::data::{Environment, Mesh};
use crate::scattering::check_size;
use crate::{Gpu, Shaders, Texture};
use glam::Vec3;

/// What a camera sees of a mesh, and the device that it lies on.
pub struct Ground<'a> {
    gpu: &'a Gpu,
    shaders: &'a Shaders,
    camera: &'a Camera,
    /// Depth, normals and albedos.
    pub geometry: Geometry,
}

impl<'a> Ground<'a> {
    /// Draws the geometry.
    ///
    /// # Errors
    /// Failures of the device.
    pub fn new(
        (gpu, shaders): (&'a Gpu, &'a Shaders),
        mesh: &Mesh,
        camera: &'a Camera,
    ) -> Result<Self, CommandError> {
        let buffers = MeshBuffers::new(gpu, mesh);
        let geometry = GeometryPass::new(gpu, shaders)?.draw(gpu, camera, &[buffers])?;
        Ok(Self { gpu, shaders, camera, geometry })
    }

    /// As the passes take it.
    pub fn images(&self) -> SurfaceImages<'_> {
        SurfaceImages { camera: self.camera, depth: &self.geometry.depth, normals: &self.geometry.normals }
    }

    /// Mean directions and openness.
    ///
    /// # Errors
    /// Failures of the device, impossible settings.
    pub fn bent(&self, form: BentForm, settings: &OcclusionSettings) -> Result<Texture, CommandError> {
        let passes = BentPasses::new(self.gpu, self.shaders, form)?;
        let mut encoder = self.gpu.encoder();
        let bent = passes.record(self.gpu, &mut encoder, self.images(), settings)?;
        self.gpu.submit(encoder)?;
        Ok(bent)
    }

    /// What was found, lit where there is light: the light, how surfaces are lit by it, and whether as bright as printed.
    ///
    /// # Errors
    /// Failures of the device.
    pub fn seen(
        &self,
        bent: &Texture,
        light: Option<(&ConeLight, Method, bool)>,
    ) -> Result<Vec<Option<Seen>>, CommandError> {
        let gpu = self.gpu;
        let lit = match light {
            Some((light, method, printed)) => {
                let shade = ShadePass::new(gpu, self.shaders, method, printed)?;
                let mut encoder = gpu.encoder();
                let albedos = &self.geometry.albedos;
                let picture = shade.record(gpu, &mut encoder, self.images(), albedos, bent, &light.cones)?;
                gpu.submit(encoder)?;
                Some(picture)
            }
            None => None,
        };
        // Memory that ran out is said here.
        gpu.check()?;
        let normals = self.geometry.normals.read(gpu)?;
        let bent = bent.read(gpu)?;
        let radiance = lit.map(|picture| picture.read(gpu)).transpose()?;
        let pixel = |(place, (normal, bent)): (usize, (&[f32], &[f32]))| {
            // Where nothing is the normal is 0.
            normal[..3].iter().any(|value| *value != 0.0).then(|| Seen {
                radiance: radiance.as_ref().map_or(Vec3::ZERO, |all| Vec3::from_slice(&all[4 * place..])),
                open: bent[3],
                mean: Vec3::from_slice(bent),
            })
        };
        Ok(normals.chunks_exact(4).zip(bent.chunks_exact(4)).enumerate().map(pixel).collect())
    }
}

/// Draws in screen space. `radius`: metres up to which occluders count, where none was given; `light`: none where only numbers are shown.
///
/// # Errors
/// Misuse and failures of all kinds.
pub fn draw(
    (gpu, shaders): (&Gpu, &Shaders),
    options: &Options,
    (mesh, camera, radius): (&Mesh, &Camera, f32),
    light: Option<&Environment>,
    method: Method,
) -> Result<Vec<Option<Seen>>, CommandError> {
    check_size(gpu, "a picture", options.size)?;
    let ground = Ground::new((gpu, shaders), mesh, camera)?;
    let bent = ground.bent(options.form(), &options.settings(radius))?;
    let light = light.map(|map| ConeLight::new(gpu, shaders, map, ConeLightForm::default())).transpose()?;
    ground.seen(&bent, light.as_ref().map(|light| (light, method, options.printed)))
}
