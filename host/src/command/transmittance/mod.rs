// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight transmittance`: volumes and particles that are lit through transmittance maps.

mod conflicts;
mod flags;
mod framing;
mod medium;
mod picture;

pub use flags::Options;

use super::scattering::write_pictures;
use super::{CommandError, progress};
use crate::core::Tonemap;
use crate::{Gpu, Shaders};
use framing::Framing;
use medium::Medium;
use picture::draw;

/// Runs the command.
pub fn run(options: &Options, quiet: bool) -> Result<(), CommandError> {
    conflicts::check(options)?;
    super::run::check_writable("--out", &options.out)?;
    let bar = progress::bar(3, quiet);
    bar.set_message("reading the medium");
    let medium = Medium::new(options)?;
    conflicts::check_medium(options, &medium)?;
    let framing = Framing::new(options, &medium)?;
    bar.inc(1);

    bar.set_message("map and picture");
    let gpu = pollster::block_on(Gpu::new())?;
    let shaders = Shaders::builtin();
    let drawn = draw((&gpu, &shaders), options, &medium, &framing)?;
    bar.inc(1);

    bar.set_message("writing");
    if let Some(folder) = &options.buffers {
        drawn.buffers.write(folder)?;
    }
    let tonemap = Tonemap::new(&gpu, &shaders)?;
    write_pictures(&gpu, &tonemap, &[drawn.composed], options.exposure, &options.out)?;
    bar.finish_and_clear();
    if !quiet {
        for line in medium.report.iter().chain(&drawn.report) {
            println!("{line}");
        }
        println!("{}", options.out.display());
    }
    Ok(())
}
