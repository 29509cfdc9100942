// SPDX-License-Identifier: MIT OR Apache-2.0
//! Volumes and meshes in one light, drawn as sheets.

use super::super::album::Album;
use super::super::studio::Studio;
use crate::command::CommandError;
use crate::command::sky::behind;
use crate::command::transfers::transfer;
use crate::core::{Camera, DepthRange, PerspectiveView};
use crate::data::{LightImage, Mesh, Volume};
use crate::splatting::{
    LightTransport, Shading, SheetFrame, SheetInputs, SheetLighting, SheetPicture, SheetSettings, Splats,
    Surfaces, light_around,
};
use crate::transmittance::Composite;
use crate::{Lighting, Texture, light_texture};
use glam::Vec3;
use std::path::Path;

/// What is drawn.
pub struct Still {
    /// Values 0..1.
    pub volumes: Vec<Volume>,
    /// Voxels of no greater value are left out.
    pub threshold: f32,
    /// Name of the transfer function.
    pub transfer: &'static str,
    /// Opaque.
    pub meshes: Vec<Mesh>,
    /// The light.
    pub light: Lighting,
    /// What colours it.
    pub slide: Option<LightImage>,
    /// What the medium and surfaces do with it.
    pub lighting: SheetLighting,
    /// Droplets or surfaces.
    pub shading: Shading,
    /// How many sheets.
    pub sheets: u32,
    /// Columns and rows of the shadow buffer.
    pub light_size: u32,
    /// Eye and target, metres, and vertical field of view, degrees.
    pub view: (Vec3, Vec3, f32),
    /// Linear RGB behind it all; where there is none, a sky.
    pub background: Option<Vec3>,
    /// Of the picture.
    pub exposure: f32,
}

/// A volume with values up to 1, and the value that became 1.
pub fn normalised(mut volume: Volume) -> (Volume, f32) {
    let greatest = volume.values.iter().copied().fold(1e-6, f32::max);
    volume.values.iter_mut().for_each(|value| *value = (*value / greatest).clamp(0.0, 1.0));
    (volume, greatest)
}

impl Still {
    fn camera(&self, size: [u32; 2]) -> Result<Camera, CommandError> {
        let (eye, target, field_of_view) = self.view;
        let depth = DepthRange::Reversed;
        let view = PerspectiveView { eye, target, field_of_view, near: 0.05, far: 1000.0, depth };
        Camera::perspective(&view, size).map_err(CommandError::failure)
    }

    /// All points that the light has to hold.
    fn points(&self) -> Vec<Vec3> {
        let volumes = self.volumes.iter().flat_map(|volume| volume.bounds().corners());
        let meshes = self.meshes.iter().filter_map(Mesh::bounds).flat_map(|bounds| bounds.corners());
        volumes.chain(meshes).collect()
    }

    /// The picture before what lies behind it, linear RGB, and milliseconds that it takes.
    pub fn draw(&self, studio: &Studio, transport: LightTransport) -> Result<(Texture, f64), CommandError> {
        let Studio { gpu, shaders, size, .. } = studio;
        let find = |volume| Splats::new(gpu, shaders, volume, self.threshold, None);
        let splats = self.volumes.iter().map(find).collect::<Result<Vec<_>, _>>()?;
        let table = transfer(Path::new(self.transfer))?.upload(gpu)?;
        let surfaces = (!self.meshes.is_empty()).then(|| Surfaces::new(gpu, &self.meshes)).transpose()?;
        let slide = self.slide.as_ref().map(|slide| light_texture(gpu, slide)).transpose()?;
        let inputs = SheetInputs {
            surfaces: surfaces.as_ref(),
            light_texture: slide.as_ref(),
            ..SheetInputs::new(&splats, &table)
        };
        let settings = SheetSettings {
            count: self.sheets,
            light_size: [self.light_size; 2],
            shading: self.shading,
            transport,
            ..SheetSettings::default()
        };
        let picture = SheetPicture::new(gpu, shaders, inputs, settings, *size)?;
        let camera = self.camera(*size)?;
        let light = light_around(&self.light, &self.points())?;
        picture.set(gpu, &SheetFrame { camera, light, lighting: self.lighting })?;
        let mut encoder = gpu.encoder();
        picture.record(gpu, &mut encoder)?;
        let started = std::time::Instant::now();
        gpu.submit(encoder)?;
        gpu.wait()?;
        let milliseconds = 1e3 * started.elapsed().as_secs_f64();
        let background = behind((gpu, shaders), &camera, &light, self.background)?.surface;
        let composite = Composite::new(gpu, shaders)?;
        Ok((composite.run(gpu, &background, &picture.picture)?, milliseconds))
    }

    /// Draws it and puts it into an album.
    pub fn hang(
        &self,
        studio: &Studio,
        album: &mut Album,
        [file, caption]: [&str; 2],
        transport: LightTransport,
    ) -> Result<(), CommandError> {
        let (composed, milliseconds) = self.draw(studio, transport)?;
        album.add(file, caption, studio.size, &studio.pixels(&composed, self.exposure)?)?;
        album.fact(caption, format!("{milliseconds:.0} ms"));
        Ok(())
    }
}
