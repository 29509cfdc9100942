// SPDX-License-Identifier: MIT OR Apache-2.0
//! From meshes and flags to passes that find light shafts: what `airlight scattering` and `airlight stylize` share.

use super::Options;
use super::framing::Framing;
use super::plan::Plan;
use crate::command::CommandError;
use crate::core::{Camera, Raster, ResolveDepth, SampleChoice, Sky};
use crate::data::{Bounds, LightImage, Mesh, load_light_image, load_mesh};
use crate::scattering::{BasisFormat, Inputs, LightForm, Settings, Start, ViewSettings, Views, Weighting};
use crate::{Gpu, Setting, Shaders, Stage, StageError, Texture};
use glam::Vec3;
use indicatif::ProgressBar;
use std::path::PathBuf;

/// What was read and framed, before any GPU work.
pub struct Scene {
    mesh: Mesh,
    bounds: Bounds,
    light_texture: Option<LightImage>,
    framing: Framing,
}

impl Scene {
    /// Frames a mesh and reads the light texture.
    ///
    /// # Errors
    /// Misuse: values that no camera, light or medium can have. A failure: nothing to draw, an unreadable texture.
    pub fn new(options: &Options, mesh: Mesh) -> Result<Self, CommandError> {
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
    fn eyes(
        &self,
        (gpu, shaders, raster): (&Gpu, &Shaders, &Raster),
        options: &Options,
    ) -> Result<Vec<Eye>, CommandError> {
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
            let stage = Stage::new(gpu, raster, &setting, options.size, options.shadow_map)?;
            eyes.push(Eye::new(gpu, shaders, stage, options.samples)?);
        }
        Ok(eyes)
    }
}

/// Everything that light shafts are found with.
pub struct Shafts {
    /// The device.
    pub gpu: Gpu,
    /// The shaders.
    pub shaders: Shaders,
    /// What draws meshes.
    pub raster: Raster,
    /// What each eye sees.
    pub eyes: Vec<Eye>,
    /// The passes of each eye.
    pub views: Views,
    /// Which rows were chosen, and why.
    pub reason: String,
}

impl Shafts {
    /// Draws shadow maps and surfaces and builds the passes. What can be refused without a GPU is refused before there is one.
    /// `bar`: moved by two steps.
    ///
    /// # Errors
    /// Misuse and failures of all kinds.
    pub fn new(options: &Options, scene: &Scene, bar: &ProgressBar) -> Result<Self, CommandError> {
        let (form, cameras, plan) = scene.plan(options)?;
        let reason = plan.reason.clone();
        bar.inc(1);

        bar.set_message("shadow map and surfaces");
        let gpu = pollster::block_on(Gpu::new())?;
        let shaders = Shaders::builtin();
        let settings = settings(options, form, &gpu);
        settings.validate(&gpu)?;
        let raster = Raster::new(&gpu, &shaders)?;
        let eyes = scene.eyes((&gpu, &shaders, &raster), options)?;
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
        Ok(Self { gpu, shaders, raster, eyes, views, reason })
    }

    /// What the names of an eye's buffers begin with.
    pub fn prefix(&self, eye: usize) -> &'static str {
        if self.eyes.len() == 1 { "" } else { ["left_", "right_"][eye.min(1)] }
    }
}

/// A stage, with one depth a pixel.
pub struct Eye {
    /// The stage.
    pub stage: Stage,
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

    /// What the passes are given.
    pub fn inputs(&self) -> Inputs<'_> {
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

/// Reads meshes.
///
/// # Errors
/// A failure, with the file.
pub fn read_meshes(paths: &[PathBuf]) -> Result<Vec<Mesh>, CommandError> {
    let read = |path| load_mesh(path).map_err(|error| CommandError::Failure(format!("--mesh: {error}")));
    paths.iter().map(read).collect()
}

/// Meshes as one.
pub fn whole<'a>(meshes: impl IntoIterator<Item = &'a Mesh>) -> Mesh {
    let mut whole = Mesh::default();
    for mesh in meshes {
        whole.append(mesh);
    }
    whole
}
