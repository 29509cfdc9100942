// SPDX-License-Identifier: MIT OR Apache-2.0
//! Against closed forms of visibility integrated in small steps, the airlight integral, and a
//! directional light.

use super::super::directional::shadow_views_picture;
use super::super::local_light::Cone;
use super::super::test_scenes::{faces, light_matrix, plate, roof, stepped};
use super::*;
use crate::error;
use crate::reference::camera::{OrthographicView, View};

const MEDIUM: Medium = Medium { extinction: 0.08, albedo: 0.8, g: 0.5, distance_limit: 30.0 };

fn camera() -> Camera {
    Camera::perspective(&View {
        eye: Vec3::new(-6.0, 1.5, 4.0),
        target: Vec3::new(0.0, 1.2, 0.0),
        up: Vec3::new(0.0, 1.0, 0.0),
        fov_y: 0.9,
        aspect: 1.5,
        near: 2.0,
        far: 40.0,
        reversed: false,
    })
}

fn light(cone: Cone) -> LocalLight {
    LocalLight { position: Vec3::new(0.0, 5.0, 0.0), radius: 0.05, intensity: [20.0, 10.0, 5.0], cone }
}

fn spot() -> Cone {
    Cone::Spot { direction: Vec3::new(-0.1, 1.0, 0.1), cosines: [0.4_f64.cos(), 0.7_f64.cos()] }
}

fn spot_view(reversed: bool) -> Camera {
    Camera::perspective(&View {
        eye: Vec3::new(0.0, 5.0, 0.0),
        target: Vec3::new(0.1, 4.0, -0.1),
        up: Vec3::new(0.0, 0.0, 1.0),
        fov_y: 1.5,
        aspect: 1.0,
        near: 0.05,
        far: 60.0,
        reversed,
    })
}

fn scene<'a>(camera: &'a Camera, light: LocalLight, depth: &'a [f32]) -> LocalScene<'a> {
    LocalScene { camera, light, texture: None, medium: MEDIUM, depth, width: 24, height: 16 }
}

fn map<'a>(view: &Camera, depth: &'a [f32], side: usize) -> ShadowMap<'a> {
    ShadowMap {
        depth,
        width: side,
        height: side,
        clip_from_world: view.clip_from_world,
        far_depth: view.far_depth,
    }
}

/// The equation in small steps under the plate at the height 2 (the light is over its edge).
fn by_steps(scene: &LocalScene<'_>, ray: &ViewRay) -> f64 {
    let light = &scene.light;
    let integrand = |t: f64| {
        let point = ray.at(t);
        if point.x > 0.0 && point.y < 2.0 {
            return 0.0;
        }
        let v = light.position - point;
        let d = v.length();
        let phase = henyey_greenstein(ray.direction.dot(v) / d, MEDIUM.g);
        phase * (-MEDIUM.extinction * (t - ray.begin + d)).exp() * light.fall_off(-v)
            / (d * d + light.radius * light.radius)
    };
    MEDIUM.albedo * MEDIUM.extinction * ray.length() * stepped(ray.begin, ray.end, 8192, integrand)
}

#[test]
fn plate_under_spot_and_point_has_its_closed_form() {
    let perspective = camera();
    let orthographic = Camera::orthographic(&OrthographicView {
        eye: perspective.eye,
        target: Vec3::new(0.0, 1.2, 0.0),
        up: Vec3::new(0.0, 1.0, 0.0),
        half_height: 4.0,
        aspect: 1.5,
        depth: 25.0,
        reversed: true,
    });
    for (camera, reversed) in [(perspective, false), (perspective, true), (orthographic, false)] {
        let sky = vec![camera.far_depth as f32; 24 * 16];
        for (cone, views) in [
            (spot(), vec![spot_view(reversed)]),
            (Cone::Point, faces(Vec3::new(0.0, 5.0, 0.0), reversed).to_vec()),
        ] {
            let stored: Vec<Vec<f32>> = views.iter().map(|view| plate(view, 2.0, 512)).collect();
            let maps: Vec<_> = views.iter().zip(&stored).map(|(view, depth)| map(view, depth, 512)).collect();
            let scene = scene(&camera, light(cone), &sky);
            let start = if reversed { Start::NearPlane } else { Start::Eye };
            let found = scene.truth(&maps, start, 2);
            let expected: Vec<f64> = found
                .pixels
                .iter()
                .map(|pixel| by_steps(&scene, &scene.ray(pixel.x, pixel.y, start)))
                .collect();
            let red: Vec<f64> = found.pixels.iter().map(|pixel| pixel.radiance[0] / 20.0).collect();
            let error = error::relative_rmse(&red, &expected);
            assert!(error < 2e-3, "{error} {cone:?}");
            let shade = found.weighted().into_iter().fold(1.0_f64, f64::min);
            assert!(shade < 0.85 && found.weighted().iter().all(|&v| v <= 1.0 + 1e-9), "{shade}");
        }
    }
}

#[test]
fn empty_scene_is_the_airlight_integral() {
    let camera = camera();
    let sky = vec![1.0_f32; 24 * 16];
    let mut scene = scene(&camera, light(Cone::Point), &sky);
    let empty: Vec<ShadowMap<'_>> =
        faces(scene.light.position, false).iter().map(|view| map(view, &[1.0; 4], 2)).collect();
    let check = |scene: &LocalScene<'_>, radius: f64, closed: bool| {
        let found = scene.truth(&empty, Start::Eye, 3);
        for pixel in &found.pixels {
            let ray = scene.ray(pixel.x, pixel.y, Start::Eye);
            let towards = scene.light.position - ray.origin;
            let cosine = ray.direction.dot(towards) / towards.length();
            let air = Airlight {
                distance: towards.length(),
                theta: cosine.acos(),
                radius,
                extinction: MEDIUM.extinction,
            };
            let expected = if closed {
                air.isotropic(0.0, ray.end)
            } else {
                air.quadrature(|c| henyey_greenstein(c, scene.medium.g), 0.0, ray.end)
            };
            let expected = MEDIUM.albedo * MEDIUM.extinction * 10.0 * expected;
            assert!((pixel.radiance[1] / expected - 1.0).abs() < 1e-8, "{} {expected}", pixel.radiance[1]);
            assert!((pixel.average - 1.0).abs() < 1e-12 && (pixel.weighted - 1.0).abs() < 1e-9);
        }
    };
    check(&scene, 0.05, false);
    scene.medium.g = 0.0;
    scene.light.radius = 1e-9;
    check(&scene, 0.0, true);
}

#[test]
fn far_and_strong_spot_is_a_directional_light() {
    const FAR: f64 = 1e5;
    let camera = camera();
    let sky = vec![1.0_f32; 24 * 16];
    let direction = Vec3::new(0.2, 1.0, 0.1).normalised();
    let thin = Medium { extinction: 1e-6, ..MEDIUM };
    let clip_from_world = light_matrix(direction, Vec3::default(), 40.0, 1.0);
    let stored = roof(clip_from_world, 1.0, 1024);
    let orthographic =
        ShadowMap { depth: &stored, width: 1024, height: 1024, clip_from_world, far_depth: 1.0 };
    let sun = Light { direction, radiance: [2.0, 1.0, 0.5] };
    let directional = Scene { camera: &camera, light: sun, medium: thin, depth: &sky, width: 24, height: 16 };
    let expected = shadow_views_picture(&directional, &[orthographic], None, Start::Eye, 2);
    let position = direction * FAR;
    let view = Camera::perspective(&View {
        eye: position,
        target: Vec3::default(),
        up: Vec3::new(0.0, 0.0, 1.0),
        fov_y: 2.0 * (40.0 / FAR).atan(),
        aspect: 1.0,
        near: FAR - 100.0,
        far: FAR + 100.0,
        reversed: false,
    });
    let stored = plate(&view, 5.0, 1024);
    let local = LocalLight {
        position,
        radius: 0.1,
        intensity: sun.radiance.map(|e| e * FAR * FAR * (thin.extinction * FAR).exp()),
        cone: Cone::Spot { direction, cosines: [0.9, 0.8] },
    };
    let mut scene = scene(&camera, local, &sky);
    scene.medium = thin;
    let found = scene.truth(&[map(&view, &stored, 1024)], Start::Eye, 2);
    let radiance = error::relative_rmse(&found.radiance(), &expected.radiance());
    let average = error::mean_absolute(&found.average(), &expected.average());
    assert!(radiance < 3e-3 && average < 2e-3, "{radiance} {average}");
    let shade = expected.average().into_iter().fold(1.0_f64, f64::min);
    assert!(shade < 0.8, "{shade}");
}

#[test]
fn texture_of_a_spot_passes_nothing_outside_of_its_map() {
    let camera = camera();
    let sky = vec![1.0_f32; 24 * 16];
    let view = spot_view(false);
    let stored = plate(&view, 2.0, 512);
    let maps = [map(&view, &stored, 512)];
    let narrow = Camera::perspective(&View {
        eye: Vec3::new(0.0, 5.0, 0.0),
        target: Vec3::new(0.0, 4.0, 0.0),
        up: Vec3::new(0.0, 0.0, 1.0),
        fov_y: 0.5,
        aspect: 1.0,
        near: 0.05,
        far: 60.0,
        reversed: false,
    });
    let mut scene = scene(&camera, light(spot()), &sky);
    let plain = scene.truth(&maps, Start::Eye, 2);
    let grey = [0.5_f32; 3 * 9];
    let texture = LightTexture { rgb: &grey, width: 3, height: 3, clip_from_world: None, outside: 0.0 };
    scene.texture = Some(texture);
    let half = scene.truth(&maps, Start::Eye, 2);
    assert_eq!(half.weighted(), plain.weighted());
    let worst =
        error::max_absolute(&half.radiance(), &plain.radiance().iter().map(|v| 0.5 * v).collect::<Vec<_>>());
    assert!(worst < 1e-8, "{worst}");
    // A narrower clip space of its own: only a part of the cone is left.
    scene.texture = Some(LightTexture { clip_from_world: Some(narrow.clip_from_world), ..texture });
    let part = scene.truth(&maps, Start::Eye, 2);
    let by_hand = |x: usize, y: usize| {
        let ray = scene.ray(x, y, Start::Eye);
        let integrand = |t: f64| {
            let point = ray.at(t);
            let v = point - Vec3::new(0.0, 5.0, 0.0);
            let shade = point.x > 0.0 && point.y < 2.0;
            if shade || v.y >= 0.0 || v.x.abs().max(v.z.abs()) > -v.y * 0.25_f64.tan() {
                return 0.0;
            }
            let d = v.length();
            let phase = henyey_greenstein(-ray.direction.dot(v) / d, MEDIUM.g);
            0.5 * phase * (-MEDIUM.extinction * (t + d)).exp() * scene.light.fall_off(v) / (d * d + 0.0025)
        };
        let steps = MEDIUM.albedo * MEDIUM.extinction * 20.0 * ray.end;
        steps * stepped(0.0, ray.end, 65_536, integrand)
    };
    let expected: Vec<f64> = part.pixels.iter().map(|pixel| by_hand(pixel.x, pixel.y)).collect();
    let red: Vec<f64> = part.pixels.iter().map(|pixel| pixel.radiance[0]).collect();
    let error = error::relative_rmse(&red, &expected);
    assert!(error < 2e-3, "{error}");
    assert!(part.radiance().iter().sum::<f64>() < 0.8 * half.radiance().iter().sum::<f64>());
}

#[test]
fn picture_over_rows_comes_near_to_the_truth() {
    let camera = camera();
    let sky = vec![1.0_f32; 24 * 16];
    for (cone, views) in
        [(spot(), vec![spot_view(false)]), (Cone::Point, faces(Vec3::new(0.0, 5.0, 0.0), false).to_vec())]
    {
        let stored: Vec<Vec<f32>> = views.iter().map(|view| plate(view, 2.0, 512)).collect();
        let maps: Vec<_> = views.iter().zip(&stored).map(|(view, depth)| map(view, depth, 512)).collect();
        let scene = scene(&camera, light(cone), &sky);
        let rows = LocalRows::new(&camera, scene.light, MEDIUM.distance_limit, [512, 256]).expect("rows");
        let texels = rows.rectify(&maps, 1e-3);
        assert!(texels.iter().all(|t| t.low <= t.z && t.z <= t.high));
        assert!(texels.iter().all(|t| t.ambiguous || t.low == t.high));
        let stored: Vec<f32> = texels.iter().map(|t| t.z as f32).collect();
        let fall_off = rows.fall_off(&maps, None);
        let over = Over { map: &stored, fall_off: &fall_off, medium: MEDIUM };
        let truth = scene.truth(&maps, Start::Eye, 2);
        let [exact, factored] = [Weights::Exact, Weights::Factored].map(|weights| {
            error::relative_rmse(&scene.over_rows(&rows, &over, weights, 2).radiance(), &truth.radiance())
        });
        println!("{cone:?}: relative RMSE of rows {exact:.4}, with the mean factored out {factored:.4}");
        assert!(exact < 1e-2, "{exact} {cone:?}");
        assert!(factored < 0.3 && factored > exact, "{factored} {cone:?}");
    }
}
