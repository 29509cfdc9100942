// SPDX-License-Identifier: MIT OR Apache-2.0
//! Light in the stack of sheets: energy, the exact sum of all bounces, order, blur and surfaces.

use super::kernels::over_cone;
use crate::light_stack::{LightStack, StackLight};
use crate::probing::{f, hold};
use airlight::splatting::{Scattering, SheetLighting};
use airlight_tests::reference::splatting::adding::{Layer, exact, swept};
use glam::Vec3;

pub fn degrees(cone: f32, free_path: f32, back: bool) -> Scattering {
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
