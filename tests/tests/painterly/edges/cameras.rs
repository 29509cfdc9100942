// SPDX-License-Identifier: MIT OR Apache-2.0
//! Cameras inside of what they see, and parallel rays.

use crate::gpu::vector;
use crate::probing::{f, triple};
use crate::surfaces::{PLAIN, Setting, hits_are_crossings, parallel_view_of};
use airlight::core::{DepthRange, PerspectiveView, View};
use airlight::data::torus_field;
use glam::Vec3;

/// From within.
pub fn inside(eye: Vec3, target: Vec3) -> View {
    PerspectiveView { eye, target, field_of_view: 80.0, near: 0.01, far: 10.0, depth: DepthRange::Reversed }
        .into()
}

#[test]
fn cameras_may_be_inside() {
    let volume = torus_field([40; 3], 0.55, 0.2);
    // In the hole of the ring, where nothing is solid.
    let mut setting =
        Setting::new(volume.clone(), &inside(Vec3::new(0.05, 0.0, 0.1), Vec3::new(1.0, 0.1, 0.0)));
    hits_are_crossings("in the hole", &setting, &setting.seen(PLAIN));
    // In what is solid every ray ends at once, and its normal is the ray turned round.
    setting = Setting::new(volume, &inside(Vec3::new(0.55, 0.0, 0.05), Vec3::ZERO));
    let seen = setting.seen(PLAIN);
    seen.check();
    assert!(seen.distance.iter().all(|distance| *distance == 0.0));
    setting.solid(|solid| {
        for (i, ray) in setting.rays(solid).iter().enumerate() {
            let off = triple(&seen.surface[4 * i..4 * i + 3]) + ray.direction;
            assert!(off.length() < 2e-3, "{off:?}");
        }
    });
}

#[test]
fn parallel_rays_are_those_of_an_eye_afar() {
    let volume = torus_field([40; 3], 0.55, 0.25);
    let towards = Vec3::new(0.3, 0.6, 1.0).normalize();
    let parallel = parallel_view_of(&volume, towards, DepthRange::Forward);
    let View::Orthographic(view) = parallel else { unreachable!() };
    let far = 800.0;
    let degrees = 2.0 * (0.5 * view.height / far).atan().to_degrees();
    let eye = far * towards;
    let afar = PerspectiveView {
        eye,
        target: Vec3::ZERO,
        field_of_view: degrees,
        near: far - 5.0,
        far: far + 5.0,
        depth: DepthRange::Forward,
    };
    let [by_parallel, by_eye] = [parallel, afar.into()].map(|view| {
        let setting = Setting::new(volume.clone(), &view);
        (setting.seen(PLAIN), setting)
    });
    let mut compared = 0;
    let shift = f64::from(far) - f64::from(view.eye.length());
    for i in 0..by_eye.0.distance.len() {
        let (one, other) = (f(by_parallel.0.distance[i]), f(by_eye.0.distance[i]));
        let normals = [&by_parallel, &by_eye].map(|(seen, _)| triple(&seen.surface[4 * i..4 * i + 3]));
        if one < 0.0 || other < 0.0 || normals[0].dot(vector(towards)) < 0.3 {
            continue;
        }
        compared += 1;
        assert!((one + shift - other).abs() < 0.1 * by_eye.1.voxel(), "{one} {other}");
        assert!((normals[0] - normals[1]).length() < 0.02, "{normals:?}");
    }
    assert!(compared > 400, "{compared}");
}
