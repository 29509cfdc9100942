// SPDX-License-Identifier: MIT OR Apache-2.0
//! Angles from their cosines, and frames about directions.

use crate::gpu::{Probe, Random};
use crate::probing::{f, hold, triple, worst};
use airlight_tests::linear::Vec3;

#[test]
fn angles_have_their_cosines() {
    let probe = Probe {
        head: "#import airlight::core::arc_cosine::arc_cosine",
        body: "output(0u, arc_cosine(input(0u)));",
        inputs: 1,
        outputs: 1,
    };
    let small = (0..200).map(|i| 10_f32.powf(-7.0 * i as f32 / 200.0));
    let near_the_ends = small.flat_map(|away| [1.0 - away, away - 1.0, away, -away]);
    let cosines: Vec<f32> =
        (-500..=500).map(|i| i as f32 / 500.0).chain(near_the_ends).chain([1.5, -1.5]).collect();
    let found = probe.run(&cosines);
    let pairs =
        cosines.iter().zip(found).map(|(cosine, angle)| (f(angle), f(cosine.clamp(-1.0, 1.0)).acos()));
    // atan2 of software drivers is off by half as much; their acos by 4e-4.
    hold("arc_cosine", worst(pairs), 8e-6);
}

#[test]
fn frames_are_orthonormal_and_right_handed() {
    let probe = Probe {
        head: "#import airlight::core::tangent_frame::tangent_frame",
        body: "let frame = tangent_frame(vec3<f32>(input(0u), input(1u), input(2u)));
               for (var c = 0u; c < 3u; c++) {
                   output(3u * c, frame[c].x); output(3u * c + 1u, frame[c].y); output(3u * c + 2u, frame[c].z);
               }",
        inputs: 3,
        outputs: 9,
    };
    let mut random = Random(11);
    let mut normals: Vec<Vec3> = (0..500).map(|_| random.direction()).collect();
    for sign in [1.0, -1.0] {
        let axes = [
            [sign, 0.0, 0.0],
            [0.0, sign, 0.0],
            [0.0, 0.0, sign],
            [1e-4, 0.0, sign],
            [1.0, 0.0, sign * 1e-7],
        ];
        normals.extend(axes.map(|axis| Vec3::from(axis).normalised()));
    }
    let records: Vec<f32> = normals.iter().flat_map(|n| n.to_array().map(|part| part as f32)).collect();
    for (normal, row) in normals.iter().zip(probe.run(&records).chunks_exact(9)) {
        let [a, b, c] = [0, 3, 6].map(|at| triple(&row[at..]));
        assert!((c - *normal).length() < 1e-6, "{normal:?}: {c:?}");
        let dots = [a.dot(b), a.dot(c), b.dot(c), a.dot(a) - 1.0, b.dot(b) - 1.0, a.cross(b).dot(c) - 1.0];
        assert!(dots.iter().all(|dot| dot.abs() < 2e-6), "{normal:?}: {dots:?}");
    }
}
