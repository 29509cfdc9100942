// SPDX-License-Identifier: MIT OR Apache-2.0
//! The searched bounds against the page's closed forms and against the picture.

use super::super::test_scenes::Random;
use super::*;
use crate::reference::camera::View;
use crate::reference::scattering::Polar;

#[test]
fn point_and_polar_coordinates_lead_to_each_other() {
    let mut random = Random(1);
    for _ in 0..2000 {
        let (camera, light) = random.camera_and_light();
        let frame = Frame::new(&camera, light);
        assert!((frame.a.cross(frame.b) - frame.l).length() < 1e-12);
        let point = camera.eye + random.direction() * random.between(0.1, 100.0);
        let polar = frame.polar(point);
        if polar.r > 1e-2 {
            assert!((frame.point(polar) - point).length() < 1e-9);
        }
    }
}

#[test]
fn rays_are_constant_where_they_must_be() {
    let mut random = Random(2);
    for _ in 0..2000 {
        let (camera, light) = random.camera_and_light();
        let frame = Frame::new(&camera, light);
        let direction = random.direction();
        let near = frame.polar(camera.eye + direction * 0.7);
        let far = frame.polar(camera.eye + direction * 40.0);
        if near.r < 1e-2 {
            continue;
        }
        assert!((near.theta - far.theta).abs() < 1e-10 && (near.phi - far.phi).abs() < 1e-10);
        let Polar { r, phi, .. } = near;
        let start = camera.eye + direction * 0.7;
        let mut before = near.theta;
        for i in 1..20 {
            // Away from the light: the same radius and azimuth, a growing angle.
            let on = frame.polar(start - frame.l * f64::from(i));
            assert!((on.r - r).abs() < 1e-10 && (on.phi - phi).abs() < 1e-8);
            assert!(on.theta > before);
            before = on.theta;
        }
    }
}

/// Closed forms of the page.
fn closed(camera: &Camera, frame: &Frame, phi: f64) -> (f64, f64) {
    let e = frame.radial(phi);
    camera.side_normals().into_iter().fold((0.0, PI), |(least, greatest), n| {
        let (a, b) = (n.dot(frame.l), n.dot(e));
        if a < 0.0 {
            (f64::max(least, (-a).atan2(b)), greatest)
        } else {
            (least, f64::min(greatest, a.atan2(-b)))
        }
    })
}

#[test]
fn searched_bounds_are_the_closed_forms() {
    let mut random = Random(3);
    let mut missed = 0;
    for _ in 0..300 {
        let (camera, light) = random.camera_and_light();
        let limit = random.between(5.0, 300.0);
        let rectification = Rectification::new(&camera, light, limit, 64, 16);
        let frame = &rectification.frame;
        for slice in &rectification.slices {
            let (mut theta_min, mut theta_max) = closed(&camera, frame, slice.phi);
            if (theta_max - theta_min - 1e-3).abs() < 1e-9 {
                continue;
            }
            if theta_max - theta_min < 1e-3 {
                missed += 1;
                let middle = (0.5 * (theta_min + theta_max)).clamp(5e-4, PI - 5e-4);
                (theta_min, theta_max) = (middle - 5e-4, middle + 5e-4);
            }
            assert!((slice.theta_min - theta_min).abs() < 1e-8, "{slice:?} {theta_min}");
            assert!((slice.theta_max - theta_max).abs() < 1e-8, "{slice:?} {theta_max}");
            let k_max = if theta_min < 0.5 * PI && theta_max > 0.5 * PI {
                1.0
            } else {
                theta_min.sin().max(theta_max.sin())
            };
            assert!((slice.k_max - k_max.max(0.1)).abs() < 1e-8);
            assert!((slice.k_min - theta_min.sin().min(theta_max.sin()).max(0.1)).abs() < 1e-8);
            let far = [theta_min, theta_max].map(|theta| {
                let along = frame.direction(slice.phi, theta).dot(camera.forward);
                if along <= 0.0 { f64::INFINITY } else { camera.far * theta.sin() / along }
            });
            let r_max = far[0].max(far[1]).min(limit * k_max);
            assert!((slice.r_max / r_max - 1.0).abs() < 1e-6, "{slice:?} {r_max}");
        }
    }
    assert!(missed > 10, "{missed} slices missed the picture");
}

#[test]
fn rays_of_a_slice_are_in_the_picture_between_its_bounds() {
    let mut random = Random(4);
    for _ in 0..200 {
        let (camera, light) = random.camera_and_light();
        let rectification = Rectification::new(&camera, light, 50.0, 64, 8);
        for slice in &rectification.slices {
            for i in 0..400 {
                let theta = PI * (f64::from(i) + 0.5) / 400.0;
                let gap = (theta - slice.theta_min).abs().min((theta - slice.theta_max).abs());
                if gap < 1e-3 {
                    continue;
                }
                let direction = rectification.frame.direction(slice.phi, theta);
                let inside = camera
                    .project(camera.eye + direction)
                    .is_some_and(|p| p[0].abs() <= 1.0 && p[1].abs() <= 1.0);
                assert_eq!(inside, theta > slice.theta_min && theta < slice.theta_max);
                if inside {
                    // The end of the ray lies within the row.
                    let end = (camera.far / direction.dot(camera.forward)).min(50.0);
                    assert!(end * theta.sin() <= slice.r_max * (1.0 + 1e-9));
                }
            }
        }
    }
}

#[test]
fn picture_lies_between_the_first_and_last_row() {
    let mut random = Random(5);
    for _ in 0..500 {
        let (camera, light) = random.camera_and_light();
        let rectification = Rectification::new(&camera, light, 50.0, 64, 8);
        let visible = |l: Vec3| {
            camera.project(camera.eye + l).is_some_and(|p| p[0].abs() <= 0.99 && p[1].abs() <= 0.99)
        };
        if visible(light) || visible(-light) {
            assert!(rectification.full_circle);
        }
        if !rectification.full_circle {
            assert!(rectification.phi_max - rectification.phi_min < PI);
        }
        for _ in 0..50 {
            let direction = camera.ray([random.between(-1.0, 1.0), random.between(-1.0, 1.0)]);
            let phi = rectification.frame.polar_direction(direction).phi;
            assert!(phi >= rectification.phi_min - 1e-9 && phi <= rectification.phi_max + 1e-9);
            let (first, second, share) = rectification.rows(phi);
            assert!((0.0..=1.0).contains(&share));
            let (a, b) = (rectification.slices[first].phi, rectification.slices[second].phi);
            let b = if b < a { b + 2.0 * PI } else { b };
            assert!((a + (b - a) * share - phi).abs() < 1e-9, "{a} {b} {share} {phi}");
        }
    }
}

#[test]
fn light_within_two_side_planes_leaves_its_outer_rows_their_rays() {
    // A level camera under an overhead light: both vertical sides hold the light.
    let camera = Camera::perspective(&View {
        eye: Vec3::new(0.3, 1.7, 4.1),
        target: Vec3::new(1.3, 1.7, -3.2),
        up: Vec3::new(0.0, 1.0, 0.0),
        fov_y: 1.0,
        aspect: 1.5,
        near: 0.1,
        far: 100.0,
        reversed: false,
    });
    let rectification = Rectification::new(&camera, Vec3::new(0.0, 1.0, 0.0), 100.0, 64, 9);
    assert!(!rectification.full_circle);
    let outer = rectification.slices[0];
    let corner = rectification.frame.polar_direction(camera.corners()[3]).theta;
    assert!((outer.theta_min - corner).abs() < 1e-3, "{outer:?} {corner}");
    assert!((outer.theta_max - (PI - corner)).abs() < 1e-3);
}

#[test]
fn depth_keeps_the_order_and_guards_both_ends() {
    let slice = Slice { phi: 0.0, theta_min: 0.4, theta_max: 0.9, r_max: 1.0, k_min: 0.4, k_max: 0.8 };
    assert_eq!([slice.depth(0.4), slice.depth(0.9)].map(|z| (z * 1e9).round() / 1e9), GUARD);
    assert_eq!([slice.depth(0.0), slice.depth(3.0)], [0.0, 1.0]);
    assert!((slice.theta(slice.depth(0.77)) - 0.77).abs() < 1e-14);
}
