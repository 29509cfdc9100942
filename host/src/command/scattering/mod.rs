// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight scattering`: light shafts around meshes of the user's. What it shares with `airlight stylize` lies in
//! `shafts` and `picture`.

mod conflicts;
mod flags;
mod framing;
mod picture;
mod plan;
mod shafts;

pub use flags::{JitterSpelling, Options};
pub use picture::{Buffers, tone_mapped, write_pictures};
pub use shafts::{Eye, Scene, Shafts, read_meshes, whole};

use super::{CommandError, progress};
use crate::Texture;
use crate::core::Tonemap;
use crate::scattering::{Composite, Inputs};

/// Runs the command.
pub fn run(options: &Options, quiet: bool) -> Result<(), CommandError> {
    options.check(false)?;
    super::run::check_writable("--out", &options.out)?;
    let bar = progress::bar(4, quiet);
    bar.set_message("reading meshes");
    let scene = Scene::new(options, whole(&read_meshes(&options.mesh)?))?;
    let shafts = Shafts::new(options, &scene, &bar)?;
    let Shafts { gpu, shaders, eyes, views, .. } = &shafts;
    let inputs: Vec<Inputs<'_>> = eyes.iter().map(Eye::inputs).collect();
    let bound = views.bind(gpu, &inputs)?;
    let mut encoder = gpu.encoder();
    views.record(&mut encoder, &bound);
    gpu.submit(encoder)?;
    let composite = Composite::new(gpu, shaders)?;
    let composed = eyes.iter().zip(&inputs).zip(&views.views);
    let composed: Vec<Texture> = composed
        .map(|((eye, inputs), view)| {
            composite.run(gpu, inputs, &eye.stage.pictures.surface, view.scattered())
        })
        .collect::<Result<_, _>>()?;
    bar.inc(1);

    bar.set_message("writing");
    if let Some(folder) = &options.buffers {
        let mut buffers = Buffers::default();
        for (index, (eye, view)) in eyes.iter().zip(&views.views).enumerate() {
            buffers.eye(gpu, shafts.prefix(index), eye, view, &composed[index])?;
        }
        buffers.write(folder)?;
    }
    write_pictures(gpu, &Tonemap::new(gpu, shaders)?, &composed, options.exposure, &options.out)?;
    bar.finish_and_clear();
    if !quiet {
        println!("rectification: {}", shafts.reason);
        println!("{}", options.out.display());
    }
    Ok(())
}
