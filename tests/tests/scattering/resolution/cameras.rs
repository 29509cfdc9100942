// SPDX-License-Identifier: MIT OR Apache-2.0
//! Cameras of any kind, and the length of their rays.

use crate::gpu::{self, Random};
use crate::probing::f;
use airlight_tests::linear;
use airlight_tests::reference::camera::Camera as ReferenceCamera;
use glam::{Vec2, Vec3};

/// The uniform of an orthographic camera: `half` metres to every side of `centre`, looking away from `towards`.
fn orthographic(
    towards: linear::Vec3,
    centre: linear::Vec3,
    half: f64,
    reversed: bool,
) -> airlight::core::Camera {
    let far_depth = if reversed { 0.0 } else { 1.0 };
    let clip = gpu::light_matrix(towards, centre, half, far_depth);
    airlight::core::Camera {
        clip_from_world: gpu::host_matrix(clip),
        world_from_clip: gpu::host_matrix(clip.inverse().unwrap()),
        eye: Vec3::ZERO,
        near_depth: 1.0 - far_depth as f32,
        viewport: Vec2::ONE,
        far_depth: far_depth as f32,
        projection: 1,
    }
}

/// A camera of any kind, with the given viewport.
pub fn any_camera(random: &mut Random, viewport: [u32; 2]) -> airlight::core::Camera {
    let viewport_of = Vec2::new(viewport[0] as f32, viewport[1] as f32);
    if random.unit() < 0.3 {
        let (towards, centre) = (random.direction(), random.direction() * random.between(0.0, 20.0));
        let (half, reversed) = (random.between(1.0, 30.0), random.unit() < 0.5);
        airlight::core::Camera { viewport: viewport_of, ..orthographic(towards, centre, half, reversed) }
    } else {
        let camera = random.camera(f64::from(viewport[0]) / f64::from(viewport[1]));
        gpu::host_camera(&camera, viewport)
    }
}

/// Distance along the ray of a pixel of any camera, metres, from its matrix in f64.
pub fn distance(camera: &airlight::core::Camera, [x, y]: [usize; 2], depth: f32, limit: f64) -> f64 {
    let ndc = ReferenceCamera::pixel_ndc(x, y, camera.viewport.x as usize, camera.viewport.y as usize);
    let point = |z: f64| {
        let [x, y, z, w] = gpu::matrix(camera.world_from_clip).apply([ndc[0], ndc[1], z, 1.0]);
        (linear::Vec3::new(x, y, z), w)
    };
    let (at, w) = point(f(depth));
    if camera.projection == 1 {
        let (near, near_w) = point(f(camera.near_depth));
        return ((at * w.recip()) - near * near_w.recip()).length().min(limit);
    }
    if w <= 1e-9 {
        return limit;
    }
    (at * w.recip() - gpu::vector(camera.eye)).length().min(limit)
}
