// SPDX-License-Identifier: MIT OR Apache-2.0
//! Rays and distances of cameras against their closed forms.

use super::*;

fn views() -> impl Iterator<Item = View> {
    [(false, 80.0), (true, 80.0), (false, f64::INFINITY), (true, f64::INFINITY)].into_iter().map(
        |(reversed, far)| View {
            eye: Vec3::new(3.0, 2.0, -7.0),
            target: Vec3::new(-1.0, 0.5, 4.0),
            up: Vec3::new(0.0, 1.0, 0.0),
            fov_y: 0.9,
            aspect: 1.6,
            near: 0.1,
            far,
            reversed,
        },
    )
}

fn close(a: f64, b: f64, tolerance: f64) -> bool {
    a == b || (a - b).abs() <= tolerance * (1.0 + b.abs())
}

#[test]
fn matrix_alone_gives_the_camera_again() {
    for view in views() {
        let camera = Camera::perspective(&view);
        let rounded = camera.clip_from_world.columns.as_flattened();
        let rounded: [f64; 16] = std::array::from_fn(|i| f64::from(rounded[i] as f32));
        for (matrix, tolerance) in [(camera.clip_from_world, 1e-10), (Mat4::from(rounded), 1e-4)] {
            let found = Camera::from_matrix(matrix, camera.far_depth).expect("a camera");
            assert!(close(found.near, view.near, tolerance), "{}", found.near);
            assert!(close(found.far, view.far, 20.0 * tolerance), "{}", found.far);
            for (a, b) in [
                (found.eye, camera.eye),
                (found.forward, camera.forward),
                (found.right, camera.right),
                (found.up, camera.up),
            ] {
                assert!((a - b).length() < tolerance);
            }
        }
    }
    let identity = Camera::perspective(&views().next().expect("one")).world_from_clip;
    assert!(Camera::from_matrix(identity * Mat4::from([0.0_f64; 16]), 1.0).is_none());
}

#[test]
fn depth_and_pixel_lead_back_to_the_point() {
    for view in views() {
        let camera = Camera::perspective(&view);
        for (x, y, distance) in [(0, 0, 0.5), (63, 47, 10.0), (20, 30, 60.0)] {
            let direction = camera.pixel_ray(x, y, 64, 48);
            let point = camera.eye + direction * distance;
            let [u, v, depth] = camera.project(point).expect("in front");
            let ndc = Camera::pixel_ndc(x, y, 64, 48);
            assert!(close(u, ndc[0], 1e-10) && close(v, ndc[1], 1e-10));
            assert!(close(camera.distance(ndc, depth), distance, 1e-9));
        }
        let sky = camera.distance([0.3, 0.2], camera.far_depth);
        let expected = view.far / camera.ray([0.3, 0.2]).dot(camera.forward);
        assert!(close(sky, expected, 1e-12));
    }
}

#[test]
fn top_left_is_up_and_left() {
    for view in views() {
        let camera = Camera::perspective(&view);
        let ray = camera.pixel_ray(0, 0, 64, 48);
        assert!(ray.dot(camera.up) > 0.3 && ray.dot(camera.right) < -0.3);
        assert!(close(ray.length(), 1.0, 1e-14));
    }
}

#[test]
fn side_normals_tell_the_picture_as_projection_does() {
    for view in views() {
        let camera = Camera::perspective(&view);
        let normals = camera.side_normals();
        for i in 0..1000 {
            let t = f64::from(i);
            let direction = Vec3::new((1.7 * t).sin(), (2.3 * t).cos(), (0.7 * t + 1.0).sin());
            let inside = camera
                .project(camera.eye + direction)
                .is_some_and(|p| p[0].abs() <= 1.0 && p[1].abs() <= 1.0);
            let by_normals = normals.iter().all(|n| n.dot(direction) >= 0.0);
            assert_eq!(inside, by_normals, "{direction:?}");
        }
    }
}

#[test]
fn orthographic_camera_is_found_from_its_matrix_and_leads_back_to_points() {
    for reversed in [false, true] {
        let view = OrthographicView {
            eye: Vec3::new(3.0, 2.0, -7.0),
            target: Vec3::new(-1.0, 0.5, 4.0),
            up: Vec3::new(0.0, 1.0, 0.0),
            half_height: 4.0,
            aspect: 1.6,
            depth: 30.0,
            reversed,
        };
        let camera = Camera::orthographic(&view);
        assert!(camera.is_orthographic());
        let found = Camera::from_matrix(camera.clip_from_world, camera.far_depth).expect("a camera");
        for (a, b) in [
            (found.eye, camera.eye),
            (found.forward, camera.forward),
            (found.right, camera.right),
            (found.up, camera.up),
        ] {
            assert!((a - b).length() < 1e-12);
        }
        assert!(close(found.far, 30.0, 1e-12) && found.near == 0.0);
        for (x, y, distance) in [(0, 0, 0.5), (63, 47, 10.0), (20, 30, 29.0)] {
            let ndc = Camera::pixel_ndc(x, y, 64, 48);
            let point = camera.origin(ndc) + camera.ray(ndc) * distance;
            let [u, v, depth] = camera.project(point).expect("in front");
            assert!(close(u, ndc[0], 1e-12) && close(v, ndc[1], 1e-12));
            assert!(close(camera.distance(ndc, depth), distance, 1e-12));
        }
        assert!(close(camera.distance([0.1, 0.2], camera.far_depth), 30.0, 1e-12));
        let top_left = camera.origin([-1.0, 1.0]) - camera.eye;
        assert!(close(top_left.dot(camera.right), -6.4, 1e-12));
        assert!(close(top_left.dot(camera.up), 4.0, 1e-12));
        assert!(top_left.dot(camera.forward).abs() < 1e-12);
        let far = camera.frustum(12.0)[7];
        assert!((far - camera.eye - top_left - camera.forward * 12.0).length() < 1e-12);
    }
    for view in views() {
        let camera = Camera::perspective(&view);
        assert!(!camera.is_orthographic());
        for (i, corner) in camera.frustum(9.0).into_iter().enumerate() {
            let [x, y, _] = camera.project(corner).expect("in front");
            assert!(close(x.abs(), 1.0, 1e-9) && close(y.abs(), 1.0, 1e-9));
            let along = (corner - camera.eye).dot(camera.forward);
            assert!(close(along, if i < 4 { 0.1 } else { 9.0 }, 1e-9));
        }
    }
}
