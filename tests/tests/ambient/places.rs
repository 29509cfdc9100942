// SPDX-License-Identifier: MIT OR Apache-2.0
//! Functions of what is seen and of sample sets, one by one: places from depths and back, normals of textures, fall-off and elevation, and
//! how evenly the directions of one pixel and of a square of pixels are spread.

use crate::gpu::{Probe, Random, host_camera};
use crate::probing::{MATRIX_AT, f, hold, triple, worst};
use crate::seen::cameras;
use airlight_tests::linear::Vec3;
use airlight_tests::reference::camera::Camera as ReferenceCamera;

/// Reads a camera of 38 numbers and the viewport 40x30.
const CAMERA: &str = "
    #import airlight::core::camera::Camera
    #import airlight::ambient::seen_surface::{seen_surface, seen_place, seen_normal}
    fn camera() -> Camera {
        return Camera(
            matrix_at(0u), matrix_at(16u), vec3<f32>(input(32u), input(33u), input(34u)), input(35u),
            vec2<f32>(40.0, 30.0), input(36u), u32(input(37u))
        );
    }";

fn camera_record(camera: &ReferenceCamera) -> Vec<f32> {
    let host = host_camera(camera, [40, 30]);
    let mut record: Vec<f32> = host.clip_from_world.to_cols_array().to_vec();
    record.extend(host.world_from_clip.to_cols_array());
    record.extend(host.eye.to_array());
    record.extend([host.near_depth, host.far_depth, f32::from(u8::from(camera.is_orthographic()))]);
    record
}

#[test]
fn places_are_where_rays_through_the_middles_of_pixels_meet_them() {
    let probe = Probe {
        head: &format!("{CAMERA}{MATRIX_AT}"),
        body:
            "let pixel = vec2<i32>(i32(input(38u)), i32(input(39u)));
               let seen = seen_surface(camera(), pixel, input(40u));
               output(0u, seen.place.x); output(1u, seen.place.y); output(2u, seen.place.z);
               output(3u, select(0.0, 1.0, seen.known));
               let back = seen_place(camera(), vec3<f32>(input(41u), input(42u), input(43u)));
               output(4u, back.pixel.x); output(5u, back.pixel.y); output(6u, select(0.0, 1.0, back.inside));",
        inputs: 44,
        outputs: 7,
    };
    let mut random = Random(7);
    let (mut records, mut expected) = (Vec::new(), Vec::new());
    for (_, camera) in cameras(Vec3::new(2.0, 3.0, 1.0), Vec3::new(0.2, 0.1, 0.3), 1.2) {
        for _ in 0..60 {
            let (x, y) = (random.below(40), random.below(30));
            let ndc = ReferenceCamera::pixel_ndc(x, y, 40, 30);
            let place = camera.origin(ndc) + camera.ray(ndc) * random.between(1.0, 5.0);
            let depth = camera.project(place).unwrap()[2];
            // Somewhere about the camera, also behind it and beside the picture.
            let other = camera.eye + random.direction() * random.between(0.5, 6.0);
            records.extend(camera_record(&camera));
            records.extend([x as f32, y as f32, depth as f32]);
            records.extend(other.to_array().map(|part| part as f32));
            let there = camera.project(other);
            let inside = there.filter(|ndc| ndc[0].abs() < 1.0 && ndc[1].abs() < 1.0);
            let pixel = inside.map(|ndc| [(0.5 + 0.5 * ndc[0]) * 40.0, (0.5 - 0.5 * ndc[1]) * 30.0]);
            expected.push((place, pixel));
        }
    }
    assert!(expected.iter().filter(|(_, pixel)| pixel.is_some()).count() > 10);
    let found = probe.run(&records);
    let rows = || found.chunks_exact(7).zip(&expected);
    hold("places", rows().map(|(row, wanted)| (triple(row) - wanted.0).length()).fold(0.0, f64::max), 2e-4);
    for (row, (_, pixel)) in rows() {
        assert_eq!(row[3], 1.0);
        assert_eq!(row[6] == 1.0, pixel.is_some(), "{row:?} {pixel:?}");
        let pixel = pixel.unwrap_or([0.0; 2]);
        assert!((f(row[4]) - pixel[0]).hypot(f(row[5]) - pixel[1]) < 1e-3, "{row:?} {pixel:?}");
    }
}

#[test]
fn far_and_broken_depths_are_no_surface() {
    let probe = Probe {
        head: &format!("{CAMERA}{MATRIX_AT}"),
        body: "let seen = seen_surface(camera(), vec2<i32>(3, 4), input(38u));
               output(0u, select(0.0, 1.0, seen.known)); output(1u, length(seen.place));",
        inputs: 39,
        outputs: 2,
    };
    for (name, camera) in cameras(Vec3::new(2.0, 3.0, 1.0), Vec3::default(), 1.2) {
        let far = camera.far_depth as f32;
        let depths = [far, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.5, 1.0 - far];
        let records: Vec<f32> =
            depths.iter().flat_map(|d| [camera_record(&camera), vec![*d]].concat()).collect();
        let found = probe.run(&records);
        let known: Vec<f32> = found.chunks_exact(2).map(|row| row[0]).collect();
        assert_eq!(known, [0.0, 0.0, 0.0, 0.0, 1.0, 1.0], "{name}");
        assert!(found.iter().all(|value| value.is_finite()), "{name}");
    }
}

#[test]
fn normals_are_made_unit_and_replaced_where_there_are_none() {
    let probe = Probe {
        head: "#import airlight::ambient::seen_surface::seen_normal",
        body:
            "let normal = seen_normal(vec3<f32>(input(0u), input(1u), input(2u)), vec3<f32>(0.0, 0.6, 0.8));
               output(0u, normal.x); output(1u, normal.y); output(2u, normal.z);",
        inputs: 3,
        outputs: 3,
    };
    let (inf, nan, other) = (f32::INFINITY, f32::NAN, [0.0, 0.6, 0.8]);
    // A part that is not finite counts as 0.
    let cases = [
        ([0.0, 0.0, 0.0], other),
        ([nan, inf, -inf], other),
        ([1e-9, 0.0, 0.0], other),
        ([3.0, 0.0, -4.0], [0.6, 0.0, -0.8]),
        ([1e-3, 0.0, 0.0], [1.0, 0.0, 0.0]),
        ([nan, -2.0, 0.0], [0.0, -1.0, 0.0]),
        ([0.0, 1e30, 0.0], [0.0, 1.0, 0.0]),
    ];
    let found = probe.run(&cases.map(|case| case.0).concat());
    for (row, (given, wanted)) in found.chunks_exact(3).zip(cases) {
        let wanted = Vec3::from(wanted.map(f));
        assert!((triple(row) - wanted).length() < 1e-5, "{given:?}: {row:?} instead of {wanted:?}");
    }
}

#[test]
fn bent_normals_are_unit_along_the_mean_and_the_normal_where_there_is_none() {
    let probe = Probe {
        head: "#import airlight::ambient::bent_cone::bent_normal",
        body: "let bent = bent_normal(vec3<f32>(input(0u), input(1u), input(2u)), vec3<f32>(0.0, 0.6, 0.8));
               output(0u, bent.x); output(1u, bent.y); output(2u, bent.z);",
        inputs: 3,
        outputs: 3,
    };
    let cases: [([f32; 3], [f32; 3]); 4] = [
        ([0.3, 0.0, 0.4], [0.6, 0.0, 0.8]),
        ([0.0, 0.99, 0.0], [0.0, 1.0, 0.0]),
        ([-0.01, 0.0, 0.0], [-1.0, 0.0, 0.0]),
        ([0.0; 3], [0.0, 0.6, 0.8]),
    ];
    let found = probe.run(&cases.map(|case| case.0).concat());
    for (row, (given, wanted)) in found.chunks_exact(3).zip(cases) {
        assert!((triple(row) - Vec3::from(wanted)).length() < 1e-6, "{given:?}: {row:?}");
    }
}

#[test]
fn occluders_count_less_with_distance_and_by_their_elevation() {
    let probe = Probe {
        head: "#import airlight::ambient::occluders::{occluder_weight, elevation_sine}",
        body: "output(0u, occluder_weight(input(0u), 2.0));
               output(1u, elevation_sine(vec3<f32>(input(0u), input(1u), 0.0), vec3<f32>(0.0, 1.0, 0.0)));",
        inputs: 2,
        outputs: 2,
    };
    let mut random = Random(13);
    let records: Vec<f32> =
        (0..400).flat_map(|_| [3.0 * random.unit() as f32, random.between(-2.0, 2.0) as f32]).collect();
    let found = probe.run(&records);
    let rows = || records.chunks_exact(2).zip(found.chunks_exact(2));
    let weight = |metres: f64| if metres < 2.0 { (1.0 - metres * metres / 4.0).powi(2) } else { 0.0 };
    hold("fall-off", worst(rows().map(|(given, row)| (f(row[0]), weight(f(given[0]))))), 1e-6);
    let sine = |given: &[f32]| f(given[1]).atan2(f(given[0])).sin();
    hold("elevations", worst(rows().map(|(given, row)| (f(row[1]), sine(given)))), 1e-6);
    // A place does not rise over itself.
    assert_eq!(probe.run(&[0.0, 0.0]), [1.0, -1.0]);
}

/// Greatest part of the circle [0, 1) between neighbours.
fn greatest_gap(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let around = values[0] + 1.0 - values[values.len() - 1];
    values.windows(2).map(|pair| pair[1] - pair[0]).fold(around, f64::max)
}

#[test]
fn a_pixel_has_a_direction_in_every_stratum() {
    let probe = Probe {
        head: "#import airlight::ambient::sample_pattern::{sample_shift, sample_place, hemisphere_direction}",
        body: "let shift = sample_shift(vec2<u32>(u32(input(0u)), u32(input(1u))), 8u, u32(input(2u)));
               let place = sample_place(u32(input(3u)), 16u, shift);
               let direction = hemisphere_direction(place);
               output(0u, place.x); output(1u, place.y);
               output(2u, direction.x); output(3u, direction.y); output(4u, direction.z);",
        inputs: 4,
        outputs: 5,
    };
    for (x, y, frame) in [(0.0, 0.0, 0.0), (3.0, 5.0, 0.0), (17.0, 4.0, 0.0), (6.0, 1.0, 9.0)] {
        let records: Vec<f32> = (0..16).flat_map(|index| [x, y, frame, index as f32]).collect();
        let found = probe.run(&records);
        let of = |part: usize| found.chunks_exact(5).map(|row| f(row[part])).collect::<Vec<_>>();
        for part in 0..2 {
            assert!(of(part).iter().all(|value| (0.0..1.0).contains(value)));
            // Sixteen values a sixteenth apart.
            assert!((greatest_gap(of(part)) - 0.0625).abs() < 1e-5, "{:?}", of(part));
        }
        // Of four by four cells of both each has one.
        let mut cells = [0; 16];
        let first = of(1)[0];
        for (high, turn) in of(0).iter().zip(of(1)) {
            let turned = (turn - first + 1.0 + 1e-6).fract();
            cells[(high * 4.0) as usize * 4 + (turned * 4.0) as usize] += 1;
        }
        assert_eq!(cells, [1; 16], "{x} {y} {frame}");
        for row in found.chunks_exact(5) {
            assert!((f(row[4]) - f(row[0])).abs() < 1e-6, "elevations are the first coordinate: {row:?}");
            let turn = f(row[3]).atan2(f(row[2])) / std::f64::consts::TAU;
            assert!(((turn - f(row[1]) + 0.5).rem_euclid(1.0) - 0.5).abs() < 1e-4, "{row:?}");
        }
    }
}

#[test]
fn sets_of_a_square_of_pixels_are_spread() {
    let probe = Probe {
        head: "#import airlight::ambient::sample_pattern::sample_shift",
        body: "let shift = sample_shift(vec2<u32>(u32(input(0u)), u32(input(1u))), u32(input(3u)), u32(input(2u)));
               output(0u, shift.directions.x); output(1u, shift.directions.y); output(2u, shift.steps);",
        inputs: 4,
        outputs: 3,
    };
    let square = |side: usize, frame: f32, corner: usize| {
        let pixels = (0..side * side).flat_map(|pixel| {
            [(pixel % side + corner) as f32, (pixel / side + corner) as f32, frame, side as f32]
        });
        probe.run(&pixels.collect::<Vec<_>>())
    };
    // g^3 = g + 1.
    let plastic = (0..60).fold(1.0_f64, |g, _| (g + 1.0).cbrt());
    let golden = (5.0_f64.sqrt() - 1.0) / 2.0;
    for (side, frame) in [(8, 0.0), (8, 3.0), (4, 0.0), (5, 1.0)] {
        let found = square(side, frame, 0);
        assert_eq!(found, square(side, frame, 3 * side), "the square repeats");
        for (pixel, row) in found.chunks_exact(3).enumerate() {
            // Roberts: the multiples of the inverse plastic number and of its square; frames add one over the golden ratio.
            let frame = f64::from(frame) * golden;
            for (part, power) in [(0, 1), (1, 2)] {
                let wanted = (0.5 + pixel as f64 * plastic.powi(-power) + frame).fract();
                let off = (f(row[part]) - wanted + 0.5).rem_euclid(1.0) - 0.5;
                assert!(off.abs() < 1e-6, "side {side}, pixel {pixel}, {part}: {} {wanted}", row[part]);
            }
        }
        let steps: Vec<f64> = found.chunks_exact(3).map(|row| f(row[2])).collect();
        assert!(steps.iter().all(|step| (0.0..1.0).contains(step)));
        // Even steps would be 1/64 apart, random ones about ln(64)/64; a few are alike.
        let gap = greatest_gap(steps) * (side * side) as f64;
        println!("side {side}, frame {frame}: greatest gap of steps {gap:.2} of even ones");
        assert!(side < 8 || gap < 2.5, "frame {frame}: {gap}");
        // Steps of neighbours differ.
        for pixel in 0..side * side {
            for other in [pixel + 1, pixel + side] {
                if other < side * side && (other == pixel + side || other % side > 0) {
                    let apart = (f(found[3 * pixel + 2]) - f(found[3 * other + 2])).abs();
                    assert!(apart.min(1.0 - apart) > 0.05, "{pixel} {other}: {apart}");
                }
            }
        }
    }
    // One pixel has its set in the middle of its strata; frames move on by one over the golden ratio.
    let moved = golden - 0.5;
    let [still, next] = [square(1, 0.0, 5), square(1, 1.0, 5)].map(|row| [f(row[0]), f(row[1]), f(row[2])]);
    assert!(still == [0.5; 3] && next.iter().all(|part| (part - moved).abs() < 1e-6), "{still:?} {next:?}");
}
