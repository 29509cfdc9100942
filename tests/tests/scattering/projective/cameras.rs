// SPDX-License-Identifier: MIT OR Apache-2.0
//! Cameras of either kind and lights that projective rows can serve, as references and as uniforms.

use crate::gpu::{self, Random};
use airlight::core::Camera;
use airlight_tests::linear;
use airlight_tests::reference::camera::{Camera as ReferenceCamera, OrthographicView};
use glam::Vec3;

/// Distance limit of the air, metres.
pub const LIMIT: f32 = 90.0;

/// The uniform of a reference's camera of either kind.
pub fn host_camera(camera: &ReferenceCamera, viewport: [u32; 2]) -> Camera {
    Camera { projection: u32::from(camera.is_orthographic()), ..gpu::host_camera(camera, viewport) }
}

pub fn orthographic(random: &mut Random, aspect: f64) -> ReferenceCamera {
    let eye = random.direction() * random.between(0.0, 30.0);
    ReferenceCamera::orthographic(&OrthographicView {
        eye,
        target: eye + random.direction(),
        up: random.direction(),
        half_height: random.between(0.5, 20.0),
        aspect,
        depth: random.between(5.0, 80.0),
        reversed: random.unit() < 0.5,
    })
}

pub fn any_camera(random: &mut Random, aspect: f64) -> ReferenceCamera {
    if random.unit() < 0.25 { orthographic(random, aspect) } else { random.camera(aspect) }
}

/// A light that projective rows can serve more often than not: beside the picture.
pub fn light_for(random: &mut Random, camera: &ReferenceCamera) -> linear::Vec3 {
    if camera.is_orthographic() {
        return random.direction();
    }
    if random.unit() < 0.4 {
        random.light(camera)
    } else {
        random.direction().without(camera.forward).normalised()
    }
}

/// Whether the light or its antipode is about as far from the picture's centre as its border, by the sine of the angle.
pub fn next_to_the_border(camera: &ReferenceCamera, light: linear::Vec3, sine: f64) -> bool {
    let sides = camera.side_normals().map(|n| n.dot(light.normalised()));
    let inside = |sign: f64| sides.iter().fold(f64::INFINITY, |least, side| least.min(sign * side));
    !camera.is_orthographic() && (inside(1.0).abs() < sine || inside(-1.0).abs() < sine)
}

/// Error of the direction of view rays, radians, by the rounding of an f32 matrix from clip space to the world: with
/// forward depth they are the difference of numbers as large as the eye's place over the near
/// distance.
pub fn matrix_rounding(camera: &ReferenceCamera) -> f64 {
    let cancels = !camera.is_orthographic() && camera.far_depth > 0.5;
    if cancels { 6e-8 * camera.eye.length() / camera.near } else { 0.0 }
}

/// A light outside of the picture: at a corner for 0, at a right angle to the view for 1.
pub fn light_beside_corner(camera: &ReferenceCamera, turn: f64) -> Vec3 {
    let corner = camera.corners()[2];
    let beside = corner.without(camera.forward).normalised();
    gpu::host_vector((corner * (1.0 - turn) + beside * turn).normalised())
}
