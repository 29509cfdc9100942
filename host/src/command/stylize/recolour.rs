// SPDX-License-Identifier: MIT OR Apache-2.0
//! `--transfer` and `--pick`: scattered light recoloured, pixels found in the function.

use crate::command::CommandError;
use crate::command::scattering::Eye;
use crate::scattering::{Inputs, Medium};
use crate::stylize::{
    Baker, Keyed, PickScene, Place, Restyle, Source, Transfer, TransferError, TransferSettings,
};
use crate::{Buffer, Gpu, Shaders, Texture};
use glam::Vec3;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A picture that was scattered: an eye, what scattering read, and what it wrote.
#[derive(Clone, Copy)]
pub struct Scattered<'a> {
    /// The eye.
    pub eye: &'a Eye,
    /// The inputs, shadow maps changed.
    pub inputs: Inputs<'a>,
    /// Radiance and mean visibility of the whole picture.
    pub radiance: &'a Texture,
}

impl<'a> Scattered<'a> {
    fn scene(&self, movements: &'a BTreeMap<String, Vec3>) -> PickScene<'a> {
        PickScene {
            camera: &self.eye.stage.camera,
            medium: &self.eye.stage.medium,
            inputs: self.inputs,
            scattered: self.radiance,
            movements,
        }
    }
}

/// Names of meshes that points may follow: of their files, without the ending. Nothing moves.
pub fn movements(meshes: &[PathBuf]) -> BTreeMap<String, Vec3> {
    let name = |path: &PathBuf| path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    meshes.iter().filter_map(name).map(|name| (name, Vec3::ZERO)).collect()
}

/// A transfer function and the passes that apply it.
pub struct Recolour {
    file: PathBuf,
    transfer: Keyed<Transfer>,
    baker: Baker,
    /// Of all key frames, where no constraint depends on the picture.
    baked: Option<Keyed<Texture>>,
    /// The function of the last frame.
    pub function: Option<Texture>,
    /// Of each eye, and whether the function asks for what is dear.
    restyles: Vec<(Restyle, bool)>,
}

impl Recolour {
    /// Builds the passes, and bakes what does not change.
    ///
    /// # Errors
    /// A failure, with the file.
    pub fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        file: &Path,
        transfer: Keyed<Transfer>,
    ) -> Result<Self, CommandError> {
        let baker = Baker::new(gpu, shaders).map_err(|error| failed(file, error))?;
        let placed = !transfer.keys().iter().any(|(_, transfer)| picks(transfer));
        let baked = placed.then(|| baker.bake_keys(gpu, &transfer, None)).transpose();
        let baked = baked.map_err(|error| failed(file, error))?;
        Ok(Self { file: file.to_owned(), transfer, baker, baked, function: None, restyles: Vec::new() })
    }

    /// Recolours what all eyes see; constraints that name pixels and points mean the first.
    ///
    /// # Errors
    /// A failure, with the file.
    pub fn draw(
        &mut self,
        gpu: &Gpu,
        shaders: &Shaders,
        frame: f32,
        pictures: &[Scattered<'_>],
        movements: &BTreeMap<String, Vec3>,
    ) -> Result<(), CommandError> {
        let file = self.file.clone();
        self.try_draw(gpu, shaders, frame, pictures, movements).map_err(|error| failed(&file, error))
    }

    fn try_draw(
        &mut self,
        gpu: &Gpu,
        shaders: &Shaders,
        frame: f32,
        pictures: &[Scattered<'_>],
        movements: &BTreeMap<String, Vec3>,
    ) -> Result<(), TransferError> {
        let first = pictures.first().map(|picture| picture.scene(movements));
        let map = match &self.baked {
            Some(baked) => self.baker.mix_frame(gpu, baked, frame)?,
            None => self.baker.bake_frame(gpu, &self.transfer, frame, first.as_ref())?,
        };
        let mut encoder = gpu.encoder();
        for (index, picture) in pictures.iter().enumerate() {
            let function = self.transfer.function(frame, &picture.eye.stage.medium);
            let marched = function.needs_visible_depth();
            let [width, height, _] = picture.radiance.size();
            if self.restyles.get(index).is_none_or(|(_, before)| *before != marched) {
                let restyle = Restyle::new(gpu, shaders, &function, &picture.inputs, [width, height])?;
                self.restyles.truncate(index);
                self.restyles.push((restyle, marched));
            }
            let restyle = &self.restyles[index].0;
            let uniform = Buffer::uniform(gpu, &function);
            let bound = restyle.bind(gpu, &picture.inputs, picture.radiance, &map, &uniform)?;
            restyle.record(&mut encoder, &bound);
        }
        gpu.submit(encoder)?;
        self.function = Some(map);
        Ok(())
    }

    /// What an eye sees, recoloured.
    pub fn restyled(&self, eye: usize) -> Option<&Texture> {
        self.restyles.get(eye).map(|(restyle, _)| &restyle.restyled)
    }

    /// The settings of a frame, numbers between those of the key frames around it.
    pub fn settings(&self, frame: f32, medium: &Medium) -> TransferSettings {
        let (before, after, share) = self.transfer.around(frame);
        let function = self.transfer.function(frame, medium);
        let settings = if share >= 1.0 { after.settings } else { before.settings };
        TransferSettings { depth_limit: Some(function.depth_limit), g: Some(function.g), ..settings }
    }
}

/// Whether a constraint names a pixel or a point.
fn picks(transfer: &Transfer) -> bool {
    transfer.layers.iter().any(|layer| match &layer.source {
        Source::Diffusion(constraints) => {
            constraints.iter().any(|constraint| !matches!(constraint.place, Place::At(_)))
        }
        _ => false,
    })
}

fn failed(file: &Path, error: TransferError) -> CommandError {
    let said = crate::command::error::named(file, error.to_string());
    CommandError::failure(format!("--transfer: {said}"))
}

/// Where pixels of the whole picture lie in a function of `settings`, as lines for constraints. Eyes lie side by side.
///
/// # Errors
/// [`CommandError`].
pub fn positions(
    gpu: &Gpu,
    shaders: &Shaders,
    settings: &TransferSettings,
    pixels: &[[u32; 2]],
    pictures: &[Scattered<'_>],
    movements: &BTreeMap<String, Vec3>,
) -> Result<Vec<String>, CommandError> {
    let failed = |error: TransferError| CommandError::failure(format!("--pick: {error}"));
    let baker = Baker::new(gpu, shaders).map_err(failed)?;
    let mut lines = Vec::new();
    for [x, y] in pixels {
        let width = pictures.first().map_or(1, |picture| picture.radiance.size()[0]);
        let Some(picture) = pictures.get((x / width) as usize) else { continue };
        let place = Place::Pixel([x % width, *y]);
        let found = baker.positions(gpu, settings, &[place], &picture.scene(movements)).map_err(failed)?;
        lines.extend(found.iter().map(|at| format!("at = [{:.4}, {:.4}] # pixel {x},{y}", at.x, at.y)));
    }
    Ok(lines)
}
