// SPDX-License-Identifier: MIT OR Apache-2.0
//! Streaks along directions in the picture, against means of noise along lines; ridges and valleys, against the table.

use crate::bending::CURVED;
use crate::gpu::{Random, gpu, shaders};
use crate::probing::{f, hold};
use crate::surfaces::{PLAIN, SIZE, Setting, view_of};
use airlight::Texture;
use airlight::core::Transfer;
use airlight::data::torus_field;
use airlight::painterly::{
    Advect, CurvatureTable, IsoForm, IsoRaycast, PainterlyError, RidgeParameters, Ridges, Shade,
    StreakParameters,
};
use airlight_tests::reference::noise::hash;
use glam::Vec3;

const WIDTH: usize = 48;
const HEIGHT: usize = 40;

/// Streaks along a field of (cos 2a, sin 2a).
fn streaks(of: impl Fn(usize, usize) -> [f32; 2], parameters: StreakParameters) -> Vec<f32> {
    let texels: Vec<f32> = (0..WIDTH * HEIGHT)
        .flat_map(|i| {
            let [cosine, sine] = of(i % WIDTH, i / WIDTH);
            [0.0, 0.0, cosine, sine]
        })
        .collect();
    let usage = wgpu::TextureUsages::TEXTURE_BINDING;
    let size = [WIDTH as u32, HEIGHT as u32];
    let field = Texture::new(gpu(), size, wgpu::TextureFormat::Rgba16Float, usage);
    field.write(gpu(), &texels).unwrap();
    let pass = Advect::new(gpu(), shaders()).unwrap();
    let bound = pass.bind(gpu(), &field, &parameters).unwrap();
    let mut encoder = gpu().encoder();
    pass.record(&mut encoder, &bound);
    gpu().submit(encoder).unwrap();
    bound.streaks.read(gpu()).unwrap()
}

fn noise(x: i64, y: i64, seed: u32) -> f64 {
    let word = hash([x as u64, y as u64, u64::from(seed)])[0];
    (word / 256) as f64 / 16_777_216.0
}

/// Mean and count of the noise over pixels at whole multiples of a step, `steps` each way, until the picture ends.
fn mean_along(x: usize, y: usize, [dx, dy]: [i64; 2], steps: i64, seed: u32) -> (f64, f64) {
    let (mut sum, mut count) = (0.0, 0.0);
    for i in -steps..=steps {
        let [at_x, at_y] = [x as i64 + i * dx, y as i64 + i * dy];
        if (0..WIDTH as i64).contains(&at_x) && (0..HEIGHT as i64).contains(&at_y) {
            sum += noise(at_x, at_y, seed);
            count += 1.0;
        }
    }
    (sum / count, count)
}

#[test]
fn a_constant_field_gives_means_along_lines() {
    // Steps from middle to middle of pixels.
    for (step, steps) in
        [([1_i64, 0_i64], 9), ([0, 1], 6), ([1, 1], 7), ([-1, 1], 5), ([2, 1], 4), ([-1, 3], 3)]
    {
        let (dx, dy) = (step[0] as f32, step[1] as f32);
        let squared = dx * dx + dy * dy;
        let double = [(dx * dx - dy * dy) / squared, 2.0 * dx * dy / squared];
        for contrast in [0.0, 1.0] {
            let parameters =
                StreakParameters { steps, step_length: squared.sqrt(), seed: 5 + steps, contrast };
            let found = streaks(|_, _| double, parameters);
            let mut worst = 0.0_f64;
            for (i, found) in found.iter().enumerate() {
                let (mean, count) = mean_along(i % WIDTH, i / WIDTH, step, i64::from(steps), parameters.seed);
                let gain = if contrast > 0.0 { count.sqrt() } else { 1.0 };
                worst = worst.max((f(*found) - (0.5 + gain * (mean - 0.5)).clamp(0.0, 1.0)).abs());
            }
            hold(&format!("{step:?}, contrast {contrast}"), worst, 1e-5);
        }
    }
}

/// Lines follow circles, whichever way each pixel's direction is meant, and do not cross them.
#[test]
fn a_turning_field_gives_rings() {
    let centre = [23.5_f32, 19.5];
    let parameters = StreakParameters { steps: 12, step_length: 1.0, seed: 3, contrast: 0.0 };
    let found = streaks(
        |x, y| {
            let [dx, dy] = [x as f32 + 0.5 - centre[0], y as f32 + 0.5 - centre[1]];
            let squared = dx * dx + dy * dy;
            // Around: (-dy, dx).
            [(dy * dy - dx * dx) / squared, -2.0 * dx * dy / squared]
        },
        parameters,
    );
    // Means over arcs that lie in the picture, by their own radius and angle.
    let arc = |x: usize, y: usize| {
        let [dx, dy] = [x as f64 + 0.5 - f64::from(centre[0]), y as f64 + 0.5 - f64::from(centre[1])];
        let (radius, angle) = (dx.hypot(dy), dy.atan2(dx));
        let mut sum = 0.0;
        for i in -12..=12 {
            let (sine, cosine) = (angle + f64::from(i) / radius).sin_cos();
            let [x, y] = [f64::from(centre[0]) + radius * cosine, f64::from(centre[1]) + radius * sine];
            sum += noise(x.floor() as i64, y.floor() as i64, 3);
        }
        ((6.0..18.0).contains(&radius)).then_some(sum / 25.0 - 0.5)
    };
    let (mut product, mut squares, mut spread, mut count) = (0.0, 0.0, 0.0, 0.0);
    for (i, found) in found.iter().enumerate() {
        if let Some(exact) = arc(i % WIDTH, i / WIDTH) {
            let found = f(*found) - 0.5;
            (product, squares, spread) =
                (product + found * exact, squares + exact * exact, spread + found * found);
            count += 1.0;
        }
    }
    // Pixels that lines only touch are met by the one and missed by the other.
    hold("what lines have not in common with arcs", 1.0 - product / (squares * spread).sqrt(), 0.15);
    // Means of 25 numbers, each of variance 1/12, but for lines that meet a pixel twice.
    let spread = spread / count * 12.0 * 25.0;
    assert!((0.7..2.0).contains(&spread), "{spread}");
}

#[test]
fn lines_end_where_there_is_no_direction_or_a_kink() {
    let parameters = StreakParameters { steps: 8, step_length: 1.0, seed: 1, contrast: 0.0 };
    let wild = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.05].map(|value| [value; 2]);
    for (kind, other) in wild.into_iter().chain([[-1.0, 0.0]]).enumerate() {
        // Rows, until a column of something else.
        let found = streaks(|x, _| if x == 20 { other } else { [1.0, 0.0] }, parameters);
        for (i, found) in found.iter().enumerate() {
            let (x, y) = (i % WIDTH, i / WIDTH);
            let exact = if x == 20 {
                match kind {
                    4 => mean_along(x, y, [0, 1], 8, 1).0,
                    _ => 0.5,
                }
            } else {
                let (low, high) = if x < 20 { (0, 19) } else { (21, WIDTH - 1) };
                let (from, to) = (x.saturating_sub(8).max(low), (x + 8).min(high));
                (from..=to).map(|x| noise(x as i64, y as i64, 1)).sum::<f64>() / (to - from + 1) as f64
            };
            assert!((f(*found) - exact).abs() < 1e-5, "{kind}: {x} {y}: {found} {exact}");
        }
    }
    let nothing = streaks(|_, _| [0.0; 2], parameters);
    assert!(nothing.iter().all(|value| *value == 0.5));
    // Other noise for another seed.
    let other = StreakParameters { seed: 2, ..parameters };
    assert_ne!(streaks(|_, _| [1.0, 0.0], parameters), streaks(|_, _| [1.0, 0.0], other));
}

/// What the table holds, straight between its entries.
fn of_table(table: &[[f32; 4]], side: usize, curvatures: [f64; 2], range: f64) -> [f64; 4] {
    let place = curvatures.map(|k| ((k / range).clamp(-1.0, 1.0) * 0.5 + 0.5) * (side - 1) as f64);
    let first = place.map(|at| (at.floor() as usize).min(side - 2));
    let [x, y] = [place[0] - first[0] as f64, place[1] - first[1] as f64];
    std::array::from_fn(|channel| {
        let entry = |i: usize, j: usize| {
            f(half::f16::from_f32(table[(first[1] + j) * side + first[0] + i][channel]).to_f32())
        };
        let row = |j: usize| entry(0, j) * (1.0 - x) + entry(1, j) * x;
        row(0) * (1.0 - y) + row(1) * y
    })
}

#[test]
fn ridges_and_valleys_have_the_colours_of_the_table() {
    let volume = torus_field([48; 3], 0.55, 0.25);
    let setting = Setting::new(volume.clone(), &view_of(&volume, Vec3::new(0.5, 0.4, 1.0)));
    let mut random = Random(21);
    let side = 9;
    let table: Vec<[f32; 4]> = (0..side * side).map(|_| [0; 4].map(|_| random.unit() as f32)).collect();
    let (uploaded, transfer) = (setting.uploaded(), Transfer::new(gpu(), &setting.table).unwrap());
    let form = IsoForm { deferred: true, ..CURVED };
    let pass = IsoRaycast::new(gpu(), shaders(), form).unwrap();
    let rays = pass.bind(gpu(), &uploaded, &transfer, SIZE).unwrap();
    pass.set(gpu(), &rays, &uploaded, &setting.frame, &setting.settings, &setting.lighting).unwrap();
    let curvature = rays.targets.curvature.as_ref().unwrap();
    let advect = Advect::new(gpu(), shaders()).unwrap();
    let drawn = advect.bind(gpu(), curvature, &StreakParameters::default()).unwrap();
    let colors = CurvatureTable::new(gpu(), side, &table).unwrap();
    let ridges = Ridges::new(gpu(), shaders()).unwrap();
    let (range, strength) = (5.0, 0.6);
    let parameters = RidgeParameters::new(range, strength).unwrap();
    let plain = ridges.bind(gpu(), &rays, &colors, None, &parameters).unwrap();
    let streaked = ridges.bind(gpu(), &rays, &colors, Some(&drawn.streaks), &parameters).unwrap();
    let shade = Shade::new(gpu(), shaders()).unwrap();
    let shaded = shade.bind_color(gpu(), &rays, &plain.tinted).unwrap();
    let mut encoder = gpu().encoder();
    pass.record(&mut encoder, &rays);
    advect.record(&mut encoder, &drawn);
    ridges.record(&mut encoder, &plain);
    ridges.record(&mut encoder, &streaked);
    shade.record(&mut encoder, &shaded);
    gpu().submit(encoder).unwrap();
    let [color, bent, streaks, plain, streaked, lit] =
        [&rays.targets.color, curvature, &drawn.streaks, &plain.tinted, &streaked.tinted, &shaded.picture]
            .map(|texture| texture.read(gpu()).unwrap());
    let (mut worst, mut hits) = (0.0_f64, 0);
    for i in 0..color.len() / 4 {
        let texels = [&color, &plain, &streaked].map(|target| &target[4 * i..4 * i + 4]);
        if texels[0][3] == 0.0 {
            assert!(texels[1..].iter().all(|texel| texel.iter().all(|v| *v == 0.0)));
            continue;
        }
        hits += 1;
        let given = of_table(&table, side, [f(bent[4 * i]), f(bent[4 * i + 1])], f(range));
        let bright = 1.0 + f(strength) * (2.0 * f(streaks[i]) - 1.0);
        for channel in 0..3 {
            let tinted = f(texels[0][channel]) * (1.0 - given[3]) + given[channel] * given[3];
            worst = worst.max((f(texels[1][channel]) - tinted).abs());
            worst = worst.max((f(texels[2][channel]) - tinted * bright).abs());
        }
        assert!(texels[1][3] == 1.0 && texels[2][3] == 1.0);
    }
    assert!(hits > 400, "{hits}");
    // Filters may weigh by 256ths.
    hold("tinted colour", worst, 6e-3);
    assert!(lit.iter().any(|v| *v > 0.1) && streaks.iter().any(|v| *v != 0.5));
    // Without curvature there is nothing to colour by.
    let blind = IsoRaycast::new(gpu(), shaders(), PLAIN).unwrap();
    let rays = blind.bind(gpu(), &uploaded, &transfer, SIZE).unwrap();
    let refused = ridges.bind(gpu(), &rays, &colors, None, &parameters);
    assert!(matches!(refused, Err(PainterlyError::NoCurvature)));
}

#[test]
fn ridges_are_convex_and_valleys_concave() {
    let (ridge, valley) = (Vec3::new(1.0, 0.5, 0.0), Vec3::new(0.0, 0.25, 1.0));
    let table = CurvatureTable::of_ridges_and_valleys(gpu(), ridge, valley).unwrap();
    let texels = table.texture.read(gpu()).unwrap();
    let side = table.texture.size()[0] as usize;
    let entry = |one: f32, two: f32| {
        let index = |k: f32| ((k * 0.5 + 0.5) * (side - 1) as f32).round() as usize;
        let first = 4 * (index(two) * side + index(one));
        (Vec3::from_slice(&texels[first..first + 3]), texels[first + 3])
    };
    assert_eq!(entry(1.0, 0.0), (ridge, 1.0));
    assert_eq!(entry(0.0, -1.0), (valley, 1.0));
    assert_eq!(entry(0.5, 0.0), (ridge, 0.5));
    for alike in [0.0, 1.0, -1.0] {
        assert_eq!(entry(alike, alike).1, 0.0);
    }
    // Saddles are neither.
    assert_eq!(entry(0.5, -0.5).1, 0.0);
}

#[test]
fn impossible_streaks_and_tables_are_errors() {
    let plain = StreakParameters::default();
    for (parameters, name) in [
        (StreakParameters { steps: 300, ..plain }, "steps"),
        (StreakParameters { step_length: 0.0, ..plain }, "step of"),
        (StreakParameters { step_length: f32::NAN, ..plain }, "step of"),
        (StreakParameters { contrast: 1.5, ..plain }, "contrast"),
    ] {
        let error = parameters.check().unwrap_err().to_string();
        assert!(error.starts_with(name), "{error}");
    }
    for (range, strength) in [(0.0, 0.0), (f32::NAN, 0.0), (1e6, 0.0), (1.0, -0.5), (1.0, 1.5)] {
        assert!(matches!(RidgeParameters::new(range, strength), Err(PainterlyError::Setting(_))));
    }
    let table = |side, table: &[[f32; 4]]| CurvatureTable::new(gpu(), side, table).err().unwrap();
    for (side, count) in [(1, 1), (3, 8), (0, 0), (10_000, 4)] {
        assert!(matches!(table(side, &vec![[0.0; 4]; count]), PainterlyError::Table { .. }));
    }
    let odd = [[0.0; 4], [0.0; 4], [0.0, 0.0, 0.0, 2.0], [0.0; 4]];
    assert!(matches!(table(2, &odd), PainterlyError::Entry { entry: 2, .. }));
}
