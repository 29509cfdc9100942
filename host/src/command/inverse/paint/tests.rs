// SPDX-License-Identifier: MIT OR Apache-2.0
//! What is painted, where, and that it repeats.
#![allow(clippy::unwrap_used)]

use super::*;
use std::f32::consts::{FRAC_PI_2, PI, TAU};

/// Grey, a little brighter to the right.
fn grey(size: [u32; 2]) -> Canvas {
    let count = size[0] * size[1];
    let light = |i: u32| 0.3 + 0.4 * (i % size[0]) as f32 / size[0] as f32;
    Canvas::new(size, (0..count).map(|i| Vec3::splat(light(i))).collect())
}

fn mean(values: &[f32]) -> f32 {
    values.iter().sum::<f32>() / values.len() as f32
}

const SUN: Logo = Logo { mark: Mark::Sun, middle: Vec2::ZERO, radius: 0.8, turn: 0.0, shade: 0.5 };

#[test]
fn marks_cover_as_much_at_any_size_and_nothing_outside_their_circle() {
    for mark in [Mark::Sun, Mark::Leaf] {
        let logo = Logo { mark, middle: Vec2::new(0.2, -0.1), turn: 0.3, ..SUN };
        let shares = [48, 96, 384].map(|side| {
            let canvas = grey([side * 3 / 2, side]);
            let painted = logo.paint(&canvas, &[]);
            for (pixel, coverage) in painted.coverage.iter().enumerate() {
                assert!((0.0..=1.0).contains(coverage));
                let away = canvas.place(pixel).distance(logo.middle);
                assert!(away < logo.radius + 1.5 * canvas.pixel() || *coverage == 0.0, "{mark:?} at {away}");
            }
            // Borders are soft: some pixels are covered in part.
            let part = painted.coverage.iter().filter(|part| **part > 0.05 && **part < 0.95).count();
            assert!(part > side as usize, "{mark:?}: {part}");
            mean(&painted.coverage)
        });
        assert!(shares[2] > 0.05 && shares[2] < 0.5, "{mark:?}: {shares:?}");
        for share in shares {
            assert!((share / shares[2] - 1.0).abs() < 0.02, "{mark:?}: {shares:?}");
        }
    }
}

#[test]
fn a_sun_covers_its_disc_and_is_alike_at_each_eighth_of_a_turn() {
    let canvas = grey([384, 384]);
    let painted = SUN.paint(&canvas, &[]);
    // Its disc has 0.47 of its radius; around it there is a gap.
    let within = |limit: f32| {
        let parts = painted.coverage.iter().enumerate();
        let near = parts.filter(|(pixel, _)| canvas.place(*pixel).length() < limit * SUN.radius);
        near.map(|(_, coverage)| coverage * canvas.pixel().powi(2)).sum::<f32>()
    };
    let disc = PI * (0.47 * SUN.radius).powi(2);
    assert!((within(0.52) / disc - 1.0).abs() < 2e-3, "{} of {disc}", within(0.52));
    assert!(within(1.1) > 1.2 * disc);
    let turned = |turn: f32| Logo { turn, ..SUN }.paint(&canvas, &[]).coverage;
    let apart =
        |other: &[f32]| painted.coverage.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(apart(&turned(TAU / 8.0)) < 0.05 && apart(&turned(TAU / 16.0)) > 0.9);
    let leaf = |turn: f32| Logo { mark: Mark::Leaf, turn, ..SUN }.paint(&canvas, &[]);
    assert!(apart(&leaf(0.0).coverage) > 0.9);
    // A quarter to the left: what was at (x, y) is at (-y, x).
    let (upright, left) = (leaf(0.0).coverage, leaf(FRAC_PI_2).coverage);
    for (pixel, upright) in upright.iter().enumerate() {
        let (x, y) = (pixel % 384, pixel / 384);
        assert!((upright - left[(383 - x) * 384 + y]).abs() < 1e-2, "{x} {y}");
    }
}

#[test]
fn paint_holds_on_matter_alone_and_keeps_its_shade() {
    let canvas = grey([64, 64]);
    let none = SUN.paint(&canvas, &[0.0; 4096]);
    assert_eq!((none.canvas, mean(&none.coverage)), (canvas.clone(), 0.0));
    let (full, half) = (SUN.paint(&canvas, &[1.0; 4096]), SUN.paint(&canvas, &[0.5; 4096]));
    assert!((mean(&half.coverage) / mean(&full.coverage) - 0.5).abs() < 1e-5);
    assert_eq!(full, SUN.paint(&canvas, &[]));
    // Two pixels of the disc, left and right, are of one colour and as bright as what was there.
    let at = |painted: &Painted, x: usize| painted.canvas.pixels()[32 * 64 + x];
    let flat = Logo { shade: 0.0, ..SUN }.paint(&canvas, &[]);
    assert_eq!(at(&flat, 25), at(&flat, 39));
    let shaded = Logo { shade: 1.0, ..SUN }.paint(&canvas, &[]);
    let ratio = at(&shaded, 25) / at(&shaded, 39);
    let expected = canvas.pixels()[25].x / canvas.pixels()[39].x;
    assert!((ratio - expected).abs().max_element() < 1e-5, "{ratio} {expected}");
}

#[test]
fn grades_do_what_they_say() {
    let mut random = crate::data::Random::new(1);
    let pixels = (0..400).map(|_| Vec3::new(random.unit(), random.unit(), random.unit())).collect();
    let canvas = Canvas::new([20, 20], pixels);
    let same = Grade::default().apply(&canvas);
    assert!(same.pixels.iter().zip(&canvas.pixels).all(|(a, b)| a.distance(*b) < 1e-5));
    let double = Grade { contrast: 2.0, ..Grade::default() }.apply(&canvas);
    let middle = 0.4 * canvas.bright();
    for (after, before) in double.pixels.iter().zip(&canvas.pixels) {
        let stops = [after, before].map(|color| (luminance(*color) / middle).log2());
        assert!((stops[0] - 2.0 * stops[1]).abs() < 1e-3, "{stops:?}");
    }
    let grey = Grade { saturation: 0.0, ..Grade::default() }.apply(&canvas);
    for (after, before) in grey.pixels.iter().zip(&canvas.pixels) {
        assert!(after.max_element() - after.min_element() < 1e-5);
        assert!((luminance(*after) - luminance(*before)).abs() < 1e-5);
    }
    let toned = Grade { shade: Vec3::Z, light: Vec3::X, ..Grade::default() };
    let toned = toned.apply(&Canvas::new([2, 1], vec![Vec3::splat(0.01), Vec3::splat(5.0)]));
    assert!(toned.pixels[0].z > 50.0 * toned.pixels[0].x && toned.pixels[1].x > 50.0 * toned.pixels[1].z);
    let black = Canvas::new([2, 1], vec![]);
    assert_eq!(Grade { contrast: 0.5, ..Grade::default() }.apply(&black), black);
}

/// A plume that widens upwards, of 64 x 96 pixels, from row 88 up to row 8.
fn plume(canvas: &Canvas) -> Vec<f32> {
    let inside = |pixel: usize| {
        let (x, y) = (pixel % 64, pixel / 64);
        let half = 6.0 + 18.0 * (88.0 - y as f32) / 80.0;
        (8..=88).contains(&y) && (x as f32 - 31.5).abs() < half
    };
    (0..canvas.pixels.len()).map(|pixel| if inside(pixel) { 0.9 } else { 0.0 }).collect()
}

#[test]
fn lava_glows_in_the_plume_from_its_foot_up() {
    let canvas = Canvas::new([64, 96], vec![Vec3::splat(0.5); 64 * 96]);
    let matter = plume(&canvas);
    let lava = Lava { azimuth: 0.4, seed: 3, radiance: 2.0, reach: 0.8 };
    let painted = lava.paint(&canvas, &matter);
    assert_eq!(painted, lava.paint(&canvas, &matter));
    let glow = |painted: &Painted, rows: std::ops::Range<usize>| {
        let pixels = rows.flat_map(|y| y * 64..y * 64 + 64).filter(|pixel| matter[*pixel] > 0.0);
        let reds: Vec<f32> = pixels.map(|pixel| painted.canvas.pixels[pixel]).map(|c| c.x - c.z).collect();
        mean(&reds)
    };
    for (pixel, color) in painted.canvas.pixels.iter().enumerate() {
        assert!(color.is_finite() && color.min_element() >= 0.0 && color.x >= color.y && color.y >= color.z);
        if matter[pixel] == 0.0 {
            assert_eq!((*color, painted.coverage[pixel]), (canvas.pixels[pixel], 0.0));
        }
    }
    let [foot, middle, top] = [70..88, 40..60, 8..20].map(|rows| glow(&painted, rows));
    assert!(foot > 1.3 * middle && middle > 3.0 * top.max(0.01), "{foot} {middle} {top}");
    assert!(painted.canvas.pixels.iter().any(|color| color.x > 1.2));
    // Once around it is the same plume, elsewhere another side, and another seed has other veins.
    let apart = |of: Lava| {
        let other = of.paint(&canvas, &matter).canvas;
        let differences = other.pixels.iter().zip(&painted.canvas.pixels).map(|(a, b)| a.distance(*b));
        differences.fold(0.0, f32::max)
    };
    assert!(apart(Lava { azimuth: 0.4 + TAU, ..lava }) < 0.01);
    assert!(apart(Lava { azimuth: 1.4, ..lava }) > 0.3 && apart(Lava { seed: 4, ..lava }) > 0.3);
    // Above its reach all is as it was.
    let low = Lava { reach: 0.5, ..lava }.paint(&canvas, &matter).canvas;
    let apart = |pixel: &usize| low.pixels[*pixel].distance(canvas.pixels[*pixel]);
    assert!(
        (0..47 * 64).all(|pixel| apart(&pixel) < 1e-5) && (60 * 64..80 * 64).any(|pixel| apart(&pixel) > 0.3)
    );
    // Without any plume nothing is painted.
    assert_eq!(lava.paint(&canvas, &[]).canvas, canvas);
}

/// What is in the middle of a view from 65 degrees lies to the right in one from 10: azimuths grow from +z towards +x, which is to the right
/// of who looks along -z.
#[test]
fn veins_of_views_from_several_sides_are_of_one_plume() {
    let canvas = Canvas::new([64, 96], vec![Vec3::splat(0.5); 64 * 96]);
    let matter: Vec<f32> =
        (0..64 * 96).map(|i| if (2..62).contains(&(i % 64)) { 0.9 } else { 0.0 }).collect();
    let view = |degrees: f32| {
        let lava = Lava { azimuth: degrees.to_radians(), seed: 3, radiance: 2.0, reach: 1.5 };
        lava.paint(&canvas, &matter).canvas
    };
    let (first, second) = (view(65.0), view(10.0));
    let column =
        |canvas: &Canvas, x: usize| -> Vec<f32> { (10..86).map(|y| canvas.pixels[y * 64 + x].y).collect() };
    let apart = |a: &[f32], b: &[f32]| mean(&a.iter().zip(b).map(|(a, b)| (a - b).abs()).collect::<Vec<_>>());
    let middle = column(&first, 32);
    let best = (2..62)
        .min_by(|a, b| apart(&column(&second, *a), &middle).total_cmp(&apart(&column(&second, *b), &middle)))
        .unwrap();
    // By the sine of 55 degrees of a radius of 30 pixels, from 31.5 on.
    assert!((55..=57).contains(&best), "{best}");
}

#[test]
fn trees_grow_from_the_ground_and_repeat() {
    let sky = Canvas::new([160, 160], vec![Vec3::splat(0.8); 160 * 160]);
    let tree = Tree {
        foot: Vec2::new(0.1, -0.8),
        height: 1.5,
        seed: 2,
        growth: 1.0,
        wood: Vec3::new(0.06, 0.03, 0.0),
        leaves: None,
    };
    let mut tops = Vec::new();
    let shares = [0.0, 0.3, 0.6, 1.0].map(|growth| {
        let painted = Tree { growth, ..tree }.paint(&sky);
        for (pixel, coverage) in painted.coverage.iter().enumerate() {
            assert!((0.0..=1.0).contains(coverage));
            assert!(*coverage == 0.0 || sky.place(pixel).y > tree.foot.y - sky.pixel());
            let expected = sky.pixels[pixel].lerp(tree.wood, *coverage);
            assert!(painted.canvas.pixels[pixel].distance(expected) < 1e-6);
        }
        let top = painted.coverage.iter().position(|coverage| *coverage > 0.5).unwrap();
        tops.push((sky.place(top).y - tree.foot.y) / tree.height);
        mean(&painted.coverage)
    });
    assert!(shares[0] > 0.0 && shares.windows(2).all(|pair| pair[1] > 1.3 * pair[0]), "{shares:?}");
    assert!(tops[0] < 0.25 && tops[1] < 0.7 && tops[2] < tops[3] && tops[3] > 0.75, "{tops:?}");
    assert!((0.08..0.5).contains(&shares[3]), "{shares:?}");
    assert_eq!(tree.paint(&sky), tree.paint(&sky));
    assert_ne!(tree.paint(&sky), Tree { seed: 3, ..tree }.paint(&sky));
    let green = Tree { growth: 0.6, leaves: Some(Vec3::new(0.0, 0.4, 0.0)), ..tree }.paint(&sky);
    assert!(mean(&green.coverage) > 1.3 * shares[2]);
    let leaves = green.canvas.pixels.iter().filter(|color| color.y > 0.3 && color.z < 0.1).count();
    assert!(leaves > 200, "{leaves}");
    // No leaf on the ground or on the trunk.
    let trunk = |pixel: usize| sky.place(pixel).y < tree.foot.y + 0.15;
    assert!(!(0..160 * 160).any(|pixel| trunk(pixel) && green.canvas.pixels[pixel].y > 0.9));
    assert!(!(0..160 * 160).any(|pixel| {
        let color = green.canvas.pixels[pixel];
        trunk(pixel) && color.y > 0.3 && color.z < 0.1
    }));
}
