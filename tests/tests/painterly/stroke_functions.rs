// SPDX-License-Identifier: MIT OR Apache-2.0
//! The functions that strokes are made of: rates, orientations, probabilities, quads.

use crate::gpu::{Probe, Random, host_matrix};
use airlight_tests::linear::Vec3;
use airlight_tests::reference::camera::{Camera, OrthographicView, View};
use airlight_tests::reference::painterly::strokes::{Quad, half_turn, left_after};
use std::f64::consts::{FRAC_PI_2, PI};

#[test]
fn rates_are_the_same_at_any_frame_rate() {
    let probe = Probe {
        head: "#import airlight::painterly::stroke_update::rate_of_step",
        body: "output(0u, rate_of_step(input(0u), input(1u)));",
        inputs: 2,
        outputs: 1,
    };
    let share = |rate: f64, seconds: f64| f64::from(probe.run(&[rate as f32, seconds as f32])[0]);
    // Half-lives and the frames to nine tenths of the printed rates.
    for (rate, half, tenth) in [(0.05, 13.5, 45.0), (1.0 / 3.0, 1.7, 5.7), (0.9, 0.3, 1.0), (0.1, 6.6, 22.0)]
    {
        assert!((share(rate, 1.0 / 60.0) - rate).abs() < 1e-6, "{rate}");
        assert!((share(rate, half / 60.0) - 0.5).abs() < 0.02, "{rate}");
        assert!((share(rate, tenth / 60.0) - 0.9).abs() < 0.01, "{rate}");
        for frames in [1_u32, 2, 4, 10, 60] {
            let left = 1.0 - share(rate, f64::from(frames) / 60.0);
            assert!((left - left_after(rate, frames)).abs() < 1e-5, "{rate} {frames}");
            // Twice as many frames of half the time.
            let halves = (1.0 - share(rate, 0.5 / 60.0)).powi(2 * frames as i32);
            assert!((halves - left_after(rate, frames)).abs() < 1e-5, "{rate} {frames}");
        }
    }
    for (rate, seconds, expected) in [
        (0.0, 0.1, 0.0),
        (1.0, 0.1, 1.0),
        (1.0, 0.0, 0.0),
        (0.3, 0.0, 0.0),
        (2.0, 0.1, 1.0),
        (0.5, 3600.0, 1.0),
    ] {
        assert_eq!(share(rate, seconds), expected, "{rate} {seconds}");
    }
}

#[test]
fn orientations_turn_the_shorter_way_modulo_half_a_turn() {
    let probe = Probe {
        head: "#import airlight::painterly::stroke_update::{wrapped_orientation, approached_orientation}",
        body: "output(0u, wrapped_orientation(input(0u)));
               output(1u, approached_orientation(input(0u), input(1u), input(2u)));",
        inputs: 3,
        outputs: 2,
    };
    let mut random = Random(12);
    let records: Vec<f32> = (0..3000)
        .flat_map(|_| [random.between(-9.0, 9.0), random.between(-1.57, 1.57), random.unit()])
        .map(|x| x as f32)
        .collect();
    let apart = |a: f64, b: f64| half_turn(a - b).abs();
    for (record, found) in records.chunks_exact(3).zip(probe.run(&records).chunks_exact(2)) {
        let [old, goal, rate] = [0, 1, 2].map(|k| f64::from(record[k]));
        let [wrapped, new] = [0, 1].map(|k| f64::from(found[k]));
        assert!(apart(wrapped, old) < 3e-6 && wrapped.abs() < FRAC_PI_2 + 1e-6, "{old}: {wrapped}");
        assert!(new.abs() < FRAC_PI_2 + 1e-6);
        let way = half_turn(goal - old);
        // A quarter of a turn either way is as short.
        if way.abs() < FRAC_PI_2 - 1e-4 {
            assert!(apart(new, old + rate * way) < 5e-6, "{old} to {goal} by {rate}: {new}");
            assert!(apart(new, goal) <= (1.0 - rate) * way.abs() + 5e-6);
        }
    }
}

#[test]
fn births_fill_gaps_and_deletions_reach_the_maximum() {
    let probe = Probe {
        head: "#import airlight::painterly::stroke_density::{
                   density_of_stroke, birth_probability, deletion_probability
               }",
        body: "output(0u, birth_probability(input(0u), input(1u), 0.01, input(2u), input(3u), input(4u)));
               output(1u, deletion_probability(input(0u), input(1u)));
               output(2u, density_of_stroke(0.01, input(0u), input(1u), input(2u), 0.5));",
        inputs: 5,
        outputs: 3,
    };
    let mut random = Random(3);
    let mut records: Vec<f32> = Vec::new();
    for _ in 0..1000 {
        let area = random.magnitude(0.5, 5000.0);
        let numbers = [
            random.between(0.0, 0.3),
            random.between(0.01, 0.2),
            random.between(0.1, 1.0),
            area,
            random.unit(),
        ];
        records.extend(numbers.map(|x| x as f32));
    }
    // No opacity, no area, no density.
    records.extend([0.0, 0.1, 0.0, 10.0, 0.4, 0.0, 0.1, 1.0, 0.0, 0.4, 0.0, 0.0, 1.0, 1.0, 0.4]);
    for (record, found) in records.chunks_exact(5).zip(probe.run(&records).chunks_exact(3)) {
        let [density, bound, opacity, area, most] = [0, 1, 2, 3, 4].map(|k| f64::from(record[k]));
        let gap = (bound - density).max(0.0);
        let filled = if gap == 0.0 { 0.0 } else { (gap / (0.01 * opacity * area)).min(most) };
        assert!((f64::from(found[0]) - filled.min(1.0)).abs() < 1e-5, "{record:?}: {found:?}");
        // Those that are left have the density of the bound, in the mean.
        let left = density * (1.0 - f64::from(found[1]));
        assert!((left - density.min(bound)).abs() < 1e-6, "{record:?}: {found:?}");
        let counted = 0.01 * (density + (bound - density) * opacity) * 0.5;
        assert!((f64::from(found[2]) - counted).abs() < 1e-8, "{record:?}: {found:?}");
    }
}

#[test]
fn quads_have_their_place_size_and_orientation() {
    let probe = Probe {
        head: "#import airlight::painterly::stroke::Stroke
               #import airlight::painterly::stroke_expand::{
                   quad_corner, corner_position, clip_from_picture, brush_coordinates, brush_layer, tint_factor,
                   varied_size
               }",
        body: "let hash = u32(input(6u)) << 30u;
               let stroke = Stroke(
                   vec3<f32>(0.0), hash, vec3<f32>(0.0), 1.0, vec2<f32>(input(1u), input(2u)), input(3u), input(4u),
                   input(5u), 0u, 1u, 0u
               );
               let corner = quad_corner(u32(input(0u)));
               let place = corner_position(stroke, corner, vec2<f32>(200.0, 100.0));
               let clip = clip_from_picture(place, vec2<f32>(200.0, 100.0));
               let coordinates = brush_coordinates(corner, hash);
               output(0u, f32(corner));
               output(1u, (clip.x + 1.0) * 100.0); output(2u, (1.0 - clip.y) * 50.0);
               output(3u, coordinates.x); output(4u, coordinates.y);
               output(5u, f32(brush_layer(input(7u), u32(input(6u)) + 8u, 3u)));
               output(6u, tint_factor(hash + 5u, 0.0)); output(7u, varied_size(20.0, hash + 77u, 0.25));",
        inputs: 8,
        outputs: 8,
    };
    let mut random = Random(8);
    let mut records: Vec<f32> = Vec::new();
    for index in 0..600 {
        let numbers = [
            random.unit(),
            random.unit(),
            random.between(1.0, 90.0),
            random.between(0.1, 2.0),
            random.between(-1.6, 1.6),
        ];
        records.push((index % 6) as f32);
        records.extend(numbers.map(|x| x as f32));
        records.extend([(index / 6 % 4) as f32, (index % 5) as f32 - 1.0]);
    }
    let mut mirrored = [false; 4];
    for (record, found) in records.chunks_exact(8).zip(probe.run(&records).chunks_exact(8)) {
        let number = |k: usize| f64::from(record[k]);
        let quad = Quad {
            middle: [200.0 * number(1), 100.0 * number(2)],
            length: number(3),
            width: number(3) * number(4),
            orientation: number(5),
        };
        let corner = [0, 1, 2, 2, 1, 3][record[0] as usize];
        assert_eq!(found[0], corner as f32);
        let at = quad.coordinates([f64::from(found[1]), f64::from(found[2])]);
        let expected = [f64::from(corner & 1), f64::from(corner >> 1)];
        assert!(
            (at[0] - expected[0]).abs() < 1e-3 && (at[1] - expected[1]).abs() < 2e-3,
            "{record:?}: {at:?}"
        );
        let flips = record[6] as u32;
        let flip = |bit: u32, of: f64| if flips >> bit & 1 == 1 { 1.0 - of } else { of };
        assert_eq!([found[3], found[4]].map(f64::from), [flip(0, expected[0]), flip(1, expected[1])]);
        mirrored[flips as usize] = true;
        // Any brush for -1, else the one asked for, as far as there are.
        let brush = if record[7] < 0.0 { (record[6] as u32 + 8) % 3 } else { (record[7] as u32).min(2) };
        assert_eq!(found[5], brush as f32);
        assert_eq!(found[6], 1.0);
        assert!((15.0..=25.0).contains(&found[7]));
    }
    assert_eq!(mirrored, [true; 4]);
}

#[test]
fn strokes_lie_at_right_angles_to_the_gradient_in_the_picture() {
    let mut random = Random(21);
    let [eye, target, up] = [[1.5, 1.0, 4.0], [0.2, 0.1, 0.0], [0.0, 1.0, 0.0]].map(Vec3::from);
    let aspect = 1.6;
    let view = View { eye, target, up, fov_y: 0.9, aspect, near: 0.1, far: 40.0, reversed: true };
    let flat = OrthographicView { eye, target, up, half_height: 1.5, aspect, depth: 20.0, reversed: false };
    for camera in [Camera::perspective(&view), Camera::orthographic(&flat)] {
        let matrix = host_matrix(camera.clip_from_world).to_cols_array();
        let columns: Vec<String> = matrix
            .chunks(4)
            .map(|c| format!("vec4<f32>({:?}, {:?}, {:?}, {:?})", c[0], c[1], c[2], c[3]))
            .collect();
        let body = format!(
            "let matrix = mat4x4<f32>({});
             let camera = Camera(matrix, matrix, vec3<f32>(0.0), 0.0, vec2<f32>(1.0), 1.0, 0u);
             let world = vec3<f32>(input(0u), input(1u), input(2u));
             let normal = vec3<f32>(input(3u), input(4u), input(5u));
             let ray = Ray(vec3<f32>(0.0), vec3<f32>(input(6u), input(7u), input(8u)));
             let turn = vec2<f32>(cos(2.0 * input(9u)), sin(2.0 * input(9u)));
             let bare = SurfaceTexel(vec3<f32>(0.0), 1.0, normal, 1.0, vec2<f32>(0.0));
             let curved = SurfaceTexel(vec3<f32>(0.0), 1.0, normal, 1.0, turn);
             var style: StrokeStyle;
             let size = vec2<f32>(1600.0, 1000.0);
             output(0u, surface_orientation(camera, world, ray, bare, style, size, 0.3));
             style.angle = 0.5;
             output(1u, surface_orientation(camera, world, ray, bare, style, size, 0.3));
             style.orientation = ALONG_CURVATURE;
             output(2u, surface_orientation(camera, world, ray, curved, style, size, 0.3));
             output(3u, surface_orientation(camera, world, ray, bare, style, size, 0.3));
             style.orientation = FIXED_ANGLE;
             output(4u, surface_orientation(camera, world, ray, curved, style, size, 0.3));
             let facing = SurfaceTexel(vec3<f32>(0.0), 1.0, -ray.direction, 1.0, vec2<f32>(0.0));
             style.orientation = ALONG_SURFACE;
             output(5u, surface_orientation(camera, world, ray, facing, style, size, 0.3));",
            columns.join(", ")
        );
        let probe = Probe {
            head: "#import airlight::core::camera::{Camera, Ray}
                   #import airlight::painterly::stroke::{StrokeStyle, ALONG_SURFACE, ALONG_CURVATURE, FIXED_ANGLE}
                   #import airlight::painterly::stroke_update::{SurfaceTexel, surface_orientation}",
            body: &body,
            inputs: 10,
            outputs: 6,
        };
        let (mut records, mut expected) = (Vec::new(), Vec::new());
        while expected.len() < 500 {
            let world = Vec3::from([0; 3].map(|_| random.between(-0.8, 0.8)));
            let normal = random.direction();
            let at = |p: Vec3| camera.project(p).map(|[x, y, _]| [800.0 * x, -500.0 * y]).unwrap();
            let ndc = camera.project(world).map(|[x, y, _]| [x, y]).unwrap();
            let ray = camera.ray(ndc);
            if normal.cross(ray).length() < 0.1 {
                continue;
            }
            let (ahead, behind) = (at(world + normal * 1e-5), at(world - normal * 1e-5));
            let gradient = (ahead[1] - behind[1]).atan2(ahead[0] - behind[0]);
            let turn = random.between(-1.5, 1.5);
            expected.push((gradient + 0.5 * PI, turn));
            records.extend(world.to_array().into_iter().chain(normal.to_array()).map(|x| x as f32));
            records.extend(ray.to_array().map(|x| x as f32));
            records.push(turn as f32);
        }
        for (found, (along, turn)) in probe.run(&records).chunks_exact(6).zip(expected) {
            let off = |k: usize, to: f64| half_turn(f64::from(found[k]) - to).abs();
            assert!(off(0, along) < 2e-4, "{found:?} {along}");
            assert!(off(1, along + 0.5) < 2e-4);
            assert!(off(2, turn + 0.5) < 1e-5);
            assert!(off(3, along + 0.5) < 2e-4);
            assert!(off(4, 0.5) < 1e-6);
            // A surface that faces the eye keeps what was.
            assert!(off(5, 0.3) < 1e-6);
        }
    }
}
