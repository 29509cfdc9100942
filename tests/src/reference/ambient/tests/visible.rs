// SPDX-License-Identifier: MIT OR Apache-2.0
//! Visibility of simple scenes.

use super::*;

/// Occlusion, direction and length in bounds that 16384 directions keep, and what is true of any visibility.
#[track_caller]
fn expect(statistics: &Statistics, open: f64, cosine: f64, direction: Vec3, length: f64) {
    near(statistics.open, open, 1.5e-3);
    near(statistics.open_cosine, cosine, 1.5e-3);
    near(statistics.length, length, 1.5e-3);
    let angle = between(statistics.direction, direction);
    assert!(angle < 0.15, "the bent normal is {angle} degrees off: {:?}", statistics.direction);
    near(statistics.open_cosine, 2.0 * statistics.open * statistics.bent_normal().dot(UP), 1e-12);
    near(statistics.scaled_bent_normal().dot(UP), statistics.open_cosine, 1e-12);
}

#[track_caller]
fn cones(statistics: &Statistics, thesis: f64, exact: f64) {
    near(statistics.angle(Angle::Thesis).to_degrees(), thesis, 0.3);
    near(statistics.angle(Angle::Exact).to_degrees(), exact, 0.3);
}

#[test]
fn an_open_plane_sees_the_hemisphere() {
    let statistics = seen(vec![], Reach::UNLIMITED);
    expect(&statistics, 1.0, 1.0, UP, 0.5);
    assert_eq!(statistics.open, 1.0);
    near(statistics.length, 0.5, 1e-6);
    near(statistics.scaled_bent_normal().length(), 1.0, 1e-6);
    near(statistics.angle(Angle::Thesis).to_degrees(), 90.0, 1e-3);
    // The inverse is steep there: an error of 1e-6 in the length is a tenth of a degree.
    near(statistics.angle(Angle::Exact).to_degrees(), 90.0, 0.15);
}

#[test]
fn a_wall_takes_half_and_bends_by_45_degrees() {
    let statistics = seen(wall(false), Reach::UNLIMITED);
    expect(&statistics, 0.5, 0.5, Vec3::new(1.0, 1.0, 0.0), 0.5_f64.sqrt());
    cones(&statistics, 52.72, 65.53);
}

/// Of an octant every component has the mean 1/2.
#[test]
fn a_corner_leaves_an_octant() {
    let statistics = seen([wall(false), wall(true)].concat(), Reach::UNLIMITED);
    expect(&statistics, 0.25, 0.25, Vec3::new(1.0, 1.0, 1.0), 0.75_f64.sqrt());
    cones(&statistics, 24.12, 42.94);
}

/// The figures of Eq. 3.6 and the exact angle for a sky that is open within an angle.
#[test]
fn pits_of_all_openings() {
    for (degrees, thesis) in
        [(10.0, 1.37), (20.0, 5.43), (30.0, 12.06), (45.0, 26.36), (60.0, 45.0), (75.0, 66.71)]
    {
        let angle = f64::to_radians(degrees);
        for bottom in [1.0, 0.5] {
            let statistics = seen(pit(angle, bottom), Reach::UNLIMITED);
            expect(&statistics, 1.0 - angle.cos(), angle.sin().powi(2), UP, 0.5 * (1.0 + angle.cos()));
            cones(&statistics, thesis, degrees);
        }
    }
}

/// A cap hidden: of half angle s about a direction c its (1/π) ∫ ω dω is sin² s c.
#[test]
fn a_ball_over_a_plane_hides_a_cap() {
    for (tilt, s) in [(0.0_f64, 30.0_f64), (50.0, 25.0), (30.0, 45.0)] {
        let (tilt, s) = (tilt.to_radians(), s.to_radians());
        let centre = Vec3::new(0.6 * tilt.sin(), tilt.cos(), 0.8 * tilt.sin());
        let statistics = seen(ball(centre * 2.0, 2.0 * s.sin()), Reach::UNLIMITED);
        let scaled = UP - centre * s.sin().powi(2);
        let open = s.cos();
        let length = scaled.length() / (2.0 * open);
        expect(&statistics, open, 1.0 - s.sin().powi(2) * tilt.cos(), scaled, length);
    }
}

/// A box without an opening: nothing to divide by.
#[test]
fn where_nothing_is_open_the_normal_stays() {
    let statistics = seen(ball(ORIGIN, 2.0), Reach::UNLIMITED);
    let closed = Statistics { open: 0.0, open_cosine: 0.0, direction: UP, length: 0.0 };
    assert_eq!(statistics, closed);
    assert_eq!([Angle::Thesis, Angle::Exact].map(|kind| statistics.angle(kind)), [0.0; 2]);
    assert_eq!(statistics.scaled_bent_normal(), ORIGIN);
}

/// Under a ceiling at the height h the ray of the cosine c is h / c long: with a step at the distance D the sky opens where
/// c < h / D, and with a fall-off by the integral of 1 − f over c.
#[test]
fn far_occluders_fall_off() {
    let ceiling = plane(0.4);
    let step = seen(ceiling.clone(), Reach { begin: 1.0, end: 1.0 });
    near(step.open, 0.4, 1e-3);
    near(step.open_cosine, 0.16, 1e-3);
    near(step.length, 0.2, 1e-3);
    assert_eq!(seen(ceiling.clone(), Reach { begin: 0.3, end: 0.3 }).open, 1.0);
    // 2000 m of ceiling end before the horizon.
    near(seen(ceiling.clone(), Reach::UNLIMITED).open, 0.0, 1e-3);

    let reach = Reach { begin: 0.6, end: 1.6 };
    let soft = seen(ceiling, reach);
    let steps = 100_000;
    let visibility = |c: f64| {
        let s = ((0.4 / c - 0.6) / 1.0).clamp(0.0, 1.0);
        3.0 * s.powi(2) - 2.0 * s.powi(3)
    };
    let mean = |weight: fn(f64) -> f64| -> f64 {
        let place = |i: i32| (f64::from(i) + 0.5) / f64::from(steps);
        (0..steps).map(|i| weight(place(i)) * visibility(place(i))).sum::<f64>() / f64::from(steps)
    };
    near(soft.open, mean(|_| 1.0), 1e-4);
    near(soft.open_cosine, mean(|c| 2.0 * c), 1e-4);
    assert!(soft.open > 0.3 && soft.open < 0.6, "{}", soft.open);
}

#[test]
fn the_fall_off_falls_from_one_to_zero() {
    let reach = Reach { begin: 1.0, end: 3.0 };
    assert_eq!([0.0, 1.0, 2.0, 3.0, 9.0].map(|r| reach.fall_off(r)), [1.0, 1.0, 0.5, 0.0, 0.0]);
    let values: Vec<f64> = (0..=40).map(|i| reach.fall_off(f64::from(i) * 0.1)).collect();
    assert!(values.windows(2).all(|pair| pair[1] <= pair[0]));
    assert_eq!(Reach::UNLIMITED.fall_off(1e300), 1.0);
}

/// Lengths that rounding or opposite openings bring about have angles too.
#[test]
fn angles_stay_in_the_quarter_circle() {
    for length in [0.0, 0.3, 0.5, 1.0, 1.0 + 1e-12] {
        for angle in [thesis_angle(length), exact_angle(length)] {
            assert!((0.0..=FRAC_PI_2).contains(&angle), "{length}: {angle}");
        }
    }
    assert_eq!([thesis_angle(1.0), exact_angle(1.0)], [0.0; 2]);
    assert_eq!([thesis_angle(0.2), exact_angle(0.2)], [FRAC_PI_2; 2]);
}
