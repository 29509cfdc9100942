// SPDX-License-Identifier: MIT OR Apache-2.0
//! A volume that is painted frame by frame: rays, what lies under strokes, strokes.

use super::{
    BrickRanges, Brushes, IsoBound, IsoForm, IsoFrame, IsoRaycast, IsoSettings, IsoTargets, IsoVolume,
    Orientation, PainterlyError, PainterlyStyle, SolidBricks, StrokeError, StrokeSettings, StrokeStep,
    StrokeTargets, Strokes, SurfaceLighting,
};
use crate::core::{Camera, Jitter, Transfer};
use crate::gpu::Gpu;
use crate::out_of_range::in_range;
use crate::pass::{Bound, Pass};
use crate::resource::{Buffer, Sampler, Texture};
use crate::shaders::Shaders;
use airlight_validate::Definitions;
use encase::ShaderType;
use glam::{Mat4, Vec2, Vec3};

/// Why a painting cannot be made as asked.
#[derive(Debug, thiserror::Error)]
pub enum PaintingError {
    /// The rays.
    #[error(transparent)]
    Rays(#[from] PainterlyError),
    /// The strokes.
    #[error(transparent)]
    Strokes(#[from] StrokeError),
}

/// The uniform `Canvas` of `painterly/underpaint`: what strokes are put on.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct Canvas {
    /// Linear RGB.
    pub color: Vec3,
    /// How much of the surface is painted under strokes, 0..1.
    pub underpainting: f32,
    /// Columns and rows of the picture; [`Painting`] knows them.
    pub picture_size: Vec2,
    /// Padding.
    pub reserved: Vec2,
}

impl Canvas {
    /// A colour in linear RGB, and how much of the surface is painted on it under strokes, 0..1.
    pub fn new(color: Vec3, underpainting: f32) -> Self {
        Self { color, underpainting, picture_size: Vec2::ONE, reserved: Vec2::ZERO }
    }

    fn check(&self) -> Result<(), PainterlyError> {
        for value in self.color.to_array() {
            in_range("colour of the canvas", value, 0.0..=65504.0, "from 0 to 65504")?;
        }
        Ok(in_range("underpainting", self.underpainting, 0.0..=1.0, "from 0 to 1")?)
    }
}

/// What is painted and with what.
pub struct PaintingSettings {
    /// Sizes of the picture and of what is cast, and room for strokes.
    pub strokes: StrokeSettings,
    /// The style; it says whether curvatures are cast.
    pub style: PainterlyStyle,
    /// Starts of rays.
    pub jitter: Jitter,
    /// Under the strokes.
    pub canvas: Canvas,
}

/// A volume before a camera, painted frame by frame.
pub struct Painting<'a> {
    volume: &'a IsoVolume,
    transfer: &'a Transfer,
    pass: IsoRaycast,
    rays: IsoBound,
    solid: SolidBricks,
    ranges: BrickRanges,
    /// Iso-value that bricks were last judged by.
    judged: Option<f32>,
    underpaint: Pass,
    ground: Bound,
    strokes: Strokes,
    before: Option<(Camera, Mat4)>,
    number: u32,
    /// Linear RGB radiance of the last frame, opaque; rgba16float.
    pub picture: Texture,
}

/// What is new in a frame of a painting.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PaintingFrame<'a> {
    /// A camera for pictures of as many pixels as there are rays. What moved since the last frame is known.
    pub camera: Camera,
    /// The volume's box 0..1 to the world, metres; affine.
    pub world_from_unit: Mat4,
    /// Which surface is seen.
    pub surface: &'a IsoSettings,
    /// In which light.
    pub lighting: &'a SurfaceLighting,
    /// Time since the frame before, seconds; with a second strokes are there at once.
    pub seconds: f32,
    /// Whether strokes are born.
    pub generation: bool,
    /// Whether strokes are deleted where they lie too densely.
    pub deletion: bool,
}

impl<'a> Painting<'a> {
    /// Builds everything, and finds the ranges of the volume's bricks.
    ///
    /// # Errors
    /// [`PaintingError`].
    pub fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        volume: &'a IsoVolume,
        transfer: &'a Transfer,
        brushes: Brushes,
        settings: PaintingSettings,
    ) -> Result<Self, PaintingError> {
        settings.canvas.check()?;
        let StrokeSettings { source_size, picture_size, .. } = settings.strokes;
        let form = IsoForm {
            jitter: settings.jitter,
            skipping: true,
            curvature: settings.style.orientation == Orientation::Curvature,
            ..IsoForm::default()
        };
        let strokes = Strokes::new(gpu, shaders, settings.style, brushes, settings.strokes)?;
        let pass = IsoRaycast::new(gpu, shaders, form)?;
        let rays = pass.bind(gpu, volume, transfer, source_size)?;
        let solid = SolidBricks::new(gpu, shaders)?;
        let mut encoder = gpu.encoder();
        let ranges = solid.ranges(gpu, &mut encoder, volume)?;
        gpu.submit(encoder).map_err(PainterlyError::from)?;

        let format = wgpu::TextureFormat::Rgba16Float;
        let (name, entry) = ("painterly/underpaint", "fragment_underpaint");
        let underpaint = Pass::picture(gpu, shaders, name, &Definitions::new(), entry, format)
            .map_err(PainterlyError::from)?;
        let size = Vec2::from(picture_size.map(|side| side as f32));
        let canvas = Buffer::uniform(gpu, &Canvas { picture_size: size, ..settings.canvas });
        let sampler = Sampler::linear(gpu);
        let resources = [
            ("canvas", (&canvas).into()),
            ("color", (&rays.targets.color).into()),
            ("linear_sampler", (&sampler).into()),
        ];
        let ground = underpaint.bind(gpu, &resources).map_err(PainterlyError::from)?;
        let picture = Texture::target(gpu, picture_size, format);
        Ok(Self {
            volume,
            transfer,
            pass,
            rays,
            solid,
            ranges,
            judged: None,
            underpaint,
            ground,
            strokes,
            before: None,
            number: 0,
            picture,
        })
    }

    /// Records a frame, to be submitted before the next one is recorded: rays are cast, strokes follow what they hit and are
    /// put in order, and [`Painting::picture`] is painted.
    ///
    /// # Errors
    /// [`PaintingError`].
    pub fn record(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        frame: &PaintingFrame<'_>,
    ) -> Result<(), PaintingError> {
        let PaintingFrame { camera, world_from_unit, surface, lighting, .. } = *frame;
        let (previous_camera, previous_world_from_unit) = self.before.unwrap_or((camera, world_from_unit));
        let cast = IsoFrame {
            camera,
            previous_camera,
            world_from_unit,
            previous_world_from_unit,
            number: self.number,
        };
        self.pass.set(gpu, &self.rays, self.volume, &cast, surface, lighting)?;
        if self.judged != Some(surface.iso_value) {
            self.solid.record(gpu, encoder, &self.ranges, self.transfer, &self.rays)?;
            self.judged = Some(surface.iso_value);
        }
        self.pass.record(encoder, &self.rays);
        let targets = &self.rays.targets;
        let seen = StrokeTargets {
            color: &targets.color,
            surface: &targets.surface,
            distance: &targets.distance,
            curvature: targets.curvature.as_ref(),
        };
        let PaintingFrame { seconds, generation, deletion, .. } = *frame;
        let step = StrokeStep { camera, world_from_unit, seconds, generation, deletion };
        self.strokes.record(gpu, encoder, &seen, &step)?;
        self.underpaint.fill(encoder, &self.ground, &self.picture);
        self.strokes.draw(gpu, encoder, &self.picture)?;
        self.before = Some((camera, world_from_unit));
        self.number = self.number.wrapping_add(1);
        Ok(())
    }

    /// The strokes, to be read or drawn elsewhere.
    pub fn strokes(&self) -> &Strokes {
        &self.strokes
    }

    /// What the rays of the last frame found.
    pub fn targets(&self) -> &IsoTargets {
        &self.rays.targets
    }
}
