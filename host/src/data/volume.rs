// SPDX-License-Identifier: MIT OR Apache-2.0
//! Volumes of extinction: values on a grid in a box, and generators of a cloud and of a plume of smoke.

use super::mesh::Bounds;
use super::random::fractal_noise;
use glam::{Mat4, Vec3};

/// What makes a volume impossible.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum VolumeError {
    /// The number of values is not that of voxels.
    #[error(
        "a volume of {size:?} voxels was given {given} values: give one a voxel, x fastest, at least one voxel"
    )]
    Count {
        /// Voxels along x, y and z.
        size: [u32; 3],
        /// Number of values.
        given: usize,
    },
    /// The box has no extent, or is nowhere.
    #[error("the box of a volume is flat or not finite: its matrix must be finite and have an inverse")]
    Space,
}

/// Values on a grid that fills a box.
#[derive(Debug, Clone, PartialEq)]
pub struct Volume {
    /// Voxels along x, y and z, positive.
    pub size: [u32; 3],
    /// One a voxel, x fastest, then y: extinction in 1/m, or what a scale makes it.
    pub values: Vec<f32>,
    /// From the box 0..1, in which voxel i lies at (i + 0.5) / size, to the world, metres; affine.
    pub world_from_unit: Mat4,
}

impl Volume {
    /// A volume from its values.
    ///
    /// # Errors
    /// [`VolumeError`].
    pub fn new(size: [u32; 3], values: Vec<f32>, world_from_unit: Mat4) -> Result<Self, VolumeError> {
        let voxels = size.iter().try_fold(1_usize, |count, side| count.checked_mul(*side as usize));
        if voxels != Some(values.len()) || values.is_empty() {
            return Err(VolumeError::Count { size, given: values.len() });
        }
        let determinant = world_from_unit.determinant();
        if !(world_from_unit.is_finite() && determinant.is_finite() && determinant != 0.0) {
            return Err(VolumeError::Space);
        }
        Ok(Self { size, values, world_from_unit })
    }

    /// The box around it in the world, metres.
    pub fn bounds(&self) -> Bounds {
        let corners = (0..8_u8).map(|corner| {
            let unit = [0, 1, 2].map(|axis| f32::from(corner >> axis & 1));
            self.world_from_unit.transform_point3(Vec3::from(unit))
        });
        corners.fold(
            Bounds { min: Vec3::splat(f32::INFINITY), max: Vec3::splat(f32::NEG_INFINITY) },
            |bounds, corner| Bounds { min: bounds.min.min(corner), max: bounds.max.max(corner) },
        )
    }

    /// Points in the world, metres, whose convex hull just holds all voxels with extinction and what is read between them and
    /// their neighbours: what [`crate::core::Light::directional_leaning`] fits a map to. Of a volume without extinction the corners
    /// of the box around it.
    pub fn occupied_points(&self) -> Vec<Vec3> {
        let [width, height, slices] = self.size.map(|side| side as usize);
        // Along each line of corners of voxels, in halves of a voxel, how far occupied ones reach.
        let mut reached = vec![(u32::MAX, 0_u32); (2 * height + 1) * (2 * slices + 1)];
        let occupied = |value: &f32| value.is_finite() && *value > 0.0;
        for (row, values) in self.values.chunks_exact(width).enumerate() {
            let Some(first) = values.iter().position(occupied) else { continue };
            let last = values.iter().rposition(occupied).unwrap_or(first);
            let ([low, high], [bottom, top], [near, far]) = (
                spread([first, last], width),
                spread([row % height; 2], height),
                spread([row / height; 2], slices),
            );
            for (y, z) in [(bottom, near), (bottom, far), (top, near), (top, far)] {
                let line = &mut reached[z * (2 * height + 1) + y];
                *line = (line.0.min(low as u32), line.1.max(high as u32));
            }
        }
        let sides = 2.0 * Vec3::from(self.size.map(|side| side as f32));
        let ends = reached.iter().enumerate().filter(|(_, (low, high))| low <= high).flat_map(
            |(line, (low, high))| {
                let (y, z) = (line % (2 * height + 1), line / (2 * height + 1));
                [low, high].map(|x| Vec3::new(*x as f32, y as f32, z as f32) / sides)
            },
        );
        let points: Vec<Vec3> = ends.map(|unit| self.world_from_unit.transform_point3(unit)).collect();
        if points.is_empty() { self.bounds().corners().to_vec() } else { points }
    }

    /// Least and greatest numbers along x, y and z of the voxels whose values exceed `threshold`; none where none does.
    pub fn occupied_voxels(&self, threshold: f32) -> Option<[Vec3; 2]> {
        let [width, height, _] = self.size.map(|side| side as usize);
        let exceeding = self.values.iter().enumerate().filter(|(_, value)| **value > threshold);
        let voxels = exceeding.map(|(i, _)| {
            Vec3::from([i % width, i / width % height, i / width / height].map(|at| at as f32))
        });
        Bounds::of(voxels).map(|Bounds { min, max }| [min, max])
    }

    /// The shortest side of a voxel, metres.
    pub fn voxel(&self) -> f32 {
        let sides = [self.world_from_unit.x_axis, self.world_from_unit.y_axis, self.world_from_unit.z_axis];
        let voxel = |axis: usize| sides[axis].length() / self.size[axis] as f32;
        voxel(0).min(voxel(1)).min(voxel(2))
    }
}

/// From where to where voxels `first` to `last` of `side` are read, in halves of a voxel.
fn spread([first, last]: [usize; 2], side: usize) -> [usize; 2] {
    [(2 * first).saturating_sub(1), (2 * last + 3).min(2 * side)]
}

/// The range of values of a volume for which none is given: its least and greatest finite number; where all are alike, one that
/// begins there.
pub fn value_range(values: &[f32]) -> [f32; 2] {
    let finite = values.iter().copied().filter(|value| value.is_finite());
    let (low, high) = finite
        .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
    match (low <= high, low < high) {
        (_, true) => [low, high],
        (true, _) => [low, low + low.abs().max(1.0)],
        (false, _) => [0.0, 1.0],
    }
}

/// A volume from a function of places in the box 0..1, which reaches from `min` to `max` in the world.
pub(super) fn filled(size: [u32; 3], min: Vec3, max: Vec3, value: impl Fn(Vec3) -> f32) -> Volume {
    let size = size.map(|side| side.max(1));
    let sides = Vec3::from(size.map(|side| side as f32));
    let mut values = Vec::with_capacity(size.iter().map(|side| *side as usize).product());
    for z in 0..size[2] {
        for y in 0..size[1] {
            for x in 0..size[0] {
                values.push(value((Vec3::new(x as f32, y as f32, z as f32) + 0.5) / sides));
            }
        }
    }
    let world_from_unit = Mat4::from_translation(min) * Mat4::from_scale(max - min);
    Volume { size, values, world_from_unit }
}

/// A cumulus cloud of 6 x 3 x 5 m about the origin, billowy at its edges and empty towards the box; extinction 0 to 3 1/m.
pub fn cloud(size: [u32; 3], seed: u64) -> Volume {
    let half = Vec3::new(3.0, 1.5, 2.5);
    filled(size, -half, half, |unit| {
        let at = (2.0 * unit - 1.0) / Vec3::new(0.85, 0.8, 0.85);
        // Flat below, round above.
        let flattened = Vec3::new(at.x, if at.y < 0.0 { 1.5 * at.y } else { at.y }, at.z);
        let shape = 1.0 - flattened.length();
        let detail = fractal_noise(seed, 7.0 * unit * Vec3::new(1.2, 0.6, 1.0), 5);
        let dense = shape + 1.6 * (detail - 0.55);
        3.0 * (3.0 * dense).clamp(0.0, 1.0)
    })
}

/// A plume of smoke of 2 x 5 x 2 m on the ground, widening, curling and thinning as it rises; extinction 0 to 6 1/m.
pub fn plume(size: [u32; 3], seed: u64) -> Volume {
    filled(size, Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 5.0, 1.0), |unit| {
        let height = unit.y;
        let curl = |phase: f32, lane: u64| {
            let slow = fractal_noise(seed.wrapping_add(lane), Vec3::new(phase, 4.0 * height, 0.0), 2) - 0.5;
            0.5 * height * slow
        };
        let centre = Vec3::new(0.5 + curl(0.3, 11), height, 0.5 + curl(7.7, 23));
        let radius = 0.07 + 0.26 * height.sqrt();
        let away = (unit - centre).length() / radius;
        let detail = fractal_noise(seed.wrapping_add(51), unit * Vec3::new(6.0, 12.0, 6.0), 5);
        let dense = (1.0 - away) + 1.3 * (detail - 0.55);
        // Nothing touches the top of the box.
        let fade = (1.0 - height) / 0.15;
        6.0 * (2.5 * dense).clamp(0.0, 1.0) * (1.0 - 0.6 * height) * fade.clamp(0.0, 1.0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn generators_repeat_and_are_neither_empty_nor_full() {
        for make in [cloud, plume] {
            let volume = make([24, 20, 28], 5);
            assert_eq!(volume, make([24, 20, 28], 5));
            assert_ne!(volume.values, make([24, 20, 28], 6).values);
            assert!(volume.values.iter().all(|value| (0.0..=6.0).contains(value)));
            let dense = volume.values.iter().filter(|value| **value > 0.1).count();
            assert!((500..8000).contains(&dense), "{dense}");
            assert!(Volume::new(volume.size, volume.values.clone(), volume.world_from_unit).is_ok());
        }
    }

    #[test]
    fn impossible_volumes_are_errors() {
        let count = Volume::new([2, 2, 2], vec![0.0; 7], Mat4::IDENTITY);
        assert_eq!(count, Err(VolumeError::Count { size: [2, 2, 2], given: 7 }));
        assert!(matches!(Volume::new([0, 2, 2], vec![], Mat4::IDENTITY), Err(VolumeError::Count { .. })));
        let huge = Volume::new([u32::MAX; 3], vec![0.0], Mat4::IDENTITY);
        assert!(matches!(huge, Err(VolumeError::Count { .. })));
        for flat in [Mat4::from_scale(Vec3::new(1.0, 0.0, 1.0)), Mat4::from_scale(Vec3::splat(f32::NAN))] {
            assert_eq!(Volume::new([1, 1, 1], vec![0.0], flat), Err(VolumeError::Space));
        }
    }

    /// Of random voxels: all that is read between them lies on the inner side of planes of any direction, and touches them.
    #[test]
    fn occupied_points_span_what_is_read_of_occupied_voxels() {
        let mut random = crate::data::Random::new(3);
        let size = [7, 5, 6];
        let space = Mat4::from_rotation_y(0.4) * Mat4::from_scale(Vec3::new(3.0, 2.0, 4.0));
        for chance in [0.01, 0.05, 0.5] {
            let value = |_| if random.unit() < chance { 0.5 } else { [0.0, -1.0, f32::NAN][random.below(3)] };
            let mut values: Vec<f32> = (0..210).map(value).collect();
            values[100] = 1.0;
            let volume = Volume::new(size, values, space).expect("a volume");
            let points = volume.occupied_points();
            for _ in 0..20 {
                let axis = random.direction();
                let reached = points.iter().map(|point| axis.dot(*point)).fold(f32::NEG_INFINITY, f32::max);
                let mut needed = f32::NEG_INFINITY;
                for (i, _) in volume.values.iter().enumerate().filter(|(_, value)| **value > 0.0) {
                    for corner in 0..8_usize {
                        let voxel = [i % 7, i / 7 % 5, i / 35];
                        let unit = [0, 1, 2].map(|a| {
                            let side = size[a] as f32;
                            let away = if corner >> a & 1 == 1 { 1.5 } else { -0.5 };
                            ((voxel[a] as f32 + away) / side).clamp(0.0, 1.0)
                        });
                        needed = needed.max(axis.dot(space.transform_point3(Vec3::from(unit))));
                    }
                }
                assert!((reached - needed).abs() < 1e-5, "{reached} of {needed}");
            }
        }
        let empty = Volume::new([2, 2, 2], vec![0.0; 8], space).expect("a volume");
        assert_eq!(empty.occupied_points(), empty.bounds().corners());
    }

    #[test]
    fn bounds_and_voxels_are_in_metres() {
        let volume = cloud([6, 6, 10], 1);
        assert_eq!(volume.bounds().min, Vec3::new(-3.0, -1.5, -2.5));
        assert_eq!(volume.bounds().max, Vec3::new(3.0, 1.5, 2.5));
        assert!((volume.voxel() - 0.5).abs() < 1e-6);
    }
}
