// SPDX-License-Identifier: MIT OR Apache-2.0
//! The geometry of local rows, their searched bounds against closed forms, and radiance over maps with
//! closed forms.

use super::super::local_light::Cone;
use super::super::test_scenes::Random;
use super::*;

const MEDIUM: Medium = Medium { extinction: 0.08, albedo: 0.8, g: 0.5, distance_limit: 30.0 };

fn light(random: &mut Random, eye: Vec3, spot: bool) -> LocalLight {
    let outer = random.between(0.1, 1.4);
    let cone = if spot {
        Cone::Spot { direction: random.direction(), cosines: [(0.7 * outer).cos(), outer.cos()] }
    } else {
        Cone::Point
    };
    let position = eye + random.direction() * random.between(0.5, 20.0);
    LocalLight { position, radius: 0.05, intensity: [3.0, 2.0, 1.0], cone }
}

#[test]
fn angles_at_the_light_are_those_of_its_rays() {
    let mut random = Random(41);
    for _ in 0..2000 {
        let camera = random.camera();
        let light = light(&mut random, camera.eye, false);
        let frame = Frame::new(&camera, light.position - camera.eye);
        let distance = (light.position - camera.eye).length();
        let direction = random.direction();
        let polar = frame.polar_direction(direction);
        let ray = LocalRay { phi: polar.phi, theta: polar.theta, distance };
        let t = random.between(0.1, 40.0);
        if polar.theta.sin() < 1e-2 {
            continue;
        }
        let from_light = camera.eye + direction * t - light.position;
        let back = (camera.eye - light.position).normalised();
        let alpha = from_light.normalised().cross(back).length().atan2(from_light.normalised().dot(back));
        assert!((ray.alpha(t) - alpha).abs() < 1e-9);
        assert!((ray.t(alpha) / t - 1.0).abs() < 1e-7);
        assert!((light_ray(&frame, polar.phi, alpha) - from_light.normalised()).length() < 1e-9);
        assert_eq!(ray.t(PI - polar.theta * 0.99), f64::INFINITY);
        // Along a light ray the angle at the eye grows from 0 towards π − alpha.
        let mut before = 0.0;
        for i in 1..30 {
            let point = light.position + light_ray(&frame, polar.phi, alpha) * (0.01 * 1.5_f64.powi(i));
            let theta = frame.polar(point).theta;
            assert!(theta > before && theta < PI - alpha + 1e-12);
            before = theta;
        }
        assert!((before - (PI - alpha)).abs() < 0.1 * distance);
    }
}

#[test]
fn searched_cone_has_its_closed_form() {
    let mut random = Random(42);
    let (mut lit, mut empty) = (0, 0);
    for _ in 0..1500 {
        let camera = random.camera();
        let light = light(&mut random, camera.eye, true);
        let Cone::Spot { direction, cosines: [_, outer] } = light.cone else { unreachable!() };
        let frame = Frame::new(&camera, light.position - camera.eye);
        let phi = random.between(-PI, PI);
        // The cosine with the axis is R cos(alpha − centre).
        let (across, along) = (-direction.dot(frame.radial(phi)), direction.dot(frame.l));
        let (size, centre) = (across.hypot(along), across.atan2(along));
        let half = if size > outer { (outer / size).acos() } else { f64::NAN };
        let turns = [-2.0 * PI, 0.0, 2.0 * PI]
            .map(|turn| ((centre + turn - half).max(0.0), (centre + turn + half).min(PI)));
        let expected = turns
            .into_iter()
            .filter(|(low, high)| !half.is_nan() && low <= high)
            .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
        match (cone(&frame, &light, phi), expected) {
            (None, None) => empty += 1,
            (Some(found), Some(expected)) => {
                lit += 1;
                assert!((found.0 - expected.0).abs() < 1e-6, "{found:?} {expected:?}");
                assert!((found.1 - expected.1).abs() < 1e-6, "{found:?} {expected:?}");
            }
            (found, expected) => panic!("{found:?} {expected:?}"),
        }
    }
    assert!(lit > 300 && empty > 300, "{lit} {empty}");
}

#[test]
fn rays_of_a_slice_end_within_its_columns() {
    let mut random = Random(43);
    let mut near = 0;
    for index in 0..60 {
        let camera = random.camera();
        let light = light(&mut random, camera.eye, index % 2 == 0);
        let rows = LocalRows::new(&camera, light, 40.0, [64, 8]).expect("rows");
        assert!((rows.distance - (light.position - camera.eye).length()).abs() < 1e-12);
        for slice in &rows.slices {
            assert!(slice.alpha_min >= 0.0 && slice.alpha_max <= PI && slice.alpha_min < slice.alpha_max);
            let mut reached = 0.0_f64;
            for i in 0..=3000 {
                let theta = slice.theta_min + (slice.theta_max - slice.theta_min) * f64::from(i) / 3000.0;
                let along = rows.frame.direction(slice.phi, theta).dot(camera.forward);
                let end = if along > 0.0 { (camera.far / along).min(40.0) } else { 40.0 };
                reached = reached.max(LocalRay { phi: slice.phi, theta, distance: rows.distance }.alpha(end));
            }
            match (light.cone, slice.dark) {
                (Cone::Point, dark) => {
                    assert!(!dark && slice.alpha_min == 0.0);
                    assert!((slice.alpha_max - reached).abs() < 2e-3, "{slice:?} {reached}");
                    assert!(slice.alpha_max >= reached - 1e-9);
                    near += 1;
                }
                (_, true) => {
                    assert!(
                        cone(&rows.frame, &light, slice.phi).is_none_or(|(low, _)| low >= reached - 1e-9)
                    );
                }
                (_, false) => {
                    let (low, high) = cone(&rows.frame, &light, slice.phi).expect("light");
                    assert!(slice.alpha_min == low && (slice.alpha_max - high.min(reached)).abs() < 2e-3);
                }
            }
        }
    }
    assert!(near > 100);
    let camera = random.camera();
    let mut light = light(&mut random, camera.eye, false);
    light.position = camera.eye + Vec3::new(0.0, 5e-5, 0.0);
    assert_eq!(LocalRows::new(&camera, light, 9.0, [4, 4]).map(|_| ()), Err(EyeAtLight));
    light.position = Vec3::new(f64::NAN, 0.0, 0.0);
    assert_eq!(LocalRows::new(&camera, light, 9.0, [4, 4]).map(|_| ()), Err(EyeAtLight));
}

/// Rows of a camera beside a point light.
fn beside(radius: f64) -> LocalRows {
    let camera = Camera::perspective(&crate::reference::camera::View {
        eye: Vec3::new(-6.0, 1.5, 4.0),
        target: Vec3::new(0.0, 1.2, 0.0),
        up: Vec3::new(0.0, 1.0, 0.0),
        fov_y: 0.9,
        aspect: 1.5,
        near: 0.1,
        far: 40.0,
        reversed: false,
    });
    let light = LocalLight {
        position: Vec3::new(0.0, 5.0, 0.0),
        radius,
        intensity: [3.0, 2.0, 1.0],
        cone: Cone::Point,
    };
    LocalRows::new(&camera, light, 30.0, [256, 16]).expect("rows")
}

#[test]
fn all_lit_is_the_airlight_integral_and_all_dark_is_nothing() {
    let rows = beside(0.1);
    let ones = vec![[1.0; 3]; 256 * 16];
    for (j, unit, end) in [(2, 0.2, 25.0), (8, 0.5, 9.0), (15, 0.9, 3.0)] {
        let slice = rows.slices[j];
        let theta = slice.theta_min + (slice.theta_max - slice.theta_min) * unit;
        let ray = LocalRay { phi: slice.phi, theta, distance: rows.distance };
        let air = Airlight { distance: rows.distance, theta, radius: 0.1, extinction: MEDIUM.extinction };
        let airlight = air.quadrature(|cosine| henyey_greenstein(cosine, MEDIUM.g), 0.0, end);
        let lit = Over { map: &vec![1.0_f32; 256 * 16], fall_off: &ones, medium: MEDIUM };
        let dark = Over { map: &vec![0.0_f32; 256 * 16], fall_off: &ones, medium: MEDIUM };
        let covered = rows.covered(j, ray, end);
        assert!(covered > 1.0 && covered < 256.0);
        for (channel, intensity) in [3.0, 2.0, 1.0].into_iter().enumerate() {
            let expected = MEDIUM.albedo * MEDIUM.extinction * intensity * airlight;
            let exact = rows.row_radiance(&lit, j, ray, end)[channel];
            let factored = rows.row_radiance_factored(&lit, j, ray, end)[channel];
            assert!((exact / expected - 1.0).abs() < 1e-9, "{exact} {expected}");
            assert!((factored / expected - 1.0).abs() < 1e-9, "{factored} {expected}");
        }
        assert_eq!(rows.row_radiance(&dark, j, ray, end), [0.0; 3]);
        assert_eq!(rows.row_radiance_factored(&dark, j, ray, end), [0.0; 3]);
        assert_eq!(rows.row_mean(&dark, j, ray, end), [0.0; 3]);
    }
}

#[test]
fn light_up_to_a_column_ends_the_integral_there() {
    let rows = beside(0.1);
    let ones = vec![[1.0, 0.5, 0.0]; 256 * 16];
    let map: Vec<f32> = (0..256 * 16).map(|i| if i % 256 < 100 { 1.0 } else { 0.0 }).collect();
    let over = Over { map: &map, fall_off: &ones, medium: MEDIUM };
    let (j, end) = (8, 25.0);
    let slice = rows.slices[j];
    let theta = 0.5 * (slice.theta_min + slice.theta_max);
    let ray = LocalRay { phi: slice.phi, theta, distance: rows.distance };
    let border = ray.t(slice.alpha(100.0, 256));
    assert!(border < end, "{border}");
    let air = Airlight { distance: rows.distance, theta, radius: 0.1, extinction: MEDIUM.extinction };
    let expected = MEDIUM.albedo
        * MEDIUM.extinction
        * air.quadrature(|cosine| henyey_greenstein(cosine, MEDIUM.g), 0.0, border);
    let found = rows.row_radiance(&over, j, ray, end);
    assert!((found[0] / (3.0 * expected) - 1.0).abs() < 1e-9);
    assert!((found[1] / expected - 1.0).abs() < 1e-9 && found[2] == 0.0);
    let mean = rows.row_mean(&over, j, ray, end);
    assert!((mean[0] - 100.0 / rows.covered(j, ray, end)).abs() < 1e-12);
}

#[test]
fn plain_means_are_weighted_by_the_inverse_square() {
    // Clear air, isotropic, a small light: nothing is left to factor.
    let rows = beside(1e-6);
    let thin = Medium { extinction: 1e-9, g: 0.0, ..MEDIUM };
    let map: Vec<f64> = (0..256 * 16).map(|i| (f64::from(i) * 12.9898).sin().abs()).collect();
    let fall_off: Vec<[f64; 3]> = (0..256 * 16).map(|i| [(f64::from(i) * 0.7).sin().abs(); 3]).collect();
    let mut worst = [0.0_f64; 2];
    for (kind, medium) in [thin, MEDIUM].into_iter().enumerate() {
        let over = Over { map: &map, fall_off: &fall_off, medium };
        for j in 0..16 {
            let slice = rows.slices[j];
            for unit in [0.1, 0.5, 0.9] {
                let theta = slice.theta_min + (slice.theta_max - slice.theta_min) * unit;
                let ray = LocalRay { phi: slice.phi, theta, distance: rows.distance };
                let exact = rows.row_radiance(&over, j, ray, 20.0)[0];
                let factored = rows.row_radiance_factored(&over, j, ray, 20.0)[0];
                worst[kind] = worst[kind].max((factored / exact - 1.0).abs());
            }
        }
    }
    assert!(worst[0] < 1e-6 && worst[1] > 1e-3, "{worst:?}");
}
