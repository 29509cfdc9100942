// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight scattering`: light shafts around meshes of the user's.

mod conflicts;
mod flags;
mod framing;
mod picture;
mod plan;

pub use flags::Options;

use super::{CommandError, progress};
use crate::core::{Camera, Raster, ResolveDepth, SampleChoice, Sky};
use crate::data::{Bounds, LightImage, Mesh, load_light_image, load_mesh};
use crate::scattering::{
    BasisFormat, Composite, Inputs, LightForm, Settings, Start, ViewSettings, Views, Weighting,
};
use crate::{Gpu, Setting, Shaders, Stage, StageError, Texture};
use framing::Framing;
use glam::Vec3;
use picture::{Buffers, write_pictures};
use plan::Plan;
use std::path::PathBuf;

/// Runs the command.
pub fn run(options: &Options, quiet: bool) -> Result<(), CommandError> {
    options.check()?;
    super::run::check_writable("--out", &options.out)?;
    let bar = progress::bar(4, quiet);
    bar.set_message("reading meshes");
    let scene = Scene::read(options)?;
    let (form, cameras, plan) = scene.plan(options)?;
    let reason = plan.reason.clone();
    bar.inc(1);

    bar.set_message("shadow map and surfaces");
    let gpu = pollster::block_on(Gpu::new())?;
    let shaders = Shaders::builtin();
    let settings = settings(options, form, &gpu);
    settings.validate(&gpu)?;
    let eyes = scene.eyes(&gpu, &shaders, options)?;
    bar.inc(1);

    bar.set_message("light shafts");
    let methods = plan.methods(options, settings, &cameras, &eyes[0].stage.light);
    let views: Vec<ViewSettings> = eyes
        .iter()
        .zip(methods)
        .map(|(eye, method)| ViewSettings {
            camera: eye.stage.camera,
            resolution: options.resolution.resolution(),
            method,
        })
        .collect();
    let views = Views::new(&gpu, &shaders, &views)?;
    // Memory that ran out is said here, before a binding fails for want of a texture.
    gpu.check()?;
    let inputs: Vec<Inputs<'_>> = eyes.iter().map(Eye::inputs).collect();
    let bound = views.bind(&gpu, &inputs)?;
    let mut encoder = gpu.encoder();
    views.record(&mut encoder, &bound);
    gpu.submit(encoder)?;
    let composite = Composite::new(&gpu, &shaders)?;
    let composed = eyes.iter().zip(&inputs).zip(&views.views);
    let composed: Vec<Texture> = composed
        .map(|((eye, inputs), view)| {
            composite.run(&gpu, inputs, &eye.stage.pictures.surface, view.scattered())
        })
        .collect::<Result<_, _>>()?;
    bar.inc(1);

    bar.set_message("writing");
    if let Some(folder) = &options.buffers {
        let mut buffers = Buffers::default();
        for (index, (eye, view)) in eyes.iter().zip(&views.views).enumerate() {
            let prefix = if eyes.len() == 1 { "" } else { ["left_", "right_"][index.min(1)] };
            buffers.shadow_maps(&gpu, prefix, &eye.stage)?;
            buffers.texture(&gpu, &format!("{prefix}surface"), &eye.stage.pictures.surface)?;
            buffers.texture(&gpu, &format!("{prefix}depth"), eye.inputs().depth)?;
            buffers.view(&gpu, prefix, view)?;
            buffers.texture(&gpu, &format!("{prefix}composed"), &composed[index])?;
        }
        buffers.write(folder)?;
    }
    let pictures: Vec<&Texture> = composed.iter().collect();
    write_pictures(&gpu, &shaders, &pictures, options.exposure, &options.out)?;
    bar.finish_and_clear();
    if !quiet {
        println!("rectification: {reason}");
        println!("{}", options.out.display());
    }
    Ok(())
}

/// What was read and framed, before any GPU work.
struct Scene {
    mesh: Mesh,
    bounds: Bounds,
    light_texture: Option<LightImage>,
    framing: Framing,
}

impl Scene {
    fn read(options: &Options) -> Result<Self, CommandError> {
        let mesh = read_meshes(&options.mesh)?;
        let bounds = mesh.bounds().ok_or_else(|| CommandError::failure("--mesh: nothing to draw"))?;
        let framing = Framing::new(options, &bounds)?;
        let light_texture = options.light_texture.as_ref().map(load_light_image).transpose();
        let light_texture =
            light_texture.map_err(|error| CommandError::Failure(format!("--light-texture: {error}")))?;
        Ok(Self { mesh, bounds, light_texture, framing })
    }

    /// The form of the light, the cameras whose pixels are evaluated, and the rows that are chosen for them.
    fn plan(&self, options: &Options) -> Result<(LightForm, Vec<Camera>, Plan), CommandError> {
        let Framing { cameras, light, medium, .. } = &self.framing;
        let light = light.fitted(&self.bounds).map_err(StageError::Light)?;
        let form = options.form();
        let evaluated = |camera: &Camera| match options.resolution.resolution() {
            Some(resolution) => camera.reduced(resolution.factor()),
            None => *camera,
        };
        let cameras: Vec<Camera> = cameras.iter().map(evaluated).collect();
        let plan = Plan::new(options, form, &cameras, &light, medium.distance_limit)?;
        Ok((form, cameras, plan))
    }

    /// Draws what each eye sees.
    fn eyes(&self, gpu: &Gpu, shaders: &Shaders, options: &Options) -> Result<Vec<Eye>, CommandError> {
        let raster = Raster::new(gpu, shaders)?;
        let mut eyes = Vec::new();
        for view in &self.framing.views {
            let setting = Setting {
                mesh: &self.mesh,
                view: *view,
                light: self.framing.light,
                light_texture: self.light_texture.as_ref(),
                cascades: options.cascades,
                sky: Sky::new(Vec3::new(0.12, 0.2, 0.36), Vec3::new(0.4, 0.42, 0.44), Vec3::splat(0.06)),
                medium: self.framing.medium,
                samples: options.samples,
            };
            let stage = Stage::new(gpu, &raster, &setting, options.size, options.shadow_map)?;
            eyes.push(Eye::new(gpu, shaders, stage, options.samples)?);
        }
        Ok(eyes)
    }
}

/// A stage, with one depth a pixel.
struct Eye {
    stage: Stage,
    resolved: Option<Texture>,
}

impl Eye {
    fn new(gpu: &Gpu, shaders: &Shaders, stage: Stage, samples: u32) -> Result<Self, CommandError> {
        if samples == 1 {
            return Ok(Self { stage, resolved: None });
        }
        let [width, height, _] = stage.pictures.depth.size();
        let choice = SampleChoice::Mean {
            extinction: stage.medium.extinction,
            distance_limit: stage.medium.distance_limit,
        };
        let resolve = ResolveDepth::new(gpu, shaders, choice, [width, height])?;
        let bound = resolve.bind(gpu, &stage.camera_buffer, &stage.pictures.depth)?;
        let mut encoder = gpu.encoder();
        resolve.record(&mut encoder, &bound);
        gpu.submit(encoder)?;
        Ok(Self { stage, resolved: Some(resolve.depth) })
    }

    fn inputs(&self) -> Inputs<'_> {
        let inputs = self.stage.inputs();
        Inputs { depth: self.resolved.as_ref().unwrap_or(inputs.depth), ..inputs }
    }
}

fn settings(options: &Options, form: LightForm, gpu: &Gpu) -> Settings {
    Settings {
        visibility: options.visibility(),
        bases: options.bases.unwrap_or(Settings::default().bases),
        map: options.map,
        format: if options.half { BasisFormat::Rgba16Float } else { BasisFormat::Rgba8Unorm },
        weighting: if options.average { Weighting::Average } else { Weighting::Transmittance },
        regions: options.regions,
        reference: options.reference.reference(),
        // The march of other lights needs no parts, and their rows have none.
        start: if options.near_plane() && !form.local() && !form.texture {
            Start::NearPlane
        } else {
            Start::Eye
        },
        light: form,
        ..Settings::tuned(gpu)
    }
}

fn read_meshes(paths: &[PathBuf]) -> Result<Mesh, CommandError> {
    let mut whole = Mesh::default();
    for path in paths {
        let mesh = load_mesh(path).map_err(|error| CommandError::Failure(format!("--mesh: {error}")))?;
        whole.append(&mesh);
    }
    Ok(whole)
}
