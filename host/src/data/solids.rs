// SPDX-License-Identifier: MIT OR Apache-2.0
//! Voxels of simple solids: 1 inside, 0 outside, and between them across the surface over a voxel.

use super::volume::{Volume, filled};
use glam::{Mat4, Vec3};

/// A ring about the y axis through the origin of `world_from_ring`. `major`: radius of the ring, `minor`: of its tube, metres.
/// `voxels`: along its diameter.
pub fn solid_ring(voxels: u32, major: f32, minor: f32, world_from_ring: Mat4) -> Volume {
    let half = Vec3::new(major + minor, minor, major + minor);
    solid(voxels, half, world_from_ring, |at| {
        Vec3::new(at.with_y(0.0).length() - major, at.y, 0.0).length() - minor
    })
}

/// A plate about the origin of `world_from_plate`. `size`: its sides, metres. `voxels`: along the longest.
pub fn solid_plate(voxels: u32, size: Vec3, world_from_plate: Mat4) -> Volume {
    let half = 0.5 * size;
    solid(voxels, half, world_from_plate, |at| {
        let beyond = at.abs() - half;
        beyond.max(Vec3::ZERO).length() + beyond.max_element().min(0.0)
    })
}

/// What lies within `distance` 0, of the box from -`half` to `half` and two voxels around it.
fn solid(voxels: u32, half: Vec3, world_from_solid: Mat4, distance: impl Fn(Vec3) -> f32) -> Volume {
    let voxel = 2.0 * half.max_element() / voxels.max(1) as f32;
    let size = (2.0 * half / voxel).ceil() + 4.0;
    let reach = 0.5 * voxel * size;
    let value = |unit: Vec3| (0.5 - distance(reach * (2.0 * unit - 1.0)) / voxel).clamp(0.0, 1.0);
    let mut volume = filled(size.to_array().map(|side| side as u32), -reach, reach, value);
    volume.world_from_unit = world_from_solid * volume.world_from_unit;
    volume
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::TAU;

    #[test]
    fn solids_have_their_volume_and_an_empty_border() {
        let away = Mat4::from_translation(Vec3::X) * Mat4::from_rotation_x(1.0);
        let ring = (solid_ring(48, 1.0, 0.2, away), TAU * std::f32::consts::PI * 0.04);
        let plate = (solid_plate(40, Vec3::new(2.0, 0.1, 1.0), away), 0.2);
        for (volume, expected) in [ring, plate] {
            let voxel = volume.voxel();
            let found = volume.values.iter().sum::<f32>() * voxel.powi(3);
            assert!((found / expected - 1.0).abs() < 0.06, "{found} of {expected}");
            let [width, height, depth] = volume.size;
            let border = volume.values.iter().enumerate().filter(|(i, _)| {
                let i = *i as u32;
                let [x, y, z] = [i % width, i / width % height, i / width / height];
                x == 0 || y == 0 || z == 0 || x + 1 == width || y + 1 == height || z + 1 == depth
            });
            assert!(border.map(|(_, value)| *value).sum::<f32>() == 0.0);
            assert!(volume.bounds().center().distance(Vec3::X) < 1e-4);
        }
    }
}
