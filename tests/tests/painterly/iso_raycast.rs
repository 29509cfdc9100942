// SPDX-License-Identifier: MIT OR Apache-2.0
//! Ray casting of iso-surfaces against dense sampling in f64, analytic gradients and analytic motion.

use crate::gpu::{matrix, vector};
use crate::probing::{hold, triple};
use crate::surfaces::{
    PLAIN, SIZE, Seen, Setting, head_setting, hits_are_crossings, parallel_view_of, reference_camera, turned,
    view_of,
};
use airlight::core::{Camera, DepthRange, View};
use airlight::data::{Volume, marschner_lobb, quadric_field, sphere_field, torus_field};
use airlight::painterly::IsoFrame;
use airlight_tests::linear;
use airlight_tests::reference::painterly::{marschner_lobb_gradient, motion};
use glam::{Mat3, Mat4, Vec3};

#[test]
fn hits_are_those_of_dense_sampling() {
    let eye = Vec3::new(0.5, 0.4, 1.0);
    let cases: [(&str, Volume); 3] = [
        ("sphere", sphere_field([40; 3], 0.6)),
        ("torus", torus_field([48, 40, 30], 0.55, 0.2)),
        ("Marschner-Lobb", marschner_lobb([64; 3])),
    ];
    for (what, volume) in cases {
        let view = view_of(&volume, eye);
        let setting = Setting::new(volume, &view);
        hits_are_crossings(what, &setting, &setting.seen(PLAIN));
    }
    for towards_eye in [Vec3::new(0.3, 0.2, 1.0), Vec3::new(-1.0, 0.5, -0.2)] {
        let setting = head_setting(towards_eye);
        hits_are_crossings("head", &setting, &setting.seen(PLAIN));
    }
}

#[test]
fn hits_are_right_for_any_camera_step_and_refinement() {
    let volume = torus_field([40; 3], 0.55, 0.22);
    let eye = Vec3::new(-0.7, 0.6, 1.0);
    let views = [
        parallel_view_of(&volume, eye, DepthRange::Forward),
        parallel_view_of(&volume, eye, DepthRange::Reversed),
        view_of(&volume, -eye),
    ];
    for (i, view) in views.iter().enumerate() {
        for (steps_per_voxel, refinements) in [(2.0, 5), (1.0, 2), (1.0, 12), (4.0, 1)] {
            let mut setting = Setting::new(volume.clone(), view);
            setting.settings.steps_per_voxel = steps_per_voxel;
            setting.settings.refinements = refinements;
            hits_are_crossings(
                &format!("view {i}, {steps_per_voxel} {refinements}"),
                &setting,
                &setting.seen(PLAIN),
            );
        }
    }
}

/// Angles between normals and the gradient of a function, degrees, and greatest relative error of its size a voxel; of hits
/// with voxels on all sides.
fn gradient_errors(
    setting: &Setting,
    seen: &Seen,
    of: impl Fn(linear::Vec3) -> Option<linear::Vec3>,
) -> (Vec<f64>, f64) {
    let (mut angles, mut worst) = (Vec::new(), 0.0_f64);
    setting.solid(|solid| {
        for (i, ray) in setting.rays(solid).iter().enumerate() {
            let found = f64::from(seen.distance[i]);
            let Some(nearest) = ray.crossings.first().filter(|first| found >= 0.0 && !first.entered) else {
                continue;
            };
            let point = ray.origin + ray.direction * found;
            let Some(gradient) = of(point) else { continue };
            let [x, y, z, _] = solid.unit_from_world.apply_point(point);
            let beside = |unit: f64, side: u32| (unit.min(1.0 - unit)) * f64::from(side) < 1.5;
            if [x, y, z].into_iter().zip(setting.volume.size).any(|(unit, side)| beside(unit, side)) {
                continue;
            }
            // The hit itself is tested elsewhere; a ray that grazes may have another.
            if (found - nearest.distance).abs() > 0.5 * setting.voxel() {
                continue;
            }
            let normal = triple(&seen.surface[4 * i..4 * i + 3]).normalised();
            angles.push((-gradient.normalised()).dot(normal).clamp(-1.0, 1.0).acos().to_degrees());
            let size = gradient.length() * setting.voxel();
            worst = worst.max((f64::from(seen.surface[4 * i + 3]) / size - 1.0).abs());
        }
    });
    (angles, worst)
}

#[test]
fn gradients_of_quadratic_fields_are_within_a_degree() {
    let curvature = Mat3::from_cols_array(&[0.5, 0.1, -0.2, 0.1, -0.4, 0.15, -0.2, 0.15, 0.3]);
    let slope = Vec3::new(-0.1, -0.15, -0.3);
    let mut volume = quadric_field([64, 56, 48], slope, curvature);
    // Voxels of three sides, turned.
    volume.world_from_unit = Mat4::from_rotation_y(0.7) * volume.world_from_unit;
    let view = view_of(&volume, Vec3::new(0.4, 0.5, 1.0));
    let setting = Setting::new(volume, &view);
    let seen = setting.seen(PLAIN);
    let back = matrix(setting.frame.world_from_unit).inverse().unwrap();
    let turn = Mat4::from_rotation_y(0.7);
    let (angles, size) = gradient_errors(&setting, &seen, |point| {
        let [x, y, z, _] = back.apply_point(point);
        let at = Vec3::new(x as f32, y as f32, z as f32) * 2.0 - 1.0;
        let gradient = slope + curvature * at;
        Some(vector(turn.transform_vector3(gradient)))
    });
    assert!(angles.len() > 400, "{}", angles.len());
    hold("degrees", angles.iter().copied().fold(0.0, f64::max), 1.0);
    hold("size", size, 0.02);
}

/// Away from its Nyquist rings: where the local wave is 20 voxels long and more; at 16 voxels 2.1 degrees occur.
#[test]
fn gradients_of_marschner_lobb_are_within_two_degrees() {
    let volume = marschner_lobb([256; 3]);
    let view = view_of(&volume, Vec3::new(0.2, 0.3, 1.0));
    let setting = Setting::new(volume, &view);
    let seen = setting.seen(PLAIN);
    let (angles, size) = gradient_errors(&setting, &seen, |point| {
        use std::f64::consts::{FRAC_PI_2, TAU};
        let wave_number = TAU * 6.0 * FRAC_PI_2 * (FRAC_PI_2 * point.x.hypot(point.y)).sin();
        (TAU / wave_number >= 20.0 * setting.voxel()).then(|| marschner_lobb_gradient(point))
    });
    assert!(angles.len() > 150, "{}", angles.len());
    hold("degrees", angles.iter().copied().fold(0.0, f64::max), 2.0);
    hold("size", size, 0.15);
}

#[test]
fn flow_is_the_motion_of_the_point() {
    let volume = torus_field([48; 3], 0.55, 0.25);
    let eye = Vec3::new(0.5, 0.6, 1.0);
    let moved = |view: View| match view {
        View::Perspective(mut view) => {
            view.eye += Vec3::new(0.3, -0.15, 0.2);
            view.target += Vec3::new(-0.05, 0.04, 0.0);
            View::Perspective(view)
        }
        View::Orthographic(mut view) => {
            view.eye += Vec3::new(0.3, -0.15, 0.2);
            view.height *= 1.1;
            View::Orthographic(view)
        }
    };
    for view in [view_of(&volume, eye), parallel_view_of(&volume, eye, DepthRange::Reversed)] {
        let turn = Mat4::from_rotation_y(0.12) * Mat4::from_translation(Vec3::new(0.05, -0.02, 0.03));
        for (what, rotation, other) in [
            ("turning volume", turn, view),
            ("moving camera", Mat4::IDENTITY, moved(view)),
            ("both", turn, moved(view)),
        ] {
            let mut setting = Setting::new(volume.clone(), &view);
            setting.frame = IsoFrame {
                // A picture of another size.
                previous_camera: Camera::new(&other, SIZE.map(|side| 2 * side)).unwrap(),
                previous_world_from_unit: turned(&volume, rotation),
                ..setting.frame
            };
            let seen = setting.seen(PLAIN);
            seen.check();
            let [camera, previous] =
                [&setting.frame.camera, &setting.frame.previous_camera].map(reference_camera);
            let [now, before] =
                [setting.frame.world_from_unit, setting.frame.previous_world_from_unit].map(matrix);
            let views = [(&previous, &before), (&camera, &now)];
            let (mut worst, mut greatest) = (0.0_f64, 0.0_f64);
            setting.solid(|solid| {
                for (i, ray) in setting.rays(solid).iter().enumerate() {
                    let Some(first) = ray.crossings.first() else { continue };
                    let found = f64::from(seen.distance[i]);
                    if (found - first.distance).abs() > 0.1 * setting.voxel() {
                        continue;
                    }
                    let unit = solid.unit(ray.origin + ray.direction * first.distance).unwrap();
                    let [x, y] = motion(views, unit, SIZE.map(f64::from)).unwrap();
                    let off = [x - f64::from(seen.flow[2 * i]), y - f64::from(seen.flow[2 * i + 1])];
                    worst = worst.max(off[0].hypot(off[1]));
                    greatest = greatest.max(x.hypot(y));
                }
            });
            assert!(greatest > 2.0, "{what}: the flow is {greatest} pixels");
            hold(&format!("{what}, flow in pixels of {greatest:.1}"), worst, 0.1);
        }
        let still = Setting::new(volume.clone(), &view).seen(PLAIN);
        assert!(still.flow.iter().all(|v| v.abs() < 1e-3), "flow where nothing moves");
    }
}
