// SPDX-License-Identifier: MIT OR Apache-2.0
//! Where rays are sampled: straight ones in slices of the box, bent ones in steps of one length.

use super::grid::{Basis, Grid};
use super::ray::{Ray, View, VolumeBox};
use crate::linear::Vec3;

/// A part of a ray, as one point stands for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// That point, coordinates of the box.
    pub unit: Vec3,
    /// Its length, metres.
    pub length: f64,
}

/// The box cut across one of its axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slices {
    /// 0 to 2.
    pub axis: usize,
    /// How many; slice s lies between s and s + 1 parts of them.
    pub count: usize,
}

impl Slices {
    /// Across the axis along which the ray through the picture's middle passes most voxels of the extinction a metre;
    /// the first of several.
    #[must_use]
    pub fn of_view(volume: &VolumeBox, view: &View, extinction: [usize; 3], count: usize) -> Self {
        let along = volume.unit_direction(view.through([0.0, 0.0]).direction).to_array();
        let pace = [0, 1, 2].map(|axis| along[axis].abs() * extinction[axis] as f64);
        let mut axis = 0;
        for other in 1..3 {
            if pace[other] > pace[axis] {
                axis = other;
            }
        }
        Self { axis, count }
    }

    fn corners(&self, slice: usize) -> [Vec3; 2] {
        let sides = [slice, slice + 1].map(|side| side as f64 / self.count as f64);
        let corner = |outside: f64, side: f64| {
            let mut corner = [outside; 3];
            corner[self.axis] = side;
            Vec3::from(corner)
        };
        [corner(0.0, sides[0]), corner(1.0, sides[1])]
    }
}

/// The parts of a straight ray, one a slice that it meets, nearest first. Each is sampled beside its middle, on the middle plane of its slice.
#[must_use]
pub fn straight(volume: &VolumeBox, slices: &Slices, ray: &Ray) -> Vec<Sample> {
    let part = |slice| volume.clip(ray, slices.corners(slice)).map(|part| (slice, part));
    let mut parts: Vec<(usize, [f64; 2])> = (0..slices.count).filter_map(part).collect();
    if volume.unit_direction(ray.direction).to_array()[slices.axis] == 0.0 {
        // A ray along the border of two slices is in both.
        parts.truncate(1);
    }
    parts.sort_by(|(_, a), (_, b)| a[0].total_cmp(&b[0]));
    let sample = |(slice, [begin, end]): (usize, [f64; 2])| {
        let middle = ray.origin + ray.direction * (0.5 * (begin + end));
        let mut unit = volume.unit(middle).to_array();
        unit[slices.axis] = (slice as f64 + 0.5) / slices.count as f64;
        Sample { unit: Vec3::from(unit), length: end - begin }
    };
    parts.into_iter().map(sample).collect()
}

/// Central differences of an index over half a voxel to both sides, to the world; 1/m.
fn gradient(volume: &VolumeBox, index: &Grid, unit: Vec3) -> Vec3 {
    let slope = |axis: usize| {
        let half = 0.5 / index.size[axis] as f64;
        let mut aside = [0.0; 3];
        aside[axis] = half;
        let aside = Vec3::from(aside);
        (index.at(Basis::Trilinear, unit + aside) - index.at(Basis::Trilinear, unit - aside)) / (2.0 * half)
    };
    volume.world_gradient(Vec3::new(slope(0), slope(1), slope(2)))
}

/// The parts of a ray that an index of refraction bends inside the box, `step` metres each but for the last.
///
/// Light goes straight outside and is not refracted by the faces of the box. The index is continued over the faces as every
/// trilinear field is, so that its differences at the faces are one-sided.
#[must_use]
pub fn bent(volume: &VolumeBox, index: &Grid, step: f64, ray: &Ray) -> Vec<Sample> {
    let whole = [Vec3::default(), Vec3::new(1.0, 1.0, 1.0)];
    let Some([entry, _]) = volume.clip(ray, whole) else { return Vec::new() };
    let index_at = |world: Vec3| index.at(Basis::Trilinear, volume.unit(world));
    let mut place = ray.origin + ray.direction * entry;
    let mut walked = entry;
    let mut velocity = ray.direction * index_at(place);
    let mut samples = Vec::new();
    let most = (4.0 * volume.diagonal() / step).ceil() as usize;
    for _ in 0..most {
        let direction = velocity.normalised();
        let left = ray.depth - walked;
        let length = step.min(left).min(way_out(volume, place, direction));
        if length <= 0.0 {
            break;
        }
        samples.push(Sample { unit: volume.unit(place + direction * (0.5 * length)), length });
        if length < step {
            break;
        }
        let force = gradient(volume, index, volume.unit(place));
        place = place + direction * step;
        walked += step;
        velocity = (velocity + force * step).normalised() * index_at(place);
    }
    samples
}

/// Metres to where a ray from inside the box leaves it; not above 0 for one on a face, on its way out.
fn way_out(volume: &VolumeBox, place: Vec3, direction: Vec3) -> f64 {
    let (from, along) = (volume.unit(place).to_array(), volume.unit_direction(direction).to_array());
    let to = |axis: usize| match along[axis] {
        0.0 => f64::INFINITY,
        pace if pace > 0.0 => (1.0 - from[axis]) / pace,
        pace => -from[axis] / pace,
    };
    to(0).min(to(1)).min(to(2))
}

#[cfg(test)]
mod tests;
