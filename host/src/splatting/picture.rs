// SPDX-License-Identifier: MIT OR Apache-2.0
//! Sheet after sheet into a picture and a shadow buffer.

use super::error::in_range;
use super::light_path::{DirectLight, LightPath, LightSheets};
use super::means::Means;
use super::order::{Order, tiles};
use super::passes::{LIGHT, MEANS, Passes};
use super::{
    LightTransport, SheetFrame, SheetInputs, SheetLighting, SheetNumber, SheetSettings, Sheets, Splats,
    SplattingError,
};
use crate::core::{Camera, Light};
use crate::gpu::Gpu;
use crate::pass::{Bound, Resource};
use crate::resource::{Buffer, Sampler, Texture};
use crate::shaders::Shaders;
use encase::ShaderType;
use glam::Vec3;

/// Volumes drawn sheet by sheet.
pub struct SheetPicture<'a> {
    splats: &'a [Splats],
    settings: SheetSettings,
    passes: Passes,
    uniforms: Uniforms,
    order: Order<'a>,
    eye: Means,
    light: Means,
    path: Box<dyn LightPath>,
    sum: Buffer,
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
        inputs: SheetInputs<'a>,
        settings: SheetSettings,
        size: [u32; 2],
    ) -> Result<Self, SplattingError> {
        let SheetInputs { splats, transfer, light_texture } = inputs;
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
        let passes = Passes::new(gpu, shaders, settings.shading, settings.scanning)?;
        let picture = Texture::storage(gpu, size, LIGHT);
        let light_means = Texture::target(gpu, settings.light_size, MEANS);
        let sheets = [&uniforms.sheets, &uniforms.kernel];
        let targets = [&picture, &light_means];
        let order = Order::new(gpu, shaders, splats, sheets, targets, settings.count, settings.scanning)?;
        let numbers: Vec<Buffer> = (0..settings.count).map(|index| number(gpu, index)).collect();
        let eye = Means::new(gpu, &passes.splat, &order, &uniforms.camera, sheets, &numbers, None)?;
        let light = Means::new(gpu, &passes.splat, &order, &uniforms.light_camera, sheets, &numbers, None)?;
        let means = [0; 3].map(|_| Texture::target(gpu, size, MEANS));
        let sum = Buffer::storage(gpu, 16 * u64::from(size[0]) * u64::from(size[1]));
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
        all.extend(light_texture.map(|texture| ("light_texture", texture.into())));
        let path: Box<dyn LightPath> = match settings.transport {
            LightTransport::Direct => {
                let textured = light_texture.is_some();
                Box::new(DirectLight::new(gpu, shaders, &all, settings.light_size, textured)?)
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
            passes,
            uniforms,
            order,
            eye,
            light,
            path,
            sum,
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
        let points: Vec<Vec3> =
            self.splats.iter().flat_map(|splats| splats.corners.iter().copied()).collect();
        let middle = points.iter().sum::<Vec3>() / points.len().max(1) as f32;
        let radius = self.settings.kernel.radius;
        let reach = |normal| {
            let reaches = self.splats.iter().map(|splats| splats.volume.reach_along(normal, radius));
            reaches.fold(0.0, f32::max)
        };
        let light = frame.light_direction(middle);
        let sheets = Sheets::between(frame.view_direction(), light, self.settings.count, &points, reach)?;
        let to = &self.uniforms;
        to.camera.write(gpu, &frame.camera);
        to.light_camera.write(gpu, &frame.light_camera(self.settings.light_size));
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
        let Passes { splat, composite } = &self.passes;
        let order = &self.order;
        order.record(gpu, encoder)?;
        encoder.clear_buffer(&self.sum.raw, 0, None);
        let light_sheets = LightSheets { pass: splat, order, means: &self.light, target: &self.light_means };
        self.path.begin(encoder, &light_sheets)?;
        begin_clear(encoder, &self.means[2]);
        let draw = |encoder: &mut wgpu::CommandEncoder, index: u32| {
            self.eye.record(encoder, splat, order, index, &self.means[index as usize % 3]);
        };
        draw(encoder, 0);
        for (index, bound) in (0..self.settings.count).zip(&self.composites) {
            draw(encoder, index + 1);
            self.path.arrive(encoder, &light_sheets, index)?;
            composite.dispatch_indirect(encoder, bound, "composite_sheet", order.over_picture(index))?;
            self.path.leave(encoder, &light_sheets, index)?;
        }
        if let Some(bound) = self.composites.first() {
            composite.dispatch_groups(encoder, bound, "show_sheets", tiles(&self.picture))?;
        }
        Ok(())
    }

    /// What is left of the light behind the last sheet, linear RGB; rgba16float.
    pub fn shadow(&self) -> &Texture {
        self.path.shadow()
    }
}

fn number(gpu: &Gpu, index: u32) -> Buffer {
    Buffer::uniform(gpu, &SheetNumber { index, reserved_a: 0, reserved_b: 0, reserved_c: 0 })
}

fn begin_clear(encoder: &mut wgpu::CommandEncoder, target: &Texture) {
    drop(crate::pass::begin_target(encoder, target, wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT)));
}
