// SPDX-License-Identifier: MIT OR Apache-2.0
//! Sheet after sheet into a picture and a shadow buffer.

use super::error::in_range;
use super::passes::{GROUP, LIGHT, MEANS, Passes, draw, rows_of_groups};
use super::splats::Batch;
use super::{Kernel, SheetNumber, SheetTargets, Sheets, Splats, SplattingError};
use crate::core::{Camera, DIRECTIONAL, Light, Sort, Transfer};
use crate::gpu::Gpu;
use crate::pass::{Bound, Resource};
use crate::resource::{Buffer, Sampler, Texture};
use crate::shaders::Shaders;
use encase::ShaderType;
use glam::{UVec2, Vec2, Vec3};

/// Columns and rows of a workgroup over pixels.
const TILE: [u32; 2] = [16, 8];

/// What the medium does with light.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Shading {
    /// It scatters by a phase function, like droplets.
    #[default]
    Scattering,
    /// It reflects by Phong across its gradient, like surfaces.
    Phong,
}

/// The uniform `SheetLighting` of `splatting/sheet_shading`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct SheetLighting {
    /// Radiance from all around, linear RGB.
    pub ambient: Vec3,
    /// Extinction where the transfer function's opacity is 1, 1/m.
    pub extinction: f32,
    /// Mean cosine of the phase function.
    pub g: f32,
    /// Share of diffuse reflection.
    pub diffuse: f32,
    /// Share of mirror-like reflection.
    pub specular: f32,
    /// Exponent of mirror-like reflection.
    pub shininess: f32,
}

impl SheetLighting {
    /// A medium of an extinction where the transfer function's opacity is 1, 1/m; isotropic, with dull reflection.
    pub fn new(extinction: f32) -> Self {
        Self { ambient: Vec3::ZERO, extinction, g: 0.0, diffuse: 0.8, specular: 0.3, shininess: 24.0 }
    }

    fn check(&self) -> Result<(), SplattingError> {
        let most = 1e6;
        let range = "from 0 to 1000000";
        in_range("extinction", self.extinction, 0.0..=most, range)?;
        for ambient in self.ambient.to_array() {
            in_range("ambient radiance", ambient, 0.0..=65504.0, "from 0 to 65504")?;
        }
        in_range("mean cosine", self.g, -0.99..=0.99, "from -0.99 to 0.99")?;
        in_range("diffuse share", self.diffuse, 0.0..=most, range)?;
        in_range("specular share", self.specular, 0.0..=most, range)?;
        in_range("shininess", self.shininess, 1.0..=10_000.0, "from 1 to 10000")
    }
}

/// How sheets are drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SheetSettings {
    /// How many.
    pub count: u32,
    /// Columns and rows of the shadow buffer.
    pub light_size: [u32; 2],
    /// Of all splats.
    pub kernel: Kernel,
    /// What the medium does with light.
    pub shading: Shading,
    /// Every sheet looks at all splats, unsorted: for comparison.
    pub scanning: bool,
}

impl Default for SheetSettings {
    fn default() -> Self {
        Self {
            count: 128,
            light_size: [512; 2],
            kernel: Kernel::default(),
            shading: Shading::Scattering,
            scanning: false,
        }
    }
}

/// Who looks at what in which light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SheetFrame {
    /// A camera of the picture's size.
    pub camera: Camera,
    /// The light; its map has to hold the volume.
    pub light: Light,
    /// Of the medium.
    pub lighting: SheetLighting,
}

impl SheetFrame {
    /// The light as a camera of pictures of `size`.
    fn light_camera(&self, size: [u32; 2]) -> Camera {
        let light = &self.light;
        Camera {
            clip_from_world: light.clip_from_world,
            world_from_clip: light.world_from_clip,
            eye: light.position,
            near_depth: 1.0 - light.far_depth,
            viewport: Vec2::from(size.map(|side| side as f32)),
            far_depth: light.far_depth,
            projection: u32::from(light.kind == DIRECTIONAL),
        }
    }

    /// In which the eye looks.
    fn view_direction(&self) -> Vec3 {
        let camera = &self.camera;
        if camera.projection == 1 {
            return camera.world_from_clip.z_axis.truncate() * (camera.far_depth - camera.near_depth);
        }
        camera.clip_from_world.transpose().w_axis.truncate()
    }

    /// In which light goes at a point.
    fn light_direction(&self, point: Vec3) -> Vec3 {
        if self.light.kind == DIRECTIONAL { -self.light.direction } else { point - self.light.position }
    }
}

struct SortedBatch {
    ranges: Buffer,
    draws: Buffer,
    order: Bound,
}

/// What is bound of one sheet.
struct Step {
    eye: Vec<Bound>,
    light: Vec<Bound>,
    composite: Bound,
    left: Bound,
}

/// A volume drawn sheet by sheet.
pub struct SheetPicture<'a> {
    splats: &'a Splats,
    settings: SheetSettings,
    passes: Passes,
    sort: Sort,
    uniforms: Uniforms,
    sorted: Vec<SortedBatch>,
    /// Of each sheet, groups over the picture and over the shadow buffer where it has splats.
    dispatches: Buffer,
    sum: Buffer,
    left: Buffer,
    means: [Texture; 3],
    light_means: Texture,
    steps: Vec<Step>,
    /// Linear RGB radiance of the medium, and the transmittance to what lies behind; rgba16float.
    pub picture: Texture,
    /// What is left of the light behind the last sheet, linear RGB; rgba16float.
    pub shadow: Texture,
}

struct Uniforms {
    camera: Buffer,
    light_camera: Buffer,
    light: Buffer,
    sheets: Buffer,
    kernel: Buffer,
    lighting: Buffer,
}

impl<'a> SheetPicture<'a> {
    /// Builds passes and buffers for pictures of `size`.
    ///
    /// # Errors
    /// [`SplattingError`].
    pub fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        splats: &'a Splats,
        transfer: &Transfer,
        settings: SheetSettings,
        size: [u32; 2],
    ) -> Result<Self, SplattingError> {
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
        let storage = |bytes: u64| Buffer::storage(gpu, bytes);
        let uniforms = Uniforms {
            camera: storage(Camera::min_size().get()),
            light_camera: storage(Camera::min_size().get()),
            light: storage(Light::min_size().get()),
            sheets: storage(Sheets::min_size().get()),
            kernel: Buffer::uniform(gpu, &settings.kernel),
            lighting: storage(SheetLighting::min_size().get()),
        };
        // Where nothing is sorted, every sheet draws everything.
        let indirect = |all: &[u32]| {
            let word = |word: &u32| if settings.scanning { *word } else { 0 };
            let bytes: Vec<u8> = all.iter().flat_map(|all| word(all).to_le_bytes()).collect();
            let bytes = bytes.repeat(settings.count as usize);
            Buffer::with_bytes(gpu, &bytes, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::INDIRECT)
        };
        let groups = |[width, height]: [u32; 2]| [width.div_ceil(TILE[0]), height.div_ceil(TILE[1])];
        let [picture, shadow] = [size, settings.light_size].map(groups);
        let targets = Buffer::uniform(
            gpu,
            &SheetTargets { picture: UVec2::from(picture), shadow: UVec2::from(shadow) },
        );
        let vectors = |[width, height]: [u32; 2]| storage(16 * u64::from(width) * u64::from(height));
        let mut made = Self {
            splats,
            settings,
            passes: Passes::new(gpu, shaders, settings.shading, settings.scanning)?,
            sort: Sort::new(gpu, shaders)?,
            uniforms,
            sorted: Vec::new(),
            dispatches: indirect(&[picture[0], picture[1], 1, 0, shadow[0], shadow[1], 1, 0]),
            sum: vectors(size),
            left: vectors(settings.light_size),
            means: [0; 3].map(|_| Texture::target(gpu, size, MEANS)),
            light_means: Texture::target(gpu, settings.light_size, MEANS),
            steps: Vec::new(),
            picture: Texture::storage(gpu, size, LIGHT),
            shadow: Texture::storage(gpu, settings.light_size, LIGHT),
        };
        for batch in &splats.batches {
            let (ranges, draws) = (storage(8 * u64::from(settings.count)), indirect(&[6, batch.count, 0, 0]));
            let resources = [
                ("volume", (&splats.uniform).into()),
                ("sheets", (&made.uniforms.sheets).into()),
                ("kernel", (&made.uniforms.kernel).into()),
                ("batch", (&batch.uniform).into()),
                ("splats", (&batch.splats).into()),
                ("keys", (&batch.keys).into()),
                ("order", (&batch.order).into()),
                ("ranges", (&ranges).into()),
                ("draws", (&draws).into()),
                ("dispatches", (&made.dispatches).into()),
                ("targets", (&targets).into()),
            ];
            let order = made.passes.order.bind(gpu, &resources)?;
            made.sorted.push(SortedBatch { ranges, draws, order });
        }
        let sampler = Sampler::linear(gpu);
        for index in 0..settings.count {
            let number = SheetNumber { index, reserved_a: 0, reserved_b: 0, reserved_c: 0 };
            let step = made.step(gpu, &Buffer::uniform(gpu, &number), index as usize, transfer, &sampler)?;
            made.steps.push(step);
        }
        Ok(made)
    }

    fn step(
        &self,
        gpu: &Gpu,
        number: &Buffer,
        index: usize,
        transfer: &Transfer,
        sampler: &Sampler,
    ) -> Result<Step, SplattingError> {
        let Uniforms { camera, light_camera, light, sheets, kernel, lighting } = &self.uniforms;
        let splat = |camera: &Buffer| -> Result<Vec<Bound>, SplattingError> {
            let of_batch = |(batch, sorted): (&Batch, &SortedBatch)| {
                let resources: [(&str, Resource<'_>); 8] = [
                    ("camera", camera.into()),
                    ("volume", (&self.splats.uniform).into()),
                    ("sheets", sheets.into()),
                    ("kernel", kernel.into()),
                    ("number", number.into()),
                    ("splats", (&batch.splats).into()),
                    ("order", (&batch.order).into()),
                    ("ranges", (&sorted.ranges).into()),
                ];
                Ok(self.passes.splat.bind_known(gpu, &resources)?)
            };
            self.splats.batches.iter().zip(&self.sorted).map(of_batch).collect()
        };
        let mean = |offset: usize| Resource::from(&self.means[(index + 2 + offset) % 3]);
        let all = [
            ("camera", camera.into()),
            ("light_camera", light_camera.into()),
            ("light", light.into()),
            ("sheets", sheets.into()),
            ("lighting", lighting.into()),
            ("number", number.into()),
            ("before", mean(0)),
            ("sheet", mean(1)),
            ("behind", mean(2)),
            ("light_sheet", (&self.light_means).into()),
            ("shadow", (&self.shadow).into()),
            ("transfer", (&transfer.texture).into()),
            ("linear_sampler", sampler.into()),
            ("sum", (&self.sum).into()),
            ("picture", (&self.picture).into()),
            ("left", (&self.left).into()),
        ];
        Ok(Step {
            eye: splat(camera)?,
            light: splat(light_camera)?,
            composite: self.passes.composite.bind_known(gpu, &all)?,
            left: self.passes.light.bind_known(gpu, &all)?,
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
        let corners = &self.splats.corners;
        let middle = corners.iter().sum::<Vec3>() / corners.len() as f32;
        let view = frame.view_direction();
        let radius = self.settings.kernel.radius;
        let reach = |normal| self.splats.volume.reach_along(normal, radius);
        let light = frame.light_direction(middle);
        let sheets = Sheets::between(view, light, self.settings.count, corners, reach)?;
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
        let count = self.settings.count;
        if !self.settings.scanning {
            self.order(gpu, encoder)?;
        }
        encoder.clear_buffer(&self.sum.raw, 0, None);
        let Passes { splat, light, composite, .. } = &self.passes;
        let Some(first) = self.steps.first() else { return Ok(()) };
        let tiles = |[width, height, _]: [u32; 3]| [width.div_ceil(TILE[0]), height.div_ceil(TILE[1]), 1];
        light.dispatch_groups(encoder, &first.left, "begin_light", tiles(self.shadow.size()))?;
        draw(encoder, &self.means[2], splat, 0, None);
        self.splat(encoder, 0);
        for (index, step) in (0..count).zip(&self.steps) {
            if index + 1 < count {
                self.splat(encoder, index + 1);
            } else {
                draw(encoder, &self.means[(index as usize + 1) % 3], splat, 0, None);
            }
            let batches = step.light.iter().zip(self.sorted.iter().map(|sorted| &sorted.draws));
            draw(encoder, &self.light_means, splat, index, batches);
            let groups = |part: u64| (&self.dispatches, 32 * u64::from(index) + 16 * part);
            composite.dispatch_indirect(encoder, &step.composite, "composite_sheet", groups(0))?;
            light.dispatch_indirect(encoder, &step.left, "light_sheet_left", groups(1))?;
        }
        composite.dispatch_groups(encoder, &first.composite, "show_sheets", tiles(self.picture.size()))?;
        Ok(())
    }

    /// Sorts splats by the first sheet that they reach.
    fn order(&self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder) -> Result<(), SplattingError> {
        let count = self.settings.count;
        encoder.clear_buffer(&self.dispatches.raw, 0, None);
        for (batch, sorted) in self.splats.batches.iter().zip(&self.sorted) {
            let groups = rows_of_groups(batch.count.div_ceil(GROUP));
            self.passes.order.dispatch_groups(encoder, &sorted.order, "first_sheets", groups)?;
            let bits = 32 - (count - 1).leading_zeros();
            self.sort.record(gpu, encoder, [&batch.keys, &batch.order], batch.count, bits.max(1))?;
            let groups = [count.div_ceil(64), 1, 1];
            self.passes.order.dispatch_groups(encoder, &sorted.order, "sheet_ranges", groups)?;
        }
        Ok(())
    }

    fn splat(&self, encoder: &mut wgpu::CommandEncoder, index: u32) {
        let batches =
            self.steps[index as usize].eye.iter().zip(self.sorted.iter().map(|sorted| &sorted.draws));
        let target = &self.means[index as usize % 3];
        draw(encoder, target, &self.passes.splat, index, batches);
    }
}
