// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight gallery`: every picture from real data, with an index page.

mod page;
mod plates;

use super::{CommandError, parse, progress};
use crate::core::{Raster, Tonemap};
use crate::formats::{create_folder, write_png};
use crate::scattering::{Along, Composite, March, Prefiltered, Settings, Weighting, epipole_near_picture};
use crate::scenes::{self, Scene};
use crate::{Gpu, Shaders, Stage, Texture};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Flags of the command.
#[derive(clap::Args)]
pub struct Options {
    /// Folder for the pictures and index.html.
    #[arg(long, value_name = "DIR", default_value = "gallery")]
    out: PathBuf,
    /// Only one system, or one picture of it, such as scattering/foliage.
    #[arg(long, value_name = "SYSTEM[/PICTURE]")]
    only: Option<String>,
    /// Size of the pictures.
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = parse::size)]
    size: [u32; 2],
}

/// The scenes of the system `scattering`.
const SCATTERING: [&str; 3] = ["foliage", "terrain", "torus"];
/// Side of the standard shadow map.
const SHADOW_MAP: [u32; 2] = [2048, 2048];
/// Steps a ray of the marched reference.
const STEPS: u32 = 1024;
/// What differences are multiplied by before they are shown.
const AMPLIFIED: f32 = 8.0;

/// A scene's pictures on disk, and what made them.
pub(super) struct Plate {
    scene: Scene,
    settings: Settings,
    /// File name in the folder of the scene, and caption.
    pictures: Vec<(&'static str, String)>,
    /// Step, and milliseconds.
    times: Vec<(&'static str, f64)>,
}

/// Runs the command.
pub fn run(options: &Options, quiet: bool) -> Result<(), CommandError> {
    let chosen = choose(options.only.as_deref())?;
    create_folder(&options.out).map_err(|error| CommandError::Failure(format!("--out: {error}")))?;
    let gpu = pollster::block_on(Gpu::new())?;
    let shaders = Shaders::builtin();
    let bar = progress::bar(chosen.len() as u64, quiet);
    let mut plates = Vec::new();
    for name in chosen {
        bar.set_message(format!("scattering/{name}"));
        let scene =
            scenes::scene(name)?.ok_or_else(|| CommandError::failure(format!("no scene `{name}`")))?;
        let folder = options.out.join("scattering").join(name);
        create_folder(&folder).map_err(|error| CommandError::Failure(format!("--out: {error}")))?;
        plates.push(plate(&gpu, &shaders, scene, options.size, &folder)?);
        bar.inc(1);
    }
    bar.finish_and_clear();
    let index = options.out.join("index.html");
    page::write(&index, &gpu.description(), options.size, &plates)?;
    if !quiet {
        println!("{}", index.display());
    }
    Ok(())
}

fn choose(only: Option<&str>) -> Result<Vec<&'static str>, CommandError> {
    let Some(only) = only else { return Ok(SCATTERING.to_vec()) };
    let (system, picture) =
        only.split_once('/').map_or((only, None), |(system, picture)| (system, Some(picture)));
    let known = SCATTERING.map(|name| format!("scattering/{name}")).join(", ");
    let unknown =
        || CommandError::misuse("--only", format!("there is no `{only}`; there is scattering, {known}"));
    if system != "scattering" {
        return Err(unknown());
    }
    match picture {
        None => Ok(SCATTERING.to_vec()),
        Some(picture) => Ok(vec![*SCATTERING.iter().find(|name| **name == picture).ok_or_else(unknown)?]),
    }
}

fn plate(
    gpu: &Gpu,
    shaders: &Shaders,
    scene: Scene,
    size: [u32; 2],
    folder: &Path,
) -> Result<Plate, CommandError> {
    let raster = Raster::new(gpu, shaders)?;
    let stage = Stage::new(gpu, &raster, &scene.setting(), size, SHADOW_MAP)?;
    let settings = Settings {
        epipole_march: epipole_near_picture(&stage.camera, stage.light.direction),
        ..Settings::tuned(gpu)
    };
    let prefiltered = Prefiltered::new(gpu, shaders, settings, size)?;
    let bound = prefiltered.bind(gpu, &stage.inputs())?;
    let along = Along::ShadowMap { steps: STEPS };
    let march = March::new(gpu, shaders, &along, Weighting::Transmittance, size)?;
    let march_bound = march.bind(gpu, &stage.inputs(), &along)?;

    let times = vec![
        ("rectification", timed(gpu, &|encoder| prefiltered.record_rectification(encoder, &bound))?),
        ("filter", timed(gpu, &|encoder| prefiltered.record_filter(encoder, &bound))?),
        ("evaluation", timed(gpu, &|encoder| prefiltered.record_evaluation(encoder, &bound))?),
        ("marched reference", timed(gpu, &|encoder| march.record(encoder, &march_bound))?),
    ];

    let tonemap = Tonemap::new(gpu, shaders)?;
    let composite = Composite::new(gpu, shaders)?;
    let inputs = stage.inputs();
    let surface = &stage.pictures.surface;
    let composed = composite.run(gpu, &inputs, surface, &prefiltered.scattered)?;
    let difference = plates::difference(gpu, &prefiltered.scattered, &march.scattered, AMPLIFIED)?;
    let mut pictures = Vec::new();
    let mut save = |file: &'static str, caption: String, texture: &Texture| -> Result<(), CommandError> {
        let pixels = tonemap.run(gpu, texture, scene.exposure)?;
        write_png(folder.join(file), size[0], size[1], &pixels).map_err(CommandError::failure)?;
        pictures.push((file, caption));
        Ok(())
    };
    save("final.png", "Final picture".to_owned(), &composed)?;
    save("scattered.png", "Scattered light alone".to_owned(), &prefiltered.scattered)?;
    save("march.png", format!("Marched reference, {STEPS} steps"), &march.scattered)?;
    save("difference.png", format!("Difference of the two, times {AMPLIFIED}"), &difference)?;
    save("surface.png", "Surfaces without air".to_owned(), surface)?;
    let maps = [
        ("shadow_map.png", "Standard shadow map", plates::depth(gpu, &stage.pictures.shadow_map)?),
        (
            "rectified.png",
            "Rectified map: radius, slice",
            plates::depth(gpu, &prefiltered.rectification.rectified)?,
        ),
        ("bases.png", "Filtered bases 1, 5, 9 and so on", plates::bases(gpu, &prefiltered.bases)?),
    ];
    for (file, caption, plate) in maps {
        write_png(folder.join(file), plate.width, plate.height, &plate.pixels)
            .map_err(CommandError::failure)?;
        pictures.push((file, caption.to_owned()));
    }
    Ok(Plate { scene, settings, pictures, times })
}

/// Milliseconds of the second run; the first one compiles.
fn timed(gpu: &Gpu, record: &dyn Fn(&mut wgpu::CommandEncoder)) -> Result<f64, CommandError> {
    let mut last = 0.0;
    for _ in 0..2 {
        let mut encoder = gpu.encoder();
        record(&mut encoder);
        let start = Instant::now();
        gpu.submit(encoder)?;
        gpu.wait()?;
        last = start.elapsed().as_secs_f64() * 1e3;
    }
    Ok(last)
}
