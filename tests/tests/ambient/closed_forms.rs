// SPDX-License-Identifier: MIT OR Apache-2.0
//! Bent normals and cones of surfaces in closed form, by every sampler.

use crate::seen::{SeenImages, cameras, many, seen, sharp};
use airlight::ambient::Sampling;
use airlight_tests::linear::Vec3;

const SIZE: [u32; 2] = [128, 128];
/// Where 8 pixels are to be narrow beside a wall that fills the picture.
const FINE: [u32; 2] = [384, 384];
const ALL: [Sampling; 4] = [Sampling::Hemisphere, Sampling::Disc, Sampling::Horizon, Sampling::Bitmask];

/// Where a ray meets the plane y = 0 from above.
fn floor(origin: Vec3, direction: Vec3) -> Option<f64> {
    let way = -origin.y / direction.y;
    (direction.y < 0.0 && way > 0.0).then_some(way)
}

/// What a pixel has of a sampler: degrees between its bent normal and one that is expected, its length, its openness.
fn found(images: &SeenImages, sampling: Sampling, radius: f32, place: Vec3, expected: Vec3) -> [f64; 3] {
    let (mean, open) = images.bent_at(sharp(sampling), &many(radius), place);
    let cosine = mean.normalised().dot(expected.normalised());
    [cosine.clamp(-1.0, 1.0).acos().to_degrees(), mean.length(), open]
}

/// Half-angles of cones, degrees: Eq. 3.6 and the exact inverse.
fn angles(length: f64) -> [f64; 2] {
    [90.0 * (1.0 - (2.0 * length - 1.0).max(0.0)), (2.0 * length - 1.0).clamp(-1.0, 1.0).acos().to_degrees()]
}

#[test]
fn an_open_plane_has_its_normal_and_the_whole_hemisphere() {
    let surface = |origin, direction| floor(origin, direction).map(|way| (way, Vec3::new(0.0, 1.0, 0.0)));
    for eye in [Vec3::new(0.0, 4.0, 0.1), Vec3::new(1.5, 1.0, 3.0)] {
        for (name, camera) in cameras(eye, Vec3::default(), 1.0) {
            let images = seen(camera, SIZE, &surface);
            for sampling in ALL {
                let place = Vec3::new(0.1, 0.0, 0.05);
                let [bend, length, open] = found(&images, sampling, 0.3, place, Vec3::new(0.0, 1.0, 0.0));
                println!("{name} {sampling:?}: {bend:.3} degrees, length {length:.4}, open {open:.4}");
                assert!(bend < 0.5 && open > 0.999 && (length - 0.5).abs() < 0.01);
                assert!((angles(length)[0] - 90.0).abs() < 1.8, "{:?}", angles(length));
            }
        }
    }
}

#[test]
fn a_wall_hides_half_of_the_hemisphere() {
    // The wall is the plane x = 0, seen from x > 0.
    let surface = |origin: Vec3, direction: Vec3| {
        let wall = -origin.x / direction.x;
        let wall = (direction.x < 0.0 && wall > 0.0).then_some((wall, Vec3::new(1.0, 0.0, 0.0)));
        let floor = floor(origin, direction).map(|way| (way, Vec3::new(0.0, 1.0, 0.0)));
        [wall, floor].into_iter().flatten().min_by(|a, b| a.0.total_cmp(&b.0))
    };
    let place = Vec3::new(0.13, 0.0, 0.0);
    for (name, camera) in cameras(Vec3::new(5.0, 6.0, 0.8), place, 3.5).into_iter().skip(1) {
        let images = seen(camera, FINE, &surface);
        for sampling in [Sampling::Hemisphere, Sampling::Bitmask] {
            let [bend, length, open] = found(&images, sampling, 20.0, place, Vec3::new(1.0, 1.0, 0.0));
            let [printed, exact] = angles(length);
            println!(
                "{name} {sampling:?}: {bend:.2} degrees, length {length:.4}, open {open:.4}, cones {printed:.1} {exact:.1}"
            );
            assert!(bend < 3.0 && (open - 0.5).abs() < 0.03);
            assert!((printed - 52.7).abs() < 3.0 && (exact - 65.5).abs() < 3.0);
        }
    }
}

#[test]
fn a_corner_leaves_an_eighth_of_the_sphere() {
    let surface = |origin: Vec3, direction: Vec3| {
        let axes = [Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.0, 1.0)];
        let met = axes.map(|axis| {
            let way = -origin.dot(axis) / direction.dot(axis);
            (direction.dot(axis) < 0.0 && way > 0.0).then_some((way, axis))
        });
        met.into_iter().flatten().min_by(|a, b| a.0.total_cmp(&b.0))
    };
    let place = Vec3::new(0.13, 0.0, 0.13);
    for (name, camera) in cameras(Vec3::new(5.0, 6.0, 4.4), place, 3.5).into_iter().skip(1) {
        let images = seen(camera, FINE, &surface);
        for sampling in [Sampling::Hemisphere, Sampling::Bitmask] {
            // The mean over an octant is 1/2 along each axis.
            let [bend, length, open] = found(&images, sampling, 20.0, place, Vec3::new(1.0, 1.0, 1.0));
            println!("{name} {sampling:?}: {bend:.2} degrees, length {length:.4}, open {open:.4}");
            assert!(bend < 3.0 && (open - 0.25).abs() < 0.03);
            let expected = angles(0.75_f64.sqrt());
            let both = angles(length);
            assert!((0..2).all(|i| (both[i] - expected[i]).abs() < 3.0), "{both:?} {expected:?}");
        }
    }
}

#[test]
fn the_bottom_of_a_hemispherical_pit_sees_a_cone() {
    // A hemisphere of radius 1 below y = 0; from its bottom the rim is 45 degrees off the vertical.
    let surface = |origin: Vec3, direction: Vec3| {
        let up = Vec3::new(0.0, 1.0, 0.0);
        let flat = floor(origin, direction)?;
        let entry = origin + direction * flat;
        if entry.length() >= 1.0 {
            return Some((flat, up));
        }
        let along = entry.dot(direction);
        let way = -along + (along * along - entry.dot(entry) + 1.0).sqrt();
        Some((flat + way, (entry + direction * way) * -1.0))
    };
    let bottom = Vec3::new(0.0, -1.0, 0.0);
    for (name, camera) in cameras(Vec3::new(0.0, 12.0, 0.1), bottom, 1.5) {
        let images = seen(camera, SIZE, &surface);
        for sampling in [Sampling::Hemisphere, Sampling::Horizon, Sampling::Bitmask] {
            let [bend, length, open] = found(&images, sampling, 30.0, bottom, Vec3::new(0.0, 1.0, 0.0));
            let [printed, exact] = angles(length);
            println!(
                "{name} {sampling:?}: {bend:.2} degrees, length {length:.4}, open {open:.4}, cones {printed:.1} {exact:.1}"
            );
            assert!(bend < 3.0 && (printed - 26.4).abs() < 3.0 && (exact - 45.0).abs() < 3.0);
            assert!((open - (1.0 - 0.5_f64.sqrt())).abs() < 0.03);
        }
    }
}
