// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight painterly`: a volume of the user's as a painting, frame by frame.

mod conflicts;
mod flags;
mod framing;
mod looks;
mod matter;
mod shrink;
mod studio;

pub use flags::Options;

use super::sequence::{numbered, write_frames};
use super::staging::Staging;
use super::{CommandError, progress};
use crate::formats::write_png;
use crate::painterly::{IsoVolume, Painting};
use crate::{Gpu, Shaders};
use framing::Framing;
use indicatif::ProgressBar;
use looks::Looks;
use matter::Matter;
use std::path::{Path, PathBuf};
use studio::Studio;

/// Name of the picture, or of the animation.
const PAINTING: &str = "painting.png";

/// Runs the command.
pub fn run(options: &Options, quiet: bool) -> Result<(), CommandError> {
    conflicts::check(options)?;
    let looks = Looks::new(options)?;
    let frames = options.shown();
    let bar = progress::bar(2 + u64::from(options.settle + frames.count), quiet);
    bar.set_message("reading the volume");
    let matter = Matter::new(options)?;
    let framing = Framing::new(options, &matter)?;
    let numbers = (frames.first..=frames.first + (frames.count - 1)).filter(|_| options.frames.is_some());
    let names = numbers.map(|frame| numbered(Path::new(PAINTING), frame));
    let staging = Staging::new(&options.out, names.chain([PathBuf::from(PAINTING)]))?;
    bar.inc(1);

    bar.set_message("preparing");
    let gpu = pollster::block_on(Gpu::new())?;
    let shaders = Shaders::builtin();
    let volume = IsoVolume::new(&gpu, &matter.volume, Some(matter.range))?;
    let transfer = matter.transfer.upload(&gpu)?;
    let settings = studio::settings(options, &looks);
    let painting = Painting::new(&gpu, &shaders, &volume, &transfer, looks.brushes(&gpu)?, settings)?;
    let mut studio = Studio { gpu: &gpu, options, matter: &matter, framing: &framing, painting };
    // Memory that ran out is said here.
    gpu.check()?;
    bar.inc(1);
    for index in 0..options.settle {
        bar.set_message(format!("settling, {}", index + 1));
        studio.settle()?;
        bar.inc(1);
    }
    draw(&mut studio, &staging, &bar)?;

    bar.set_message("writing");
    if let Some(folder) = &options.buffers {
        studio.buffers()?.write(folder)?;
    }
    let report = studio.report()?;
    staging.publish()?;
    bar.finish_and_clear();
    if let Some(warning) = matter.warning.as_ref().or(report.warning.as_ref()) {
        eprintln!("airlight: warning: {warning}");
    }
    if !quiet {
        report.lines.iter().for_each(|line| println!("{line}"));
        println!("{}", options.out.join(PAINTING).display());
    }
    Ok(())
}

/// Paints and writes the frames.
fn draw(studio: &mut Studio<'_>, staging: &Staging, bar: &ProgressBar) -> Result<(), CommandError> {
    let failed = |error| CommandError::failure(format!("--out: {error}"));
    let options = studio.options;
    let ([width, height], frames) = (options.size, options.shown());
    let path = staging.path(PAINTING);
    if options.frames.is_none() {
        bar.set_message("painting");
        return write_png(path, width, height, &studio.paint(frames.first)?).map_err(failed);
    }
    write_frames(&path, options.size, frames, options.rate, |frame| {
        bar.set_message(format!("frame {frame}"));
        let pixels = studio.paint(frame)?;
        bar.inc(1);
        Ok(pixels)
    })
}
