// SPDX-License-Identifier: MIT OR Apache-2.0
//! The painting, frame by frame, and what is said of it.

use super::flags::Options;
use super::framing::Framing;
use super::looks::Looks;
use super::matter::Matter;
use crate::Gpu;
use crate::command::CommandError;
use crate::command::scattering::Buffers;
use crate::command::sequence::RATE;
use crate::data::srgb_from_linear;
use crate::formats::{Array, ArrayData};
use crate::painterly::{
    Canvas, PainterlyStyle, Painting, PaintingFrame, PaintingSettings, StrokeSettings, StrokeState,
};

/// What is painted and with what.
pub fn settings(options: &Options, looks: &Looks) -> PaintingSettings {
    let sizes = StrokeSettings::new(options.source_size(), options.size);
    PaintingSettings {
        strokes: StrokeSettings { capacity: options.capacity, seed: options.seed, ..sizes },
        style: looks.style,
        jitter: options.jitter.jitter(),
        canvas: Canvas::new(options.canvas, options.underpainting),
    }
}

/// Everything that paints frames.
pub struct Studio<'a> {
    pub gpu: &'a Gpu,
    pub options: &'a Options,
    pub matter: &'a Matter,
    pub framing: &'a Framing,
    pub painting: Painting<'a>,
}

/// What is to be said.
pub struct Report {
    /// A line each.
    pub lines: Vec<String>,
    /// That nothing can be seen.
    pub warning: Option<String>,
}

impl Studio<'_> {
    /// Lets strokes gather for a second where the first frame is.
    pub fn settle(&mut self) -> Result<(), CommandError> {
        self.record(self.options.shown().first, 1.0)
    }

    /// The picture of a frame, RGB of 8 bits.
    pub fn paint(&mut self, frame: u32) -> Result<Vec<u8>, CommandError> {
        self.record(frame, 1.0 / self.options.rate.unwrap_or(RATE))?;
        let radiance = self.painting.picture.read(self.gpu)?;
        let byte = |value: f32| (255.0 * srgb_from_linear(value.clamp(0.0, 1.0))).round() as u8;
        Ok(radiance.chunks_exact(4).flat_map(|texel| [0, 1, 2].map(|channel| byte(texel[channel]))).collect())
    }

    fn record(&mut self, frame: u32, seconds: f32) -> Result<(), CommandError> {
        let Framing { camera, surface, lighting } = self.framing;
        let degrees = f64::from(frame) * f64::from(self.options.turning());
        let step = PaintingFrame {
            camera: *camera,
            world_from_unit: self.matter.turned(degrees),
            surface,
            lighting,
            seconds,
            generation: true,
            deletion: true,
        };
        let mut encoder = self.gpu.encoder();
        self.painting.record(self.gpu, &mut encoder, &step)?;
        Ok(self.gpu.submit(encoder)?)
    }

    /// What rays found in the last frame, what was painted, and the strokes.
    pub fn buffers(&self) -> Result<Buffers, CommandError> {
        let targets = self.painting.targets();
        let mut buffers = Buffers::default();
        let named = [
            ("color", Some(&targets.color)),
            ("surface", Some(&targets.surface)),
            ("flow", Some(&targets.flow)),
            ("distance", Some(&targets.distance)),
            ("curvature", targets.curvature.as_ref()),
            ("density", Some(&self.painting.strokes().density)),
            ("picture", Some(&self.painting.picture)),
        ];
        for (name, texture) in named {
            if let Some(texture) = texture {
                buffers.texture(self.gpu, name, texture)?;
            }
        }
        let strokes = self.painting.strokes().read(self.gpu)?;
        let order = self.painting.strokes().read_order(self.gpu)?;
        let mut rows = Vec::with_capacity(COLUMNS * strokes.len());
        for stroke in order.iter().filter_map(|index| strokes.get(*index as usize)) {
            rows.extend(stroke.position.to_array());
            rows.extend([stroke.size, stroke.aspect, stroke.orientation]);
            rows.extend(stroke.color.to_array());
            let stays = stroke.state == StrokeState::Stays;
            rows.extend([stroke.opacity, stroke.layer as f32, f32::from(u8::from(stays))]);
        }
        let shape = vec![rows.len() / COLUMNS, COLUMNS];
        buffers.array("strokes", Array { shape, data: ArrayData::F32(rows) });
        Ok(buffers)
    }

    /// What is said of the last frame and of the volume.
    pub fn report(&self) -> Result<Report, CommandError> {
        let frames = self.options.shown();
        let (first, last) = (frames.first, frames.first + (frames.count - 1));
        let counts = self.painting.strokes().read_counts(self.gpu)?;
        let layers = counts.layers();
        let named: Vec<_> = PainterlyStyle::LAYERS
            .iter()
            .zip(layers)
            .map(|(name, count)| format!("{count} {name}"))
            .collect();
        let distances = self.painting.targets().distance.read(self.gpu)?;
        let hit = distances.iter().filter(|distance| **distance >= 0.0).count();
        let all: u32 = layers.iter().sum();
        let (dropped, named, voxels) =
            (counts.dropped_in_all, named.join(", "), self.matter.volume.values.len());
        let lines = vec![
            format!("frames: {first} to {last}, after {} to settle", self.options.settle),
            format!("strokes: {all}, {named}; {dropped} dropped in all frames"),
            format!("rays: {hit} of {} hit", distances.len()),
            format!("voxels: {voxels}; taken as the least value: {} not finite", self.matter.not_finite),
        ];
        let aside = "no ray meets the volume where it is solid: look elsewhere with --eye and --target, or check --clip";
        Ok(Report { lines, warning: (hit == 0).then(|| aside.to_owned()) })
    }
}

/// Numbers of a stroke in its array.
const COLUMNS: usize = 11;
