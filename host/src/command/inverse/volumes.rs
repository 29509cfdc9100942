// SPDX-License-Identifier: MIT OR Apache-2.0
//! The volume: its extinction, emission and albedo, read or made, without numbers that mean nothing.

use super::field::{Field, reduced};
use super::options::{MediumFlags, Property};
use crate::command::CommandError;
use crate::command::error::medium_error;
use crate::command::volumes::{KNOWN, Made, is_array, load_all, voxels};
use crate::data::{Bounds, Volume, load_channels};
use crate::inverse::Channels;
use glam::{Mat4, Vec3};
use std::path::PathBuf;

/// Optical depth along the longest side of a file, were all of it as dense as its densest voxel.
const OPTICAL_DEPTH: f32 = 32.0;
/// Voxels along the longest side of what is made.
const VOXELS: u32 = 64;
/// How far the corners of two volumes of one place may lie apart, of the longest side.
const SAME_PLACE: f32 = 1e-3;
/// Greatest emission that is read.
const MOST_EMISSION: f32 = 1e4;

/// What is in the box of the volume.
pub struct Matter {
    /// From the box 0..1 to the world, metres.
    pub place: Mat4,
    /// 1/m, 0 and more.
    pub extinction: Field,
    /// Radiance, 0 and more.
    pub emission: Field,
    /// 0..1.
    pub albedo: Field,
    /// From values to 1/m.
    pub scale: f32,
    /// What is to be said, a line each.
    pub report: Vec<String>,
}

impl Matter {
    /// Reads or makes it.
    ///
    /// # Errors
    /// Misuse: an unknown name. A failure: a file, or properties that lie elsewhere than the volume.
    pub fn new(flags: &MediumFlags, channels: Channels) -> Result<Self, CommandError> {
        let mut report = Vec::new();
        let volumes = volumes(flags)?;
        let place = volumes[0].world_from_unit;
        let mut field = field(&volumes);
        let made = Made::of(&flags.volume).is_some();
        let threshold = flags.of_volume.threshold.unwrap_or(0.0);
        let bad = field.values.iter().filter(|value| !value.is_finite() || value.min_element() < 0.0).count();
        for value in &mut field.values {
            *value = clean(*value - threshold, f32::MAX);
        }
        let greatest = field.values.iter().map(|value| value.max_element()).fold(0.0, f32::max);
        let longest = edges(place).into_iter().fold(0.0, f32::max);
        let usual = if made || greatest == 0.0 { 1.0 } else { OPTICAL_DEPTH / (longest * greatest) };
        let scale = flags.of_volume.extinction_scale.unwrap_or(usual);
        for value in &mut field.values {
            *value = reduced((*value * scale).min(Vec3::splat(1e6)), channels);
        }
        report.push(format!("extinction: {scale:.4} 1/m a unit of value above {threshold}"));
        if bad > 0 {
            let voxels = field.values.len();
            report.push(format!("voxels: {voxels}; taken as empty: {bad} not finite or negative"));
        }
        let property = |flag: &str, of: &Property, most: f32| {
            let mut field = match of {
                Property::Constant(colour) => Field::constant(*colour),
                Property::File(path) => placed(flag, path, place)?,
            };
            field.values.iter_mut().for_each(|value| *value = reduced(clean(*value, most), channels));
            Ok::<_, CommandError>(field)
        };
        let emission = property("--emission", &flags.emission, MOST_EMISSION)?;
        let albedo = property("--albedo", &flags.albedo, 1.0)?;
        Ok(Self { place, extinction: field, emission, albedo, scale, report })
    }

    /// The box around it in the world, metres.
    pub fn bounds(&self) -> Bounds {
        let unit = Bounds { min: Vec3::ZERO, max: Vec3::ONE };
        let corners = unit.corners().map(|corner| self.place.transform_point3(corner));
        Bounds::of(corners).unwrap_or(unit)
    }
}

/// Metres of the edges of a box.
pub fn edges(place: Mat4) -> [f32; 3] {
    [place.x_axis, place.y_axis, place.z_axis].map(|edge| edge.truncate().length())
}

/// Voxels of a volume in such a place with `count` along its longest side.
pub fn voxels_of(place: Mat4, count: u32) -> [u32; 3] {
    voxels(count, edges(place))
}

/// Greatest distance of the corners of two boxes, metres.
fn apart(one: Mat4, other: Mat4) -> f32 {
    let corners = Bounds { min: Vec3::ZERO, max: Vec3::ONE }.corners();
    let apart = corners.map(|corner| one.transform_point3(corner).distance(other.transform_point3(corner)));
    apart.into_iter().fold(0.0, f32::max)
}

/// Whether a volume lies where another does, but for rounding.
pub fn same_place(own: Mat4, place: Mat4) -> bool {
    apart(own, place) <= SAME_PLACE * edges(place).into_iter().fold(0.0, f32::max)
}

/// From 0 to the most; 0 where it is no number.
fn clean(value: Vec3, most: f32) -> Vec3 {
    Vec3::from(value.to_array().map(|value| if value.is_finite() { value.clamp(0.0, most) } else { 0.0 }))
}

fn volumes(flags: &MediumFlags) -> Result<Vec<Volume>, CommandError> {
    let of = &flags.of_volume;
    match Made::of(&flags.volume) {
        Some(made) => Ok(vec![made.volume(of.voxels.unwrap_or(VOXELS), of.seed())]),
        None => load_all(&flags.volume, of.voxel, KNOWN),
    }
}

/// One volume is grey.
fn field(volumes: &[Volume]) -> Field {
    let channel = |channel: usize| &volumes[channel.min(volumes.len() - 1)].values;
    let [red, green, blue] = [0, 1, 2].map(channel);
    let values = red.iter().zip(green).zip(blue).map(|((r, g), b)| Vec3::new(*r, *g, *b));
    Field { size: volumes[0].size, values: values.collect() }
}

/// A property from a file, which has to lie where the volume does if it says where.
///
/// # Errors
/// Misuse: an unknown name. A failure: a file, or one that lies elsewhere.
pub fn placed(flag: &str, path: &PathBuf, place: Mat4) -> Result<Field, CommandError> {
    let known = "a file that ends in .nii, .nii.gz or .npy";
    let volumes = load_channels(path, 1.0).map_err(|error| medium_error(flag, error, known))?;
    if !is_array(path) {
        let own = volumes[0].world_from_unit;
        if !same_place(own, place) {
            let most = apart(own, place);
            return Err(CommandError::failure(format!(
                "{flag}: {} lies elsewhere than --volume, up to {most} m apart: resample it to the same box, or give a .npy, which has no place",
                path.display()
            )));
        }
    }
    Ok(field(&volumes))
}
