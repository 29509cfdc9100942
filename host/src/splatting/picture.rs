// SPDX-License-Identifier: MIT OR Apache-2.0
//! Sheet after sheet into a picture and a shadow buffer.

#[cfg(feature = "command")]
mod parts;

use super::light_path::{DirectLight, LightPath, LightSheets};
use super::means::Means;
use super::order::{Order, tiles};
use super::passes::{LIGHT, MEANS, Passes};
use super::scattered_light::ScatteredLight;
use super::soft_light::{AreaLight, LitSurfaces};
use super::surfaces::SurfacePictures;
use super::{
    LightTransport, SheetFrame, SheetInputs, SheetLighting, SheetNumber, SheetSettings, Sheets, Splats,
    SplattingError,
};
use crate::core::{Camera, Light};
use crate::gpu::Gpu;
use crate::out_of_range::in_range;
use crate::pass::{Bound, Resource};
use crate::resource::{Buffer, Sampler, Texture};
use crate::shaders::Shaders;
use encase::ShaderType;
use glam::Vec3;
use std::sync::{Mutex, PoisonError};

/// Volumes drawn sheet by sheet.
pub struct SheetPicture<'a> {
    splats: &'a [Splats],
    settings: SheetSettings,
    surfaces: Option<SurfacePictures<'a>>,
    /// Whether the depth of the eye's camera is reversed, and that of the light's.
    reversed: Mutex<[bool; 2]>,
    passes: Passes,
    uniforms: Uniforms,
    order: Order<'a>,
    eye: Means,
    light: Means,
    path: Box<dyn LightPath>,
    sum: Buffer,
    /// Where light spreads behind surfaces.
    surface_light: Option<Buffer>,
    means: [Texture; 3],
    light_means: Texture,
    composites: Vec<Bound>,
    /// Linear RGB radiance of the medium, and the transmittance to what lies behind; rgba16float.
    pub picture: Texture,
}

struct Uniforms {
    camera: Buffer,
    light_camera: Buffer,
    light: Buffer,
    sheets: Buffer,
    kernel: Buffer,
    lighting: Buffer,
}

impl Uniforms {
    fn new(gpu: &Gpu, settings: &SheetSettings) -> Self {
        let storage = |bytes: std::num::NonZeroU64| Buffer::storage(gpu, bytes.get());
        Self {
            camera: storage(Camera::min_size()),
            light_camera: storage(Camera::min_size()),
            light: storage(Light::min_size()),
            sheets: storage(Sheets::min_size()),
            kernel: Buffer::uniform(gpu, &settings.kernel),
            lighting: storage(SheetLighting::min_size()),
        }
    }
}

impl<'a> SheetPicture<'a> {
    /// Builds passes and buffers for pictures of `size`.
    ///
    /// # Errors
    /// [`SplattingError`].
    pub fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        inputs: SheetInputs<'a, '_>,
        settings: SheetSettings,
        size: [u32; 2],
    ) -> Result<Self, SplattingError> {
        let SheetInputs { splats, transfer, surfaces: given, light_texture } = inputs;
        in_range("number of sheets", settings.count as f32, 1.0..=4096.0, "from 1 to 4096")?;
        let limit = gpu.limits.max_texture_dimension_2d as f32;
        for side in size.into_iter().chain(settings.light_size) {
            in_range(
                "side of a picture",
                side as f32,
                1.0..=limit,
                "at least 1 and at most the device's limit",
            )?;
        }
        let uniforms = Uniforms::new(gpu, &settings);
        let polygons = given.is_some();
        let passes = Passes::new(gpu, shaders, &settings, polygons)?;
        let picture = Texture::storage(gpu, size, LIGHT);
        let light_means = Texture::target(gpu, settings.light_size, MEANS);
        let sheets = [&uniforms.sheets, &uniforms.kernel];
        let targets = [&picture, &light_means];
        let order = Order::new(gpu, shaders, splats, sheets, targets, settings.count, settings.scanning)?;
        let numbers: Vec<Buffer> =
            (0..settings.count).map(|index| Buffer::uniform(gpu, &SheetNumber::new(index))).collect();
        let buffers = [&uniforms.camera, &uniforms.light_camera, sheets[0]];
        let surfaces = given.map(|surfaces| {
            let exits = matches!(settings.transport, LightTransport::Soft(_));
            SurfacePictures::new(gpu, shaders, surfaces, buffers, [size, settings.light_size], exits)
        });
        let surfaces = surfaces.transpose()?;
        let means = |pass, camera, heights| Means::new(gpu, pass, &order, camera, sheets, &numbers, heights);
        let eye = means(&passes.splat, buffers[0], surfaces.as_ref().map(SurfacePictures::eye_heights))?;
        let heights = surfaces.as_ref().map(SurfacePictures::light_heights);
        let light = means(&passes.light_splat, buffers[1], heights)?;
        let means = [0; 3].map(|_| Texture::target(gpu, size, MEANS));
        let sum = Buffer::storage(gpu, 16 * u64::from(size[0]) * u64::from(size[1]));
        let spread = polygons && settings.transport != LightTransport::Direct;
        let surface_light =
            spread.then(|| Buffer::storage(gpu, 16 * u64::from(size[0]) * u64::from(size[1])));
        let sampler = Sampler::linear(gpu);
        let mut all: Vec<(&str, Resource<'_>)> = vec![
            ("camera", (&uniforms.camera).into()),
            ("light_camera", (&uniforms.light_camera).into()),
            ("light", (&uniforms.light).into()),
            ("sheets", sheets[0].into()),
            ("lighting", (&uniforms.lighting).into()),
            ("light_sheet", (&light_means).into()),
            ("transfer", (&transfer.texture).into()),
            ("linear_sampler", (&sampler).into()),
            ("sum", (&sum).into()),
            ("picture", (&picture).into()),
        ];
        if let Some(surfaces) = &surfaces {
            all.extend([
                ("eye_heights", surfaces.eye_heights().into()),
                ("light_heights", surfaces.light_heights().into()),
                ("albedo", surfaces.albedo().into()),
                ("normal", surfaces.normal().into()),
            ]);
        }
        all.extend(light_texture.map(|texture| ("light_texture", texture.into())));
        all.extend(surface_light.as_ref().map(|buffer| ("surface_light", buffer.into())));
        let path: Box<dyn LightPath> = match settings.transport {
            LightTransport::Direct => {
                Box::new(DirectLight::new(gpu, shaders, &all, &numbers, settings.light_size)?)
            }
            LightTransport::Scattering(scattering) => {
                let (size, heights) =
                    (settings.light_size, surfaces.as_ref().map(SurfacePictures::light_heights));
                Box::new(ScatteredLight::new(gpu, shaders, &all, size, &scattering, &numbers, heights)?)
            }
            LightTransport::Soft(soft) => {
                let lit = surfaces.as_ref().and_then(|surfaces| {
                    let exit_heights = surfaces.light_exit_heights()?;
                    Some(LitSurfaces { heights: surfaces.light_heights(), exit_heights })
                });
                Box::new(AreaLight::new(gpu, shaders, &all, soft, settings.count, settings.light_size, lit)?)
            }
        };
        all.push(("shadow", path.shadow().into()));
        all.extend(path.resources());
        let mut composites = Vec::new();
        for (index, number) in numbers.iter().enumerate() {
            let mean = |offset: usize| Resource::from(&means[(index + 2 + offset) % 3]);
            let mut resources = all.clone();
            resources.extend([
                ("number", number.into()),
                ("before", mean(0)),
                ("sheet", mean(1)),
                ("behind", mean(2)),
            ]);
            composites.push(passes.composite.bind_known(gpu, &resources)?);
        }
        Ok(Self {
            splats,
            settings,
            surfaces,
            reversed: Mutex::default(),
            passes,
            uniforms,
            order,
            eye,
            light,
            path,
            sum,
            surface_light,
            means,
            light_means,
            composites,
            picture,
        })
    }

    /// Says what the next recorded frame shows, and how sheets lie.
    ///
    /// # Errors
    /// [`SplattingError`].
    pub fn set(&self, gpu: &Gpu, frame: &SheetFrame) -> Result<Sheets, SplattingError> {
        frame.lighting.check()?;
        let [width, height, _] = self.picture.size();
        let camera = [frame.camera.viewport.x as u32, frame.camera.viewport.y as u32];
        if camera != [width, height] {
            return Err(SplattingError::Viewport { camera, picture: [width, height] });
        }
        let splats = self.splats;
        let mut points: Vec<Vec3> = splats.iter().flat_map(|splats| splats.corners.iter().copied()).collect();
        // Light that spreads has to pass surfaces sheet by sheet.
        if points.is_empty() || self.surface_light.is_some() {
            points.extend(self.surfaces.iter().flat_map(SurfacePictures::corners));
        }
        let middle = points.iter().sum::<Vec3>() / points.len().max(1) as f32;
        let radius = self.settings.kernel.radius;
        let reach = |normal| {
            let reaches = splats.iter().map(|splats| splats.volume.reach_along(normal, radius));
            reaches.fold(0.0, f32::max)
        };
        let light = frame.light_direction(middle);
        let sheets = Sheets::between(frame.view_direction(), light, self.settings.count, &points, reach)?;
        let hulls = splats.iter().flat_map(|splats| splats.volume.hull(radius));
        let corners = self.surfaces.iter().flat_map(SurfacePictures::corners).copied();
        let light_camera = self.path.set(gpu, &sheets, frame, &hulls.chain(corners).collect::<Vec<_>>())?;
        let reversed = [frame.camera.is_reversed(), light_camera.is_reversed()];
        *self.reversed.lock().unwrap_or_else(PoisonError::into_inner) = reversed;
        let to = &self.uniforms;
        to.camera.write(gpu, &frame.camera);
        to.light_camera.write(gpu, &light_camera);
        to.light.write(gpu, &frame.light);
        to.sheets.write(gpu, &sheets);
        to.lighting.write(gpu, &frame.lighting);
        Ok(sheets)
    }

    /// Records the picture.
    ///
    /// # Errors
    /// [`SplattingError`].
    pub fn record(&self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder) -> Result<(), SplattingError> {
        let Passes { splat, light_splat, composite } = &self.passes;
        let order = &self.order;
        order.record(gpu, encoder)?;
        if let Some(surfaces) = &self.surfaces {
            surfaces.record(encoder, *self.reversed.lock().unwrap_or_else(PoisonError::into_inner));
        }
        for buffer in std::iter::once(&self.sum).chain(&self.surface_light) {
            encoder.clear_buffer(&buffer.raw, 0, None);
        }
        let light_sheets =
            LightSheets { pass: light_splat, order, means: &self.light, target: &self.light_means };
        self.path.begin(encoder, &light_sheets)?;
        // Nothing lies before the first sheet.
        self.eye.record(encoder, splat, order, u32::MAX, &self.means[2]);
        let draw = |encoder: &mut wgpu::CommandEncoder, index: u32| {
            self.eye.record(encoder, splat, order, index, &self.means[index as usize % 3]);
        };
        draw(encoder, 0);
        for (index, bound) in (0..self.settings.count).zip(&self.composites) {
            draw(encoder, index + 1);
            self.path.arrive(encoder, &light_sheets, index)?;
            if self.surface_light.is_some() {
                composite.dispatch_groups(encoder, bound, "composite_sheet", tiles(&self.picture))?;
            } else {
                composite.dispatch_indirect(encoder, bound, "composite_sheet", order.over_picture(index))?;
            }
            self.path.leave(encoder, &light_sheets, index)?;
        }
        if let Some(bound) = self.composites.first() {
            composite.dispatch_groups(encoder, bound, "show_sheets", tiles(&self.picture))?;
        }
        Ok(())
    }

    /// Bytes of its textures and larger buffers, without those of the splats.
    pub fn memory(&self) -> u64 {
        let textures = self.means.iter().chain([&self.light_means, &self.picture]);
        let textures: u64 = textures.map(Texture::memory).sum();
        textures + self.sum.raw.size() + self.order.memory() + self.path.memory()
    }

    /// What is left of the light behind the last sheet, linear RGB; rgba16float.
    pub fn shadow(&self) -> &Texture {
        self.path.shadow()
    }

    /// What the medium sends back to the light, linear RGB, where it is scattered back; rgba16float.
    pub fn returned(&self) -> Option<&Texture> {
        self.path.returned()
    }
}
