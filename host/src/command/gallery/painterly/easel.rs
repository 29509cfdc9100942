// SPDX-License-Identifier: MIT OR Apache-2.0
//! A motif on the device: cast by rays, or painted.

use super::super::studio::Studio;
use super::Motif;
use crate::Texture;
use crate::command::CommandError;
use crate::core::{Camera, DepthRange, Jitter, PerspectiveView, TRANSFERS, Transfer, parse_transfer};
use crate::data::Volume;
use crate::painterly::{
    Brushes, Canvas, IsoBound, IsoForm, IsoFrame, IsoRaycast, IsoSettings, IsoVolume, PainterlyStyle,
    Painting, PaintingFrame, PaintingSettings, STYLES, Stroke, StrokeSettings, SurfaceLighting, parse_style,
};
use glam::Vec3;

/// Frames in which a still picture fills with strokes; each takes a second, in which strokes of the one before become opaque.
const FRAMES: u32 = 6;
/// How much of the surface is painted thinly under the strokes.
const UNDERPAINTING: f32 = 0.55;

/// A motif, the same on the device, and its light.
pub struct Easel<'a> {
    studio: &'a Studio,
    /// What is shown.
    pub motif: &'static Motif,
    volume: Volume,
    uploaded: IsoVolume,
    transfer: Transfer,
    lighting: SurfaceLighting,
}

/// A painting that was read back.
pub struct Painted {
    /// 4 bytes a pixel.
    pub pixels: Vec<u8>,
    /// Its strokes, in the order that they are drawn in.
    pub strokes: Vec<Stroke>,
}

impl<'a> Easel<'a> {
    /// Uploads a motif.
    pub fn new(studio: &'a Studio, motif: &'static Motif) -> Result<Self, CommandError> {
        let (name, text) = named(&TRANSFERS, motif.transfer)?;
        let function = parse_transfer(name, text).map_err(CommandError::failure)?;
        let volume = motif.volume()?;
        let uploaded = IsoVolume::new(&studio.gpu, &volume, function.range).map_err(CommandError::failure)?;
        let transfer = function.upload(&studio.gpu).map_err(CommandError::failure)?;
        // Warm light from one side, cool light from all around.
        let lighting = SurfaceLighting {
            radiance: Vec3::new(1.35, 1.15, 0.85),
            ambient: Vec3::new(0.19, 0.19, 0.36),
            ..SurfaceLighting::towards(motif.towards_light).map_err(CommandError::failure)?
        };
        Ok(Self { studio, motif, volume, uploaded, transfer, lighting })
    }

    fn camera(&self, size: [u32; 2]) -> Result<Camera, CommandError> {
        let view = PerspectiveView {
            eye: self.motif.eye,
            target: self.motif.target,
            field_of_view: 30.0,
            near: 0.01,
            far: 10.0,
            depth: DepthRange::Forward,
        };
        Camera::perspective(&view, size).map_err(CommandError::failure)
    }

    fn surface(&self, degrees: f32) -> IsoSettings {
        IsoSettings { refinements: 5, clip_planes: self.motif.clip_planes(degrees), ..Default::default() }
    }

    /// What rays find, turned by as many degrees since the frame before as `flow`.
    pub fn cast(&self, form: IsoForm, flow: f32) -> Result<IsoBound, CommandError> {
        let Studio { gpu, shaders, size, .. } = self.studio;
        let pass = IsoRaycast::new(gpu, shaders, form).map_err(CommandError::failure)?;
        let bound = pass.bind(gpu, &self.uploaded, &self.transfer, *size).map_err(CommandError::failure)?;
        let frame = IsoFrame {
            previous_world_from_unit: self.motif.world_from_unit(&self.volume, -flow),
            ..IsoFrame::still(self.camera(*size)?, self.motif.world_from_unit(&self.volume, 0.0))
        };
        pass.set(gpu, &bound, &self.uploaded, &frame, &self.surface(0.0), &self.lighting)
            .map_err(CommandError::failure)?;
        let mut encoder = gpu.encoder();
        pass.record(&mut encoder, &bound);
        gpu.submit(encoder)?;
        Ok(bound)
    }

    /// A painting without strokes. `scale`: side of its sources over that of its picture.
    pub fn painting(&self, style: PainterlyStyle, scale: f32) -> Result<Painting<'_>, CommandError> {
        let Studio { gpu, shaders, size, .. } = self.studio;
        let source = source_size(*size, scale);
        let settings = PaintingSettings {
            strokes: StrokeSettings::new(source, *size),
            style,
            jitter: Jitter::None,
            canvas: Canvas::new(self.motif.canvas, UNDERPAINTING),
        };
        let brushes = Brushes::procedural(gpu).map_err(CommandError::failure)?;
        Painting::new(gpu, shaders, &self.uploaded, &self.transfer, brushes, settings)
            .map_err(CommandError::failure)
    }

    /// Paints a frame. `changes`: whether strokes are born and deleted.
    pub fn paint(
        &self,
        painting: &mut Painting<'_>,
        degrees: f32,
        seconds: f32,
        changes: bool,
    ) -> Result<(), CommandError> {
        let gpu = &self.studio.gpu;
        let surface = self.surface(degrees);
        let frame = PaintingFrame {
            camera: self.camera(painting.strokes().settings().source_size)?,
            world_from_unit: self.motif.world_from_unit(&self.volume, degrees),
            surface: &surface,
            lighting: &self.lighting,
            seconds,
            generation: changes,
            deletion: changes,
        };
        let mut encoder = gpu.encoder();
        painting.record(gpu, &mut encoder, &frame).map_err(CommandError::failure)?;
        gpu.submit(encoder)?;
        Ok(())
    }

    /// Fills a painting that stands still with strokes.
    pub fn fill(&self, painting: &mut Painting<'_>) -> Result<(), CommandError> {
        (0..FRAMES).try_for_each(|_| self.paint(painting, 0.0, 1.0, true))
    }

    /// A still painting.
    pub fn still(&self, style: PainterlyStyle, scale: f32) -> Result<Painted, CommandError> {
        let mut painting = self.painting(style, scale)?;
        self.fill(&mut painting)?;
        self.read(&painting)
    }

    /// Reads a painting back.
    pub fn read(&self, painting: &Painting<'_>) -> Result<Painted, CommandError> {
        let gpu = &self.studio.gpu;
        let strokes = painting.strokes().read(gpu).map_err(CommandError::failure)?;
        let order = painting.strokes().read_order(gpu).map_err(CommandError::failure)?;
        let strokes = order.iter().filter_map(|place| strokes.get(*place as usize).copied()).collect();
        Ok(Painted { pixels: self.pixels(&painting.picture)?, strokes })
    }

    /// Pixels of linear RGB.
    pub fn pixels(&self, picture: &Texture) -> Result<Vec<u8>, CommandError> {
        self.studio.pixels(picture, 1.0)
    }

    /// Pixels of linear RGB that covers the canvas by its alpha.
    pub fn on_canvas(&self, picture: &Texture) -> Result<Vec<u8>, CommandError> {
        let gpu = &self.studio.gpu;
        let mut values = picture.read(gpu)?;
        for texel in values.chunks_exact_mut(4) {
            let open = 1.0 - texel[3];
            for (channel, canvas) in texel.iter_mut().zip(self.motif.canvas.to_array()) {
                *channel += open * canvas;
            }
        }
        let [width, height, _] = picture.size();
        let covered = Texture::storage(gpu, [width, height], wgpu::TextureFormat::Rgba16Float);
        covered.write(gpu, &values)?;
        self.pixels(&covered)
    }
}

/// Columns and rows of sources of a picture.
fn source_size(size: [u32; 2], scale: f32) -> [u32; 2] {
    size.map(|side| ((side as f32 * scale).round() as u32).max(1))
}

/// A style that comes with Airlight.
pub fn style(name: &str) -> Result<PainterlyStyle, CommandError> {
    let (name, text) = named(&STYLES, name)?;
    parse_style(name, text).map_err(CommandError::failure)
}

fn named(
    all: &'static [(&'static str, &'static str)],
    name: &str,
) -> Result<(&'static str, &'static str), CommandError> {
    let found = all.iter().find(|(known, _)| *known == name).copied();
    found.ok_or_else(|| CommandError::failure(format!("no `{name}` comes with the program")))
}
