// SPDX-License-Identifier: MIT OR Apache-2.0
//! A medium before a camera, under a sun and a fill light, with a sky behind.

use super::super::studio::Studio;
use super::sky::{Sky, directions};
use crate::command::CommandError;
use crate::core::{Bricks, Camera, Light, LightError, PerspectiveView, Reading, VolumeTexture};
use crate::data::Volume;
use crate::transmittance::{
    Composite, MapSettings, MediumLighting, MediumView, Query, TransmittanceMap, VolumePicture, Voxels,
};
use crate::{Buffer, Texture};
use glam::Vec3;

/// Who looks at what under which light.
pub struct Arrangement {
    /// The camera.
    pub view: PerspectiveView,
    /// Towards the sun, and its radiance.
    pub sun: (Vec3, Vec3),
    /// Towards a second light that lifts shadows, and its radiance.
    pub fill: (Vec3, Vec3),
    /// Albedo, and mean cosine of the phase function.
    pub medium: (Vec3, f32),
    /// Behind it.
    pub sky: Sky,
    /// Albedo of the ground at height 0.
    pub ground: Option<Vec3>,
    /// Of the picture.
    pub exposure: f32,
}

/// The same on the device.
pub struct Setting<'a> {
    /// The device and what all pictures need.
    pub studio: &'a Studio,
    /// As it was given.
    pub of: &'a Arrangement,
    /// The sun over the medium.
    pub sun: Light,
    /// The fill light over the medium.
    pub fill: Light,
    camera: Camera,
    camera_uniform: Buffer,
    lighting: Buffer,
    depth: Texture,
    composite: Composite,
}

impl<'a> Setting<'a> {
    /// Before empty space. `fit`: the light of a direction and radiance, its map fitted to the medium.
    pub fn new(
        studio: &'a Studio,
        of: &'a Arrangement,
        fit: impl Fn(Vec3, Vec3) -> Result<Light, LightError>,
    ) -> Result<Self, CommandError> {
        let camera = Camera::perspective(&of.view, studio.size).map_err(CommandError::failure)?;
        let light = |(towards, radiance)| fit(towards, radiance).map_err(CommandError::failure);
        let (albedo, g) = of.medium;
        let lighting = MediumLighting::new(albedo, g, 1000.0)?;
        let [width, height] = studio.size;
        let depth = Texture::storage(&studio.gpu, studio.size, wgpu::TextureFormat::R32Float);
        depth.write(&studio.gpu, &vec![camera.far_depth; width as usize * height as usize])?;
        Ok(Self {
            studio,
            of,
            sun: light(of.sun)?,
            fill: light(of.fill)?,
            camera_uniform: Buffer::uniform(&studio.gpu, &camera),
            camera,
            lighting: Buffer::uniform(&studio.gpu, &lighting),
            depth,
            composite: Composite::new(&studio.gpu, &studio.shaders)?,
        })
    }

    /// What passes are given.
    pub fn view(&self) -> MediumView<'_> {
        MediumView { camera: &self.camera_uniform, lighting: &self.lighting, depth: &self.depth }
    }

    /// The volume through a map.
    pub fn lit(&self, map: &TransmittanceMap, volume: &VolumeTexture) -> Result<Texture, CommandError> {
        let Studio { gpu, shaders, .. } = self.studio;
        let pass = VolumePicture::new(gpu, shaders, map.settings, false, Reading::Linear)?;
        let bound = pass.bind(gpu, &self.view(), map, volume)?;
        let mut encoder = gpu.encoder();
        pass.record(&mut encoder, &bound);
        gpu.submit(encoder)?;
        Ok(bound.picture)
    }

    /// The volume with a march to the sun from every step.
    pub fn brute_force(&self, volume: &VolumeTexture) -> Result<Texture, CommandError> {
        let Studio { gpu, shaders, .. } = self.studio;
        let light = Buffer::uniform(gpu, &self.sun);
        let pass = VolumePicture::reference(gpu, shaders, Reading::Linear)?;
        let bound = pass.bind_reference(gpu, &self.view(), &light, volume)?;
        let mut encoder = gpu.encoder();
        pass.record(&mut encoder, &bound);
        gpu.submit(encoder)?;
        Ok(bound.picture)
    }

    /// Sky, and ground with the shadow that a map casts on it.
    pub fn background(&self, map: &TransmittanceMap) -> Result<Texture, CommandError> {
        let Studio { gpu, shaders, .. } = self.studio;
        let (sun, eye) = (self.sun.direction, self.camera.eye);
        let directions = directions(&self.camera, self.studio.size);
        let mut colors: Vec<Vec3> = directions.iter().map(|d| self.of.sky.radiance(*d, sun)).collect();
        let ground = self.of.ground.map(|albedo| {
            let places = directions.iter().enumerate().filter(|(_, direction)| direction.y < -1e-3);
            let places: Vec<(usize, Vec3)> =
                places.map(|(pixel, direction)| (pixel, eye - *direction * (eye.y / direction.y))).collect();
            (albedo, places)
        });
        if let Some((albedo, places)) = ground.filter(|(_, places)| !places.is_empty()) {
            let points: Vec<Vec3> = places.iter().map(|(_, place)| *place).collect();
            let query = Query::new(gpu, shaders, map.settings, false)?;
            let bound = query.bind(gpu, map, &points)?;
            let mut encoder = gpu.encoder();
            query.record(&mut encoder, &bound)?;
            gpu.submit(encoder)?;
            let sunlit = albedo * self.sun.radiance * sun.y.max(0.0) / std::f32::consts::PI;
            for ((pixel, place), through) in places.iter().zip(bound.read(gpu)?) {
                // Sky light is even; far ground fades into the horizon.
                let near = (-0.02 * place.distance(eye)).exp();
                let lit = sunlit * through + 0.5 * albedo * self.of.sky.zenith;
                colors[*pixel] = self.of.sky.radiance(directions[*pixel], sun).lerp(lit, near);
            }
        }
        let values: Vec<f32> = colors.iter().flat_map(|c| [c.x, c.y, c.z, 1.0]).collect();
        let background = Texture::storage(gpu, self.studio.size, wgpu::TextureFormat::Rgba16Float);
        background.write(gpu, &values)?;
        Ok(background)
    }

    /// Pixels of what the sun and the fill light make of the medium, over what lies behind.
    pub fn finish(&self, background: &Texture, sun: &Texture, fill: &[f32]) -> Result<Vec<u8>, CommandError> {
        let gpu = &self.studio.gpu;
        let sum = sun.read(gpu)?.into_iter().zip(fill).enumerate();
        let sum: Vec<f32> = sum.map(|(i, (a, b))| if i % 4 == 3 { a } else { a + b }).collect();
        let both = Texture::storage(gpu, self.studio.size, wgpu::TextureFormat::Rgba16Float);
        both.write(gpu, &sum)?;
        let composed = self.composite.run(gpu, background, &both)?;
        self.studio.pixels(&composed, self.of.exposure)
    }
}

/// A volume for pictures, thinned or thickened.
pub fn upload(studio: &Studio, volume: &Volume, scale: f32) -> Result<VolumeTexture, CommandError> {
    let mut uploaded = VolumeTexture::new(&studio.gpu, volume, scale, Reading::Linear)?;
    Bricks::new(&studio.gpu, &studio.shaders)?.give(&studio.gpu, &mut uploaded)?;
    Ok(uploaded)
}

/// A map of the volume, built.
pub fn build(
    studio: &Studio,
    settings: MapSettings,
    light: &Light,
    volume: &VolumeTexture,
) -> Result<TransmittanceMap, CommandError> {
    let Studio { gpu, shaders, .. } = studio;
    let map = TransmittanceMap::new(gpu, settings, light)?;
    let voxels = Voxels::new(gpu, shaders, settings, Reading::Linear)?;
    let mut encoder = gpu.encoder();
    voxels.record(&mut encoder, &voxels.bind(gpu, &map, volume)?);
    gpu.submit(encoder)?;
    Ok(map)
}
