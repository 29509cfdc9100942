// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight splatting`: volumes and meshes of the user's as sheets of splats.

mod conflicts;
mod flags;
mod framing;
mod studio;
mod transport;
mod volumes;

pub use flags::Options;

use super::scattering::{tone_mapped, write_pictures};
use super::sequence::{FrameRange, write_frames};
use super::{CommandError, progress};
use crate::core::Tonemap;
use crate::data::load_light_image;
use crate::splatting::{SheetInputs, SheetPicture, SheetSettings, Splats, Surfaces};
use crate::transmittance::Composite;
use crate::{Gpu, Shaders, light_texture};
use framing::Framing;
use indicatif::ProgressBar;
use studio::{Drawn, Studio};
use volumes::Volumes;

/// Runs the command.
pub fn run(options: &Options, quiet: bool) -> Result<(), CommandError> {
    conflicts::check(options)?;
    super::run::check_writable("--out", &options.out)?;
    let frames = options.shown();
    let bar = progress::bar(2 + u64::from(frames.count), quiet);
    bar.set_message("reading the volumes");
    let volumes = Volumes::new(options)?;
    let image = options.light_texture.as_ref().map(load_light_image).transpose();
    let image = image.map_err(|error| CommandError::Failure(format!("--light-texture: {error}")))?;
    let framing = Framing::new(options, &volumes)?;
    // What no camera can have is said before there is a device.
    framing.camera(options, frames.first)?;
    let transport = transport::transport(&options.transport, options.light);
    let settings = SheetSettings { transport, ..options.settings() };
    bar.inc(1);

    bar.set_message("finding splats");
    let gpu = pollster::block_on(Gpu::new())?;
    let shaders = Shaders::builtin();
    let find = |volume| Splats::new(&gpu, &shaders, volume, volumes.threshold, None);
    let splats = volumes.list.iter().map(find).collect::<Result<Vec<_>, _>>()?;
    let transfer = volumes.transfer.upload(&gpu)?;
    let image = image.map(|image| light_texture(&gpu, &image)).transpose()?;
    let polygons = !volumes.mesh.indices.is_empty();
    let surfaces = polygons.then(|| Surfaces::new(&gpu, std::slice::from_ref(&volumes.mesh))).transpose()?;
    let inputs = SheetInputs {
        splats: &splats,
        transfer: &transfer,
        surfaces: surfaces.as_ref(),
        light_texture: image.as_ref(),
    };
    let picture = SheetPicture::new(&gpu, &shaders, inputs, settings, options.size)?;
    let composite = Composite::new(&gpu, &shaders)?;
    let studio = Studio { device: (&gpu, &shaders), options, framing: &framing, picture, composite };
    // Memory that ran out is said here.
    gpu.check()?;
    bar.inc(1);

    let drawn = draw(&studio, frames, &bar)?;
    bar.set_message("writing");
    if let Some(folder) = &options.buffers {
        studio.buffers(&drawn)?.write(folder)?;
    }
    bar.finish_and_clear();
    if let Some(warning) = volumes.warning.clone().or_else(|| studio.warning(&drawn.sheets)) {
        eprintln!("airlight: warning: {warning}");
    }
    if !quiet {
        volumes.report.iter().for_each(|line| println!("{line}"));
        let all: usize = volumes.list.iter().map(|volume| volume.values.len()).sum();
        let kept: u64 = splats.iter().map(Splats::count).sum();
        println!("splats: {kept} of {all} voxels");
        println!("sheets: {} of {:.4} m", drawn.sheets.count, drawn.sheets.thickness);
        println!("{}", options.out.display());
    }
    Ok(())
}

/// Draws and writes the frames; the last of them.
fn draw(studio: &Studio<'_>, frames: FrameRange, bar: &ProgressBar) -> Result<Drawn, CommandError> {
    let (gpu, shaders) = studio.device;
    let options = studio.options;
    let tonemap = Tonemap::new(gpu, shaders)?;
    if options.frames.is_none() {
        bar.set_message("drawing");
        let drawn = studio.draw(frames.first)?;
        let composed = std::slice::from_ref(&drawn.composed);
        write_pictures(gpu, &tonemap, composed, options.exposure, &options.out)?;
        bar.inc(1);
        return Ok(drawn);
    }
    let mut last = None;
    write_frames(&options.out, options.size, frames, options.rate, |frame| {
        bar.set_message(format!("frame {frame}"));
        let drawn = studio.draw(frame)?;
        let pixels = tone_mapped(gpu, &tonemap, std::slice::from_ref(&drawn.composed), options.exposure)?;
        last = Some(drawn);
        bar.inc(1);
        Ok(pixels)
    })?;
    last.ok_or_else(|| CommandError::failure("--frames: there is none"))
}
