// SPDX-License-Identifier: MIT OR Apache-2.0
//! Projective rows: their geometry, the figures of EQUATIONS.md 1.7 and 2.2, and closed forms.

use super::super::picture::{Light, Medium};
use super::super::test_scenes::{Random, light_matrix, roof};
use super::super::truth::shadow_map_picture;
use super::*;
use crate::error;
use crate::reference::camera::{OrthographicView, View};

const MEDIUM: Medium = Medium { extinction: 0.05, albedo: 0.8, g: 0.6, distance_limit: 60.0 };

fn orthographic(random: &mut Random) -> Camera {
    let eye = random.direction() * random.between(0.0, 30.0);
    Camera::orthographic(&OrthographicView {
        eye,
        target: eye + random.direction(),
        up: random.direction(),
        half_height: random.between(0.5, 20.0),
        aspect: random.between(0.5, 2.5),
        depth: random.between(5.0, 80.0),
        reversed: random.unit() < 0.5,
    })
}

#[test]
fn rows_fail_if_and_only_if_the_light_or_its_antipode_is_in_view() {
    let mut random = Random(21);
    let mut failed = [0, 0];
    for _ in 0..1500 {
        let (camera, light) = random.camera_and_light();
        let l = light.normalised();
        let axes = axes(l, bisectrix(&camera, l));
        let reach = camera.far.min(90.0);
        let x = camera.frustum(reach).map(|corner| coordinates(axes, corner - camera.eye)[0]);
        let least = x.into_iter().fold(f64::INFINITY, f64::min);
        let found = Projective::new(&camera, light, 90.0, [8, 4], 1);
        assert_eq!(found.is_err(), least <= 0.0, "{least}");
        match found {
            Err(Failure::LightInView) => {
                failed[0] += 1;
                assert!(l.dot(camera.forward) > 0.0);
            }
            Err(Failure::AntipodeInView) => {
                failed[1] += 1;
                assert!(l.dot(camera.forward) < 0.0);
            }
            Err(other) => panic!("{other:?}"),
            Ok(found) => {
                assert_eq!(found.oblique(0.0), Some(Failure::Oblique(found.ratio)));
                assert_eq!(found.oblique(f64::INFINITY), None);
            }
        }
    }
    assert!(failed.iter().all(|&count| count > 200), "{failed:?}");
    let (camera, light) = random.camera_and_light();
    assert_eq!(Projective::new(&camera, Vec3::default(), 9.0, [4, 4], 1), Err(Failure::Impossible));
    assert_eq!(Projective::new(&camera, light * f64::NAN, 9.0, [4, 4], 1), Err(Failure::Impossible));
    let level = orthographic(&mut random);
    for light in [level.forward, -level.forward] {
        assert_eq!(Projective::new(&level, light, 9.0, [4, 4], 1), Err(Failure::ParallelView));
    }
}

#[test]
fn view_rays_are_rows_and_light_rays_columns() {
    let mut random = Random(22);
    for index in 0..1000 {
        let (camera, light) = if index % 4 == 0 {
            (orthographic(&mut random), random.direction())
        } else {
            random.camera_and_light()
        };
        let splits = if camera.is_orthographic() { 1 } else { index % 3 + 1 };
        let Ok(rows) = Projective::new(&camera, light, 90.0, [24, 4], splits) else { continue };
        let [x, y, z] = rows.axes;
        assert!((x.cross(y) - z).length() < 1e-9 && (z + light.normalised()).length() < 1e-12);
        let reach = camera.far.min(90.0);
        for corner in camera.frustum(reach) {
            let [y, z] = rows.slopes(corner);
            let x = rows.coordinates(corner)[0];
            let inside = |v: f64, [a, b]: [f64; 2]| v >= a - 1e-9 * (b - a) && v <= b + 1e-9 * (b - a);
            assert!(inside(y, rows.y) && inside(z, rows.z) && x <= rows.far);
            assert!(x >= rows.near || rows.near > 0.999e-3 * rows.far);
        }
        let ndc = [random.between(-1.0, 1.0), random.between(-1.0, 1.0)];
        let (origin, direction) = (camera.origin(ndc), camera.ray(ndc));
        let slopes = rows.slopes(origin + direction * 0.7);
        let mut before = -1.0;
        for i in 0..30 {
            let point = origin + direction * (f64::from(i) * 0.03 + 0.001) * reach;
            for (a, b) in rows.slopes(point).into_iter().zip(slopes) {
                assert!((a - b).abs() < 1e-8 * (1.0 + b.abs()), "{a} {b}");
            }
            let column = rows.column(rows.coordinates(point)[0]);
            assert!(column >= before);
            before = column;
            // Along the light: X and Y stay, Z grows.
            let on = point + rows.axes[2] * 3.0;
            let (a, b) = (rows.coordinates(point), rows.coordinates(on));
            assert!((a[0] - b[0]).abs() < 1e-8 && (a[1] - b[1]).abs() < 1e-8 && b[2] > a[2]);
        }
    }
}

fn straight(near: f64, far: f64, width: usize, splits: usize) -> Projective {
    let step = (far / near).powf((splits as f64).recip());
    Projective {
        origin: Vec3::default(),
        axes: [Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.0, 1.0)],
        near,
        far,
        ratio: far / near,
        y: [-1.0, 1.0],
        z: [-1.0, 1.0],
        orthographic: None,
        bounds: (0..=splits).map(|k| if k == splits { far } else { near * step.powi(k as i32) }).collect(),
        width,
        height: 1,
    }
}

#[test]
fn edges_have_the_figures_of_the_equations() {
    let rows = straight(0.1, 100.0, 1024, 1);
    let edges = rows.edges([0.0, 0.0]);
    for (i, &edge) in edges.iter().enumerate().skip(1) {
        let expected = 0.1 * 100.0 / (100.0 - i as f64 / 1024.0 * 99.9);
        assert!((edge / expected - 1.0).abs() < 1e-10);
        assert!((rows.column(edge) - i as f64).abs() < 1e-7, "{i}");
    }
    let length = |i: usize| edges[i + 1] - edges[i];
    assert!((length(1) / (edges[1] - 0.1) - 1.00195).abs() < 1e-5);
    assert!((length(1023) / length(1022) - 2.95).abs() < 0.01);
    assert!((length(1023) / 100.0 - 0.49).abs() < 0.01);
    // Texels that lie beyond a tenth of the far end.
    assert_eq!(edges[..1024].iter().filter(|&&edge| edge > 10.0).count(), 9);
    // A ray that is lit up to the middle.
    let row: Vec<f64> =
        (0..1024).map(|i| if rows.x_of(f64::from(i) + 0.5) < 50.0 { 1.0 } else { 0.0 }).collect();
    let ray =
        ViewRay { origin: Vec3::default(), direction: Vec3::new(1.0, 0.0, 0.0), begin: 0.0, end: 100.0 };
    let lit = rows.visibility(&row, &ray, 0.0).average;
    assert!((lit - edges[1023] / 100.0).abs() < 1e-9 && (lit - 0.5).abs() < 0.02, "{lit}");
    // Splits come nearer.
    let rows = straight(0.1, 100.0, 1024, 4);
    let row: Vec<f64> =
        (0..1024).map(|i| if rows.x_of(f64::from(i) + 0.5) < 50.0 { 1.0 } else { 0.0 }).collect();
    let lit = rows.visibility(&row, &ray, 0.0).average;
    assert!((lit - 0.5).abs() < 0.005, "{lit}");
    for i in 0..=1024 {
        assert!((rows.column(rows.x_of(f64::from(i))) - f64::from(i)).abs() < 1e-7);
    }
}

#[test]
fn row_has_its_centre_in_the_middle_of_its_slopes() {
    let rows = Projective { height: 4, y: [-1.0, 3.0], ..straight(1.0, 8.0, 2, 1) };
    assert_eq!((0..4).map(|j| rows.row_slope(j)).collect::<Vec<_>>(), [-0.5, 0.5, 1.5, 2.5]);
    for (slope, expected) in [
        (-1.0, (0, 1, 0.0)),
        (-0.5, (0, 1, 0.0)),
        (0.75, (1, 2, 0.25)),
        (2.5, (2, 3, 1.0)),
        (3.0, (2, 3, 1.0)),
    ] {
        assert_eq!(rows.rows(slope), expected);
    }
    // One row is lit: what a ray sees of it falls off to either side.
    let map = [0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0];
    for (slope, expected) in [(-0.5, 0.0), (0.0, 0.5), (0.5, 1.0), (1.25, 0.25), (2.5, 0.0)] {
        let direction = Vec3::new(1.0, slope, 0.0).normalised();
        let ray = ViewRay { origin: Vec3::default(), direction, begin: 0.0, end: 5.0 };
        assert!((rows.visibility(&map, &ray, 0.1).weighted - expected).abs() < 1e-12);
    }
}

#[test]
fn splits_do_not_change_exact_visibility() {
    // A row whose shadows begin and end on edges of the map without splits: finer rows with splits
    // hold the same light rays, but for the texels on those edges.
    let mut random = Random(23);
    let coarse = straight(1.0, 16.0, 16, 1);
    let map: Vec<f64> = (0..16).map(|_| random.unit()).collect();
    for splits in [2, 4] {
        let fine = straight(1.0, 16.0, 1 << 16, splits);
        let stored: Vec<f64> = (0..1 << 16)
            .map(|i| map[(coarse.column(fine.x_of(f64::from(i) + 0.5)).floor() as usize).min(15)])
            .collect();
        for _ in 0..20 {
            let direction = Vec3::new(1.0, random.between(-0.9, 0.9), random.between(-0.9, 0.9)).normalised();
            let ray =
                ViewRay { origin: Vec3::default(), direction, begin: 0.0, end: random.between(0.2, 20.0) };
            let a = coarse.visibility(&map, &ray, 0.1);
            let b = fine.visibility(&stored, &ray, 0.1);
            assert!((a.average - b.average).abs() < 1e-3 && (a.weighted - b.weighted).abs() < 1e-3);
        }
    }
}

#[test]
fn weights_of_the_reference_ray_are_those_of_a_ray_of_its_length() {
    for extinction in [0.0, 0.03, 0.5] {
        let rows = straight(0.5, 40.0, 256, 2);
        let metres = rows.reference_length(0);
        // Slopes from -1 to 1: the ray of 22.5 degrees.
        assert!((metres - std::f64::consts::FRAC_PI_8.cos().recip()).abs() < 1e-12);
        let weights = rows.reference_weights(0, extinction);
        let sum: f64 = weights.iter().sum();
        let end = 40.0 * metres;
        let expected = if extinction == 0.0 { end } else { 1.0 - (-extinction * end).exp() };
        assert!((sum - expected).abs() < 1e-9);
        assert!(weights.iter().all(|&weight| weight > 0.0));
    }
}

#[test]
fn roof_has_the_picture_of_the_shadow_map() {
    let up = Vec3::new(0.0, 1.0, 0.0);
    let eye = Vec3::new(-4.0, 1.0, 0.0);
    for (orthographic, far_depth, target, direction) in [
        (false, 1.0, Vec3::new(0.0, 1.4, 0.3), Vec3::new(0.1, 1.0, 0.2)),
        (false, 0.0, Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 1.0, 0.0)),
        (true, 1.0, Vec3::new(0.0, 1.4, 0.3), Vec3::new(0.1, 1.0, 0.2)),
        (true, 0.0, Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 1.0, 0.0)),
    ] {
        let reversed = far_depth < 0.5;
        let camera = if orthographic {
            let view =
                OrthographicView { eye, target, up, half_height: 6.0, aspect: 1.5, depth: 40.0, reversed };
            Camera::orthographic(&view)
        } else {
            let view = View { eye, target, up, fov_y: 0.9, aspect: 1.5, near: 1.5, far: 40.0, reversed };
            Camera::perspective(&view)
        };
        let light = Light { direction, radiance: [2.0, 1.0, 0.5] };
        let depth = vec![camera.far_depth as f32; 96 * 64];
        let scene = Scene { camera: &camera, light, medium: MEDIUM, depth: &depth, width: 96, height: 64 };
        let clip_from_world = light_matrix(direction, Vec3::default(), 64.0, far_depth);
        let stored = roof(clip_from_world, far_depth, 1024);
        let shadow_map = ShadowMap { depth: &stored, width: 1024, height: 1024, clip_from_world, far_depth };
        let truth = shadow_map_picture(&scene, &shadow_map, 3);
        let spread = truth.weighted().into_iter().fold((1.0_f64, 0.0_f64), |(a, b), v| (a.min(v), b.max(v)));
        assert!(spread.1 - spread.0 > 0.2, "{spread:?}");
        for splits in if orthographic { vec![1] } else { vec![1, 2, 4] } {
            let rows = Projective::new(&camera, direction, 60.0, [1024, 256], splits).expect("rows");
            let texels = rows.rectify(&[shadow_map], 1e-3);
            assert!(texels.iter().all(|t| t.low <= t.z && t.z <= t.high));
            assert!(texels.iter().all(|t| t.ambiguous || t.low == t.high));
            let map: Vec<f32> = texels.iter().map(|t| t.z as f32).collect();
            let found = projective_picture(&scene, &rows, &map, Start::Eye, 3);
            let mean = error::mean_absolute(&found.average(), &truth.average());
            assert!(mean < 4e-3, "mean {mean} for {target:?}, {splits} splits");
            let radiance = error::relative_rmse(&found.radiance(), &truth.radiance());
            assert!(radiance < 1e-2, "radiance {radiance} for {target:?}, {splits} splits");
        }
    }
}

#[test]
fn all_lit_is_one_and_all_dark_is_zero() {
    let mut random = Random(24);
    for index in 0..60 {
        let (camera, light) = if index % 3 == 0 {
            (orthographic(&mut random), random.direction())
        } else {
            random.camera_and_light()
        };
        let Ok(rows) = Projective::new(&camera, light, 30.0, [32, 4], 1) else { continue };
        let depth = [camera.far_depth as f32; 24];
        let light = Light { direction: light, radiance: [1.0; 3] };
        let scene = Scene { camera: &camera, light, medium: MEDIUM, depth: &depth, width: 6, height: 4 };
        for start in [Start::Eye, Start::NearPlane] {
            let mut medium = scene;
            medium.medium.distance_limit = 30.0;
            let lit = projective_picture(&medium, &rows, &[1.0_f32; 128], start, 1);
            let dark = projective_picture(&medium, &rows, &[0.0_f32; 128], start, 1);
            assert!(lit.pixels.iter().all(|p| (p.weighted - 1.0).abs() < 1e-12 && p.average == 1.0));
            assert!(dark.pixels.iter().all(|p| p.weighted == 0.0 && p.radiance == [0.0; 3]));
        }
    }
}
