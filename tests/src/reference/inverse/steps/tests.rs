// SPDX-License-Identifier: MIT OR Apache-2.0
//! Straight rays against their chords, bent ones against curves in closed form.

use super::super::tests::{sheared_box, unit_box, view};
use super::*;
use crate::reference::camera::{Camera, OrthographicView};

fn ray(origin: [f64; 3], towards: [f64; 3]) -> Ray {
    let origin = Vec3::from(origin);
    Ray { origin, direction: (Vec3::from(towards) - origin).normalised(), depth: f64::INFINITY }
}

#[test]
fn slices_lie_across_the_axis_that_passes_most_voxels() {
    let eye = Vec3::new(4.0, 0.5, 0.5);
    let (target, up) = (Vec3::new(0.5, 2.5, 1.0), Vec3::new(0.0, 1.0, 0.0));
    let view =
        OrthographicView { eye, target, up, half_height: 1.0, aspect: 1.0, depth: 9.0, reversed: true };
    let view = View::new(&Camera::orthographic(&view), [2, 2]);
    let axis = |size| Slices::of_view(&unit_box(), &view, size, 5).axis;
    assert_eq!([axis([4, 4, 4]), axis([4, 8, 4]), axis([4, 4, 40]), axis([7, 12, 1])], [0, 1, 2, 0]);
}

#[test]
fn parts_are_a_chord_from_front_to_back() {
    let volume = sheared_box();
    let whole = [Vec3::default(), Vec3::new(1.0, 1.0, 1.0)];
    let mut met = 0;
    for (x, y, depth) in (0..30).flat_map(|i| [(i % 6, i / 6, f64::INFINITY), (i % 6, i / 6, 5.1)]) {
        for axis in 0..3 {
            let slices = Slices { axis, count: 7 };
            let ray = Ray { depth, ..view().ray(x, y) };
            let samples = straight(&volume, &slices, &ray);
            let Some([begin, end]) = volume.clip(&ray, whole) else {
                assert!(samples.is_empty());
                continue;
            };
            let mut at = begin;
            for sample in &samples {
                let middle = volume.unit(ray.origin + ray.direction * (at + 0.5 * sample.length)).to_array();
                let plane = ((middle[axis] * 7.0).floor() + 0.5) / 7.0;
                let unit = sample.unit.to_array();
                for other in 0..3 {
                    let expected = if other == axis { plane } else { middle[other] };
                    assert!((unit[other] - expected).abs() < 1e-12, "{unit:?} for {middle:?}");
                }
                at += sample.length;
            }
            assert!((at - end).abs() < 1e-12 && samples.len() <= slices.count);
            let slice = |sample: &Sample| (sample.unit.to_array()[axis] * 7.0).floor();
            assert!(samples.windows(2).all(|pair| (slice(&pair[0]) - slice(&pair[1])).abs() == 1.0));
            met += 1;
        }
    }
    assert!(met > 90, "{met}");
}

#[test]
fn whole_parts_are_in_the_middle_of_their_slices_both_ways() {
    let volume = unit_box();
    let slices = Slices { axis: 2, count: 4 };
    let forth = straight(&volume, &slices, &ray([0.3, 0.4, -1.0], [0.6, 0.5, 2.0]));
    let back = straight(&volume, &slices, &ray([0.6, 0.5, 2.0], [0.3, 0.4, -1.0]));
    let length = Vec3::new(0.1, 0.1 / 3.0, 1.0).length() / 4.0;
    assert_eq!([forth.len(), back.len()], [4, 4]);
    for (slice, (sample, other)) in forth.iter().zip(back.iter().rev()).enumerate() {
        assert!((sample.unit.z - (slice as f64 + 0.5) / 4.0).abs() < 1e-14);
        assert!((sample.length - length).abs() < 1e-14);
        assert!((sample.unit - other.unit).length() < 1e-14 && (sample.length - other.length).abs() < 1e-14);
    }
}

#[test]
fn a_ray_along_the_slices_has_one_part() {
    let slices = Slices { axis: 1, count: 4 };
    for (y, parts) in [(0.6, 1), (0.5, 1), (0.0, 1), (1.0, 1), (1.1, 0)] {
        let samples = straight(&unit_box(), &slices, &ray([-2.0, y, 0.5], [2.0, y, 0.5]));
        assert_eq!(samples.len(), parts, "{y}");
        assert!(samples.iter().all(|sample| (sample.length - 1.0).abs() < 1e-14));
    }
}

#[test]
fn an_even_index_bends_nothing() {
    let volume = sheared_box();
    let whole = [Vec3::default(), Vec3::new(1.0, 1.0, 1.0)];
    let index = Grid::constant([3, 3, 3], 1.7);
    for depth in [f64::INFINITY, 5.03] {
        let ray = Ray { depth, ..view().ray(2, 2) };
        let [begin, end] = volume.clip(&ray, whole).expect("through the box");
        let samples = bent(&volume, &index, 0.1, &ray);
        let mut at = begin;
        for (i, sample) in samples.iter().enumerate() {
            let middle = volume.unit(ray.origin + ray.direction * (at + 0.5 * sample.length));
            assert!((middle - sample.unit).length() < 1e-12);
            let last = i + 1 == samples.len();
            assert!(if last { sample.length <= 0.1 } else { sample.length == 0.1 });
            at += sample.length;
        }
        assert!((at - end).abs() < 1e-12);
    }
    assert!(bent(&volume, &index, 0.1, &ray([0.0, 9.0, 0.0], [1.0, 9.0, 0.0])).is_empty());
}

/// The greatest of errors of steps of 0.02 to 0.0025 metres, each divided by the step.
fn errors_per_step(error: impl Fn(f64) -> f64) -> [f64; 4] {
    [0.02, 0.01, 0.005, 0.0025].map(|step| error(step) / step)
}

fn assert_first_order(ratios: [f64; 4]) {
    assert!(ratios[0] > 1e-3, "{ratios:?}");
    assert!(ratios.windows(2).all(|pair| (pair[1] / pair[0] - 1.0).abs() < 0.1), "{ratios:?}");
}

#[test]
fn a_square_of_the_index_that_rises_evenly_makes_parabolas() {
    let volume = unit_box();
    // n^2 = 1 + 2 y, in steps so fine that straight lines between them are as good.
    let index = Grid::from_fn([1, 4000, 1], |p| (1.0 + 2.0 * p.y).sqrt());
    let ray = ray([-1.0, 1.1, 0.5], [0.0, 0.5, 0.5]);
    let n = 2.0_f64.sqrt();
    let (along, up) = (n * ray.direction.x, n * ray.direction.y);
    // x = along s', y = 0.5 + up s' + s'^2 / 2, of which the ray leaves the box at x = 1.
    let height = |x: f64| 0.5 + up * x / along + 0.5 * (x / along).powi(2);
    let error = |step: f64| {
        let samples = bent(&volume, &index, step, &ray);
        let last = samples.last().expect("samples");
        assert!((last.unit.x - 1.0).abs() < step && samples.len() as f64 * step > 1.0);
        samples.iter().map(|sample| (sample.unit.y - height(sample.unit.x)).abs()).fold(0.0, f64::max)
    };
    assert_first_order(errors_per_step(error));
    // Its length, as the sum of many chords.
    let point = |i: u32| Vec3::new(f64::from(i) / 1e4, height(f64::from(i) / 1e4), 0.0);
    let length: f64 = (0..10_000).map(|i| (point(i + 1) - point(i)).length()).sum();
    let walked = |step: f64| bent(&volume, &index, step, &ray).iter().map(|s| s.length).sum::<f64>();
    assert!((walked(0.0025) - length).abs() < 2e-3 && (length - 1.0) > 0.01);
}

#[test]
fn an_index_that_rises_evenly_makes_catenaries_in_any_box() {
    let volume = sheared_box();
    let index = Grid::from_fn([1, 8, 1], |p| 1.1 + 0.9 * p.y);
    let gradient = volume.world_gradient(Vec3::new(0.0, 0.9, 0.0));
    let (slope, up) = (gradient.length(), gradient.normalised());
    let entry = volume.world(Vec3::new(0.0, 0.55, 0.4));
    let direction = volume.world(Vec3::new(1.0, 0.3, 0.7)) - entry;
    let direction = direction.normalised();
    let ray = Ray { origin: entry - direction * 2.0, direction, depth: f64::INFINITY };
    let across = direction.without(up).normalised();
    // The index times the cosine is kept: index = kept cosh(slope (x - lowest) / kept).
    let begin = 1.1 + 0.9 * 0.55;
    let kept = begin * direction.dot(across);
    let lowest = -kept / slope * (direction.dot(up) / direction.dot(across)).asinh();
    let height = |x: f64| (kept * (slope * (x - lowest) / kept).cosh() - begin) / slope;
    let error = |step: f64| {
        let samples = bent(&volume, &index, step, &ray);
        assert!(
            samples.len() as f64 * step > 1.5 && samples.iter().all(|s| s.unit.y > 0.1 && s.unit.y < 0.9)
        );
        let away = |sample: &Sample| {
            let way = volume.world(sample.unit) - entry;
            (way.dot(up) - height(way.dot(across))).abs().max(way.dot(up.cross(across)).abs())
        };
        samples.iter().map(away).fold(0.0, f64::max)
    };
    assert_first_order(errors_per_step(error));
}

#[test]
fn the_first_turn_is_by_the_gradient_where_the_step_began() {
    let volume = unit_box();
    let index = Grid::from_fn([1, 8, 1], |p| 1.2 + p.y * p.y);
    let ray = ray([-1.0, 0.3, 0.5], [0.0, 0.4, 0.5]);
    let step = 0.1;
    // Between values the index is straight.
    let between = |y: f64| {
        let low = (y * 8.0 - 0.5).floor();
        let value = |i: f64| 1.2 + ((i + 0.5) / 8.0).powi(2);
        value(low) + (value(low + 1.0) - value(low)) * (y * 8.0 - 0.5 - low)
    };
    let slope = (between(0.4 + 1.0 / 16.0) - between(0.4 - 1.0 / 16.0)) * 8.0;
    let turned = ray.direction * between(0.4) + Vec3::new(0.0, slope * step, 0.0);
    let second = Vec3::new(0.0, 0.4, 0.5) + ray.direction * step + turned.normalised() * (0.5 * step);
    let samples = bent(&volume, &index, step, &ray);
    assert!((samples[1].unit - second).length() < 1e-14, "{:?} {second:?}", samples[1]);
    assert!(samples.len() > 8 && samples[0].length == step && samples[1].length == step);
}

#[test]
fn a_ray_that_goes_round_ends() {
    // A ray around the middle of n = 1 / r keeps its distance; sooner or later its steps are all spent.
    let volume = unit_box();
    let index = Grid::from_fn([64, 64, 1], |p| 0.2 / Vec3::new(p.x - 0.5, p.y - 0.5, 0.0).length().max(0.05));
    let round =
        Ray { origin: Vec3::new(0.7, 0.5, 0.5), direction: Vec3::new(0.0, 1.0, 0.0), depth: f64::INFINITY };
    let samples = bent(&volume, &index, 0.001, &round);
    assert_eq!(samples.len(), (4.0 * 3.0_f64.sqrt() / 0.001).ceil() as usize);
    // Its way round the middle, once about and back to its side.
    assert!(samples.iter().take(1300).all(|s| {
        let away = Vec3::new(s.unit.x - 0.5, s.unit.y - 0.5, 0.0).length();
        (away - 0.2).abs() < 0.02
    }));
    assert!(samples[628].unit.x < 0.35);
}
