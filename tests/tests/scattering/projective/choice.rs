// SPDX-License-Identifier: MIT OR Apache-2.0
//! Which rows are refused, and when projective rows are chosen.

use super::cameras::{
    LIMIT, any_camera, host_camera, light_beside_corner, light_for, next_to_the_border, orthographic,
};
use crate::gpu::{self, Random};
use airlight::scattering::{Choice, OBLIQUENESS_LIMIT, ProjectiveError, choose, projective_rows};
use airlight_tests::reference::scattering as reference;
use glam::Vec3;

#[test]
fn rows_are_refused_exactly_when_the_light_or_its_antipode_is_in_view() {
    let mut random = Random(44);
    let (mut failed, mut borders, mut rows, mut oblique) = ([0; 2], 0, 0, 0);
    for index in 0..2000 {
        let aspect = random.between(0.5, 2.5);
        let camera = random.camera(aspect);
        let light = gpu::vector(gpu::host_vector(random.light(&camera)));
        let expected = reference::light_in_view(&camera, light);
        if next_to_the_border(&camera, light, 2e-5) {
            borders += 1;
            continue;
        }
        let found = projective_rows(&host_camera(&camera, [96, 64]), gpu::host_vector(light), LIMIT, 2);
        match (found, expected) {
            (Err(ProjectiveError::LightInView), Some(reference::Failure::LightInView)) => failed[0] += 1,
            (Err(ProjectiveError::AntipodeInView), Some(reference::Failure::AntipodeInView)) => {
                failed[1] += 1
            }
            (Ok(_), None) => rows += 1,
            (Err(ProjectiveError::TooOblique { obliqueness, limit }), None) => {
                assert!(obliqueness > limit);
                oblique += 1;
            }
            (found, expected) => panic!("camera {index}: {found:?} instead of {expected:?}"),
        }
    }
    println!(
        "{failed:?} light and antipode in view, {rows} rows, {oblique} too oblique, {borders} at borders"
    );
    assert!(failed.iter().all(|count| *count > 200) && rows > 200 && oblique < rows / 4);
    let mut camera = host_camera(&random.camera(1.5), [96, 64]);
    let towards = gpu::host_vector(random.direction());
    for splits in [0, 5] {
        assert_eq!(projective_rows(&camera, towards, LIMIT, splits), Err(ProjectiveError::Splits(splits)));
    }
    for (light, limit) in [(Vec3::ZERO, 9.0), (Vec3::NAN, 9.0), (Vec3::X, f32::INFINITY), (Vec3::X, 0.0)] {
        assert_eq!(projective_rows(&camera, light, limit, 1), Err(ProjectiveError::NotFinite));
    }
    camera.world_from_clip.x_axis.x = f32::NAN;
    assert_eq!(projective_rows(&camera, towards, LIMIT, 1), Err(ProjectiveError::NotFinite));
    let level = orthographic(&mut random, 1.5);
    for sign in [1.0, -1.0] {
        let light = gpu::host_vector(level.forward * sign);
        let found = projective_rows(&host_camera(&level, [96, 64]), light, LIMIT, 1);
        assert_eq!(found, Err(ProjectiveError::ViewParallelToLight));
    }
}

#[test]
fn the_choice_is_projective_where_rows_are_good_and_says_why_where_not() {
    let mut random = Random(45);
    let mut counts = [0; 4];
    for index in 0..1000 {
        let aspect = random.between(0.5, 2.5);
        let camera = any_camera(&mut random, aspect);
        let mut light = gpu::host_vector(light_for(&mut random, &camera));
        if index % 5 == 0 && !camera.is_orthographic() {
            light = light_beside_corner(&camera, random.magnitude(0.01, 0.5));
        }
        let host = host_camera(&camera, [96, 64]);
        let rows = projective_rows(&host, light, LIMIT, 2);
        match (choose(&host, light, LIMIT, 2), rows) {
            (Choice::Projective(chosen), Ok(rows)) => {
                assert_eq!(*chosen, rows);
                assert!(rows.obliqueness <= OBLIQUENESS_LIMIT, "camera {index}");
                counts[0] += 1;
            }
            (Choice::Epipolar { reason } | Choice::March { reason }, Ok(rows)) => {
                let limit = OBLIQUENESS_LIMIT;
                assert!(rows.obliqueness > limit, "camera {index}");
                assert_eq!(reason, ProjectiveError::TooOblique { obliqueness: rows.obliqueness, limit });
                counts[1] += 1;
            }
            (Choice::Epipolar { reason }, Err(_)) => {
                assert!(!camera.is_orthographic() && !reason.to_string().is_empty());
                counts[2] += 1;
            }
            (Choice::March { .. }, Err(_)) => {
                assert!(camera.is_orthographic());
                counts[3] += 1;
            }
            (choice, rows) => panic!("camera {index}: {choice:?} of {rows:?}"),
        }
    }
    println!("{counts:?} projective, too oblique, epipolar for other reasons, marched for other reasons");
    assert!(counts[0] > 300 && counts[1] > 10 && counts[2] > 100);
}
