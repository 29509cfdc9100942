// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight scattering`: light shafts around meshes of the user's.

use super::parse::{self, LightSpelling};
use super::{CommandError, progress};
use crate::core::{DepthRange, PerspectiveView, Raster, Sky, Tonemap};
use crate::data::{Mesh, load_mesh};
use crate::formats::{Array, ArrayData, create_folder, write_exr, write_npy, write_png};
use crate::scattering::{
    Along, BasisFormat, Composite, March, Medium, Prefiltered, Rectification, Settings, Weighting,
    epipole_near_picture,
};
use crate::{Gpu, Setting, Shaders, Stage, Texture, scenes};
use clap::ValueEnum;
use glam::Vec3;
use std::path::{Path, PathBuf};

/// How visibility is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Method {
    /// Prefiltered Fourier bases: constant cost a pixel.
    Fourier,
    /// One step after the other through the standard shadow map.
    March,
}

/// Flags of the command. Every flag but --mesh and --out has a default.
#[derive(clap::Args)]
pub struct Options {
    /// Mesh file, OBJ or glTF; may be given several times.
    #[arg(long, value_name = "FILE", required = true)]
    mesh: Vec<PathBuf>,
    /// Picture to write: .png (tone-mapped) or .exr (linear radiance).
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Position of the eye, metres [default: frames the mesh].
    #[arg(long, value_name = "X,Y,Z", value_parser = parse::vector, allow_hyphen_values = true)]
    eye: Option<Vec3>,
    /// Point in the middle of the picture, metres [default: centre of the mesh].
    #[arg(long, value_name = "X,Y,Z", value_parser = parse::vector, allow_hyphen_values = true)]
    target: Option<Vec3>,
    /// Vertical field of view, degrees.
    #[arg(long, value_name = "DEG", default_value = "45", value_parser = parse::number, allow_hyphen_values = true)]
    fov: f32,
    /// Distance of the near plane, metres [default: from the mesh].
    #[arg(long, value_name = "M", value_parser = parse::number, allow_hyphen_values = true)]
    near: Option<f32>,
    /// Distance of the far plane, metres, where the air ends [default: from the mesh].
    #[arg(long, value_name = "M", value_parser = parse::number, allow_hyphen_values = true)]
    far: Option<f32>,
    /// Light: azimuth from +z towards +x and elevation, degrees, pointing TOWARDS the light.
    #[arg(long, value_name = "directional:AZ,EL", default_value = "directional:150,35", value_parser = parse::light)]
    light: LightSpelling,
    /// Linear RGB radiance of the light (irradiance of a surface that faces it).
    #[arg(long, value_name = "R,G,B", default_value = "12,10.5,8.4", value_parser = parse::vector)]
    radiance: Vec3,
    /// Extinction of the air, 1/m; 0 is a clear picture [default: optical depth 0.7 to the far plane].
    #[arg(long, value_name = "S", value_parser = parse::number, allow_hyphen_values = true)]
    extinction: Option<f32>,
    /// Single-scattering albedo, 0..1.
    #[arg(long, value_name = "A", default_value = "0.95", value_parser = parse::number, allow_hyphen_values = true)]
    albedo: f32,
    /// Mean cosine of the Henyey-Greenstein phase function, -0.999..0.999.
    #[arg(long, value_name = "G", default_value = "0.5", value_parser = parse::number, allow_hyphen_values = true)]
    g: f32,
    /// How visibility along a ray is found.
    #[arg(long, value_enum, default_value = "fourier")]
    method: Method,
    /// Number of Fourier bases, a multiple of 4 from 4 to 128.
    #[arg(long, value_name = "M", default_value = "32")]
    bases: u32,
    /// Plain average visibility instead of visibility weighted by transmittance.
    #[arg(long)]
    average: bool,
    /// Stores the filtered bases in 16 instead of 8 bits.
    #[arg(long)]
    half: bool,
    /// Steps a ray of the march.
    #[arg(long, value_name = "N", default_value = "512", value_parser = clap::value_parser!(u32).range(1..=65536))]
    steps: u32,
    /// Columns and rows of the rectified map.
    #[arg(long, value_name = "WxH", default_value = "1024x1024", value_parser = parse::size)]
    map: [u32; 2],
    /// Size of the standard shadow map.
    #[arg(long, value_name = "WxH", default_value = "2048x2048", value_parser = parse::size)]
    shadow_map: [u32; 2],
    /// Size of the picture.
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = parse::size)]
    size: [u32; 2],
    /// Factor on the radiance before the tone curve of a .png.
    #[arg(long, value_name = "F", default_value = "1", value_parser = parse::number, allow_hyphen_values = true)]
    exposure: f32,
    /// Folder for every intermediate buffer as .npy.
    #[arg(long, value_name = "DIR")]
    buffers: Option<PathBuf>,
}

/// Runs the command.
pub fn run(options: &Options, quiet: bool) -> Result<(), CommandError> {
    let extension = options.out.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    if !matches!(extension.as_str(), "png" | "exr") {
        let shown = options.out.display();
        return Err(CommandError::misuse("--out", format!("`{shown}` must end in .png or .exr")));
    }
    if options.exposure <= 0.0 {
        return Err(CommandError::misuse(
            "--exposure",
            format!("{} is impossible: it must be positive", options.exposure),
        ));
    }
    if options.radiance.min_element() < 0.0 || options.radiance.max_element() > 1e4 {
        let shown = options.radiance;
        return Err(CommandError::misuse(
            "--radiance",
            format!("{shown} is impossible: 0 to 1e4 is possible"),
        ));
    }
    super::run::check_writable("--out", &options.out)?;
    let bar = progress::bar(4, quiet);
    bar.set_message("reading meshes");
    let mesh = read_meshes(&options.mesh)?;
    let (view, medium) = frame(options, &mesh)?;
    bar.inc(1);

    bar.set_message("shadow map and surfaces");
    let gpu = pollster::block_on(Gpu::new())?;
    let shaders = Shaders::builtin();
    let settings = Settings {
        bases: options.bases,
        map: options.map,
        format: if options.half { BasisFormat::Rgba16Float } else { BasisFormat::Rgba8Unorm },
        weighting: if options.average { Weighting::Average } else { Weighting::Transmittance },
        ..Settings::tuned(&gpu)
    };
    settings.validate(&gpu)?;
    if !matches!(options.light, LightSpelling::Directional { .. }) {
        return Err(CommandError::misuse("--light", "only directional:AZ,EL is there for this command"));
    }
    let setting = Setting {
        mesh: &mesh,
        view: view.into(),
        light: options.light.lighting(options.radiance),
        light_texture: None,
        cascades: None,
        sky: Sky::new(Vec3::new(0.12, 0.2, 0.36), Vec3::new(0.4, 0.42, 0.44), Vec3::splat(0.06)),
        medium,
        samples: 1,
    };
    let raster = Raster::new(&gpu, &shaders)?;
    let stage = Stage::new(&gpu, &raster, &setting, options.size, options.shadow_map)?;
    bar.inc(1);

    bar.set_message("light shafts");
    let mut buffers = Vec::new();
    let scattered = match options.method {
        Method::Fourier => {
            let epipole_march = epipole_near_picture(&stage.camera, stage.light.direction);
            let settings = Settings { epipole_march, ..settings };
            fourier(&gpu, &shaders, &stage, settings, options, &mut buffers)?
        }
        Method::March => march(&gpu, &shaders, &stage, settings, options)?,
    };
    let composed =
        Composite::new(&gpu, &shaders)?.run(&gpu, &stage.inputs(), &stage.pictures.surface, &scattered)?;
    bar.inc(1);

    bar.set_message("writing");
    if let Some(folder) = &options.buffers {
        create_folder(folder).map_err(|error| CommandError::Failure(format!("--buffers: {error}")))?;
        for (name, texture) in [
            ("shadow_map", &stage.pictures.shadow_map),
            ("surface", &stage.pictures.surface),
            ("depth", &stage.pictures.depth),
            ("scattered", &scattered),
            ("composed", &composed),
        ] {
            buffers.push((name, array(&gpu, texture)?));
        }
        for (name, array) in &buffers {
            write_npy(folder.join(format!("{name}.npy")), array)
                .map_err(|error| CommandError::Failure(format!("--buffers: {error}")))?;
        }
    }
    write_picture(&gpu, &shaders, &composed, options.exposure, &options.out)?;
    bar.finish_and_clear();
    if !quiet {
        println!("{}", options.out.display());
    }
    Ok(())
}

fn read_meshes(paths: &[PathBuf]) -> Result<Mesh, CommandError> {
    let mut whole = Mesh::default();
    for path in paths {
        let mesh = load_mesh(path).map_err(|error| CommandError::Failure(format!("--mesh: {error}")))?;
        whole.append(&mesh);
    }
    Ok(whole)
}

/// The camera and the air, with what was not said taken from the mesh.
fn frame(options: &Options, mesh: &Mesh) -> Result<(PerspectiveView, Medium), CommandError> {
    let bounds = mesh.bounds().ok_or_else(|| CommandError::failure("--mesh: nothing to draw"))?;
    let fov = options.fov;
    let framing = scenes::framing(&bounds, fov.clamp(0.1, 170.0));
    let eye = options.eye.unwrap_or(framing.eye);
    let target = options.target.unwrap_or(framing.target);
    // With an eye of the user's the planes must still hold the whole mesh.
    let distance = (bounds.center() - eye).length();
    let far = options.far.unwrap_or(distance + 2.0 * bounds.radius().max(1e-3));
    let near = options.near.unwrap_or(far * 1e-3);
    let view = PerspectiveView { eye, target, field_of_view: fov, near, far, depth: DepthRange::Forward };
    let extinction = options.extinction.unwrap_or(0.7 / far);
    let limit = if far.is_finite() && far > 0.0 { far } else { 1.0 };
    // Rays to the corners of the far plane are longer than the plane is far.
    let medium = Medium::new(extinction, Vec3::splat(options.albedo), options.g, (limit * 4.0).min(1e7))?;
    Ok((view, medium))
}

fn fourier(
    gpu: &Gpu,
    shaders: &Shaders,
    stage: &Stage,
    settings: Settings,
    options: &Options,
    buffers: &mut Vec<(&'static str, Array)>,
) -> Result<Texture, CommandError> {
    let prefiltered = Prefiltered::new(gpu, shaders, settings, options.size)?;
    // Memory that ran out is said here, before a binding fails for want of a texture.
    gpu.check()?;
    let bound = prefiltered.bind(gpu, &stage.inputs())?;
    let mut encoder = gpu.encoder();
    prefiltered.record(&mut encoder, &bound);
    gpu.submit(encoder)?;
    if options.buffers.is_some() {
        let Rectification { slices, rectified, frame, .. } = &prefiltered.rectification;
        buffers.push(("slices", array(gpu, slices)?));
        buffers.push(("rectified", array(gpu, rectified)?));
        buffers.push(("bases", array(gpu, &prefiltered.bases)?));
        let words = frame.read_floats(gpu)?;
        buffers.push(("frame", Array { shape: vec![words.len()], data: ArrayData::F32(words) }));
    }
    Ok(prefiltered.scattered)
}

fn march(
    gpu: &Gpu,
    shaders: &Shaders,
    stage: &Stage,
    settings: Settings,
    options: &Options,
) -> Result<Texture, CommandError> {
    let along = Along::ShadowMap { steps: options.steps };
    let march = March::new(gpu, shaders, &along, settings.weighting, options.size)?;
    let bound = march.bind(gpu, &stage.inputs(), &along)?;
    let mut encoder = gpu.encoder();
    march.record(&mut encoder, &bound);
    gpu.submit(encoder)?;
    Ok(march.scattered)
}

/// A texture as an array: layers first where there are several, then rows, columns, channels.
fn array(gpu: &Gpu, texture: &Texture) -> Result<Array, CommandError> {
    let values = texture.read(gpu)?;
    let [width, height, layers] = texture.size().map(|side| side as usize);
    let channels = values.len() / (width * height * layers);
    let mut shape = vec![height, width];
    if layers > 1 {
        shape.insert(0, layers);
    }
    if channels > 1 {
        shape.push(channels);
    }
    Ok(Array { shape, data: ArrayData::F32(values) })
}

/// Writes radiance as .png (tone-mapped) or .exr (linear), by the ending of `path`.
pub fn write_picture(
    gpu: &Gpu,
    shaders: &Shaders,
    radiance: &Texture,
    exposure: f32,
    path: &Path,
) -> Result<(), CommandError> {
    let [width, height, _] = radiance.size();
    let failure = |error| CommandError::Failure(format!("--out: {error}"));
    if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr")) {
        write_exr(path, width, height, &radiance.read(gpu)?).map_err(failure)
    } else {
        let pixels = Tonemap::new(gpu, shaders)?.run(gpu, radiance, exposure)?;
        write_png(path, width, height, &pixels).map_err(failure)
    }
}
