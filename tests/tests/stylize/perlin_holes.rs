// SPDX-License-Identifier: MIT OR Apache-2.0
//! Random holes: the noise against f64, share of the area and size against what was asked for, shadow maps with holes, the
//! same by discarding fragments, and how masks change with time.
//!
//! `--nocapture` prints the measured figures next to their bounds.

use crate::gpu::{Random, gpu, shaders, texture};
use crate::holes::{Measured, correlation, draw_scene, measure, most_like};
use airlight::Texture;
use airlight::core::DepthRange;
use airlight::stylize::{
    HoleError, HoleMask, HoleMotion, HoleParameters, HolePattern, HolePicture, Holes, PunchHoles,
    StylizeError,
};
use airlight_tests::reference::stylize::holes::Pattern;

/// A map of `SIDE` texels is as many metres wide: sizes are in texels.
const SIDE: u32 = 512;

fn pattern(holes: &Holes, side: u32) -> HolePattern {
    HolePattern::new(holes, [side as f32; 2], DepthRange::Forward).unwrap()
}

/// The picture of one set of parameters after the other.
fn pictures(picture: HolePicture, size: [u32; 2], all: &[HoleParameters]) -> Vec<Vec<f32>> {
    let pass = HoleMask::new(gpu(), shaders(), picture, &all[0], size).unwrap();
    let draw = |parameters| {
        pass.set(gpu(), parameters).unwrap();
        let mut encoder = gpu().encoder();
        pass.record(&mut encoder);
        gpu().submit(encoder).unwrap();
        pass.mask.read(gpu()).unwrap()
    };
    all.iter().map(draw).collect()
}

/// Area and size over the seeds, of holes of `size` texels at any time.
fn measured(holes: &Holes, seeds: u32) -> Measured {
    let of = |seed| pattern(&Holes { seed: 1000 + seed, ..*holes }, SIDE).at(f64::from(seed) * 1.7).unwrap();
    let parameters: Vec<_> = (0..seeds).map(of).collect();
    let masks = pictures(HolePicture::Mask, [SIDE; 2], &parameters);
    measure(&masks, SIDE as usize)
}

#[test]
fn noise_and_masks_are_those_of_the_reference() {
    let mut random = Random(31);
    let size = [96, 64];
    for (octaves, persistence) in [(1, 0.5), (2, 1.0), (3, 0.0), (5, 0.5), (8, 0.7)] {
        for moving in [false, true] {
            let parameters = HoleParameters {
                cells: [random.between(3.0, 40.0) as f32, random.between(3.0, 40.0) as f32].into(),
                threshold: random.between(0.35, 0.6) as f32,
                persistence: persistence as f32,
                octaves,
                seed: random.bits(),
                travel: random.bits() >> 8,
                travel_part: random.unit() as f32,
                displacement: if moving { random.between(0.1, 1.0) as f32 } else { 0.0 },
                turn: random.between(-3.0, 3.0) as f32,
                far_depth: 1.0,
                reserved: 0.0,
            };
            let reference = Pattern {
                cells: parameters.cells.to_array().map(f64::from),
                persistence: f64::from(parameters.persistence),
                octaves,
                seed: parameters.seed,
                travel: f64::from(parameters.travel) + f64::from(parameters.travel_part),
                displacement: f64::from(parameters.displacement),
                turn: f64::from(parameters.turn),
            };
            let noise = &pictures(HolePicture::Noise, size, &[parameters])[0];
            let mask = &pictures(HolePicture::Mask, size, &[parameters])[0];
            // A position in cells is a float: 2^-24 of 40 cells, times the slope of the noise; of the finest octaves that is
            // 2^7 times as steep but a hundredth as high. The displacement adds the rounding of its own position.
            let budget = if moving { 1e-4 } else { 5e-5 };
            let mut worst = 0.0_f64;
            let mut counted = 0;
            for (i, (noise, mask)) in noise.iter().zip(mask).enumerate() {
                let at = [i as u32 % size[0], i as u32 / size[0]];
                let uv = [0, 1].map(|k| (f64::from(at[k]) + 0.5) / f64::from(size[k]));
                let expected = reference.at(uv);
                worst = worst.max((f64::from(*noise) - expected).abs());
                let apart = expected - f64::from(parameters.threshold);
                if apart.abs() > 2.0 * budget {
                    assert_eq!(*mask, if apart < 0.0 { 1.0 } else { 0.0 }, "{parameters:?}: {uv:?}");
                    counted += 1;
                }
            }
            println!(
                "{octaves} octaves, persistence {persistence}, moving {moving}: {worst:.2e} of at most {budget:.0e}"
            );
            assert!(worst <= budget && counted > 5000, "{worst:e}, {counted} texels");
        }
    }
}

#[test]
fn holes_have_the_area_and_size_that_were_asked_for() {
    for octaves in [1, 3, 5] {
        for density in [0.05, 0.1, 0.2, 0.3, 0.5, 0.7] {
            let holes = Holes { size: 12.0, density, octaves, ..Holes::default() };
            let found = measured(&holes, 64);
            println!("{octaves} octaves, density {density}: {found}");
            assert!((found.area - f64::from(density)).abs() <= 0.02, "{octaves} octaves, {density}: {found}");
            let ratio = found.chord / 12.0;
            assert!(density > 0.3 || (ratio - 1.0).abs() <= 0.15, "{octaves} octaves, {density}: {found}");
        }
    }
}

#[test]
fn other_persistences_sizes_and_motions_keep_the_promise() {
    // Cells of the finest octave are at least three texels: of smaller ones a map misses the shortest chords.
    let still = Holes { density: 0.2, ..Holes::default() };
    let moving = |distance| HoleMotion { distance, ..HoleMotion::default() };
    for holes in [
        Holes { size: 30.0, octaves: 2, persistence: 1.0, ..still },
        Holes { size: 8.0, octaves: 4, persistence: 0.2, ..still },
        Holes { size: 12.0, octaves: 6, persistence: 0.3, ..still },
        Holes { size: 12.0, octaves: 5, persistence: 0.0, density: 0.3, ..still },
        Holes { size: 12.0, octaves: 1, motion: moving(6.0), ..still },
        Holes { size: 12.0, octaves: 3, motion: moving(12.0), ..still },
        Holes { size: 12.0, octaves: 3, motion: moving(24.0), density: 0.1, ..still },
        Holes { size: 12.0, octaves: 5, motion: moving(24.0), density: 0.3, ..still },
    ] {
        let found = measured(&holes, 64);
        println!("{holes:?}: {found}");
        assert!((found.area - f64::from(holes.density)).abs() <= 0.02, "{holes:?}: {found}");
        assert!((found.chord / f64::from(holes.size) - 1.0).abs() <= 0.15, "{holes:?}: {found}");
    }
}

#[test]
fn more_density_only_adds_holes_and_the_ends_are_none_and_all() {
    let of = |density, seed| {
        pattern(&Holes { size: 9.0, density, seed, ..Holes::default() }, SIDE).at(0.0).unwrap()
    };
    for seed in [1, 2, u32::MAX] {
        let masks = pictures(HolePicture::Mask, [256; 2], &[of(0.0, seed), of(1.0, seed)]);
        assert!(masks[0].iter().all(|hole| *hole == 0.0) && masks[1].iter().all(|hole| *hole == 1.0));
        // With the same cells: size follows from density, too.
        let with = |density| HoleParameters { cells: of(0.3, seed).cells, ..of(density, seed) };
        let rising: Vec<_> = [0.01, 0.1, 0.2, 0.4, 0.6, 0.9, 0.99].into_iter().map(with).collect();
        let masks = pictures(HolePicture::Mask, [256; 2], &rising);
        for pair in masks.windows(2) {
            assert!(pair[0].iter().zip(&pair[1]).all(|(less, more)| less <= more));
            assert!(pair[0].iter().sum::<f32>() < pair[1].iter().sum::<f32>());
        }
    }
}

#[test]
fn equal_input_gives_equal_bits_and_another_seed_other_holes() {
    let motion = HoleMotion { distance: 5.0, ..HoleMotion::default() };
    let of = |seed| {
        pattern(&Holes { size: 9.0, density: 0.3, seed, motion, ..Holes::default() }, SIDE).at(9.0).unwrap()
    };
    let noise = pictures(HolePicture::Noise, [200, 120], &[of(5), of(6), of(5)]);
    let bits = |values: &[f32]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&noise[0]), bits(&noise[2]));
    assert!(correlation(&noise[0], &noise[1]).abs() < 0.3);
}

/// The shadow map with holes.
fn punch(parameters: &HoleParameters, object: &Texture, rest: Option<&Texture>) -> Vec<f32> {
    let [width, height, _] = object.size();
    let pass = PunchHoles::new(gpu(), shaders(), parameters, [width, height]).unwrap();
    let bound = pass.bind(gpu(), object, rest).unwrap();
    let mut encoder = gpu().encoder();
    pass.record(&mut encoder, &bound);
    gpu().submit(encoder).unwrap();
    pass.punched.read(gpu()).unwrap()
}

#[test]
fn holes_are_far_and_everything_else_keeps_its_depth() {
    let size = [70, 45];
    let count = (size[0] * size[1]) as usize;
    let mut random = Random(33);
    let wild = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, 1.0];
    let mut map = || -> Vec<f32> {
        let texel = |random: &mut Random| {
            if random.below(4) == 0 { wild[random.below(5)] } else { random.unit() as f32 }
        };
        (0..count).map(|_| texel(&mut random)).collect()
    };
    let (object, rest) = (map(), map());
    let on_gpu = |values: &[f32]| texture(size, wgpu::TextureFormat::R32Float, values);
    let (object_map, rest_map) = (on_gpu(&object), on_gpu(&rest));
    for (depth, far) in [(DepthRange::Forward, 1.0), (DepthRange::Reversed, 0.0)] {
        let holes = Holes { size: 6.0, density: 0.4, ..Holes::default() };
        let parameters = HolePattern::new(&holes, [70.0, 45.0], depth).unwrap().at(0.0).unwrap();
        let mask = &pictures(HolePicture::Mask, size, &[parameters])[0];
        let alone = punch(&parameters, &object_map, None);
        let both = punch(&parameters, &object_map, Some(&rest_map));
        let mut holes = 0;
        for i in 0..count {
            let finite = |x: f32| if x.is_finite() { x } else { far };
            let own = if mask[i] == 1.0 { far } else { finite(object[i]) };
            let other = finite(rest[i]);
            assert_eq!(alone[i].to_bits(), own.to_bits(), "{i}");
            let nearer = if far == 1.0 { own.min(other) } else { own.max(other) };
            assert_eq!(both[i].to_bits(), nearer.to_bits(), "{i}");
            holes += usize::from(mask[i] == 1.0);
        }
        assert!(holes > count / 5, "{holes} of {count}");
    }
}

#[test]
fn discarding_fragments_is_punching_the_map_of_the_object() {
    let size = [160, 120];
    let motion = HoleMotion { distance: 4.0, ..HoleMotion::default() };
    let holes = Holes { size: 8.0, density: 0.35, octaves: 4, motion, ..Holes::default() };
    let parameters = HolePattern::new(&holes, [160.0, 120.0], DepthRange::Forward).unwrap().at(3.7).unwrap();
    let scene = draw_scene(size, &parameters);
    let punched = punch(&parameters, &scene.object, Some(&scene.rest));
    let [discarded, object, rest] =
        [&scene.discarded, &scene.object, &scene.rest].map(|map| map.read(gpu()).unwrap());
    // The object is in front of the rest in part, has holes there, and does not fill the map.
    let shown = (0..punched.len()).filter(|i| object[*i] < rest[*i]).count();
    let open = (0..punched.len()).filter(|i| object[*i] < rest[*i] && punched[*i] == rest[*i]).count();
    let empty = object.iter().filter(|depth| **depth == 1.0).count();
    println!("{shown} texels of the object in front, {open} of them holes, {empty} empty");
    assert!(shown > 4000 && open > shown / 5 && open < shown / 2 && empty > 1000);
    let bits = |values: &[f32]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&discarded), bits(&punched));
}

#[test]
fn masks_change_smoothly_and_in_proportion_to_time() {
    for (octaves, distance) in [(1, 8.0), (3, 16.0), (5, 24.0)] {
        let motion = HoleMotion { distance, turn: 1.5, pace: 0.5 };
        let holes = Holes { size: 16.0, density: 0.25, octaves, motion, ..Holes::default() };
        let pattern = pattern(&holes, SIDE);
        let parameters = pattern.at(0.0).unwrap();
        let frame = 1.0 / 60.0;
        let times = (0..24).map(|i| pattern.at(5.0 + f64::from(i) * frame).unwrap()).collect::<Vec<_>>();
        let masks = pictures(HolePicture::Mask, [SIDE; 2], &times);
        let changed = |from: usize, to: usize| {
            let pairs = masks[from].iter().zip(&masks[to]);
            pairs.filter(|(a, b)| a != b).count() as f64 / f64::from(SIDE * SIDE)
        };
        // Edges, pi A / chord metres of them a square metre (Cauchy and Crofton), move by the slope of the travelling noise,
        // 0.88 a cell, times the pace, the displacement and the turn; across themselves they move by less.
        let edges = std::f64::consts::PI * 0.25 / 16.0;
        let speed = f64::from(distance) * (1.0 + 1.5 * 1.5 * 0.094_f64).sqrt() * 0.88 * 0.5;
        let bound = edges * speed * frame;
        let most = (0..23).map(|i| changed(i, i + 1)).fold(0.0, f64::max);
        let mean = |step: usize| {
            let starts = 24 - step;
            (0..starts).map(|i| changed(i, i + step)).sum::<f64>() / starts as f64
        };
        let [one, two, four] = [1, 2, 4].map(mean);
        println!(
            "{octaves} octaves, displacement {:.2}: at most {most:.5} a frame of {bound:.5}; two frames {:.3}, four {:.3}",
            parameters.displacement,
            two / one,
            four / one
        );
        assert!(most <= bound, "{octaves}: {most} of {bound} a frame");
        assert!(one >= 0.2 * bound, "{octaves}: only {one} of {bound} a frame");
        // A piece of an edge that comes back counts less.
        assert!((1.8..=2.05).contains(&(two / one)) && (3.4..=4.1).contains(&(four / one)), "{octaves}");
        // No time, no change.
        let again = pictures(HolePicture::Mask, [SIDE; 2], &times[..1]);
        assert_eq!(again[0], masks[0]);
    }
}

#[test]
fn masks_do_not_merely_translate() {
    for (octaves, distance) in [(1, 12.0), (3, 16.0), (5, 24.0)] {
        let motion = HoleMotion { distance, turn: 1.5, pace: 0.5 };
        let holes = Holes { size: 12.0, density: 0.25, octaves, motion, ..Holes::default() };
        let pattern = pattern(&holes, 256);
        let parameters = [0.0, 1.0, 2.0].map(|second| pattern.at(second).unwrap());
        let masks = pictures(HolePicture::Mask, [256; 2], &parameters);
        // What the search says of a mask that is translated: the same pattern, standing still, seen through another window.
        let still = HoleParameters { displacement: 0.0, ..parameters[0] };
        let wide = &pictures(HolePicture::Mask, [256; 2], &[still])[0];
        let window = |x: usize, y: usize| -> Vec<f32> {
            (0..224 * 224).map(|i| wide[(y + i / 224) * 256 + x + i % 224]).collect()
        };
        let translated = most_like(&window(16, 16), &window(9, 21), 224, 20);
        assert!(translated.0 > 0.999 && translated.1 == [7, -5], "{translated:?}");
        for later in [1, 2] {
            let found = most_like(&masks[0], &masks[later], 256, 20);
            let standing = correlation(&masks[0], &masks[later]);
            println!(
                "{octaves} octaves, {later} s: {:.3} at {:?}, {standing:.3} where it is",
                found.0, found.1
            );
            assert!(
                found.0 < 0.8,
                "{octaves} octaves: a translation by {:?} explains {:.3}",
                found.1,
                found.0
            );
            // Holes sway about their places: they are not strewn anew.
            assert!(standing > 0.1, "{octaves} octaves: {standing}");
        }
    }
}

#[test]
fn what_cannot_be_is_refused() {
    let parameters = pattern(&Holes { size: 9.0, ..Holes::default() }, SIDE).at(0.0).unwrap();
    let bad = HoleParameters { octaves: 0, ..parameters };
    assert!(matches!(
        PunchHoles::new(gpu(), shaders(), &bad, [8, 8]),
        Err(StylizeError::Holes(HoleError::Octaves(0)))
    ));
    let bad = HoleParameters { threshold: f32::NAN, ..parameters };
    let made = HoleMask::new(gpu(), shaders(), HolePicture::Mask, &bad, [8, 8]);
    assert!(matches!(made, Err(StylizeError::Holes(HoleError::Value { name: "threshold", .. }))));
    for size in [[0, 8], [8, 0], [1 << 20, 8]] {
        assert!(matches!(
            PunchHoles::new(gpu(), shaders(), &parameters, size),
            Err(StylizeError::Size { .. })
        ));
    }
    let pass = PunchHoles::new(gpu(), shaders(), &parameters, [8, 8]).unwrap();
    assert!(matches!(pass.set(gpu(), &bad), Err(StylizeError::Holes(HoleError::Value { .. }))));
    let map = |size: [u32; 2]| {
        texture(size, wgpu::TextureFormat::R32Float, &vec![1.0; (size[0] * size[1]) as usize])
    };
    let (right, wrong) = (map([8, 8]), map([8, 9]));
    assert!(matches!(pass.bind(gpu(), &wrong, None), Err(StylizeError::OtherSize { given: [8, 9], .. })));
    assert!(matches!(
        pass.bind(gpu(), &right, Some(&wrong)),
        Err(StylizeError::OtherSize { given: [8, 9], .. })
    ));
    assert!(pass.bind(gpu(), &right, Some(&right)).is_ok());
}
