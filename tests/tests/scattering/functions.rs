// SPDX-License-Identifier: MIT OR Apache-2.0
//! Functions of the modules for lights at a point, evaluated on the GPU and held to f64 within a stated error budget.

use crate::gpu::{Probe, Random};
use crate::probing::hold;
use airlight_tests::linear::Vec3;
use airlight_tests::reference::phase::henyey_greenstein;
use airlight_tests::reference::scattering::Airlight;
use std::f64::consts::PI;

fn worst(errors: impl Iterator<Item = f64>) -> f64 {
    errors.fold(0.0, |a, b| if b <= a { a } else { b })
}

/// A view ray and a light at a point.
#[derive(Clone, Copy, Debug)]
struct Case {
    away: f32,
    theta: f32,
    radius: f32,
    extinction: f32,
    g: f32,
    from: f32,
    to: f32,
}

fn case(random: &mut Random) -> Case {
    let theta = match random.below(4) {
        0 => random.magnitude(1e-5, 1.0),
        1 => PI - random.magnitude(1e-5, 1.0),
        _ => random.between(0.0, PI),
    };
    let away = random.magnitude(0.01, 300.0);
    let to = away * random.magnitude(1e-3, 100.0);
    Case {
        away: away as f32,
        theta: theta as f32,
        radius: (away * random.magnitude(1e-4, 0.1)) as f32,
        extinction: if random.unit() < 0.1 { 0.0 } else { (random.magnitude(1e-4, 10.0) / away) as f32 },
        g: random.between(-0.75, 0.9) as f32,
        from: if random.unit() < 0.5 { 0.0 } else { (to * random.unit()) as f32 },
        to: to as f32,
    }
}

/// The integral by Simpson's rule in `w`, with `t = nearest + h sinh w`: its own f64 form, many times faster than the
/// adaptive quadrature of the reference, to which it is held below.
fn exact(case: &Case) -> f64 {
    let geometry = geometry(case);
    let h = geometry.height().hypot(geometry.radius).max(1e-6 * geometry.distance);
    let w = |t: f64| ((t - geometry.nearest()) / h).asinh();
    let (from, to) = (w(f64::from(case.from)), w(f64::from(case.to)));
    let value = |w: f64| {
        let t = geometry.nearest() + h * w.sinh();
        geometry.integrand(|cosine| henyey_greenstein(cosine, f64::from(case.g)), t) * h * w.cosh()
    };
    const HALVES: usize = 4000;
    let step = (to - from) / (2 * HALVES) as f64;
    let sum: f64 =
        (1..2 * HALVES).map(|i| value(from + i as f64 * step) * if i % 2 == 1 { 4.0 } else { 2.0 }).sum();
    (sum + value(from) + value(to)) * step / 3.0
}

fn geometry(case: &Case) -> Airlight {
    Airlight {
        distance: f64::from(case.away),
        theta: f64::from(case.theta),
        radius: f64::from(case.radius),
        extinction: f64::from(case.extinction),
    }
}

/// What a stretch that is short against the distances loses to the rounding of f32.
fn rounding(case: &Case) -> f64 {
    let scale = f64::from(case.away.max(case.to));
    1e-6 * scale / f64::from(case.to - case.from).max(1e-30)
}

#[test]
fn the_test_s_own_integral_is_that_of_the_reference() {
    let mut random = Random(70);
    for _ in 0..20 {
        let case = Case { theta: random.between(0.2, 2.9) as f32, ..case(&mut random) };
        if case.to - case.from < 0.01 * case.away {
            continue;
        }
        let (from, to) = (f64::from(case.from), f64::from(case.to));
        let g = f64::from(case.g);
        let expected = geometry(&case).quadrature(|cosine| henyey_greenstein(cosine, g), from, to);
        assert!((exact(&case) / expected - 1.0).abs() < 1e-6, "{case:?}: {} {expected}", exact(&case));
    }
}

fn airlight_on_gpu(cases: &[Case]) -> Vec<f32> {
    let probe = Probe {
        head: "#import airlight::scattering::local_light::{local_ray, airlight}",
        body: "let ray = local_ray(input(0u), cos(input(1u)), sin(input(1u)), input(2u));
               output(0u, airlight(ray, input(3u), input(4u), input(5u), input(6u)));",
        inputs: 7,
        outputs: 1,
    };
    let values: Vec<f32> =
        cases.iter().flat_map(|c| [c.away, c.theta, c.radius, c.extinction, c.g, c.from, c.to]).collect();
    probe.run(&values)
}

#[test]
fn airlight_is_the_integral() {
    let mut random = Random(71);
    let cases: Vec<Case> = (0..6000).map(|_| case(&mut random)).collect();
    let found = airlight_on_gpu(&cases);
    let (mut outside, mut inside, mut compared) = (0.0_f64, 0.0_f64, 0);
    let mut mean = 0.0;
    for (case, found) in cases.iter().zip(found) {
        assert!(found.is_finite() && found >= 0.0, "{case:?}: {found}");
        let expected = exact(case);
        // Below half floats of the brightest lights; and f32 rounds the angles of f64 next to the poles.
        if expected < 1e-12 {
            continue;
        }
        compared += 1;
        let error = (f64::from(found) / expected - 1.0).abs() - rounding(case);
        if geometry(case).height() >= 2.0 * f64::from(case.radius) {
            if error > outside {
                println!("{error:.1e}: {case:?}, {found} instead of {expected}");
            }
            outside = outside.max(error);
            mean += error.max(0.0);
        } else {
            inside = inside.max(error);
        }
    }
    println!("{compared} integrals, mean error {:.1e}", mean / f64::from(compared));
    assert!(compared > 4500);
    hold("airlight, passing at twice the radius or farther", outside, 1e-3);
    hold("airlight, nearer", inside, 5e-2);
}

#[test]
fn isotropic_airlight_has_its_closed_form() {
    let mut random = Random(72);
    let cases: Vec<Case> = (0..2000)
        .map(|_| Case { g: 0.0, radius: 0.0, theta: random.between(0.01, 3.1) as f32, ..case(&mut random) })
        .filter(|c| c.extinction > 0.0)
        .collect();
    let error = worst(cases.iter().zip(airlight_on_gpu(&cases)).map(|(case, found)| {
        let expected = geometry(case).isotropic(f64::from(case.from), f64::from(case.to));
        if expected < 1e-12 { 0.0 } else { (f64::from(found) / expected - 1.0).abs() - rounding(case) }
    }));
    hold("airlight, isotropic", error, 1e-3);
}

#[test]
fn airlight_is_finite_at_its_poles() {
    let poles = [0.0, 1e-30, 1e-6, std::f32::consts::FRAC_PI_2, 3.1, std::f32::consts::PI];
    let mut cases = Vec::new();
    for theta in poles {
        for (away, radius, extinction, g) in [
            (1.0, 0.1, 0.1, 0.5),
            (1e-4, 1e-6, 1e6, -0.999),
            (1e6, 1e-6, 1e-6, 0.999),
            (1.0, 0.0, 0.0, 0.0),
            (1e6, 1e3, 1e6, 0.3),
        ] {
            for (from, to) in [(0.0, 0.0), (0.0, 1e-20), (0.0, 1e7), (5.0, 5.0), (5.0, 1.0), (1e7, 1e7)] {
                cases.push(Case { away, theta, radius, extinction, g, from, to });
            }
        }
    }
    for (case, found) in cases.iter().zip(airlight_on_gpu(&cases)) {
        assert!(found.is_finite() && found >= 0.0, "{case:?}: {found}");
        assert!(case.to > case.from || found == 0.0, "{case:?}: {found}");
    }
}

#[test]
fn angles_and_distances_belong_together() {
    let probe = Probe {
        head: "#import airlight::scattering::local_light::{
                   light_angle, distance_from_light_angle, angle_from_light_ray, local_ray, path_through_air,
                   cosine_to_light, equal_angle, along_from_equal_angle
               }",
        body: "let away = input(0u); let theta = input(1u); let along = input(2u);
               let alpha = light_angle(away, cos(theta), sin(theta), along);
               output(0u, alpha);
               output(1u, distance_from_light_angle(away, theta, input(3u), input(5u)));
               output(2u, angle_from_light_ray(away, input(3u), input(4u)));
               let ray = local_ray(away, cos(theta), sin(theta), 0.01);
               output(3u, path_through_air(ray, along));
               output(4u, cosine_to_light(ray, along));
               output(5u, along_from_equal_angle(ray, equal_angle(ray, along)));",
        inputs: 6,
        outputs: 6,
    };
    let mut random = Random(73);
    let records: Vec<[f32; 6]> = (0..4000)
        .map(|_| {
            let away = random.magnitude(0.1, 100.0);
            let theta = random.between(0.05, 3.0);
            let at_light = random.between(0.0, 1.2 * (PI - theta)).min(PI);
            [
                away,
                theta,
                away * random.magnitude(0.01, 10.0),
                at_light,
                away * random.magnitude(0.01, 10.0),
                8.0 * away,
            ]
            .map(|x| x as f32)
        })
        .collect();
    let found = probe.run(records.as_flattened());
    let mut errors = [0.0_f64; 6];
    for (record, found) in records.iter().zip(found.chunks_exact(6)) {
        let [away, theta, along, at_light, tau, limit] = record.map(f64::from);
        let light = Vec3::new(0.0, 0.0, away);
        let view = |t: f64| Vec3::new(t * theta.sin(), 0.0, t * theta.cos());
        let (point, back) = (view(along), Vec3::new(0.0, 0.0, -1.0));
        let from_light = point - light;
        let d = from_light.length();
        let angle = |a: Vec3, b: Vec3| a.cross(b).length().atan2(a.dot(b));
        // The light ray, and where it meets the view ray: by bisection of the angle at the light.
        let ray = Vec3::new(at_light.sin(), 0.0, -at_light.cos());
        let (mut low, mut high) = (0.0, limit);
        for _ in 0..80 {
            let middle = 0.5 * (low + high);
            if angle(view(middle) - light, back) < at_light { low = middle } else { high = middle }
        }
        let on_light_ray = light + ray * tau;
        let expected = [
            angle(from_light, back),
            low,
            on_light_ray.x.atan2(on_light_ray.z),
            along + d,
            -(view(1.0).dot(from_light)) / d,
            along,
        ];
        // Two angles of f32 that all but make a half turn: the distance is as good as what they lack to it.
        let open = (PI - theta - at_light).abs().max(1e-3);
        // WGSL allows atan2 an error of 4096 units in the last place; this adapter has 3e-6.
        let budgets =
            [4e-6, 2e-6 * low / open + 1e-6 * away, 4e-6, 1e-5 * (away + along), 1e-4, 2e-4 * (away + along)];
        for k in 0..6 {
            errors[k] = errors[k].max((f64::from(found[k]) - expected[k]).abs() / budgets[k]);
        }
    }
    println!("{errors:?}");
    for (name, error) in [
        "light_angle",
        "distance_from_light_angle",
        "angle_from_light_ray",
        "path_through_air",
        "cosine_to_light",
        "equal_angle",
    ]
    .iter()
    .zip(errors)
    {
        hold(&format!("{name}, in budgets"), error, 1.0);
    }
}

#[test]
fn cones_are_cut_where_they_are() {
    let probe = Probe {
        head: "#import airlight::scattering::local_light::cone_interval",
        body: "let cut = cone_interval(input(0u), input(1u), input(2u)); output(0u, cut.x); output(1u, cut.y);",
        inputs: 3,
        outputs: 2,
    };
    let mut random = Random(74);
    let records: Vec<[f32; 3]> = (0..3000)
        .map(|_| {
            let axis = random.direction();
            [axis.z as f32, axis.x as f32, random.between(-1.0, 1.0) as f32]
        })
        .collect();
    let found = probe.run(records.as_flattened());
    let (mut empty, mut split) = (0, 0);
    for (record, found) in records.iter().zip(found.chunks_exact(2)) {
        let [along, radial, cosine] = record.map(f64::from);
        const COUNT: usize = 4000;
        let inside: Vec<usize> = (0..=COUNT)
            .filter(|i| {
                let alpha = PI * *i as f64 / COUNT as f64;
                radial * alpha.sin() - along * alpha.cos() >= cosine
            })
            .collect();
        let [low, high] = [found[0], found[1]].map(f64::from);
        let step = PI / COUNT as f64;
        let Some((first, last)) = inside.first().zip(inside.last()) else {
            empty += 1;
            assert!(low >= high || high - low < 2.0 * step, "{record:?}: {found:?}");
            continue;
        };
        split += usize::from(last - first + 1 > inside.len());
        let (first, last) = (*first as f64 * step, *last as f64 * step);
        assert!(
            (0.0..1.01 * step).contains(&(first - low + 1e-6)),
            "{record:?}: {found:?} instead of {first}"
        );
        assert!(
            (0.0..1.01 * step).contains(&(high - last + 1e-6)),
            "{record:?}: {found:?} instead of {last}"
        );
    }
    println!("{empty} missed, {split} in two parts");
    assert!(empty > 300 && split > 100);
}

#[test]
fn greatest_sine_of_a_slice_is_within_two_percent() {
    let probe = Probe {
        head: "#import airlight::scattering::rectify::{Slice, greatest_sine}",
        body: "output(0u, greatest_sine(Slice(input(0u), input(1u), 1.0, 0.5)));",
        inputs: 2,
        outputs: 1,
    };
    let mut random = Random(717);
    let bounds: Vec<[f32; 2]> = (0..2000)
        .map(|_| {
            let ends = [random.between(0.0, PI), random.between(0.0, PI)];
            [ends[0].min(ends[1]) as f32, ends[0].max(ends[1]) as f32]
        })
        .chain([[0.0, PI as f32], [0.0, 1e-3], [PI as f32 - 1e-3, PI as f32], [1.5, 1.6]])
        .collect();
    let found = probe.run(bounds.as_flattened());
    let mut off_right_angles = 0;
    let errors = bounds.iter().zip(&found).map(|(bounds, found)| {
        let [min, max] = bounds.map(f64::from);
        off_right_angles += usize::from(max < 0.5 * PI || min > 0.5 * PI);
        ((0.5 * PI).clamp(min, max).sin() - f64::from(*found)).abs()
    });
    hold("greatest sine of a slice", worst(errors), 0.02);
    assert!(off_right_angles > 500);
}
