// SPDX-License-Identifier: MIT OR Apache-2.0
//! Light that sheets scatter on and back: shares of cones, kernels, energy, the exact sum of all bounces, and that more scattering
//! is more light at every point.
//!
//! `--nocapture` prints what was measured.
#![allow(clippy::unwrap_used)]

#[path = "support/gpu.rs"]
mod gpu;
#[path = "support/light_stack.rs"]
mod light_stack;
#[path = "support/probing.rs"]
mod probing;
#[path = "support/sheets.rs"]
mod sheets;

use airlight::core::{Camera, DepthRange, Light, PerspectiveView};
use airlight::data::cloud;
use airlight::splatting::{
    LightTransport, Scattering, ScatteringSettings, Shading, SheetFrame, SheetInputs, SheetLighting,
    SheetPicture, SheetSettings, SplattingError,
};
use airlight_tests::reference::phase::henyey_greenstein;
use airlight_tests::reference::splatting::adding::{Layer, exact, swept};
use glam::Vec3;
use gpu::{Probe, Random, gpu, shaders};
use light_stack::{LightStack, StackLight};
use probing::{f, hold, worst};
use sheets::{colored, metres, shoot, splats};
use std::f32::consts::{FRAC_PI_2, FRAC_PI_3, FRAC_PI_6};
use std::f64::consts::PI;

/// Integral over a cone, by Simpson's rule over the angle; finer where phase functions peak.
fn over_cone(g: f64, cone: f64, value: impl Fn(f64) -> f64) -> f64 {
    const STEPS: u32 = 20_000;
    let at = |i: u32| {
        let unit = f64::from(i) / f64::from(STEPS);
        let angle = cone * unit * unit;
        2.0 * PI * henyey_greenstein(angle.cos(), g) * angle.sin() * value(angle) * 2.0 * cone * unit
    };
    let weight = |i: u32| match i {
        0 | STEPS => 1.0,
        i if i % 2 == 1 => 4.0,
        _ => 2.0,
    };
    (0..=STEPS).map(|i| weight(i) * at(i)).sum::<f64>() / (3.0 * f64::from(STEPS))
}

const CONES: [f32; 6] = [0.02, FRAC_PI_6, FRAC_PI_3, FRAC_PI_2, 2.4, 3.1415925];
const MEANS: [f32; 9] = [-0.95, -0.6, -0.01, -1e-6, 0.0, 1e-4, 0.3, 0.85, 0.97];

#[test]
fn shares_and_slopes_of_cones_are_integrals() {
    let probe = Probe {
        head: "#import airlight::splatting::light_scattering::{Scattering, cone_share, cone_shares, mean_square_slope}",
        body: "output(0u, cone_share(input(0u), input(1u))); output(1u, mean_square_slope(input(0u), input(1u)));
               let both = cone_shares(Scattering(input(1u), input(1u), 0.0, 0.0), input(0u));
               output(2u, both.x); output(3u, both.y);",
        inputs: 2,
        outputs: 4,
    };
    let all: Vec<[f32; 2]> = MEANS.iter().flat_map(|g| CONES.map(|cone| [*g, cone])).collect();
    let found = probe.run(&all.concat());
    let steepest = 75_f64.to_radians();
    let (mut shares, mut slopes) = (Vec::new(), Vec::new());
    for ([g, cone], found) in all.iter().zip(found.chunks_exact(4)) {
        let share = over_cone(f(*g), f(*cone), |_| 1.0);
        shares.push((f(found[0]) / share, 1.0));
        let slope = over_cone(f(*g), f(*cone), |angle| angle.min(steepest).tan().powi(2)) / share;
        slopes.push((f(found[1]) / slope, 1.0));
        assert_eq!(found[2], found[0]);
        let back = over_cone(-f(*g), f(*cone), |_| 1.0).min(1.0 - share);
        assert!((f(found[3]) - back).abs() < 2e-6 && found[2] + found[3] <= 1.0, "{g} {cone}: {found:?}");
    }
    hold("share of a cone, relative", worst(shares.into_iter()), 2e-5);
    hold("mean squared slope, relative", worst(slopes.into_iter()), 2e-3);
    // Figures of EQUATIONS.md, 9.
    let degrees = |g: f32, cone: f32| probe.run(&[g, cone.to_radians()])[0];
    for (found, expected) in [
        (degrees(0.85, 30.0), 0.762),
        (degrees(-0.85, 30.0), 0.0031),
        (degrees(0.85, 90.0), 0.964),
        (degrees(0.0, 30.0), 0.067),
    ] {
        assert!((found - expected).abs() < 5.1e-4, "{found} for {expected}");
    }
}

#[test]
fn kernels_have_their_sum_and_variance() {
    let probe = Probe {
        head: "#import airlight::splatting::light_scattering::axis_kernel",
        body: "let kernel = axis_kernel(input(0u));
               for (var i = 0u; i < 16u; i++) { output(i, kernel.weights[i >> 2u][i & 3u]); }",
        inputs: 1,
        outputs: 16,
    };
    let mut random = Random(3);
    let mut values = vec![0.0, 1e-6, 0.499_999, 0.5, 0.500_001, 15.999, 16.0, 17.0, 1e30];
    values.extend((0..500).map(|_| random.magnitude(1e-3, 16.0) as f32));
    let found = probe.run(&values);
    let (mut sums, mut variances) = (Vec::new(), Vec::new());
    for (variance, kernel) in values.iter().zip(found.chunks_exact(16)) {
        let (weights, rest) = kernel.split_at(13);
        let moment = |power: i32| -> f64 {
            let sides = weights.iter().enumerate().skip(1);
            2.0 * sides.map(|(i, weight)| (i as f64).powi(power) * f(*weight)).sum::<f64>()
        };
        sums.push((f(weights[0]) + moment(0), 1.0));
        let expected = f(variance.min(16.0));
        variances.push((moment(2) / expected.max(1e-30), if expected > 0.0 { 1.0 } else { 0.0 }));
        let radius = rest[2] as usize;
        assert_eq!([rest[0], rest[1]], [0.0; 2]);
        assert!(radius <= 12 && weights[radius + 1..].iter().all(|weight| *weight == 0.0), "{kernel:?}");
        assert!(weights.windows(2).all(|pair| pair[0] >= pair[1] && pair[1] >= 0.0), "{variance} {kernel:?}");
    }
    hold("sum of weights", worst(sums.into_iter()), 5e-7);
    hold("variance, relative", worst(variances.into_iter()), 5e-6);
}

fn degrees(cone: f32, free_path: f32, back: bool) -> Scattering {
    let forward_cone = cone.to_radians();
    let back_cone = if back { forward_cone } else { 0.0 };
    Scattering { forward_cone, back_cone, free_path, reserved_a: 0.0 }
}

fn sum(light: &[f32]) -> f64 {
    light.chunks_exact(4).map(|texel| f(texel[0])).sum()
}

/// Means around texels of which nothing reaches the edge.
fn within([x, y]: [u32; 2], [width, height]: [u32; 2]) -> bool {
    x >= 12 && y >= 12 && x + 12 < width && y + 12 < height
}

fn lumps(sheet: u32, [x, y]: [u32; 2]) -> f32 {
    let [x, y, z] = [x as f32, y as f32, sheet as f32];
    (0.4 * (1.3 + (0.5 * x).sin() + (0.37 * y + 0.2 * z).cos() - (0.1 * x * y + z).sin())).max(0.0)
}

#[test]
fn light_that_is_only_scattered_on_is_kept() {
    let _turn = gpu::turn();
    let size = [72, 50];
    let even = |_, place| if within(place, size) { 0.7_f32 } else { 0.0 };
    let lumpy = |sheet, place| if within(place, size) { lumps(sheet, place) } else { 0.0 };
    for (name, means) in [("even", &even as &dyn Fn(u32, [u32; 2]) -> f32), ("lumpy", &lumpy)] {
        let mut worst = 0.0_f64;
        for free_path in [0.0, 0.3, 5.0] {
            let stack = LightStack {
                means,
                size,
                texel: 0.1,
                count: 24,
                thickness: 0.2,
                lighting: SheetLighting { g: 0.4, ..SheetLighting::new(2.0) },
                albedo: Vec3::ONE,
                scattering: Some(degrees(180.0, free_path, false)),
                sweeps: 0,
                surfaces: None,
            };
            let light = stack.run();
            let all = 4.0 * f64::from(size[0] * size[1]);
            for down in &light.down {
                worst = worst.max((sum(down) / all - 1.0).abs());
            }
            // It did move.
            let last = light.down.last().unwrap();
            let least = last.chunks_exact(4).map(|texel| texel[0]).fold(9.0, f32::min);
            assert!(least < 3.9, "{name}, {free_path} m: {least}");
        }
        hold(&format!("light lost or gained, {name}"), worst, 5e-3 * 1e-2);
    }
}

#[test]
fn sweeps_come_within_a_percent_of_all_bounces() {
    let _turn = gpu::turn();
    let (tau, albedo, g, cone) = (0.3_f64, 63.0 / 64.0, 0.45_f64, 90.0_f64);
    let shares = [g, -g].map(|g| over_cone(g, cone.to_radians(), |_| 1.0));
    let layers = [Layer::new(tau, albedo, shares); 20];
    let all = exact(&layers);
    let run = |sweeps: u32| {
        // Texels of ten metres: nothing spreads.
        let stack = LightStack {
            // Opacity and colour that half floats hold.
            means: &|_, _| 1.0,
            size: [40, 40],
            texel: 10.0,
            count: 20,
            thickness: 0.1,
            lighting: SheetLighting { g: g as f32, ..SheetLighting::new((tau / 0.1) as f32) },
            albedo: Vec3::splat(albedo as f32),
            scattering: Some(degrees(cone as f32, 0.0, true)),
            sweeps,
            surfaces: None,
        };
        let light = stack.run();
        let middle = 4 * (20 * 40 + 20);
        let shares = [&light.down[19], &light.returned].map(|light| f(light[middle]) / 4.0);
        for channel in [1, 2] {
            let scale = [4.0, 2.0, 1.0][channel];
            assert!((light.down[19][middle + channel] / scale / shares[0] as f32 - 1.0).abs() < 1e-3);
        }
        shares
    };
    for sweeps in [1, 2, 4, 8] {
        let [through, back] = run(sweeps);
        // The picture is one way down more.
        let expected = [swept(&layers, sweeps as usize + 1).through, swept(&layers, sweeps as usize).back];
        println!(
            "{sweeps} sweeps: {through:.4} through and {back:.4} back of {:.4} and {:.4}; in f64 {expected:.4?}",
            all.through, all.back
        );
        hold("through, of as many sweeps", (through / expected[0] - 1.0).abs(), 1e-3);
        hold("back, of as many sweeps", (back / expected[1] - 1.0).abs(), 1.5e-3);
        if sweeps >= 4 {
            hold("through, of all", (through / all.through - 1.0).abs(), 0.01);
            hold("back, of all", (back / all.back - 1.0).abs(), 0.01);
        }
    }
}

#[test]
fn more_scattering_is_more_light_at_every_texel() {
    let _turn = gpu::turn();
    let size = [40, 36];
    let run = |scattering: Option<Scattering>, sweeps| -> StackLight {
        let stack = LightStack {
            means: &|sheet, place| lumps(sheet, place),
            size,
            texel: 0.1,
            count: 16,
            thickness: 0.1,
            lighting: SheetLighting { g: 0.6, ..SheetLighting::new(3.0) },
            albedo: Vec3::new(0.99, 0.9, 0.7),
            scattering,
            sweeps,
            surfaces: None,
        };
        stack.run()
    };
    let none = run(None, 0);
    let forward = run(Some(degrees(60.0, 0.2, false)), 0);
    let once = run(Some(degrees(60.0, 0.2, true)), 1);
    let often = run(Some(degrees(60.0, 0.2, true)), 4);
    let channels = |i: &usize| i % 4 != 3;
    for sheet in 0..16 {
        let ways = [&none, &forward, &once, &often].map(|light| &light.down[sheet]);
        for i in (0..ways[0].len()).filter(channels) {
            let [none, forward, once, often] = ways.map(|way| way[i]);
            assert!(none <= forward && forward <= once && once <= often, "{sheet} {i}");
            // Half of the light has met something.
            assert!(sheet < 4 || none < forward, "{sheet} {i}: {none} {forward}");
            assert!(!(4..12).contains(&sheet) || forward < once, "{sheet} {i}: {forward} {once}");
        }
        for i in (0..ways[0].len()).filter(channels) {
            let [first, last] = [&once.up[sheet], &often.up[sheet]].map(|up| up[i]);
            // Stored in halves.
            assert!(first >= 0.0 && first <= last * 1.001, "{sheet} {i}: {first} {last}");
            assert!(sheet > 11 || first > 0.0);
        }
    }
}

#[test]
fn the_number_of_sheets_does_not_change_the_blur() {
    let _turn = gpu::turn();
    // A wall of medium beside a clear half: what spreads across its edge is the blur.
    let size = [96, 16];
    let run = |count: u32, free_path: f32| -> Vec<f64> {
        let stack = LightStack {
            means: &|_, [x, _]| if x < 48 { 0.5 } else { 0.0 },
            size,
            texel: 0.05,
            count,
            thickness: 1.6 / count as f32,
            lighting: SheetLighting { g: 0.6, ..SheetLighting::new(2.0) },
            albedo: Vec3::ONE,
            scattering: Some(degrees(60.0, free_path, false)),
            sweeps: 0,
            surfaces: None,
        };
        let light = stack.run();
        // Away from the ends of the buffer, where light is lost.
        let row = light.down.last().unwrap()[4 * 96 * 8..4 * 96 * 9].chunks_exact(4).map(|texel| f(texel[0]));
        row.skip(24).take(48).collect()
    };
    // Light that has crossed the edge.
    let crossed = |row: &[f64]| row[24..].iter().map(|light| light - 4.0).sum::<f64>();
    for (free_path, most) in [(0.3, 0.02), (0.0, 1.0)] {
        let [few, many] = [64, 128].map(|count| run(count, free_path));
        let error = few.iter().zip(&many).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        let relative = (error / many.iter().map(|x| x * x).sum::<f64>()).sqrt();
        let ratio = crossed(&many) / crossed(&few);
        println!(
            "free path {free_path} m: {relative:.5} apart, crossed {:.4}, ratio {ratio:.4}",
            crossed(&many)
        );
        assert!(relative < most * 0.25, "{relative}");
        match free_path > 0.0 {
            true => assert!((ratio - 1.0).abs() < most, "{ratio}"),
            // As in the paper: blur goes with the thickness of sheets.
            false => assert!(ratio < 0.75, "{ratio}"),
        }
    }
}

#[test]
fn surfaces_take_light_away_and_hold_it() {
    let _turn = gpu::turn();
    let size = [48, 24];
    // Surfaces in the left half, in the middle of the sixth sheet; in the last columns before the first.
    let heights = (0..48 * 24).map(|i| match i % 48 {
        0..24 => 0.55,
        40.. => -0.2,
        _ => 1e30,
    });
    let heights: Vec<f32> = heights.collect();
    let run = |albedo: f32, sweeps: u32| {
        let stack = LightStack {
            // Footprints end at surfaces.
            means: &|sheet, [x, _]| match (x < 24, sheet) {
                (true, 5) => 0.25,
                (true, 6..) => 0.0,
                _ => 0.5,
            },
            size,
            texel: 0.05,
            count: 10,
            thickness: 0.1,
            lighting: SheetLighting { g: 0.6, ..SheetLighting::new(2.0) },
            albedo: Vec3::splat(albedo),
            scattering: Some(degrees(60.0, 0.2, sweeps > 0)),
            sweeps,
            surfaces: Some(heights.clone()),
        };
        stack.run()
    };
    let at = |light: &[f32], x: usize| f(light[4 * (12 * 48 + x)]) / 4.0;
    let black = run(0.0, 0);
    for x in 0..48 {
        let behind = at(&black.down[9], x);
        let expected = if (24..40).contains(&x) { (-1.0_f64).exp() } else { 0.0 };
        assert!((behind - expected).abs() < 1e-5, "{x}: {behind}");
        let held = at(&black.held, x);
        let expected = match x {
            0..24 => (-0.55_f64).exp(),
            40.. => 1.0,
            _ => (-1.0_f64).exp(),
        };
        assert!((held - expected).abs() < 1e-3, "{x}: {held}");
    }
    for (light, back) in [(run(0.95, 0), false), (run(0.95, 3), true)] {
        assert!(light.down.iter().flatten().all(|value| value.is_finite() && *value >= 0.0));
        // Far from edges nothing gets behind; beside them light is scattered in, and it stays.
        assert!(at(&light.down[9], 4) < 1e-6 && at(&light.down[9], 22) > 1e-3);
        assert!(at(&light.held, 12) > (-0.55_f64).exp() * 1.05);
        assert_eq!(at(&light.held, 45), 1.0);
        assert!(!back || at(&light.returned, 12) > 0.005);
    }
}

fn perspective(size: [u32; 2]) -> Camera {
    let view = PerspectiveView {
        eye: Vec3::new(0.3, 0.5, 9.0),
        target: Vec3::ZERO,
        field_of_view: 40.0,
        near: 0.01,
        far: 100.0,
        depth: DepthRange::Reversed,
    };
    Camera::perspective(&view, size).unwrap()
}

fn settings(transport: LightTransport, shading: Shading) -> SheetSettings {
    SheetSettings { count: 24, light_size: [48; 2], shading, transport, ..SheetSettings::default() }
}

#[test]
fn more_scattering_is_more_light_at_every_pixel() {
    let _turn = gpu::turn();
    let mut volume = cloud([24, 14, 20], 5);
    volume.values.iter_mut().for_each(|value| *value /= 3.0);
    let splats = splats(&volume);
    let transfer = colored([Vec3::splat(0.98); 2]);
    let bounds = volume.bounds();
    for degrees in [35.0_f32, 140.0] {
        let angle = degrees.to_radians();
        let to_light = -Vec3::new(angle.sin(), -0.2, -angle.cos()).normalize();
        let light =
            Light::directional(to_light, Vec3::new(3.0, 2.0, 1.0), bounds.min - 0.5, bounds.max + 0.5)
                .unwrap();
        let lighting = SheetLighting { g: 0.5, ..SheetLighting::new(8.0) };
        let frame = SheetFrame { camera: perspective([48, 32]), light, lighting };
        for shading in [Shading::Scattering, Shading::Phong] {
            let shot = |transport| shoot(&splats, &transfer, settings(transport, shading), &frame);
            let forward = ScatteringSettings { free_path: 0.1, ..ScatteringSettings::default() };
            let none = shot(LightTransport::Direct);
            let ways = [
                forward,
                ScatteringSettings { back: true, sweeps: 1, ..forward },
                ScatteringSettings { back: true, sweeps: 4, ..forward },
            ];
            let shots = ways.map(|way| shot(LightTransport::Scattering(way)));
            assert!(shots.iter().all(sheets::Shot::is_sound));
            let [mut inside, mut brighter] = [0_u32; 2];
            for i in (0..none.picture.len()).filter(|i| i % 4 != 3) {
                let all = [&none, &shots[0], &shots[1], &shots[2]].map(|shot| shot.picture[i]);
                // Half floats of neighbouring pictures may round to the same.
                assert!(all.windows(2).all(|pair| pair[0] <= pair[1]), "{degrees} {shading:?} {i}: {all:?}");
                // Phong leaves what no side faces dark.
                if none.picture[i - i % 4 + 3] < 0.9
                    && (shading == Shading::Scattering || none.picture[i] > 0.01)
                {
                    inside += 1;
                    brighter += u32::from(all[0] < all[1] && (all[1] < all[2] || shading == Shading::Phong));
                }
            }
            let mean = |shot: &sheets::Shot| {
                let all = shot.picture.chunks_exact(4).map(|pixel| f(pixel[0] + pixel[1] + pixel[2]));
                all.sum::<f64>()
            };
            let times = shots.each_ref().map(|shot| mean(shot) / mean(&none));
            println!(
                "{degrees} degrees, {shading:?}: {brighter} of {inside} brighter at each step; {times:.3?} times"
            );
            // What Phong adds from behind may be less than half floats tell apart; all of it is more.
            assert!(times[0] > 1.05 && times[1] > times[0] && times[2] > times[1] - 1e-9);
            assert!(inside > 100 && f64::from(brighter) >= 0.99 * f64::from(inside));
        }
    }
}

#[test]
fn nonsense_leaves_no_hole() {
    let _turn = gpu::turn();
    let mut volume = cloud([24, 14, 20], 5);
    let middle = (10 * 14 + 7) * 24 + 8;
    for (place, value) in
        [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, 3e38, 1e-30].into_iter().enumerate()
    {
        volume.values[middle + place] = value;
    }
    let splats = splats(&volume);
    let transfer = colored([Vec3::splat(7.0); 2]);
    let bounds = volume.bounds();
    let sun = Light::directional(Vec3::Z, Vec3::splat(6e4), bounds.min, bounds.max).unwrap();
    // In the middle of the volume.
    let spot =
        Light::spot(Vec3::new(0.1, 0.0, 0.2), Vec3::ZERO, 40.0, 20.0, Vec3::splat(20.0), 0.05, 0.05, 30.0);
    for light in [sun, spot.unwrap()] {
        for (extinction, g, free_path) in [(4.0, 0.99, 0.0), (1e6, -0.99, 1e6)] {
            let lighting = SheetLighting { g, ..SheetLighting::new(extinction) };
            let frame = SheetFrame { camera: perspective([48, 32]), light, lighting };
            for (back, cone) in [(false, 180.0), (true, 90.0)] {
                let way = ScatteringSettings { cone, free_path, back, sweeps: 2 };
                for shading in [Shading::Scattering, Shading::Phong] {
                    let settings = settings(LightTransport::Scattering(way), shading);
                    let shot = shoot(&splats, &transfer, settings, &frame);
                    let sound = |values: &[f32]| values.iter().all(|value| (0.0..=65504.0).contains(value));
                    assert!(sound(&shot.picture) && sound(&shot.shadow), "{light:?} {lighting:?} {way:?}");
                    assert!(shot.picture.iter().any(|value| *value < 65504.0 && *value > 0.0));
                }
            }
        }
    }
}

#[test]
fn impossible_settings_are_refused() {
    let splats = splats(&metres([4, 4, 4], |_| 0.5));
    let transfer = colored([Vec3::ONE; 2]);
    let with = |way: ScatteringSettings, light_size| {
        let settings =
            SheetSettings { light_size, ..settings(LightTransport::Scattering(way), Shading::Scattering) };
        let inputs = SheetInputs::new(std::slice::from_ref(&splats), &transfer);
        SheetPicture::new(gpu(), shaders(), inputs, settings, [8, 8]).err()
    };
    let possible = ScatteringSettings::default();
    for way in [
        ScatteringSettings { cone: 0.0, ..possible },
        ScatteringSettings { cone: f32::NAN, ..possible },
        ScatteringSettings { cone: 181.0, ..possible },
        ScatteringSettings { cone: 91.0, back: true, ..possible },
        ScatteringSettings { free_path: -1.0, ..possible },
        ScatteringSettings { free_path: f32::INFINITY, ..possible },
        ScatteringSettings { sweeps: 0, ..possible },
        ScatteringSettings { sweeps: 17, ..possible },
    ] {
        assert!(matches!(with(way, [8; 2]), Some(SplattingError::Setting(_))), "{way:?}");
    }
    let refused = with(ScatteringSettings { back: true, ..possible }, [4096; 2]).unwrap();
    let said = refused.to_string();
    assert!(matches!(refused, SplattingError::LightBuffer { .. }) && said.contains("24 sheets"), "{said}");
    assert!(said.contains("4096") && said.contains("smaller"), "{said}");
}
