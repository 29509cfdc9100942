// SPDX-License-Identifier: MIT OR Apache-2.0
//! Files of a solve: volumes, pictures of views and between them, and frames between key frames.

use super::between::between;
use super::keys::place_of;
use super::options::{SolveOptions, Wanted};
use super::parts::Property;
use super::stage::Stages;
use super::studio::{Look, Seen, Shot};
use super::views::ViewDescription;
use crate::command::CommandError;
use crate::command::sequence::{FrameRange, write_frames};
use crate::command::staging::Staging;
use crate::data::srgb_from_linear;
use crate::formats::{WriteError, write_exr, write_png};
use glam::Vec3;
use indicatif::ProgressBar;
use std::path::{Path, PathBuf};

/// The animation of all frames.
const FRAMES: &str = "frame.png";

/// Names of a volume's files.
pub fn volume_names(property: Property) -> [String; 2] {
    ["nii.gz", "npy"].map(|ending| format!("{}.{ending}", property.name()))
}

/// Names of the pictures of views, and between those that follow each other.
pub fn view_names(views: &[ViewDescription]) -> Vec<String> {
    let solved = |view: &ViewDescription| ["png", "exr"].map(|end| format!("solved_{}.{end}", view.name));
    let mut names: Vec<String> = views.iter().flat_map(solved).collect();
    names.extend(views.windows(2).map(|pair| between_name(&pair[0], &pair[1])));
    names
}

/// Names of the pictures and volumes of frames.
pub fn frame_names(frames: FrameRange, properties: &[Property]) -> Vec<String> {
    let mut names = vec![FRAMES.to_owned()];
    for frame in frames.first..=frames.last() {
        names.extend(["png", "exr"].map(|end| format!("frame.{frame:04}.{end}")));
        for name in properties.iter().map(|property| frame_name(*property, frame)) {
            names.extend(["nii.gz", "npy"].map(|end| format!("{name}.{end}")));
        }
    }
    names
}

fn frame_name(property: Property, frame: u32) -> String {
    format!("{}.{frame:04}", property.name())
}

fn between_name(first: &ViewDescription, second: &ViewDescription) -> String {
    format!("between_{}_{}.png", first.name, second.name)
}

/// Writes one volume of what was solved for.
///
/// # Errors
/// A failure.
pub fn write_volume(
    stages: &Stages<'_>,
    look: &Look,
    property: Property,
    name: &str,
    staging: &Staging,
) -> Result<(), CommandError> {
    let field = match property {
        Property::Extinction => &look.extinction,
        Property::Emission => &look.emission,
        Property::Albedo => &look.albedo,
    };
    field.write(&staging.path(""), name, stages.studio.place, stages.studio.channels)
}

/// Writes each view as it looks now, and pictures between those that follow each other, in the light of the first and before the mean of what
/// lies behind both.
///
/// # Errors
/// A failure.
pub fn write_views(stages: &Stages<'_>, shown: &Look, staging: &Staging) -> Result<(), CommandError> {
    let (studio, seen) = (stages.studio, stages.seen);
    for (seen, picture) in seen.iter().zip(stages.pictures(shown)?) {
        let name = format!("solved_{}.png", seen.name());
        let composed = picture.over(&seen.background);
        write_both(&staging.path(name), seen.loaded.description.size, &composed)?;
    }
    let mut cameras = Vec::new();
    for pair in seen.windows(2) {
        if let Some(camera) = between(&pair[0].loaded.description, &pair[1].loaded.description) {
            cameras.push((studio.rays(&camera, shown)?, pair));
        }
    }
    let shots: Vec<Shot<'_>> =
        cameras.iter().map(|(slices, pair)| Shot { slices, depths: None, light: pair[0].light }).collect();
    let mean = |seen: &Seen| seen.background.iter().sum::<Vec3>() / seen.background.len().max(1) as f32;
    for (picture, (_, pair)) in studio.pictures(shown, &shots)?.iter().zip(&cameras) {
        let [one, other] = [&pair[0].loaded.description, &pair[1].loaded.description];
        let behind = vec![mean(&pair[0]).midpoint(mean(&pair[1])); picture.radiance.len()];
        let path = staging.path(between_name(one, other));
        write_shown(&path, one.size, &bytes(&picture.over(&behind)))?;
    }
    Ok(())
}

/// Frames between key frames.
pub struct Frames<'a> {
    /// Which.
    pub range: FrameRange,
    /// Times of the key frames, which ascend.
    pub times: &'a [f32],
    /// What was solved for, of each.
    pub looks: &'a [Look],
    /// What is blended and written of them.
    pub properties: &'a [Property],
    /// From where they are seen.
    pub seen: &'a Seen,
}

impl Frames<'_> {
    /// Writes the pictures and volumes of all frames. `last`: what was solved for at last.
    ///
    /// # Errors
    /// A failure.
    pub fn write(
        &self,
        stages: &Stages<'_>,
        last: Wanted,
        flags: &SolveOptions,
        staging: &Staging,
        bar: &ProgressBar,
    ) -> Result<(), CommandError> {
        let size = self.seen.loaded.description.size;
        let out = staging.path(FRAMES);
        write_frames(&out, size, self.range, flags.rate, |frame| {
            bar.set_message(format!("frame {frame}"));
            let look = self.look(frame);
            for property in self.properties {
                write_volume(stages, &look, *property, &frame_name(*property, frame), staging)?;
            }
            let shown = stages.shown(last, &look);
            let pictures = stages.studio.pictures(&shown, &[self.seen.shot()])?;
            let composed: Vec<Vec3> =
                pictures.iter().flat_map(|picture| picture.over(&self.seen.background)).collect();
            write_radiance(&staging.path(format!("frame.{frame:04}.exr")), size, &composed)?;
            bar.inc(1);
            Ok(bytes(&composed))
        })
    }

    /// The blend of the key frames before and after a frame.
    fn look(&self, frame: u32) -> Look {
        let (first, part) = place_of(frame, self.times);
        let own = &self.looks[first];
        self.looks.get(first + 1).map_or_else(|| own.clone(), |next| own.blended(next, part))
    }
}

/// A .png and, beside it, an .exr.
fn write_both(path: &Path, size: [u32; 2], composed: &[Vec3]) -> Result<(), CommandError> {
    write_shown(path, size, &bytes(composed))?;
    write_radiance(&path.with_extension("exr"), size, composed)
}

fn write_shown(path: &Path, [width, height]: [u32; 2], bytes: &[u8]) -> Result<(), CommandError> {
    write_png(path, width, height, bytes).map_err(said)
}

/// An .exr of linear radiance.
///
/// # Errors
/// A failure.
pub fn write_radiance(
    path: &PathBuf,
    [width, height]: [u32; 2],
    composed: &[Vec3],
) -> Result<(), CommandError> {
    let values: Vec<f32> = composed.iter().flat_map(|colour| colour.to_array()).collect();
    write_exr(path, width, height, &values).map_err(said)
}

/// A file that cannot be written.
pub fn said(error: WriteError) -> CommandError {
    CommandError::failure(format!("--out: {error}"))
}

/// As a .png has it: sRGB, clipped.
fn bytes(colours: &[Vec3]) -> Vec<u8> {
    let encode = |value: f32| (255.0 * srgb_from_linear(value.max(0.0)) + 0.5) as u8;
    colours.iter().flat_map(|colour| colour.to_array().map(encode)).collect()
}
