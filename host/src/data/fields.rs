// SPDX-License-Identifier: MIT OR Apache-2.0
//! Volumes of functions whose surfaces are known: the test signal of Marschner and Lobb, spheres, tori and quadrics.
//!
//! All lie in the cube from -1 to 1 m, and all values in 0..1.

use super::volume::{Volume, filled};
use glam::{Mat3, Vec3};
use std::f32::consts::{FRAC_PI_2, TAU};

/// The signal of Marschner and Lobb, "An evaluation of reconstruction filters for volume rendering" (1994), with its own
/// numbers: a modulation of 0.25 and 6 rings a radius. Its usual surface has the value 0.5.
pub fn marschner_lobb(size: [u32; 3]) -> Volume {
    in_cube(size, |at| {
        let radius = at.truncate().length();
        let rings = (TAU * 6.0 * (FRAC_PI_2 * radius).cos()).cos();
        (1.0 - (FRAC_PI_2 * at.z).sin() + 0.25 * (1.0 + rings)) / 2.5
    })
}

/// 0.5 less the distance from a sphere of `radius` metres about the origin, in half metres: greater inside, 0.5 on it.
pub fn sphere_field(size: [u32; 3], radius: f32) -> Volume {
    in_cube(size, |at| 0.5 - 0.5 * (at.length() - radius))
}

/// 0.5 less the distance from a torus about the z axis, in half metres: greater inside, 0.5 on it. `major`: radius of the ring;
/// `minor`: of its tube; metres.
pub fn torus_field(size: [u32; 3], major: f32, minor: f32) -> Volume {
    in_cube(size, |at| {
        let ring = Vec3::new(at.truncate().length() - major, 0.0, at.z);
        0.5 - 0.5 * (ring.length() - minor)
    })
}

/// A quadratic field: 0.5 plus `slope` times the place in metres plus half the form of `curvature`, cut to 0..1.
pub fn quadric_field(size: [u32; 3], slope: Vec3, curvature: Mat3) -> Volume {
    in_cube(size, |at| 0.5 + slope.dot(at) + 0.5 * at.dot(curvature * at))
}

fn in_cube(size: [u32; 3], value: impl Fn(Vec3) -> f32) -> Volume {
    filled(size, Vec3::NEG_ONE, Vec3::ONE, |unit| value(2.0 * unit - 1.0).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn surfaces_lie_where_they_should() {
        let at = |volume: &Volume, [x, y, z]: [usize; 3]| volume.values[(z * 41 + y) * 41 + x];
        // Voxels of an odd number: the middle one is the origin; voxel 40 is at 40/41.
        let ball = sphere_field([41; 3], 0.5);
        assert!((at(&ball, [20; 3]) - 0.75).abs() < 1e-6);
        assert!((at(&ball, [40, 20, 20]) - (0.5 - 0.5 * (40.0 / 41.0 - 0.5))).abs() < 1e-6);
        let ring = torus_field([41; 3], 40.0 / 41.0, 0.2);
        assert!((at(&ring, [40, 20, 20]) - 0.6).abs() < 1e-6);
        assert!((at(&ring, [20, 0, 24]) - (0.6 - 0.5 * 8.0 / 41.0)).abs() < 1e-6);
        let signal = marschner_lobb([41; 3]);
        assert!((at(&signal, [20; 3]) - 0.6).abs() < 1e-5, "{}", at(&signal, [20; 3]));
        assert!(signal.values.iter().all(|value| (0.0..=1.0).contains(value)));
        let saddle = quadric_field([41; 3], Vec3::X * 0.1, Mat3::from_diagonal(Vec3::new(0.2, -0.2, 0.0)));
        assert!((at(&saddle, [40, 0, 3]) - (0.5 + 4.0 / 41.0)).abs() < 1e-6);
    }
}
