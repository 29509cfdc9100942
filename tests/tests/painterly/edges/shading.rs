// SPDX-License-Identifier: MIT OR Apache-2.0
//! Lighting and occlusion of surfaces.

use crate::gpu::{Probe, Random};
use crate::probing::{self, f, hold, worst};
use crate::surfaces::{SIZE, Setting, parallel_view_of, view_of};
use airlight::core::DepthRange;
use airlight::data::sphere_field;
use airlight_tests::linear;
use glam::Vec3;

#[test]
fn light_is_phong_s() {
    let probe = Probe {
        head: "#import airlight::painterly::iso_surface::{SurfaceLighting, phong}",
        body: "let lighting = SurfaceLighting(
                   vec3<f32>(input(0u), input(1u), input(2u)), 0.7, vec3<f32>(2.0, 1.0, 0.5), 0.4, vec3<f32>(0.1, 0.2, 0.3), input(9u));
               let lit = phong(lighting, vec3<f32>(0.9, 0.5, 0.1), vec3<f32>(input(3u), input(4u), input(5u)),
                   vec3<f32>(input(6u), input(7u), input(8u)));
               output(0u, lit.x); output(1u, lit.y); output(2u, lit.z);",
        inputs: 10,
        outputs: 3,
    };
    let mut random = Random(77);
    let mut records = Vec::new();
    let mut expected = Vec::new();
    for _ in 0..500 {
        let [light, normal, view] = [0; 3].map(|_| random.direction());
        let alpha = random.magnitude(1.0, 60.0).floor();
        // R.V with R the light's direction mirrored at the normal and V towards the eye.
        let mirrored = normal * (2.0 * normal.dot(light)) - light;
        let lobe = if normal.dot(light) > 0.0 { mirrored.dot(-view).max(0.0).powf(alpha) } else { 0.0 };
        let facing = normal.dot(light).max(0.0);
        for ((albedo, radiance), ambient) in
            [0.9, 0.5, 0.1].into_iter().zip([2.0, 1.0, 0.5]).zip([0.1, 0.2, 0.3])
        {
            expected.push(albedo * (ambient + 0.7 * facing * radiance) + 0.4 * lobe * radiance);
        }
        for v in [light, normal, view] {
            records.extend(v.to_array().map(|x| x as f32));
        }
        records.push(alpha as f32);
    }
    let found = probe.run(&records);
    hold("radiance", worst(found.iter().map(|x| f(*x)).zip(expected)), 2e-4);
}

/// A sphere before a plane, a point of each: what is hidden is told from what is seen, by distances that a picture of some
/// pixels may have; and a pixel's side is that of projected points.
#[test]
fn occlusion_is_told_by_distances() {
    let probe = Probe {
        head: "#import airlight::painterly::iso_surface::{distance_tolerance, is_occluded}",
        body: "let tolerance = distance_tolerance(input(0u), input(1u), 1.0, 0.0);
               output(0u, tolerance);
               output(1u, select(0.0, 1.0, is_occluded(input(2u), input(3u), tolerance)));",
        inputs: 4,
        outputs: 2,
    };
    // A plane seen under an angle: a pixel of 1 cm beside, its distance differs by side times tangent.
    let mut records = Vec::new();
    let mut expected = Vec::new();
    for degrees in [0.0_f64, 20.0, 45.0, 70.0, 85.0] {
        let (side, angle) = (0.01, degrees.to_radians());
        let tolerance = side * angle.tan();
        for (found, hidden) in [
            (5.0 + 1.1 * tolerance + 1e-4, 0.0),
            (5.0 - 0.9 * tolerance, 0.0),
            (5.0 - 1.1 * tolerance - 1e-4, 1.0),
            (1.0, 1.0),
            (-1.0, 0.0),
        ] {
            records.extend([side as f32, -angle.cos() as f32, 5.0, found as f32]);
            expected.push((tolerance, hidden));
        }
    }
    for (found, (tolerance, hidden)) in probe.run(&records).chunks_exact(2).zip(expected) {
        assert!((f(found[0]) - tolerance).abs() < 1e-5 + 1e-3 * tolerance, "{found:?} {tolerance}");
        assert_eq!(f(found[1]), hidden, "{tolerance}");
    }
    let volume = sphere_field([8; 3], 0.5);
    for view in [view_of(&volume, Vec3::ONE), parallel_view_of(&volume, Vec3::ONE, DepthRange::Reversed)] {
        let setting = Setting::new(volume.clone(), &view);
        let camera = setting.camera();
        let matrix = setting.frame.camera.clip_from_world.to_cols_array();
        let probe = Probe {
            head: &format!(
                "#import airlight::core::camera::Camera\n#import airlight::painterly::iso_surface::pixel_side{}",
                probing::MATRIX_AT
            ),
            body: "let m = matrix_at(0u);
                   let camera = Camera(m, m, vec3<f32>(0.0), 0.0, vec2<f32>(64.0, 48.0), 1.0, 0u);
                   output(0u, pixel_side(camera, vec3<f32>(input(16u), input(17u), input(18u))));",
            inputs: 19,
            outputs: 1,
        };
        let point = linear::Vec3::new(0.2, -0.1, 0.3);
        let record: Vec<f32> = matrix.into_iter().chain([0.2, -0.1, 0.3]).collect();
        let side = f(probe.run(&record)[0]);
        let above = camera.project(point + camera.up * side).unwrap();
        let pixels = (above[1] - camera.project(point).unwrap()[1]) * f64::from(SIZE[1]) / 2.0;
        hold("a pixel's side", (pixels - 1.0).abs(), 1e-3);
    }
}
