// SPDX-License-Identifier: MIT OR Apache-2.0
//! Functions of bent normals and cones, one by one, against integrals and counts in f64.

use crate::gpu::{Probe, Random};
use crate::probing::{f, hold, triple, worst};
use airlight_tests::linear::Vec3;
use std::f64::consts::FRAC_PI_2;

#[test]
fn cones_have_the_angles_of_their_mean_lengths() {
    let probe = Probe {
        head: "#import airlight::ambient::bent_cone::{cone_angle, cone_angle_exact}",
        body: "output(0u, cone_angle(input(0u))); output(1u, cone_angle_exact(input(0u)));",
        inputs: 1,
        outputs: 2,
    };
    let lengths: Vec<f32> =
        (0..=90).map(|degrees| (0.5 + 0.5 * f64::from(degrees).to_radians().cos()) as f32).collect();
    let found = probe.run(&lengths);
    let rows = || lengths.iter().map(|length| f(*length)).zip(found.chunks_exact(2));
    // Twice what atan2 of software drivers is off by.
    hold("exact angle", worst(rows().map(|(length, row)| (f(row[1]), (2.0 * length - 1.0).acos()))), 8e-6);
    hold("Eq. 3.6", worst(rows().map(|(length, row)| (f(row[0]), FRAC_PI_2 * (2.0 - 2.0 * length)))), 1e-6);
    let outside = probe.run(&[0.0, -1.0, 1e-3, 0.3, 1.0, 1.5]);
    let quarter = FRAC_PI_2 as f32;
    assert_eq!(outside[..4], [0.0; 4]);
    assert!(outside[4..8].iter().all(|angle| (angle - quarter).abs() < 8e-6), "{outside:?}");
    assert_eq!(outside[8..], [0.0; 4]);
}

#[test]
fn outliers_are_visible_to_directions_and_unknown_to_openness() {
    let probe = Probe {
        head: "#import airlight::ambient::bent_cone::{bent_nothing, bent_add, bent_add_all, openness, mean_direction, irradiance_share, scaled_direction}",
        body: "var sum = bent_nothing();
               for (var k = 0u; k < 8u; k++) {
                   let direction = vec3<f32>(input(5u * k), input(5u * k + 1u), input(5u * k + 2u));
                   sum = bent_add(sum, direction, input(5u * k + 3u), input(5u * k + 4u) > 0.5);
               }
               let mean = mean_direction(sum);
               output(0u, openness(sum)); output(1u, mean.x); output(2u, mean.y); output(3u, mean.z);
               output(4u, irradiance_share(mean, openness(sum), vec3<f32>(0.0, 1.0, 0.0)));
               output(5u, scaled_direction(mean, openness(sum)).y);
               sum = bent_add_all(sum, vec3<f32>(0.0, 3.0, 0.0), 4.0, 6.0);
               output(6u, openness(sum)); output(7u, mean_direction(sum).y);",
        inputs: 40,
        outputs: 8,
    };
    let mut random = Random(5);
    let mut records = Vec::new();
    let mut expected = Vec::new();
    for case in 0..200 {
        let (mut sum, mut visible, mut open, mut known) = (Vec3::default(), 0.0, 0.0, 0.0);
        for _ in 0..8 {
            let direction = random.direction();
            let direction = Vec3::new(direction.x, direction.y.abs(), direction.z);
            let visibility = if case == 0 { 0.0 } else { f64::from(random.unit() as f32) };
            let outlier = case != 0 && (case == 1 || random.unit() < 0.3);
            records.extend(direction.to_array().map(|part| part as f32));
            records.extend([visibility as f32, f32::from(u8::from(outlier))]);
            let seen = if outlier { 1.0 } else { visibility };
            sum = sum + direction * seen;
            visible += seen;
            if !outlier {
                open += visibility;
                known += 1.0;
            }
        }
        let mean = if visible > 0.0 { sum * (1.0 / visible) } else { sum };
        let openness = if known > 0.0 { open / known } else { 1.0 };
        let both = [(open + 4.0) / (known + 6.0), (sum.y + 3.0) / (visible + 4.0)];
        let share = 2.0 * openness * mean.y.max(0.0);
        expected.extend([openness, mean.x, mean.y, mean.z, share, openness * mean.y, both[0], both[1]]);
    }
    let found = probe.run(&records);
    hold("sums of directions", worst(found.iter().map(|v| f(*v)).zip(expected)), 2e-6);
}

#[test]
fn slices_above_a_horizon_are_their_integrals() {
    let probe = Probe {
        head: "#import airlight::ambient::occluders::open_slice",
        body: "let slice = open_slice(vec3<f32>(0.0, 1.0, 0.0), vec3<f32>(0.6, 0.0, 0.8), input(0u));
               output(0u, slice.mean.x); output(1u, slice.mean.y); output(2u, slice.mean.z); output(3u, slice.open);",
        inputs: 1,
        outputs: 4,
    };
    let sines: Vec<f32> = (0..=40).map(|i| i as f32 / 40.0).collect();
    let found = probe.run(&sines);
    let pairs = sines.iter().zip(found.chunks_exact(4)).flat_map(|(sine, row)| {
        // Midpoints over elevations; solid angle falls off with their cosine.
        let (horizon, parts) = (f(*sine).asin(), 4000);
        let step = (FRAC_PI_2 - horizon) / f64::from(parts);
        let mut sums = [0.0; 3];
        for part in 0..parts {
            let elevation = horizon + (f64::from(part) + 0.5) * step;
            let (high, across) = elevation.sin_cos();
            let terms = [across * across, high * across, across];
            sums = [0, 1, 2].map(|i| sums[i] + terms[i] * step);
        }
        let expected = [0.6 * sums[0], sums[1], 0.8 * sums[0], sums[2]];
        row.iter().map(|value| f(*value)).zip(expected).collect::<Vec<_>>()
    });
    hold("slices", worst(pairs), 2e-6);
}

#[test]
fn sectors_are_those_whose_middles_are_between() {
    let probe = Probe {
        head: "#import airlight::ambient::occluders::sector_bits",
        body: "let bits = sector_bits(input(0u), input(1u));
               output(0u, f32(bits & 0xffffu)); output(1u, f32(bits >> 16u));",
        inputs: 2,
        outputs: 2,
    };
    let mut random = Random(9);
    let mut records: Vec<f32> = vec![0.0, 1.0, -3.0, 5.0, 0.5, 0.5, 1.2, 2.0, -2.0, -1.0];
    for _ in 0..500 {
        let ends = [random.between(-0.4, 1.4) as f32, random.between(-0.4, 1.4) as f32];
        records.extend([ends[0].min(ends[1]), ends[0].max(ends[1])]);
    }
    for (ends, row) in records.chunks_exact(2).zip(probe.run(&records).chunks_exact(2)) {
        let found = row[0] as u32 | ((row[1] as u32) << 16);
        let middle = |sector: u32| (sector as f32 + 0.5) / 32.0;
        let between = (0..32).filter(|sector| middle(*sector) >= ends[0] && middle(*sector) < ends[1]);
        let expected = between.fold(0, |bits, sector| bits | (1 << sector));
        assert_eq!(found, expected, "{ends:?}: {found:032b} {expected:032b}");
    }
}

#[test]
fn patterns_fill_the_hemisphere_and_frames_move_them() {
    let probe = Probe {
        head: "#import airlight::ambient::sample_pattern::{sample_shift, sample_place, hemisphere_direction}",
        body: "let shift = sample_shift(vec2<u32>(u32(input(0u)), u32(input(1u))), 8u, u32(input(2u)));
               let direction = hemisphere_direction(sample_place(u32(input(3u)), 4u, shift));
               output(0u, direction.x); output(1u, direction.y); output(2u, direction.z); output(3u, shift.steps);",
        inputs: 4,
        outputs: 4,
    };
    let of_frame = |frame: f32| {
        let pixels = (0..64).flat_map(|pixel| (0..4).map(move |index| (pixel, index)));
        let records: Vec<f32> = pixels
            .flat_map(|(pixel, index)| [(pixel % 8) as f32, (pixel / 8) as f32, frame, index as f32])
            .collect();
        probe.run(&records)
    };
    let frames = [0.0, 1.0, 2.0, 1000.0].map(of_frame);
    for (index, found) in frames.iter().enumerate() {
        // The means of a hemisphere: direction (0, 0, 1/2), its squares 1/3 each; steps 1/2.
        let rows = found.chunks_exact(4);
        let mut sums = [0.0; 7];
        for row in rows {
            let [x, y, z] = triple(row).to_array();
            assert!((x * x + y * y + z * z - 1.0).abs() < 1e-5 && z >= 0.0);
            let terms =
                [x, y, z - 0.5, x * x - 1.0 / 3.0, y * y - 1.0 / 3.0, z * z - 1.0 / 3.0, f(row[3]) - 0.5];
            sums = std::array::from_fn(|i| sums[i] + terms[i] / 256.0);
        }
        // Of 256 independent directions the means would be off by 0.036 with 68 % confidence.
        assert!(sums.iter().all(|off| off.abs() < 0.02), "frame {index}: {sums:?}");
    }
    for later in &frames[1..] {
        let moved = frames[0].iter().zip(later).filter(|(a, b)| (*a - *b).abs() > 1e-3).count();
        assert!(moved > 900, "{moved} of 1024 numbers differ from the static pattern");
    }
    assert_eq!(frames[0], of_frame(0.0));
}

#[test]
fn neighbours_count_by_distance_from_the_plane_and_by_normal() {
    let probe = Probe {
        head: "#import airlight::ambient::bent_blur::{BentBlur, edge_weight}
               fn three(k: u32) -> vec3<f32> { return vec3<f32>(input(k), input(k + 1u), input(k + 2u)); }",
        body: "var blur: BentBlur;
               blur.reach = 0.5; blur.least_cosine = 0.6;
               output(0u, edge_weight(blur, three(0u), three(3u), three(6u), three(9u)));",
        inputs: 12,
        outputs: 1,
    };
    let mut random = Random(3);
    let mut records = Vec::new();
    let mut expected = Vec::new();
    for _ in 0..1000 {
        let place = Vec3::from([0; 3].map(|_| f64::from(random.between(-0.6, 0.6) as f32)));
        let normals = [random.direction(), random.direction()];
        // Half of them alike.
        let other =
            if expected.len() % 2 == 0 { (normals[0] * 4.0 + normals[1]).normalised() } else { normals[1] };
        let away = place.dot(normals[0]).abs().max(place.dot(other).abs());
        let alike = 1.0 - (1.0 - normals[0].dot(other)) / 0.4;
        expected.push((1.0 - away / 0.5).clamp(0.0, 1.0) * alike.clamp(0.0, 1.0));
        for vector in [Vec3::default(), normals[0], place, other] {
            records.extend(vector.to_array().map(|part| part as f32));
        }
    }
    assert!(expected.iter().filter(|weight| **weight > 0.2).count() > 100);
    let found = probe.run(&records);
    hold("weights", worst(found.iter().map(|v| f(*v)).zip(expected)), 5e-6);
}
