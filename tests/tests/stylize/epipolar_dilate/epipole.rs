// SPDX-License-Identifier: MIT OR Apache-2.0
//! The place in a shadow map where view rays meet.

use super::morphed::reference_epipole;
use crate::gpu::{self, Random};
use airlight::core::{Camera, DepthRange, Light, OrthographicView, View};
use airlight::stylize::{Epipole, StylizeError};
use glam::{DMat4, DVec3, DVec4, Vec2, Vec3};

#[test]
fn the_epipole_is_where_view_rays_meet() {
    let mut random = Random(86);
    let size = [300, 200];
    let mut worst = 0.0_f64;
    let check = |epipole: &Epipole, clip: DMat4, eye: DVec4, random: &mut Random, worst: &mut f64| {
        let project = |point: DVec3| {
            let clip = clip * point.extend(1.0);
            (clip.w > 0.05).then(|| {
                let [x, y, z] = [clip.x, clip.y, clip.z].map(|value| value / clip.w);
                ([150.0 * (x + 1.0), 100.0 * (1.0 - y)], z)
            })
        };
        let direction =
            if eye.w == 0.0 { -eye.truncate() } else { gpu::host_vector(random.direction()).as_dvec3() };
        let origin =
            if eye.w == 0.0 { gpu::host_vector(random.direction()).as_dvec3() * 5.0 } else { eye.truncate() };
        let [near, far] = [random.between(2.0, 6.0), random.between(7.0, 12.0)];
        let (Some((s, z)), Some((t, wanted))) =
            (project(origin + near * direction), project(origin + far * direction))
        else {
            return 0;
        };
        let epipole = reference_epipole(epipole);
        let towards = epipole.direction(t).unwrap();
        let apart = [s[0] - t[0], s[1] - t[1]];
        let along = apart[0] * towards[0] + apart[1] * towards[1];
        // Rays along light rays stay in their texel.
        if along.abs() < 1.0 {
            return 0;
        }
        let across = apart[0] * towards[1] - apart[1] * towards[0];
        assert!(along > 0.0, "the eye lies the other way: {epipole:?}");
        *worst = worst.max((across / along).abs()).max((epipole.extruded(s, z, t, 1.0) - wanted).abs());
        1
    };
    let mut checked = [0; 3];
    for _ in 0..400 {
        let towards = gpu::host_vector(random.direction());
        let (min, max) = (Vec3::splat(-20.0), Vec3::splat(20.0));
        let sun = Light::directional(towards, Vec3::ONE, min, max).unwrap();
        let camera = gpu::host_camera(&random.camera(1.5), [64, 64]);
        let epipole = Epipole::new(&sun, &camera, size).unwrap();
        let eye = camera.eye.as_dvec3().extend(1.0);
        checked[0] += check(&epipole, sun.clip_from_world.as_dmat4(), eye, &mut random, &mut worst);

        let view = OrthographicView {
            eye: gpu::host_vector(random.direction()) * 9.0,
            target: Vec3::ZERO,
            height: 4.0,
            near: 0.5,
            far: 30.0,
            depth: if random.unit() < 0.5 { DepthRange::Reversed } else { DepthRange::Forward },
        };
        let camera = Camera::new(&View::Orthographic(view), [64, 64]).unwrap();
        let epipole = Epipole::new(&sun, &camera, size).unwrap();
        assert!(epipole.weight.abs() < 1e-6);
        let eye = (view.eye - view.target).normalize().as_dvec3().extend(0.0);
        checked[1] += check(&epipole, sun.clip_from_world.as_dmat4(), eye, &mut random, &mut worst);

        // A perspective map; the eye is in front of the light or behind it.
        let clip = glam::dcamera::rh::proj::directx::perspective(1.2, 1.5, 0.1, 50.0);
        let eye = gpu::host_vector(random.direction()).as_dvec3() * random.between(1.0, 6.0);
        let epipole = Epipole::in_map(clip, eye.extend(1.0), size).unwrap();
        checked[2] += check(&epipole, clip, eye.extend(1.0), &mut random, &mut worst);
    }
    println!("{checked:?} rays, worst {worst:.1e}");
    assert!(checked.iter().all(|count| *count > 30), "{checked:?}");
    assert!(worst < 2e-4, "{worst}");
}

#[test]
fn impossible_eyes_are_errors() {
    let nan = Epipole::in_map(DMat4::IDENTITY, DVec4::new(f64::NAN, 0.0, 0.0, 1.0), [4, 4]);
    assert!(matches!(nan, Err(StylizeError::Epipole(_))));
    let nowhere = Epipole::in_map(DMat4::IDENTITY, DVec4::ZERO, [4, 4]);
    assert!(matches!(nowhere, Err(StylizeError::Epipole(_))));
    // An eye at infinity along the light is no error: nothing has a direction there.
    let along = Epipole::in_map(DMat4::IDENTITY, DVec4::Z, [4, 4]).unwrap();
    assert_eq!((along.position, along.depth, along.weight), (Vec2::ZERO, 1.0, 0.0));
}
