// SPDX-License-Identifier: MIT OR Apache-2.0
//! Closed forms of visibility, of light in cones, and of both together.

use super::*;
use crate::linear::Vec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

mod light;
mod shading;
mod visible;

const UP: Vec3 = Vec3::new(0.0, 1.0, 0.0);
const ORIGIN: Vec3 = Vec3::new(0.0, 0.0, 0.0);

/// A parallelogram.
fn sheet(corner: Vec3, first: Vec3, second: Vec3) -> Vec<Triangle> {
    let [a, b, c, d] = [corner, corner + first, corner + first + second, corner + second];
    vec![Triangle::flat([a, b, c]), Triangle::flat([a, c, d])]
}

/// The plane y = `height`, 2000 m wide.
fn plane(height: f64) -> Vec<Triangle> {
    sheet(Vec3::new(-1e3, height, -1e3), Vec3::new(0.0, 0.0, 2e3), Vec3::new(2e3, 0.0, 0.0))
}

/// A wall on the side −x (or −z), a hundredth of a millimetre from the origin.
fn wall(along_x: bool) -> Vec<Triangle> {
    let side = if along_x {
        [Vec3::new(-1e3, -1e3, -1e-5), Vec3::new(2e3, 0.0, 0.0)]
    } else {
        [Vec3::new(-1e-5, -1e3, -1e3), Vec3::new(0.0, 0.0, 2e3)]
    };
    sheet(side[0], side[1], Vec3::new(0.0, 2e3, 0.0))
}

/// The wall of a round pit of depth 1 about the origin whose edge is seen at `angle` from the axis: a cylinder, or a
/// cone that is half as wide at the bottom.
fn pit(angle: f64, bottom: f64) -> Vec<Triangle> {
    const SIDES: u32 = 720;
    let at = |i: u32, radius: f64, y: f64| {
        let azimuth = TAU * f64::from(i) / f64::from(SIDES);
        Vec3::new(radius * azimuth.cos(), y, radius * azimuth.sin())
    };
    let top = angle.tan();
    let side = |i: u32| {
        let [a, b] = [at(i, bottom * top, 0.0), at(i + 1, bottom * top, 0.0)];
        let [c, d] = [at(i + 1, top, 1.0), at(i, top, 1.0)];
        [Triangle::flat([a, b, c]), Triangle::flat([a, c, d])]
    };
    (0..SIDES).flat_map(side).collect()
}

/// A ball.
fn ball(centre: Vec3, radius: f64) -> Vec<Triangle> {
    const ROWS: u32 = 180;
    let at = |x: u32, y: u32| {
        let (azimuth, polar) = (PI * f64::from(x) / f64::from(ROWS), PI * f64::from(y) / f64::from(ROWS));
        let around = polar.sin();
        centre + Vec3::new(around * azimuth.cos(), polar.cos(), around * azimuth.sin()) * radius
    };
    let patch = |x: u32, y: u32| {
        let [a, b, c, d] = [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)];
        [Triangle::flat([a, b, c]), Triangle::flat([a, c, d])]
    };
    (0..ROWS).flat_map(|y| (0..2 * ROWS).flat_map(move |x| patch(x, y))).collect()
}

/// What is seen from the origin of a floor with these occluders on it.
fn seen(occluders: Vec<Triangle>, reach: Reach) -> Statistics {
    let scene = Scene::new([plane(0.0), occluders].concat());
    Statistics::of(UP, &trace(&scene, ORIGIN, UP, &Pattern::new(16384), 0.3, reach))
}

#[track_caller]
fn near(value: f64, expected: f64, tolerance: f64) {
    assert!((value - expected).abs() <= tolerance, "{value} is not {expected} within {tolerance}");
}

/// Degrees between two directions.
fn between(a: Vec3, b: Vec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b)).to_degrees()
}
