// SPDX-License-Identifier: MIT OR Apache-2.0
//! Volumes, cameras and lights for sheets of splats and for their reference.
#![allow(dead_code, clippy::unwrap_used)]

use crate::gpu::{host_camera, host_vector};
use airlight::core::{Camera, Light};
use airlight::data::{Volume, cloud};
use airlight_tests::linear::{Mat4, Vec3};
use airlight_tests::reference::camera::{Camera as ReferenceCamera, OrthographicView, View};
use airlight_tests::reference::light::Light as ReferenceLight;
use airlight_tests::reference::splatting::{Field, Kernel};

/// Values up to 1.
pub fn small_cloud() -> Volume {
    let mut volume = cloud([32, 16, 28], 3);
    volume.values.iter_mut().for_each(|value| *value /= 3.0);
    volume
}

/// The field that splats of a volume make.
pub fn field_of(volume: &Volume) -> Field {
    let size = volume.size.map(|side| side as usize);
    let columns: [[f64; 4]; 4] =
        volume.world_from_unit.to_cols_array_2d().map(|column| column.map(f64::from));
    // Voxel i lies at (i + 0.5) / size of the box 0..1.
    let mut voxels = columns;
    for axis in 0..3 {
        for row in 0..4 {
            voxels[axis][row] = columns[axis][row] / size[axis] as f64;
            voxels[3][row] += 0.5 * voxels[axis][row];
        }
    }
    let world_from_voxel = Mat4 { columns: voxels };
    Field {
        size,
        values: volume.values.iter().copied().map(f64::from).collect(),
        world_from_voxel,
        voxel_from_world: world_from_voxel.inverse().unwrap(),
        kernel: Kernel::new(0.7, 2.25),
    }
}

/// A camera, 9 m from the origin, that looks at it in a direction, for both.
pub fn camera(direction: Vec3, parallel: bool, size: [u32; 2]) -> (ReferenceCamera, Camera) {
    let aspect = f64::from(size[0]) / f64::from(size[1]);
    let (eye, target, up) = (direction * -9.0, Vec3::default(), Vec3::new(0.0, 1.0, 0.0));
    let reference = if parallel {
        let view =
            OrthographicView { eye, target, up, half_height: 2.1, aspect, depth: 20.0, reversed: false };
        ReferenceCamera::orthographic(&view)
    } else {
        let view = View { eye, target, up, fov_y: 0.5, aspect, near: 0.5, far: 40.0, reversed: true };
        ReferenceCamera::perspective(&view)
    };
    (reference, Camera { projection: u32::from(parallel), ..host_camera(&reference, size) })
}

/// A light that goes in a direction at the origin, for both; a spot has 30 times the radiance. `bounds`: least and greatest corner of the
/// scene.
pub fn light(
    direction: Vec3,
    spot: bool,
    radiance: [f64; 3],
    bounds: [glam::Vec3; 2],
) -> (ReferenceLight, Light) {
    let rgb = glam::Vec3::from(radiance.map(|x| x as f32));
    if spot {
        let position = direction * -8.0;
        let [outer, inner] = [25.0_f32, 16.0];
        let host =
            Light::spot(host_vector(position), glam::Vec3::ZERO, outer, inner, 30.0 * rgb, 0.1, 1.0, 20.0);
        let [inner, outer] = [inner, outer].map(|degrees| f64::from(degrees).to_radians());
        return (
            ReferenceLight::Spot { position, axis: direction, inner, outer, radius: 0.1 },
            host.unwrap(),
        );
    }
    let towards = direction * -1.0;
    let host = Light::directional(host_vector(towards), rgb, bounds[0], bounds[1]);
    (ReferenceLight::Directional { towards }, host.unwrap())
}

/// A view direction, and one of light at an angle to it.
pub fn directions(degrees: f64) -> [Vec3; 2] {
    let view = Vec3::new(0.35, -0.3, -0.9).normalised();
    let across = view.cross(Vec3::new(0.3, 0.9, 0.1)).normalised().cross(view);
    let angle = degrees.to_radians();
    [view, view * angle.cos() + across * -angle.sin()]
}
