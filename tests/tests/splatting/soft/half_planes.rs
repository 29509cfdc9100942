// SPDX-License-Identifier: MIT OR Apache-2.0
//! Penumbras of half-planes, between sheets of their own.

use super::lights::{lamp, sun};
use crate::probing::f;
use crate::soft_light::{Lit, crossings};
use airlight::core::Light;
use airlight::splatting::SoftShadows;
use glam::{DVec3, Vec3};

/// Corners of the box of the half-plane scenes.
pub fn corners() -> Vec<Vec3> {
    let side = |bit: i32, [low, high]: [f32; 2]| if bit & 1 == 1 { high } else { low };
    (0..8)
        .map(|i| Vec3::new(side(i, [-4.0, 4.0]), side(i >> 1, [-8.0, 0.5]), side(i >> 2, [-3.0, 3.0])))
        .collect()
}

/// Half-planes across y: height of each, and the range of x that it covers.
fn half_planes(all: &[(f64, [f64; 2])]) -> impl Fn(DVec3, DVec3) -> Option<[f64; 2]> {
    move |origin, way| {
        let place = |(height, [low, high]): &(f64, [f64; 2])| {
            let place = (height - origin.y) / way.y;
            let x = (origin + way * place).x;
            (x >= *low && x < *high).then_some(place)
        };
        all.iter().filter_map(place).reduce(f64::min).map(|place| [place; 2])
    }
}

/// Of points at a depth below a half-plane at `height`, the place on the light at which its edge at `edge` is seen: slope or metres.
pub fn place_on_light(light: &Light, point: DVec3, height: f64, edge: f64) -> f64 {
    if light.kind == 0 {
        let towards = light.direction.as_dvec3();
        return (point.x - edge) / (height - point.y) + towards.x / towards.y;
    }
    let middle = light.position.as_dvec3();
    let along = (height - point.y) / (middle.y - point.y);
    (point.x + (middle.x - point.x) * along - edge) / along
}

#[test]
fn penumbras_of_half_planes_have_their_width_at_any_tilt() {
    let (side, count) = (160, 64);
    let cases = [
        (sun(Vec3::Y), 10.0_f32),
        (sun(Vec3::new(0.1, 1.0, 0.2)), 10.0),
        (lamp(Vec3::new(0.4, 6.0, 0.0)), 2.4),
    ];
    for (light, size) in cases {
        let width =
            if light.kind == 0 { 2.0 * (f64::from(size).to_radians() / 2.0).tan() } else { f64::from(size) };
        for angle in [0.0_f32, 60.0, 120.0] {
            for axis in [Vec3::X, Vec3::Z] {
                let (sine, cosine) = angle.to_radians().sin_cos();
                let view = axis * sine - Vec3::Y * cosine;
                let lit = Lit::new(light, view, count, &corners(), side, &SoftShadows::new(size));
                let heights = lit.heights(half_planes(&[(0.0, [-1e9, 0.0])]));
                let depths = [1.5, 4.0, 7.0];
                let at = depths.map(|depth| lit.sheet_of(Vec3::new(0.0, -depth as f32, 0.0)));
                for ((depth, sheet), [shares, _]) in depths.iter().zip(at).zip(lit.shadows(&heights, &at)) {
                    let points = lit.points(lit.middle(sheet));
                    let of_depth = points.iter().zip(&shares).filter(|(point, _)| {
                        (-point.y / depth - 1.0).abs() < 0.25 && point.z.abs() < 1.5 && point.x.abs() < 3.0
                    });
                    let profile: Vec<(f64, f64)> = of_depth
                        .map(|(point, share)| (place_on_light(&light, *point, 0.0, 0.0), f(*share)))
                        .collect();
                    let [low, middle, high] = crossings(&profile, width);
                    let found = (high - low) / (0.8 * width);
                    let shift = middle / width;
                    println!(
                        "light {}, eye at {angle} about {axis:?}, {depth} m behind: width {found:.3}, middle off by {shift:.3} of it",
                        light.kind
                    );
                    // An edge of heights lies between texels: up to half of one, as it is seen on the light.
                    let texel = f64::from(lit.plane.light.texel.max_element());
                    let far = light.position.as_dvec3().y;
                    let texel =
                        if light.kind == 0 { texel / depth } else { texel * far * (far + depth) / depth };
                    let most = 0.05 + 0.6 * texel / width;
                    assert!((found - 1.0).abs() < 0.1 && shift.abs() < most, "{angle} {axis} {depth}");
                }
            }
        }
    }
}

#[test]
fn two_half_planes_have_a_penumbra_each() {
    let light = sun(Vec3::Y);
    let width = 2.0 * 5.0_f64.to_radians().tan();
    for angle in [0.0_f32, 60.0] {
        let (sine, cosine) = angle.to_radians().sin_cos();
        let view = Vec3::new(0.0, -cosine, sine);
        let lit = Lit::new(light, view, 64, &corners(), 160, &SoftShadows::new(10.0));
        let heights = lit.heights(half_planes(&[(0.0, [-1e9, -1.0]), (-4.0, [1.0, 1e9])]));
        let sheet = lit.sheet_of(Vec3::new(0.0, -7.0, 0.0));
        let [shares, _] = &lit.shadows(&heights, &[sheet])[0];
        let points = lit.points(lit.middle(sheet));
        for (edge, height) in [(-1.0, 0.0), (1.0, -4.0)] {
            let own = points.iter().zip(shares).filter(|(point, _)| {
                (point.y + 7.0).abs() < 0.7
                    && point.z.abs() < 1.5
                    && point.x * edge > 0.0
                    && point.x.abs() < 2.5
            });
            let profile: Vec<(f64, f64)> =
                own.map(|(point, share)| (place_on_light(&light, *point, height, edge), f(*share))).collect();
            let [low, middle, high] = crossings(&profile, width);
            let found = (high - low).abs() / (0.8 * width);
            println!(
                "eye at {angle}, edge at {height} m: width {found:.3}, middle off by {:.3} of it",
                middle / width
            );
            assert!((found - 1.0).abs() < 0.1 && (middle / width).abs() < 0.05, "{angle} {edge}");
        }
    }
}
