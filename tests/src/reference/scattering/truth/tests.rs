// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pictures with closed forms, with and without rectification.

use super::super::picture::{Light, Medium, Scene, picture};
use super::super::shadow_map::{ShadowMap, rectify};
use super::super::slice::Rectification;
use super::super::test_scenes::{light_matrix, roof};
use super::*;
use crate::error;
use crate::reference::camera::{Camera, View};
use crate::reference::phase::henyey_greenstein;

const SIZE: [usize; 2] = [96, 64];
const MEDIUM: Medium = Medium { extinction: 0.05, albedo: 0.8, g: 0.6, distance_limit: 60.0 };

fn camera(target: Vec3, reversed: bool) -> Camera {
    Camera::perspective(&View {
        eye: Vec3::new(-4.0, 1.0, 0.0),
        target,
        up: Vec3::new(0.0, 1.0, 0.0),
        fov_y: 0.9,
        aspect: 1.5,
        near: 0.1,
        far: 40.0,
        reversed,
    })
}

fn light(direction: [f64; 3]) -> Light {
    Light { direction: direction.into(), radiance: [2.0, 1.0, 0.5] }
}

/// A depth buffer without surfaces.
fn sky(camera: &Camera) -> Vec<f32> {
    vec![camera.far_depth as f32; SIZE[0] * SIZE[1]]
}

fn scene<'a>(camera: &'a Camera, light: Light, depth: &'a [f32]) -> Scene<'a> {
    Scene { camera, light, medium: MEDIUM, depth, width: SIZE[0], height: SIZE[1] }
}

#[test]
fn without_blockers_radiance_has_its_closed_form() {
    let camera = camera(Vec3::new(0.0, 2.0, 0.5), true);
    let light = light([0.4, 0.8, -0.3]);
    let depth = sky(&camera);
    let scene = scene(&camera, light, &depth);
    let empty = ShadowMap {
        depth: &[1.0; 64],
        width: 8,
        height: 8,
        clip_from_world: light_matrix(light.direction, Vec3::default(), 20.0, 1.0),
        far_depth: 1.0,
    };
    let rectification = Rectification::new(&camera, light.direction, 60.0, 32, 16);
    let map: Vec<f64> = rectify(&empty, &rectification, 0.0).iter().map(|t| t.z).collect();
    assert!(map.iter().all(|&z| z == 1.0));
    for picture in [picture(&scene, &rectification, &map, 5), shadow_map_picture(&scene, &empty, 5)] {
        assert_eq!((picture.columns, picture.rows), (20, 13));
        for pixel in &picture.pixels {
            assert!((pixel.average - 1.0).abs() < 1e-12 && (pixel.weighted - 1.0).abs() < 1e-12);
            let (direction, distance) = scene.view_ray(pixel.x, pixel.y);
            assert!((distance - (40.0 / direction.dot(camera.forward)).min(60.0)).abs() < 1e-9);
            let phase = henyey_greenstein(direction.dot(light.direction.normalised()), 0.6);
            let expected = 0.8 * phase * 2.0 * (1.0 - (-0.05 * distance).exp());
            assert!((pixel.radiance[0] / expected - 1.0).abs() < 1e-12);
            assert!((pixel.radiance[0] / pixel.radiance[2] - 4.0).abs() < 1e-12);
        }
    }
}

/// Lit part of a view ray under the roof: it is dark where x > 0 and y < 5 (overhead light).
fn closed_form(scene: &Scene<'_>, x: usize, y: usize) -> f64 {
    let (d, end) = scene.view_ray(x, y);
    let into = if d.x > 0.0 { 4.0 / d.x } else { f64::INFINITY };
    let above = if d.y > 0.0 { 4.0 / d.y } else { f64::INFINITY };
    let dark = (above.min(end) - into.min(end)).max(0.0);
    1.0 - dark / end
}

#[test]
fn roof_under_an_overhead_light_has_its_closed_form() {
    for (far_depth, target) in [
        (1.0, Vec3::new(0.0, 1.4, 0.3)),
        (0.0, Vec3::new(0.0, 1.4, 0.3)),
        (1.0, Vec3::new(0.0, 1.0, 0.0)),  // level: the sides hold the light
        (1.0, Vec3::new(-3.5, 2.5, 0.0)), // steep: the light is in the picture
    ] {
        let camera = camera(target, false);
        let light = light([0.0, 1.0, 0.0]);
        let depth = sky(&camera);
        let scene = scene(&camera, light, &depth);
        let clip_from_world = light_matrix(light.direction, Vec3::default(), 64.0, far_depth);
        let stored = roof(clip_from_world, far_depth, 1024);
        let shadow_map = ShadowMap { depth: &stored, width: 1024, height: 1024, clip_from_world, far_depth };
        let truth = shadow_map_picture(&scene, &shadow_map, 3);
        let expected: Vec<f64> =
            truth.pixels.iter().map(|pixel| closed_form(&scene, pixel.x, pixel.y)).collect();
        let worst = error::max_absolute(&truth.average(), &expected);
        assert!(worst < 1e-5, "truth: {worst}");
        // Within a texel of the row: 1/1024 of it at either end of the shade.
        let rectification = Rectification::new(&camera, light.direction, 60.0, 1024, 256);
        let texels = rectify(&shadow_map, &rectification, 1e-3);
        assert!(texels.iter().all(|t| t.low <= t.z && t.z <= t.high));
        assert!(texels.iter().all(|t| t.ambiguous || t.low == t.high));
        let map: Vec<f32> = texels.iter().map(|t| t.z as f32).collect();
        let found = picture(&scene, &rectification, &map, 3);
        let mean = error::mean_absolute(&found.average(), &expected);
        assert!(mean < 2e-3, "mean {mean} for {target:?}");
        let radiance = error::relative_rmse(&found.radiance(), &truth.radiance());
        assert!(radiance < 5e-3, "radiance {radiance} for {target:?}");
    }
}

#[test]
fn reversed_depth_changes_nothing() {
    let light = light([0.5, 0.7, 0.2]);
    let [forward, reversed] = [(1.0, false), (0.0, true)].map(|(far_depth, reversed)| {
        let camera = camera(Vec3::new(0.0, 1.2, 0.0), reversed);
        let depth = sky(&camera);
        let clip_from_world = light_matrix(light.direction, Vec3::default(), 32.0, far_depth);
        let stored = roof(clip_from_world, far_depth, 256);
        let shadow_map = ShadowMap { depth: &stored, width: 256, height: 256, clip_from_world, far_depth };
        shadow_map_picture(&scene(&camera, light, &depth), &shadow_map, 4).weighted()
    });
    let worst = error::max_absolute(&forward, &reversed);
    assert!(worst < 1e-5, "{worst}");
    let (least, greatest) = forward.iter().fold((1.0_f64, 0.0_f64), |(a, b), &v| (a.min(v), b.max(v)));
    assert!(greatest - least > 0.2, "{least} to {greatest}");
}

#[test]
fn clear_air_scatters_nothing() {
    let camera = camera(Vec3::default(), false);
    let depth = sky(&camera);
    let mut scene = scene(&camera, light([0.0, 1.0, 0.1]), &depth);
    scene.medium.extinction = 0.0;
    let rectification = Rectification::new(&camera, scene.light.direction, 60.0, 16, 4);
    let found = picture(&scene, &rectification, &[1.0_f32; 64], 7);
    assert!(found.radiance().iter().all(|&v| v == 0.0));
    assert!(found.weighted().iter().all(|&v| v == 1.0));
}
