// SPDX-License-Identifier: MIT OR Apache-2.0
//! What is painted: a volume that was read, its transfer function, and where it is solid.

use super::flags::Options;
use super::shrink::shrunk;
use crate::command::CommandError;
use crate::command::transfers::transfer;
use crate::command::volumes::load;
use crate::core::{TransferFunction, TransferPoint};
use crate::data::{Bounds, Volume, value_range};
use glam::{Mat4, Vec3};

/// Slices that the solid is measured in.
const SLICES: usize = 32;

/// A volume without what is not finite, and what is to be seen of it.
pub struct Matter {
    /// The volume, small enough for the device.
    pub volume: Volume,
    /// Colours and opacities.
    pub transfer: TransferFunction,
    /// What becomes value 0 and value 1.
    pub range: [f32; 2],
    /// Where it is solid.
    pub solid: Solid,
    /// Voxels that were not finite, and are the least value now.
    pub not_finite: usize,
    /// Why nothing can be seen.
    pub warning: Option<String>,
}

/// What holds the solid part of a volume, also where it turns about the upright axis through the middle of its box; metres.
#[derive(Debug, Clone, PartialEq)]
pub struct Solid {
    /// The box around it.
    pub bounds: Bounds,
    /// Of slices of one height, from the lowest to the highest, how far the solid reaches from the axis; negative where it does not.
    radii: [f32; SLICES],
}

impl Matter {
    /// Reads it.
    ///
    /// # Errors
    /// Misuse: an unknown name. A failure: a file, or a volume that is too large.
    pub fn new(flags: &Options) -> Result<Self, CommandError> {
        let transfer = flags.transfer.as_deref().map_or_else(|| Ok(ramp()), transfer)?;
        let volume = load(&flags.volume, flags.voxel, "a file that ends in .nii, .nii.gz or .npy")?;
        check_sides(flags, volume.size)?;
        Ok(Self::of(volume, transfer, flags.iso, flags.downsample))
    }

    fn of(mut volume: Volume, transfer: TransferFunction, iso: f32, downsample: u32) -> Self {
        let [low, high] = transfer.range.unwrap_or_else(|| value_range(&volume.values));
        let mut not_finite = 0;
        for value in volume.values.iter_mut().filter(|value| !value.is_finite()) {
            *value = low;
            not_finite += 1;
        }
        let volume = shrunk(volume, downsample);
        let share = |value: f32| {
            let share = (f64::from(value) - f64::from(low)) / (f64::from(high) - f64::from(low));
            share.clamp(0.0, 1.0) as f32
        };
        let [least, greatest] = volume
            .values
            .iter()
            .fold([f32::INFINITY, f32::NEG_INFINITY], |[l, g], value| [l.min(*value), g.max(*value)]);
        let warning = if transfer.greatest_opacity(0.0, 1.0) < iso {
            let most = transfer.greatest_opacity(0.0, 1.0);
            Some(format!(
                "--transfer: it is nowhere as opaque as --iso {iso}, {most} at most: nothing is seen"
            ))
        } else if transfer.greatest_opacity(share(least), share(greatest)) < iso {
            Some(format!(
                "--volume: none of its values, from {least} to {greatest}, is as opaque as --iso {iso}: nothing is seen"
            ))
        } else {
            None
        };
        let solid = Solid::new(&volume, |value| transfer.opacity(share(value)) >= iso);
        Self { volume, transfer, range: [low, high], solid, not_finite, warning }
    }

    /// Where the volume lies after so many degrees about the upright axis through what is solid.
    pub fn turned(&self, degrees: f64) -> Mat4 {
        let center = self.solid.bounds.center();
        let turn = Mat4::from_rotation_y((degrees % 360.0).to_radians() as f32);
        Mat4::from_translation(center) * turn * Mat4::from_translation(-center) * self.volume.world_from_unit
    }
}

impl Solid {
    /// Of all voxels whose values are solid, and what is read between them and their neighbours; of the whole volume where none is.
    fn new(volume: &Volume, solid: impl Fn(f32) -> bool) -> Self {
        let [width, height, _] = volume.size.map(|side| side as usize);
        let sides = Vec3::from(volume.size.map(|side| side as f32));
        let place = |index: usize| {
            let voxel = [index % width, index / width % height, index / width / height];
            let unit = (Vec3::from(voxel.map(|at| at as f32)) + 0.5) / sides;
            volume.world_from_unit.transform_point3(unit)
        };
        let places = || {
            let solid = volume.values.iter().enumerate().filter(|(_, value)| solid(**value));
            solid.map(|(index, _)| place(index))
        };
        let axes =
            [volume.world_from_unit.x_axis, volume.world_from_unit.y_axis, volume.world_from_unit.z_axis];
        let voxel = Vec3::from([0, 1, 2].map(|axis| axes[axis].truncate().length() / sides[axis]));
        // Half a voxel is its own, and half way to its neighbours may be solid too.
        let around = voxel.length();
        let whole = volume.bounds();
        let Some(Bounds { min, max }) = Bounds::of(places()) else {
            return Self { bounds: whole, radii: [0.5 * whole.size().with_y(0.0).length(); SLICES] };
        };
        let bounds = Bounds { min: (min - around).max(whole.min), max: (max + around).min(whole.max) };
        let (center, height) = (bounds.center(), bounds.size().y);
        let slice = |y: f32| (((y - bounds.min.y) / height).clamp(0.0, 0.999) * SLICES as f32) as usize;
        let mut radii = [-1.0_f32; SLICES];
        for place in places() {
            let radius = around + (place - center).with_y(0.0).length();
            let reached = slice(place.y - around)..=slice(place.y + around);
            radii[reached].iter_mut().for_each(|known| *known = known.max(radius));
        }
        Self { bounds, radii }
    }

    /// Points whose convex hull holds it, however it turns.
    pub fn points(&self) -> impl Iterator<Item = Vec3> {
        const AROUND: u16 = 32;
        let (bottom, center) = (self.bounds.min.y, self.bounds.center());
        let height = self.bounds.size().y / SLICES as f32;
        let slices = self.radii.iter().enumerate().filter(|(_, radius)| **radius >= 0.0);
        slices.flat_map(move |(index, radius)| {
            let radius = radius / (std::f32::consts::PI / f32::from(AROUND)).cos();
            (0..AROUND).flat_map(move |step| {
                let (sine, cosine) = (std::f32::consts::TAU * f32::from(step) / f32::from(AROUND)).sin_cos();
                let (x, z) = (center.x + radius * sine, center.z + radius * cosine);
                [index, index + 1].map(|edge| Vec3::new(x, bottom + height * edge as f32, z))
            })
        })
    }
}

/// From terracotta to ivory; opacity is the share of the range.
fn ramp() -> TransferFunction {
    let point = |value, color, opacity| TransferPoint { value, color: Vec3::from(color), opacity };
    let points = vec![point(0.0, [0.35, 0.09, 0.05], 0.0), point(1.0, [0.95, 0.85, 0.66], 1.0)];
    TransferFunction { range: None, points }
}

/// Whether the volume, with fewer voxels as asked for, fits into a 3D texture.
fn check_sides(flags: &Options, size: [u32; 3]) -> Result<(), CommandError> {
    // Those of every device.
    let limit = wgpu::Limits::default().max_texture_dimension_3d;
    let longest = size.into_iter().max().unwrap_or(0);
    if longest.div_ceil(flags.downsample) <= limit {
        return Ok(());
    }
    let (path, enough) = (flags.volume.display(), longest.div_ceil(limit));
    let [x, y, z] = size;
    let remedy = if enough <= 64 { format!("give --downsample {enough}") } else { "crop it".to_owned() };
    Err(CommandError::failure(format!(
        "--volume: {path}: {x} x {y} x {z} voxels are too many for a 3D texture, which has {limit} a side: {remedy}"
    )))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matter(values: &[(usize, f32)], iso: f32, downsample: u32) -> Matter {
        let mut all = vec![0.0; 1000];
        values.iter().for_each(|(index, value)| all[*index] = *value);
        let world_from_unit = Mat4::from_translation(Vec3::X) * Mat4::from_scale(Vec3::splat(10.0));
        Matter::of(Volume { size: [10; 3], values: all, world_from_unit }, ramp(), iso, downsample)
    }

    #[test]
    fn what_is_solid_is_found_and_framed() {
        let found = matter(&[(555, 4.0), (554, 1.9), (0, f32::NAN), (999, f32::NEG_INFINITY)], 0.5, 1);
        assert_eq!((found.not_finite, found.range, found.warning.is_none()), (2, [0.0, 4.0], true));
        assert_eq!((found.volume.values[0], found.volume.values[999]), (0.0, 0.0));
        let center = Vec3::new(6.5, 5.5, 5.5);
        assert!(found.solid.bounds.center().distance(center) < 1e-5, "{:?}", found.solid);
        let radius = 3.0_f32.sqrt();
        assert!(found.solid.bounds.min.distance(center - radius) < 1e-5, "{:?}", found.solid);
        assert!(found.solid.radii.iter().all(|found| (found - radius).abs() < 1e-5), "{:?}", found.solid);
        // It stays where it is when it turns.
        for degrees in [0.0, 90.0, -33.0, 36000.0 + 12.5] {
            let unit = Vec3::new(0.55, 0.55, 0.55);
            assert!(found.turned(degrees).transform_point3(unit).distance(center) < 1e-5, "{degrees}");
        }
        let corner = found.turned(90.0).transform_point3(Vec3::new(0.55, 0.55, 0.65));
        assert!(corner.distance(center + Vec3::X) < 1e-5, "{corner}");
        let away = |point: Vec3| (point - center).with_y(0.0).length();
        assert!(found.solid.points().all(|point| (0.999 * radius..1.01 * radius).contains(&away(point))));
        // The mean over eight voxels.
        assert_eq!(matter(&[(555, 4.0)], 0.5, 2).range, [0.0, 4.0]);
    }

    #[test]
    fn what_cannot_be_seen_is_said() {
        assert!(matter(&[(555, 4.0)], 1.0, 1).warning.is_none());
        let alike = matter(&[], 0.5, 1);
        assert!(alike.warning.is_some_and(|said| said.contains("from 0 to 0")));
        assert_eq!(alike.solid.bounds.size(), Vec3::splat(10.0));
        // What is averaged is no longer as great.
        let thin = matter(&[(555, 4.0)], 0.5, 2).warning;
        assert!(thin.is_some_and(|said| said.contains("from 0 to 0.5")));
    }
}
