// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight stylize`: light shafts around meshes of the user's, with shadows reshaped and light recoloured.

mod flags;
mod holes;
mod recolour;
mod shadows;

pub use flags::Options;

use super::scattering::{Buffers, Scene, Shafts, read_meshes, tone_mapped, whole, write_pictures};
use super::sequence::{self, FrameRange, delay, numbered};
use super::{CommandError, progress};
use crate::Texture;
use crate::core::Tonemap;
use crate::formats::{write_animation, write_png};
use crate::scattering::{Composite, ViewPasses};
use crate::stylize::{TransferSettings, read_transfer};
use glam::Vec3;
use indicatif::ProgressBar;
use recolour::{Recolour, Scattered, movements, positions};
use shadows::Shadows;
use std::collections::BTreeMap;
use std::io;

/// Runs the command.
pub fn run(options: &Options, quiet: bool) -> Result<(), CommandError> {
    options.check()?;
    let shafts_of = &options.scattering;
    super::run::check_writable("--out", &shafts_of.out)?;
    let frames = options.frames.unwrap_or(FrameRange { first: shafts_of.frame.unwrap_or(0), count: 1 });
    if options.frames.is_some() {
        for index in 0..frames.count {
            let file = numbered(&shafts_of.out, frames.first + index);
            if file.is_dir() {
                return Err(CommandError::failure(format!("--frames: {} is a folder", file.display())));
            }
        }
    }
    let bar = progress::bar(3 + u64::from(frames.count), quiet);
    bar.set_message("reading meshes");
    let failed = |error| CommandError::failure(format!("--transfer: {error}"));
    let transfer = options.transfer.as_ref();
    let transfer = transfer.map(|file| Ok::<_, CommandError>((file, read_transfer(file).map_err(failed)?)));
    let transfer = transfer.transpose()?;
    let meshes = read_meshes(&shafts_of.mesh)?;
    let scene = Scene::new(shafts_of, whole(&meshes))?;
    let shafts = Shafts::new(shafts_of, &scene, &bar)?;
    let mut studio = Studio {
        options,
        shadows: Shadows::new(options, &shafts, &meshes, frames)?,
        composite: Composite::new(&shafts.gpu, &shafts.shaders)?,
        tonemap: Tonemap::new(&shafts.gpu, &shafts.shaders)?,
        recolour: transfer
            .map(|(file, transfer)| Recolour::new(&shafts.gpu, &shafts.shaders, file, transfer))
            .transpose()?,
        movements: movements(&shafts_of.mesh),
        shafts: &shafts,
    };
    let composed = match options.frames {
        None => {
            let composed = studio.draw(frames.first)?;
            write_pictures(&shafts.gpu, &studio.tonemap, &composed, shafts_of.exposure, &shafts_of.out)?;
            composed
        }
        Some(_) => studio.sequence(frames, &bar)?,
    };
    bar.set_message("writing");
    let last = frames.first + (frames.count - 1);
    if let Some(folder) = &shafts_of.buffers {
        studio.buffers(&composed)?.write(folder)?;
    }
    let picked = studio.picked(last as f32)?;
    bar.finish_and_clear();
    if !quiet {
        println!("rectification: {}", shafts.reason);
    }
    for line in picked {
        println!("{line}");
    }
    if !quiet {
        println!("{}", shafts_of.out.display());
    }
    Ok(())
}

/// Everything that draws frames.
struct Studio<'a> {
    options: &'a Options,
    shafts: &'a Shafts,
    shadows: Shadows<'a>,
    recolour: Option<Recolour>,
    composite: Composite,
    tonemap: Tonemap,
    movements: BTreeMap<String, Vec3>,
}

impl Studio<'_> {
    /// What each eye sees in a frame: radiance.
    fn draw(&mut self, frame: u32) -> Result<Vec<Texture>, CommandError> {
        let Shafts { gpu, shaders, eyes, views, .. } = self.shafts;
        self.shadows.set(frame)?;
        for view in &views.views {
            if let ViewPasses::March { march, .. } = &view.passes {
                march.set_frame(gpu, frame)?;
            }
        }
        let mut encoder = gpu.encoder();
        self.shadows.record(&mut encoder);
        gpu.submit(encoder)?;
        if let Some(recolour) = &mut self.recolour {
            let pictures = scattered(self.shafts, &self.shadows);
            recolour.draw(gpu, shaders, frame as f32, &pictures, &self.movements)?;
        }
        let composed = eyes.iter().zip(&views.views).enumerate().map(|(index, (eye, view))| {
            let restyled = self.recolour.as_ref().and_then(|recolour| recolour.restyled(index));
            let shown = restyled.unwrap_or(view.scattered());
            Ok(self.composite.run(gpu, &eye.inputs(), &eye.stage.pictures.surface, shown)?)
        });
        composed.collect()
    }

    /// Writes a sequence and its animation; what each eye sees in the last frame.
    fn sequence(&mut self, frames: FrameRange, bar: &ProgressBar) -> Result<Vec<Texture>, CommandError> {
        let options = &self.options.scattering;
        let rate = self.options.rate.unwrap_or(sequence::RATE);
        let [width, height] = self.options.picture_size();
        let (mut problem, mut last) = (None, Vec::new());
        let pictures = (0..frames.count as usize).map(|index| {
            let frame = frames.first + index as u32;
            bar.set_message(format!("frame {frame}"));
            let picture = self.draw(frame).and_then(|composed| {
                let gpu = &self.shafts.gpu;
                let pixels = tone_mapped(gpu, &self.tonemap, &composed, options.exposure)?;
                let failed = |error| CommandError::failure(format!("--frames: {error}"));
                write_png(numbered(&options.out, frame), width, height, &pixels).map_err(failed)?;
                last = composed;
                Ok(pixels)
            });
            bar.inc(1);
            picture.map_err(|error| {
                problem = Some(error);
                io::Error::other("a frame could not be drawn")
            })
        });
        let written = write_animation(&options.out, width, height, pictures, delay(rate));
        if let Some(problem) = problem {
            return Err(problem);
        }
        written.map_err(|error| CommandError::failure(format!("--out: {error}")))?;
        Ok(last)
    }

    /// Everything on the way to the last frame that was drawn.
    fn buffers(&self, composed: &[Texture]) -> Result<Buffers, CommandError> {
        let Shafts { gpu, eyes, views, .. } = self.shafts;
        let mut buffers = Buffers::default();
        for (index, (eye, view)) in eyes.iter().zip(&views.views).enumerate() {
            let prefix = self.shafts.prefix(index);
            buffers.eye(gpu, prefix, eye, view, &composed[index])?;
            self.shadows.buffers(&mut buffers, prefix, index)?;
            if let Some(restyled) = self.recolour.as_ref().and_then(|recolour| recolour.restyled(index)) {
                buffers.texture(gpu, &format!("{prefix}restyled"), restyled)?;
            }
        }
        if let Some(function) = self.recolour.as_ref().and_then(|recolour| recolour.function.as_ref()) {
            buffers.texture(gpu, "transfer", function)?;
        }
        self.shadows.masks(&mut buffers)?;
        Ok(buffers)
    }

    /// Lines for the pixels that were picked.
    fn picked(&self, frame: f32) -> Result<Vec<String>, CommandError> {
        let pixels = &self.options.pick;
        if pixels.is_empty() {
            return Ok(Vec::new());
        }
        let Shafts { gpu, shaders, eyes, .. } = self.shafts;
        let settings = self.recolour.as_ref().map_or_else(TransferSettings::default, |recolour| {
            recolour.settings(frame, &eyes[0].stage.medium)
        });
        let pictures = scattered(self.shafts, &self.shadows);
        positions(gpu, shaders, &settings, pixels, &pictures, &self.movements)
    }
}

/// What scattering read and wrote for each eye.
fn scattered<'a>(shafts: &'a Shafts, shadows: &'a Shadows<'_>) -> Vec<Scattered<'a>> {
    let eyes = shafts.eyes.iter().zip(&shafts.views.views).enumerate();
    eyes.map(|(index, (eye, view))| Scattered {
        eye,
        inputs: shadows.inputs(index),
        radiance: view.scattered(),
    })
    .collect()
}
