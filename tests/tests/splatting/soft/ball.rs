// SPDX-License-Identifier: MIT OR Apache-2.0
//! The shadow of a ball against rays to a square.

use super::lights::{lamp, sun};
use crate::probing::f;
use crate::soft_light::{Lit, vector};
use airlight::splatting::SoftShadows;
use airlight_tests::reference::splatting::area_light::{Square, meets_ball};
use glam::{DVec3, Vec3};

/// Greatest and root mean square difference of a ball's shadow from what rays say; least share of the light.
fn ball(lit: &Lit, square: &Square, depth: f32) -> [f64; 3] {
    let surfaces = |origin: DVec3, way: DVec3| {
        let along = -origin.dot(way);
        let square = 1.0 - (origin.length_squared() - along * along);
        (square > 0.0).then(|| [along - square.sqrt(), along + square.sqrt()])
    };
    let sheet = lit.sheet_of(Vec3::new(0.0, -depth, 0.0));
    let [shares, _] = &lit.shadows(&lit.heights(surfaces), &[sheet])[0];
    let points = lit.points(lit.middle(sheet));
    let (mut most, mut squares, mut least, mut count) = (0.0_f64, 0.0, 1.0_f64, 0.0);
    for (index, (point, share)) in points.iter().zip(shares).enumerate() {
        // A quarter of the texels will do.
        if index % 4 > 0 || point.y > -1.2 || point.x.hypot(point.z) > 2.2 {
            continue;
        }
        let ball = |origin, way, limit| meets_ball(vector(DVec3::ZERO), 1.0, origin, way, limit);
        let error = f(*share) - square.seen(vector(*point), 24, ball);
        most = most.max(error.abs());
        squares += error * error;
        least = least.min(f(*share));
        count += 1.0;
    }
    [most, (squares / count).sqrt(), least]
}

#[test]
fn a_ball_casts_the_shadow_of_a_ball() {
    let far =
        (sun(Vec3::Y), 10.0_f32, Square::Far { towards: vector(DVec3::Y), angle: 10.0_f64.to_radians() });
    let middle = vector(DVec3::Y * 9.0);
    let near = (lamp(Vec3::Y * 9.0), 1.5, Square::Near { middle, facing: vector(DVec3::Y), side: 1.5 });
    let side = |bit: i32, [low, high]: [f32; 2]| if bit & 1 == 1 { high } else { low };
    let corners: Vec<Vec3> = (0..8)
        .map(|i| Vec3::new(side(i, [-2.2, 2.2]), side(i >> 1, [-5.0, 1.1]), side(i >> 2, [-2.2, 2.2])))
        .collect();
    let mut leaks = Vec::new();
    for (light, size, square) in [far, near] {
        for angle in [0.0_f32, 60.0, 120.0] {
            let (sine, cosine) = angle.to_radians().sin_cos();
            let view = Vec3::new(0.0, -cosine, sine);
            for depth in if angle == 120.0 { vec![4.0] } else { vec![2.5, 4.0] } {
                let of = |deepest: f32| {
                    let soft = SoftShadows { deepest, ..SoftShadows::new(size) };
                    ball(&Lit::new(light, view, 64, &corners, 128, &soft), &square, depth)
                };
                let [most, mean, least] = of(1e6);
                let [thin, thin_mean, thin_least] = of(0.0);
                println!(
                    "light {}, eye at {angle}, {depth} m behind: {most:.3} at most, {mean:.4} RMS, umbra {least:.4}; \
                     not filled {thin:.3}, {thin_mean:.4}, {thin_least:.4}",
                    light.kind
                );
                // The greatest differences are those of a Gaussian from a ramp, and of heights from an edge between texels.
                assert!(
                    most < 0.12 && mean < 0.03 && least < 0.005,
                    "{angle} {depth}: {most} {mean} {least}"
                );
                assert!(thin_mean >= mean && thin_least >= least, "{angle} {depth}");
                leaks.push(thin_least);
            }
        }
    }
    // Of the surface alone the umbra is not dark.
    assert!(leaks.iter().any(|leak| *leak > 0.02), "{leaks:?}");
}
