// SPDX-License-Identifier: MIT OR Apache-2.0
//! Against the walk over one map, and closed forms.

use super::super::picture::{Light, Medium, ViewRay, picture};
use super::super::shadow_map::{rectify, rectify_views};
use super::super::slice::Rectification;
use super::super::stretch::rectified_picture;
use super::super::test_scenes::{light_matrix, roof, stepped};
use super::super::truth::shadow_map_picture;
use super::*;
use crate::error;
use crate::linear::Vec3;
use crate::reference::camera::{Camera, OrthographicView, View};

const MEDIUM: Medium = Medium { extinction: 0.05, albedo: 0.8, g: 0.6, distance_limit: 60.0 };

fn cameras() -> [Camera; 2] {
    let (eye, target, up) = (Vec3::new(-4.0, 1.0, 0.0), Vec3::new(0.0, 1.4, 0.3), Vec3::new(0.0, 1.0, 0.0));
    [
        Camera::perspective(&View {
            eye,
            target,
            up,
            fov_y: 0.9,
            aspect: 1.5,
            near: 3.0,
            far: 40.0,
            reversed: false,
        }),
        Camera::orthographic(&OrthographicView {
            eye,
            target,
            up,
            half_height: 6.0,
            aspect: 1.5,
            depth: 40.0,
            reversed: true,
        }),
    ]
}

fn scene<'a>(camera: &'a Camera, direction: Vec3, depth: &'a [f32]) -> Scene<'a> {
    let light = Light { direction, radiance: [2.0, 1.0, 0.5] };
    Scene { camera, light, medium: MEDIUM, depth, width: 24, height: 16 }
}

fn sky(camera: &Camera) -> Vec<f32> {
    vec![camera.far_depth as f32; 24 * 16]
}

fn texture(rgb: &[f32]) -> LightTexture<'_> {
    LightTexture { rgb, width: 8, height: 8, clip_from_world: None, outside: 1.0 }
}

/// Whether a point is out of the roof's shade under an overhead light.
fn lit(point: Vec3) -> f64 {
    f64::from(u8::from(point.x <= 0.0 || point.y >= 5.0))
}

#[test]
fn one_map_gives_the_walk_over_it() {
    for camera in cameras() {
        for (direction, far_depth) in [(Vec3::new(0.3, 1.0, 0.2), 1.0), (Vec3::new(-0.5, 0.3, 0.4), 0.0)] {
            let depth = sky(&camera);
            let scene = scene(&camera, direction, &depth);
            let clip_from_world = light_matrix(direction, Vec3::default(), 32.0, far_depth);
            let stored = roof(clip_from_world, far_depth, 256);
            let map = ShadowMap { depth: &stored, width: 256, height: 256, clip_from_world, far_depth };
            let walked = shadow_map_picture(&scene, &map, 1);
            let found = shadow_views_picture(&scene, &[map], None, Start::Eye, 1);
            assert!(error::max_absolute(&found.average(), &walked.average()) < 1e-10);
            assert!(error::max_absolute(&found.weighted(), &walked.weighted()) < 1e-10);
            assert!(error::max_absolute(&found.radiance(), &walked.radiance()) < 1e-10);
        }
    }
}

#[test]
fn roof_has_its_closed_form_from_the_eye_and_from_the_near_plane() {
    let up = Vec3::new(0.0, 1.0, 0.0);
    let clip_from_world = light_matrix(up, Vec3::default(), 64.0, 1.0);
    let stored = roof(clip_from_world, 1.0, 1024);
    let map = ShadowMap { depth: &stored, width: 1024, height: 1024, clip_from_world, far_depth: 1.0 };
    for camera in cameras() {
        let depth = sky(&camera);
        let scene = scene(&camera, up, &depth);
        let mut shortest = f64::INFINITY;
        for start in [Start::Eye, Start::NearPlane] {
            let found = shadow_views_picture(&scene, &[map], None, start, 3);
            for pixel in &found.pixels {
                let ray = scene.ray(pixel.x, pixel.y, start);
                shortest = shortest.min(ray.begin);
                assert!((pixel.distance - (ray.end - ray.begin)).abs() < 1e-12);
                let average = stepped(ray.begin, ray.end, 4096, |t| lit(ray.at(t)));
                let transmitted = |t: f64| (-MEDIUM.extinction * (t - ray.begin)).exp();
                let weighted = stepped(ray.begin, ray.end, 4096, |t| transmitted(t) * lit(ray.at(t)))
                    / stepped(ray.begin, ray.end, 4096, transmitted);
                assert!((pixel.average - average).abs() < 1e-3, "{} {average}", pixel.average);
                assert!((pixel.weighted - weighted).abs() < 1e-3, "{} {weighted}", pixel.weighted);
            }
            let near = if start == Start::NearPlane && !camera.is_orthographic() { 3.0 } else { 0.0 };
            assert!(shortest >= 0.0 && found.pixels.iter().all(|p| p.distance <= 60.0 - near));
        }
    }
}

#[test]
fn light_ray_belongs_to_the_first_map_that_holds_it() {
    // A dark square in the first map, a wider one that is dark in the second, and light around both.
    let up = Vec3::new(0.0, 1.0, 0.0);
    let [small, wide] = [4.0, 16.0].map(|half| light_matrix(up, Vec3::new(3.0, 0.0, 0.0), half, 1.0));
    let (dark, empty) = ([0.0_f32; 64], [1.0_f32; 64]);
    let map =
        |depth, clip_from_world| ShadowMap { depth, width: 8, height: 8, clip_from_world, far_depth: 1.0 };
    let inside = |point: Vec3, half: f64| (point.x - 3.0).abs() < half && point.z.abs() < half;
    // Depth 0, where the dark begins, lies `half` metres above the centre.
    let shade = |point: Vec3, half: f64, dark: bool| dark && point.y < half;
    for camera in cameras() {
        let depth = sky(&camera);
        let scene = scene(&camera, up, &depth);
        for (maps, dark, first) in [
            ([map(&dark, small), map(&empty, wide)], [true, false], 4.0),
            ([map(&empty, small), map(&dark, wide)], [false, true], 4.0),
            ([map(&dark, wide), map(&empty, small)], [true, false], 16.0),
        ] {
            let found = shadow_views_picture(&scene, &maps, None, Start::Eye, 3);
            for pixel in &found.pixels {
                let ray = scene.ray(pixel.x, pixel.y, Start::Eye);
                let expected = stepped(ray.begin, ray.end, 8192, |t| {
                    let point = ray.at(t);
                    let lit = if inside(point, first) {
                        !shade(point, first, dark[0])
                    } else {
                        !(inside(point, 16.0) && shade(point, 16.0, dark[1]))
                    };
                    f64::from(u8::from(lit))
                });
                assert!((pixel.average - expected).abs() < 1e-3, "{} {expected}", pixel.average);
            }
        }
    }
}

#[test]
fn light_texture_passes_what_it_says() {
    let up = Vec3::new(0.0, 1.0, 0.0);
    let clip_from_world = light_matrix(up, Vec3::default(), 64.0, 1.0);
    let stored = roof(clip_from_world, 1.0, 256);
    let map = ShadowMap { depth: &stored, width: 256, height: 256, clip_from_world, far_depth: 1.0 };
    let camera = cameras()[0];
    let depth = sky(&camera);
    let scene = scene(&camera, up, &depth);
    let plain = shadow_views_picture(&scene, &[map], None, Start::NearPlane, 2);
    for grey in [1.0_f32, 0.25] {
        let rgb = [grey; 192];
        let found = shadow_views_picture(&scene, &[map], Some(&texture(&rgb)), Start::NearPlane, 2);
        assert_eq!(found.weighted(), plain.weighted());
        for (a, b) in found.radiance().into_iter().zip(plain.radiance()) {
            assert!((a - f64::from(grey) * b).abs() < 1e-12);
        }
    }
    // A ramp is affine along a ray, where it is not clamped: compare with the integral by hand.
    let rgb: Vec<f32> = (0..64)
        .flat_map(|i| {
            let across = ((i % 8) as f32 + 0.5) / 8.0;
            [across, 1.0 - across, 0.5]
        })
        .collect();
    let empty = ShadowMap { depth: &[1.0_f32; 4], width: 2, height: 2, ..map };
    let found = shadow_views_picture(&scene, &[empty], Some(&texture(&rgb)), Start::Eye, 2);
    let clear = shadow_views_picture(&scene, &[empty], None, Start::Eye, 2);
    for (pixel, clear) in found.pixels.iter().zip(&clear.pixels) {
        let ViewRay { end, .. } = scene.ray(pixel.x, pixel.y, Start::Eye);
        let ray = scene.ray(pixel.x, pixel.y, Start::Eye);
        let across = |t: f64| {
            let [x, _, _, w] = clip_from_world.apply_point(ray.at(t));
            0.5 + 0.5 * x / w
        };
        assert!((0.0625..0.9375).contains(&across(0.0)) && (0.0625..0.9375).contains(&across(end)));
        // ∫ σ e^(−σt) (a + b t) dt = a (1 − T) + b ((1 − T) / σ − T end).
        let sigma = MEDIUM.extinction;
        let (a, b) = (across(0.0), (across(end) - across(0.0)) / end);
        let transmittance = (-sigma * end).exp();
        let taken = 1.0 - transmittance;
        let share = (a * taken + b * (taken / sigma - transmittance * end)) / taken;
        for (channel, share) in [share, 1.0 - share, 0.5].into_iter().enumerate() {
            let expected = clear.radiance[channel] * share;
            assert!((pixel.radiance[channel] - expected).abs() < 1e-7 * clear.radiance[channel]);
        }
    }
}

#[test]
fn rows_from_the_near_plane_and_over_cascades_come_near_to_the_truth() {
    let up = Vec3::new(0.1, 1.0, 0.05);
    let [fine, coarse] = [12.0, 64.0].map(|half| light_matrix(up, Vec3::default(), half, 1.0));
    let stored = [fine, coarse].map(|clip_from_world| roof(clip_from_world, 1.0, 512));
    let map = |i: usize| {
        let clip_from_world = [fine, coarse][i];
        ShadowMap { depth: &stored[i], width: 512, height: 512, clip_from_world, far_depth: 1.0 }
    };
    let maps = [map(0), map(1)];
    let camera = cameras()[0];
    let depth = sky(&camera);
    let scene = scene(&camera, up, &depth);
    let rectification = Rectification::new(&camera, up, 60.0, 1024, 256);
    let texels = rectify_views(&maps, &rectification, 1e-3);
    let one = rectify(&maps[1], &rectification, 1e-3);
    assert_eq!(rectify_views(&maps[1..], &rectification, 1e-3).len(), one.len());
    for (a, b) in rectify_views(&maps[1..], &rectification, 1e-3).iter().zip(&one) {
        assert!((a.z - b.z).abs() < 1e-9 && (a.low - b.low).abs() < 1e-9 && (a.high - b.high).abs() < 1e-9);
    }
    assert!(texels.iter().zip(&one).any(|(a, b)| a.z != b.z));
    let stored: Vec<f32> = texels.iter().map(|texel| texel.z as f32).collect();
    let plain = picture(&scene, &rectification, &stored, 2).weighted();
    for start in [Start::Eye, Start::NearPlane] {
        let truth = shadow_views_picture(&scene, &maps, None, start, 2);
        let found = rectified_picture(&scene, &rectification, &stored, start, 2);
        let error = error::relative_rmse(&found.radiance(), &truth.radiance());
        assert!(error < 5e-3, "{error} {start:?}");
        let difference = error::max_absolute(&found.weighted(), &plain);
        assert_eq!(difference < 1e-9, start == Start::Eye, "{difference}");
    }
}
