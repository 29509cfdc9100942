// SPDX-License-Identifier: MIT OR Apache-2.0
//! What is seen: volumes, read or made, their values brought to 0..1, and where they lie.

use super::flags::Options;
use crate::command::CommandError;
use crate::command::parse::Placed;
use crate::command::transfers::transfer;
use crate::command::volumes::{KNOWN, Made, load};
use crate::core::TransferFunction;
use crate::data::{Bounds, Mesh, Volume, load_mesh, value_range};
use crate::splatting::Kernel;
use glam::Vec3;
use std::path::Path;

/// Optical depth along the longest side of files, were all of them opaque.
const OPTICAL_DEPTH: f32 = 100.0;

/// Reads or makes one.
fn volume(source: &Path, flags: &Options) -> Result<Volume, CommandError> {
    match Made::of(source) {
        Some(made) => Ok(made.volume(flags.voxels(), flags.of_volume.seed())),
        None => load(source, flags.of_volume.voxel, KNOWN),
    }
}

/// All volumes of the scene, which act as one, and its meshes.
pub struct Volumes {
    /// Values 0..1.
    pub list: Vec<Volume>,
    /// Voxels of no greater value are left out, 0..1.
    pub threshold: f32,
    /// Colours and opacities.
    pub transfer: TransferFunction,
    /// Where opacity is 1, 1/m.
    pub extinction: f32,
    /// Meshes as one.
    pub mesh: Mesh,
    /// Points whose convex hull holds all splats and meshes, metres.
    pub points: Vec<Vec3>,
    /// The box around what is to be seen.
    pub framed: Bounds,
    /// What is to be said, a line each.
    pub report: Vec<String>,
    /// That nothing can be seen.
    pub warning: Option<String>,
}

impl Volumes {
    /// Reads or makes them.
    ///
    /// # Errors
    /// Misuse: an unknown name. A failure: a file.
    pub fn new(flags: &Options) -> Result<Self, CommandError> {
        let transfer = transfer(&flags.transfer)?.tinted(flags.albedo);
        let mut mesh = Mesh::default();
        for placed in &flags.mesh {
            let read = load_mesh(&placed.source);
            let read = read.map_err(|error| CommandError::Failure(format!("--mesh: {error}")))?;
            mesh.append(&read.transformed(placed.transform()));
        }
        let read = |placed: &Placed| -> Result<Volume, CommandError> {
            let mut volume = volume(&placed.source, flags)?;
            volume.world_from_unit = placed.transform() * volume.world_from_unit;
            Ok(volume)
        };
        let list = flags.volume.iter().map(read).collect::<Result<Vec<_>, _>>()?;
        let made = flags.volume.iter().all(|placed| Made::of(&placed.source).is_some());
        Ok(Self::of(list, mesh, transfer, flags, made))
    }

    fn of(
        mut list: Vec<Volume>,
        mesh: Mesh,
        transfer: TransferFunction,
        flags: &Options,
        made: bool,
    ) -> Self {
        let ranges = list.iter().map(|volume| value_range(&volume.values));
        let [low, high] = transfer.range.unwrap_or_else(|| {
            // Of those that are made opacity is to be the share of the extinction.
            let none = if made { 0.0 } else { f32::INFINITY };
            ranges.fold([none, f32::NEG_INFINITY], |[low, high], [l, h]| [low.min(l), high.max(h)])
        });
        let share = |value: f32| {
            let share = (f64::from(value) - f64::from(low)) / (f64::from(high) - f64::from(low));
            share.clamp(0.0, 1.0) as f32
        };
        let transparent = transfer.transparent_below();
        let threshold = flags.of_volume.threshold.map_or(transparent, share).min(1.0);
        let mut not_finite = 0;
        for value in list.iter_mut().flat_map(|volume| &mut volume.values) {
            if value.is_finite() {
                *value = share(*value);
            } else {
                *value = 0.0;
                not_finite += 1;
            }
        }
        let (mut points, mut framed): (Vec<Vec3>, Option<Bounds>) = (mesh.positions.clone(), mesh.bounds());
        let mut seen = false;
        for volume in &list {
            let (held, occupied) = corners(volume, threshold);
            seen |= occupied;
            points.extend(held);
            if let (true, Some(bounds)) = (occupied, Bounds::of(held)) {
                framed = Some(framed.map_or(bounds, |all| all.union(&bounds)));
            }
        }
        let whole = Bounds::of(points.iter().copied());
        let whole = whole.unwrap_or(Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE });
        let longest =
            list.iter().map(|volume| volume.bounds().size().max_element()).fold(0.0, f32::max).max(1e-6);
        let own = if made { high.max(0.0) } else { (OPTICAL_DEPTH / longest).min(1e6) };
        let extinction = flags.of_volume.extinction_scale.unwrap_or(own);
        let mut report = vec![
            format!("values: {low} to {high}; left out up to {}", low + threshold * (high - low)),
            format!("extinction: {extinction:.4} 1/m where opacity is 1"),
        ];
        if not_finite > 0 {
            let voxels: usize = list.iter().map(|volume| volume.values.len()).sum();
            report.push(format!("voxels: {voxels}; taken as the least value: {not_finite} not finite"));
        }
        let warning = (!seen).then(|| {
            let least = low + threshold * (high - low);
            format!("--volume: no voxel exceeds {least}: give another --threshold or --transfer; nothing of it is seen")
        });
        let framed = framed.unwrap_or(whole);
        Self { list, threshold, transfer, extinction, mesh, points, framed, report, warning }
    }
}

/// Points whose convex hull holds all splats of a volume, metres, and whether there are any; of one without splats its own corners.
fn corners(volume: &Volume, threshold: f32) -> ([Vec3; 8], bool) {
    let sides = Vec3::from(volume.size.map(|side| side as f32));
    let reach = Kernel::default().radius;
    let occupied = volume.occupied_voxels(threshold.max(0.0));
    let [low, high] = occupied.map_or([Vec3::splat(-0.5), sides - 0.5], |[l, h]| [l - reach, h + reach]);
    let unit = Bounds { min: (low + 0.5) / sides, max: (high + 0.5) / sides }.corners();
    (unit.map(|at| volume.world_from_unit.transform_point3(at)), occupied.is_some())
}
