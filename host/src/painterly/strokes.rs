// SPDX-License-Identifier: MIT OR Apache-2.0
//! Strokes that live from frame to frame, all on the GPU.

use super::stroke_data::STROKE_WORDS;
use super::stroke_passes::{StrokePasses, TARGET};
use super::{Brushes, Orientation, PainterlyStyle, Stroke, StrokeCounts, StrokeError, StrokeFrame};
use crate::core::Camera;
use crate::gpu::Gpu;
use crate::pass::{Pass, Render, Resource};
use crate::resource::{Buffer, Texture};
use crate::shaders::Shaders;
use glam::{Mat4, Vec2, Vec3};

/// Threads of a workgroup over strokes.
const THREADS: u32 = 64;
/// Strokes that a thread counts and lists, `CHUNK` of `painterly/stroke`.
const CHUNK: u32 = 32;
/// Columns and rows of pixels that a thread looks at for births, `BLOCK` of `painterly/stroke`.
const BLOCK: [u32; 2] = [8, 4];
/// Columns and rows of a workgroup over blocks.
const TILE: [u32; 2] = [8, 8];
/// Bytes before the arguments of the draw of densities among the counts.
const DENSITY_DRAW: u64 = 48;
/// Bytes of a stroke.
const STROKE_BYTES: u64 = 4 * STROKE_WORDS as u64;

/// Sizes of what strokes need.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StrokeSettings {
    /// Strokes that there may be at a time. Where more would be born they are dropped, and counted.
    pub capacity: u32,
    /// Columns and rows of what the ray caster writes.
    pub source_size: [u32; 2],
    /// Columns and rows of the picture that strokes are drawn into.
    pub picture_size: [u32; 2],
    /// Pixels of the picture along the side of a texel of the density, at most the width of the thinnest stroke.
    pub density_step: u32,
    /// Other seeds give other strokes.
    pub seed: u32,
}

impl StrokeSettings {
    /// Room for 98304 strokes, and a density of four pixels a texel.
    pub fn new(source_size: [u32; 2], picture_size: [u32; 2]) -> Self {
        Self { capacity: 98_304, source_size, picture_size, density_step: 4, seed: 1 }
    }
}

/// What the ray caster writes, all of one size.
#[derive(Clone, Copy)]
pub struct StrokeTargets<'a> {
    /// Premultiplied linear RGB, alpha 1 on the surface.
    pub color: &'a Texture,
    /// Unit normal in the world, and gradient magnitude.
    pub surface: &'a Texture,
    /// Metres along the view ray, negative where there is no surface.
    pub distance: &'a Texture,
    /// Principal curvatures and direction; needed for [`Orientation::Curvature`] only.
    pub curvature: Option<&'a Texture>,
}

/// What is new in a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StrokeStep {
    /// The camera that the targets were cast with.
    pub camera: Camera,
    /// Unit space of the volume to the world, metres.
    pub world_from_unit: Mat4,
    /// Time since the frame before, seconds. With a second, strokes of the frame before fade in whole.
    pub seconds: f32,
    /// Whether strokes are born.
    pub generation: bool,
    /// Whether strokes are deleted where they lie too densely.
    pub deletion: bool,
}

/// Strokes on a surface.
pub struct Strokes {
    passes: StrokePasses,
    settings: StrokeSettings,
    style: PainterlyStyle,
    brushes: Brushes,
    frame: StrokeFrame,
    /// Those of now, and room for those of the next frame.
    buffers: [Buffer; 2],
    counts: Buffer,
    marks: Buffer,
    birth_bits: Buffer,
    sources: Buffer,
    layer_marks: Buffer,
    order: Buffer,
    /// Density of the layers in the channels, of the last frame before births and deletions; rgba16float.
    pub density: Texture,
}

impl Strokes {
    /// Builds passes and buffers; there are no strokes yet.
    ///
    /// # Errors
    /// [`StrokeError`].
    pub fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        style: PainterlyStyle,
        brushes: Brushes,
        settings: StrokeSettings,
    ) -> Result<Self, StrokeError> {
        check_settings(gpu, &settings)?;
        check_style(&style, &brushes)?;
        let capacity = u64::from(settings.capacity);
        let words = |count: u64| Buffer::storage(gpu, 4 * count);
        let [columns, rows] = blocks_of(settings.source_size);
        let (chunks, blocks) = (settings.capacity.div_ceil(CHUNK), columns * rows);
        let first = StrokeCounts { draws: 1, ..Default::default() };
        let mut bytes = encase::UniformBuffer::new(Vec::<u8>::new());
        bytes.write(&first).unwrap_or_default();
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::INDIRECT;
        let density_size = settings.picture_size.map(|side| side.div_ceil(settings.density_step.max(1)));
        Ok(Self {
            passes: StrokePasses::new(gpu, shaders, style.orientation == Orientation::Curvature)?,
            frame: StrokeFrame {
                world_from_unit: Mat4::IDENTITY,
                unit_from_world: Mat4::IDENTITY,
                picture_size: Vec2::from(settings.picture_size.map(|side| side as f32)),
                seconds: 0.0,
                frame: 0,
                areas: Vec3::ZERO,
                seed: settings.seed,
                capacity: settings.capacity,
                generation: 0.0,
                deletion: 0.0,
                reserved: 0.0,
            },
            buffers: [0; 2].map(|_| Buffer::storage(gpu, STROKE_BYTES * capacity)),
            counts: Buffer::with_bytes(gpu, bytes.as_ref(), usage),
            marks: words(u64::from(chunks) + u64::from(blocks) + 1),
            birth_bits: words(u64::from(blocks)),
            sources: words(capacity),
            layer_marks: words(3 * u64::from(chunks) + 1),
            order: words(capacity),
            density: Texture::target(gpu, density_size, TARGET),
            settings,
            style,
            brushes,
        })
    }

    /// The style.
    pub fn style(&self) -> &PainterlyStyle {
        &self.style
    }

    /// The brushes.
    pub fn brushes(&self) -> &Brushes {
        &self.brushes
    }

    /// The sizes.
    pub fn settings(&self) -> &StrokeSettings {
        &self.settings
    }

    /// Changes the style from the next frame on. Strokes that are there take to it at its rates.
    ///
    /// # Errors
    /// [`StrokeError`]; [`StrokeError::Curvature`] where strokes were built for a style that does not follow curvature.
    pub fn set_style(&mut self, style: PainterlyStyle) -> Result<(), StrokeError> {
        check_style(&style, &self.brushes)?;
        if style.orientation == Orientation::Curvature && !self.passes.curvature {
            return Err(StrokeError::Curvature);
        }
        self.style = style;
        Ok(())
    }

    /// Records a frame: strokes move, fade, are deleted and born, and put in order.
    ///
    /// # Errors
    /// [`StrokeError`].
    pub fn record(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        targets: &StrokeTargets<'_>,
        step: &StrokeStep,
    ) -> Result<(), StrokeError> {
        self.check_targets(targets)?;
        self.frame = self.next_frame(step)?;
        let frame = Buffer::uniform(gpu, &self.frame);
        let style = Buffer::uniform(gpu, &self.style.uniform());
        let camera = Buffer::uniform(gpu, &step.camera);
        let [strokes, kept] = &self.buffers;
        let resources = |strokes| {
            let mut resources = vec![
                ("color", Resource::from(targets.color)),
                ("surface", targets.surface.into()),
                ("distances", targets.distance.into()),
                ("camera", (&camera).into()),
                ("frame", (&frame).into()),
                ("style", (&style).into()),
                ("strokes", strokes),
                ("kept", kept.into()),
                ("density", (&self.density).into()),
                ("counts", (&self.counts).into()),
                ("marks", (&self.marks).into()),
                ("birth_bits", (&self.birth_bits).into()),
                ("sources", (&self.sources).into()),
                ("layer_marks", (&self.layer_marks).into()),
                ("order", (&self.order).into()),
                ("brushes", (&self.brushes.texture).into()),
                ("brush_sampler", (&self.brushes.sampler).into()),
            ];
            resources.extend(targets.curvature.map(|texture| ("curvature", texture.into())));
            resources
        };
        let passes = &self.passes;
        let (now, next) = (resources(strokes.into()), resources(kept.into()));
        let of_strokes = [self.settings.capacity.div_ceil(THREADS), 1, 1];
        let chunks = self.settings.capacity.div_ceil(CHUNK);
        let of_chunks = [chunks.div_ceil(THREADS), 1, 1];
        let [columns, rows] = blocks_of(self.settings.source_size);
        let of_blocks = [columns.div_ceil(TILE[0]), rows.div_ceil(TILE[1]), 1];

        let bound = passes.update.bind_known(gpu, &now)?;
        passes.update.dispatch_groups(encoder, &bound, "update_strokes", of_strokes)?;

        let bound = passes.density.bind_known(gpu, &now)?;
        let none = Some(wgpu::Color::TRANSPARENT);
        self.draw_indirect(encoder, &passes.density, &bound, &self.density, none, DENSITY_DRAW);

        let bound = passes.population.bind_known(gpu, &now)?;
        passes.population.dispatch_groups(encoder, &bound, "thin_strokes", of_strokes)?;
        passes.population.dispatch_groups(encoder, &bound, "count_survivors", of_chunks)?;
        passes.population.dispatch_groups(encoder, &bound, "place_strokes", of_blocks)?;
        passes.scan.record(gpu, encoder, &self.marks, chunks + columns * rows + 1)?;

        let bound = passes.compact.bind_known(gpu, &now)?;
        passes.compact.dispatch_groups(encoder, &bound, "list_survivors", of_chunks)?;
        passes.compact.dispatch_groups(encoder, &bound, "list_births", of_blocks)?;
        passes.compact.dispatch_groups(encoder, &bound, "count_strokes", [1, 1, 1])?;
        passes.compact.dispatch_groups(encoder, &bound, "gather_strokes", of_strokes)?;

        let bound = passes.order.bind_known(gpu, &next)?;
        passes.order.dispatch_groups(encoder, &bound, "count_layers", of_chunks)?;
        passes.scan.record(gpu, encoder, &self.layer_marks, 3 * chunks + 1)?;
        passes.order.dispatch_groups(encoder, &bound, "order_strokes", of_chunks)?;
        self.buffers.swap(0, 1);
        Ok(())
    }

    /// Records the picture of the strokes of the last frame, over what is in `picture`: rgba16float of the announced size,
    /// premultiplied linear RGB.
    ///
    /// # Errors
    /// [`StrokeError`].
    pub fn draw(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        picture: &Texture,
    ) -> Result<(), StrokeError> {
        check_size_of("the picture", picture, self.settings.picture_size)?;
        let (frame, style) = (Buffer::uniform(gpu, &self.frame), Buffer::uniform(gpu, &self.style.uniform()));
        let resources = [
            ("frame", (&frame).into()),
            ("style", (&style).into()),
            ("strokes", (&self.buffers[0]).into()),
            ("order", (&self.order).into()),
            ("brushes", (&self.brushes.texture).into()),
            ("brush_sampler", (&self.brushes.sampler).into()),
        ];
        let bound = self.passes.draw.bind(gpu, &resources)?;
        self.draw_indirect(encoder, &self.passes.draw, &bound, picture, None, 0);
        Ok(())
    }

    /// Counts of the last frame that was submitted. Waits for the GPU.
    ///
    /// # Errors
    /// [`StrokeError`].
    pub fn read_counts(&self, gpu: &Gpu) -> Result<StrokeCounts, StrokeError> {
        Ok(StrokeCounts::from_words(&self.counts.read_words(gpu)?))
    }

    /// The strokes of the last frame that was submitted, in the order of their buffer. Waits for the GPU.
    ///
    /// # Errors
    /// [`StrokeError`].
    pub fn read(&self, gpu: &Gpu) -> Result<Vec<Stroke>, StrokeError> {
        let count = self.read_counts(gpu)?.instances as usize;
        let words = self.buffers[0].read_words(gpu)?;
        Ok(words.chunks_exact(STROKE_WORDS).take(count).map(Stroke::from_words).collect())
    }

    /// Numbers of strokes in the order that they are drawn in. Waits for the GPU.
    ///
    /// # Errors
    /// [`StrokeError`].
    pub fn read_order(&self, gpu: &Gpu) -> Result<Vec<u32>, StrokeError> {
        let count = self.read_counts(gpu)?.instances as usize;
        let mut order = self.order.read_words(gpu)?;
        order.truncate(count);
        Ok(order)
    }

    /// Bytes of all buffers and of the density.
    pub fn memory(&self) -> u64 {
        let one =
            [&self.counts, &self.marks, &self.birth_bits, &self.sources, &self.layer_marks, &self.order];
        let buffers = one.into_iter().chain(&self.buffers).map(|buffer| buffer.raw.size()).sum::<u64>();
        buffers + self.density.memory()
    }

    fn draw_indirect(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        pass: &Pass,
        bound: &crate::pass::Bound,
        target: &Texture,
        clear: Option<wgpu::Color>,
        arguments: u64,
    ) {
        let load = clear.map_or(wgpu::LoadOp::Load, wgpu::LoadOp::Clear);
        let mut render = Render::onto(encoder, target, load);
        render.set(pass, bound);
        render.draw_indirect(&self.counts, arguments);
    }

    fn next_frame(&self, step: &StrokeStep) -> Result<StrokeFrame, StrokeError> {
        let inverse = step.world_from_unit.as_dmat4().inverse().as_mat4();
        if !step.world_from_unit.is_finite() || !inverse.is_finite() {
            return Err(StrokeError::Transform);
        }
        let pixels = |[width, height]: [u32; 2]| width as f32 * height as f32;
        let scale = pixels(self.settings.source_size) / pixels(self.settings.picture_size);
        Ok(StrokeFrame {
            world_from_unit: step.world_from_unit,
            unit_from_world: inverse,
            seconds: if step.seconds.is_finite() { step.seconds.clamp(0.0, 3600.0) } else { 0.0 },
            frame: self.frame.frame.wrapping_add(1),
            areas: self.style.areas(&self.brushes) * scale,
            generation: f32::from(u8::from(step.generation)),
            deletion: f32::from(u8::from(step.deletion)),
            ..self.frame
        })
    }

    fn check_targets(&self, targets: &StrokeTargets<'_>) -> Result<(), StrokeError> {
        if self.passes.curvature && targets.curvature.is_none() {
            return Err(StrokeError::Curvature);
        }
        let named = [("color", targets.color), ("surface", targets.surface), ("distance", targets.distance)];
        for (what, texture) in named.into_iter().chain(targets.curvature.map(|it| ("curvature", it))) {
            check_size_of(what, texture, self.settings.source_size)?;
        }
        Ok(())
    }
}

/// Columns and rows of blocks.
fn blocks_of([width, height]: [u32; 2]) -> [u32; 2] {
    [width.div_ceil(BLOCK[0]), height.div_ceil(BLOCK[1])]
}

fn check_size_of(what: &'static str, texture: &Texture, expected: [u32; 2]) -> Result<(), StrokeError> {
    let [width, height, _] = texture.size();
    if [width, height] == expected {
        Ok(())
    } else {
        Err(StrokeError::OtherSize { what, given: [width, height], expected })
    }
}

fn check_style(style: &PainterlyStyle, brushes: &Brushes) -> Result<(), StrokeError> {
    style.check()?;
    for (layer, of) in PainterlyStyle::LAYERS.into_iter().zip(style.layers()) {
        if let Some(brush) = of.brush.filter(|brush| *brush >= brushes.count()) {
            return Err(StrokeError::MissingBrush { layer, brush, count: brushes.count() });
        }
    }
    Ok(())
}

fn check_settings(gpu: &Gpu, settings: &StrokeSettings) -> Result<(), StrokeError> {
    let side = gpu.limits.max_texture_dimension_2d.min(65_535);
    for (what, [width, height]) in
        [("the source", settings.source_size), ("the picture", settings.picture_size)]
    {
        if width == 0 || height == 0 || width > side || height > side {
            return Err(StrokeError::Size { what, width, height, limit: side });
        }
    }
    let bytes = u64::from(gpu.limits.max_storage_buffer_binding_size as u32);
    let by_groups = u64::from(gpu.limits.max_compute_workgroups_per_dimension) * u64::from(THREADS);
    let limit = (bytes / STROKE_BYTES).min(by_groups) as u32;
    if settings.capacity == 0 || settings.capacity > limit {
        return Err(StrokeError::Capacity { given: settings.capacity, limit });
    }
    Ok(())
}
