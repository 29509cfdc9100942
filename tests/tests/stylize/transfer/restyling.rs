// SPDX-License-Identifier: MIT OR Apache-2.0
//! The place of a ray, and what is made of a colour.

use super::baking::{baker, greatest, texels};
use super::synthetic::{SIZE, Synthetic};
use crate::gpu::{self, Random, gpu, shaders};
use crate::probing::{f, hold};
use crate::wild_function::wild_function;
use airlight::stylize::{Mode, Phase, Place, RayProperty, Restyle, TransferFunction, TransferSettings};
use airlight::{Buffer, Pass, Texture};
use airlight_tests::reference::stylize::transfer as reference;
use glam::Vec3;
use std::collections::BTreeMap;
use wgpu::TextureFormat::{R32Float, Rgba16Float};

fn all_pixels() -> Vec<Place> {
    (0..SIZE[0] * SIZE[1]).map(|i| Place::Pixel([i % SIZE[0], i / SIZE[0]])).collect()
}

#[test]
fn rays_lie_where_their_properties_say() {
    let mut random = Random(37);
    use RayProperty::{Depth, LightAngle, PictureAngle, Visibility};
    let mut errors = [0.0_f64; 4];
    let (mut held, mut all) = (0, 0);
    for _ in 0..30 {
        let picture = Synthetic::new(&mut random);
        let movements = BTreeMap::new();
        let limit = random.between(2.0, 30.0) as f32;
        let sines = picture.sines();
        for (across, down) in [(Visibility, Depth), (LightAngle, PictureAngle)] {
            let settings =
                TransferSettings { across, down, depth_limit: Some(limit), ..TransferSettings::default() };
            let places =
                baker().positions(gpu(), &settings, &all_pixels(), &picture.scene(&movements)).unwrap();
            for (property, found) in [
                (across, places.iter().map(|place| f(place.x)).collect::<Vec<_>>()),
                (down, places.iter().map(|place| f(place.y)).collect()),
            ] {
                for ((found, expected), sine) in
                    found.iter().zip(picture.properties(property, f(limit))).zip(&sines)
                {
                    let mut off = (found - expected).abs();
                    if property == PictureAngle {
                        // Looking at the light there is no direction; and after 1 follows 0.
                        all += 1;
                        if *sine < 0.05 || expected.is_nan() {
                            continue;
                        }
                        held += 1;
                        off = off.min(1.0 - off);
                    }
                    assert!(!off.is_nan());
                    let error = &mut errors[property as usize];
                    *error = error.max(off);
                }
            }
        }
    }
    assert!(held * 10 > all * 8, "{held} of {all} pixels say where the light lies");
    hold("visibility", errors[0], 1e-6);
    hold("depth", errors[1], 1e-4);
    // The arc cosine loses half the digits at both ends.
    hold("angle to the light", errors[2], 5e-4);
    hold("angle in the picture", errors[3], 1e-4);
}

/// A smooth function: the filter of a sampler has only 8 bits between two texels.
fn smooth_map(random: &mut Random, size: u32) -> Texture {
    let phases: Vec<f64> = (0..12).map(|_| random.between(0.0, 6.3)).collect();
    let values: Vec<f32> = (0..size * size)
        .flat_map(|i| {
            let [x, y] = [i % size, i / size].map(|p| 2.0 * f64::from(p) / f64::from(size));
            let wave =
                |k: usize| 0.5 + 0.5 * (x * phases[k] * 0.5 + y * phases[k + 4] * 0.5 + phases[k + 8]).sin();
            let alpha = wave(3);
            [wave(0) * alpha, wave(1) * alpha, wave(2) * alpha, alpha].map(|v| v as f32)
        })
        .collect();
    gpu::texture([size, size], Rgba16Float, &values)
}

fn restyle(picture: &Synthetic, function: &TransferFunction, map: &Texture) -> Texture {
    let inputs = picture.inputs();
    let restyle = Restyle::new(gpu(), shaders(), function, &inputs, SIZE).unwrap();
    let uniform = Buffer::uniform(gpu(), function);
    let bound = restyle.bind(gpu(), &inputs, &picture.scattered, map, &uniform).unwrap();
    let mut encoder = gpu().encoder();
    restyle.record(&mut encoder, &bound);
    gpu().submit(encoder).unwrap();
    restyle.restyled
}

#[test]
fn every_mode_makes_of_a_colour_what_it_should() {
    let mut random = Random(41);
    let mut error = 0.0_f64;
    for round in 0..24 {
        let picture = Synthetic::new(&mut random);
        let map = smooth_map(&mut random, 32);
        let settings = TransferSettings {
            across: [RayProperty::Visibility, RayProperty::Depth, RayProperty::LightAngle][round % 3],
            down: [RayProperty::Depth, RayProperty::LightAngle, RayProperty::Visibility][round % 3],
            mode: [Mode::Replace, Mode::Light, Mode::Scattering][round / 3 % 3],
            phase: if round % 2 == 0 { Phase::Constant } else { Phase::HenyeyGreenstein },
            strength: if round % 4 == 0 { 1.0 } else { random.unit() as f32 },
            brightness: random.between(0.0, 3.0) as f32,
            g: (round % 5 != 0).then(|| random.between(-0.8, 0.8) as f32),
            ..TransferSettings::default()
        };
        let function = settings.function(&picture.medium);
        let found = texels(&restyle(&picture, &function, &map));
        let (scattered, map) = (texels(&picture.scattered), texels(&map));
        let x = picture.properties(settings.across, f(function.depth_limit));
        let y = picture.properties(settings.down, f(function.depth_limit));
        let angles = picture.properties(RayProperty::LightAngle, 1.0);
        let light = picture.light.radiance.to_array().map(f);
        let mode = match settings.mode {
            Mode::Replace => reference::Mode::Replace,
            Mode::Light => reference::Mode::Light,
            Mode::Scattering => reference::Mode::Scattering,
        };
        let g = (settings.phase == Phase::HenyeyGreenstein).then_some(f(function.g));
        for i in 0..found.len() {
            let color = reference::lookup(&map, 32, [x[i], y[i]]);
            let cosine = (angles[i] * std::f64::consts::PI).cos();
            let of = [f(settings.strength), f(settings.brightness), cosine];
            let radiance = [scattered[i][0], scattered[i][1], scattered[i][2]];
            let of_color = |color| reference::restyled(mode, g, color, of, radiance, light);
            let expected = of_color(color);
            // Errors of the function's colour grow with what it is multiplied by.
            let white = of_color([1.0; 4]);
            for k in 0..3 {
                let scale = 1.0 + white[k] + radiance[k];
                error = error.max((found[i][k] - expected[k]).abs() / scale);
            }
            assert!((found[i][3] - scattered[i][3]).abs() < 1e-6, "visibility stays");
        }
    }
    hold("restyled light", error, 2e-3);
}

#[test]
fn strength_leads_from_one_light_to_the_other() {
    let mut random = Random(43);
    let picture = Synthetic::new(&mut random);
    let map = smooth_map(&mut random, 8);
    let light = |strength: f32| {
        let settings = TransferSettings { strength, ..TransferSettings::default() };
        texels(&restyle(&picture, &settings.function(&picture.medium), &map))
    };
    assert_eq!(light(0.0), texels(&picture.scattered), "without strength nothing changes");
    let (full, half) = (light(1.0), light(0.5));
    let middle: Vec<[f64; 4]> = full
        .iter()
        .zip(texels(&picture.scattered))
        .map(|(a, b)| std::array::from_fn(|i| 0.5 * (a[i] + b[i])))
        .collect();
    hold("halfway", greatest(&half, &middle), 6e-3);
}

#[test]
fn nothing_but_numbers_leaves_the_pass() {
    let mut random = Random(47);
    let wild = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 6e4, -6e4, 0.0];
    for round in 0..12 {
        let mut picture = Synthetic::new(&mut random);
        let pixels = (SIZE[0] * SIZE[1]) as usize;
        let mut any = |count: usize| (0..count).map(|_| wild[random.below(6)]).collect::<Vec<_>>();
        picture.depth = gpu::texture(SIZE, R32Float, &any(pixels));
        picture.scattered = gpu::texture(SIZE, Rgba16Float, &any(4 * pixels));
        let map = gpu::texture([4, 4], Rgba16Float, &any(64));
        picture.light.radiance = Vec3::splat([0.0, 3e38, -3e38][round % 3]);
        picture.buffers[1] = Buffer::uniform(gpu(), &picture.light);
        let function = wild_function(&mut random, round);
        let found = restyle(&picture, &function, &map).read(gpu()).unwrap();
        assert!(found.iter().all(|value| value.is_finite()), "{function:?}");
        // The compute form says the same.
        let pass = Pass::compute(gpu(), shaders(), "stylize/transfer", "default").unwrap();
        let restyled = Texture::storage(gpu(), SIZE, Rgba16Float);
        let (uniform, sampler) = (Buffer::uniform(gpu(), &function), airlight::Sampler::linear(gpu()));
        let inputs = picture.inputs();
        let bound = pass
            .bind(
                gpu(),
                &[
                    ("camera", inputs.camera.into()),
                    ("light", inputs.light.into()),
                    ("transfer_function", (&uniform).into()),
                    ("depth", inputs.depth.into()),
                    ("scattered", (&picture.scattered).into()),
                    ("transfer_map", (&map).into()),
                    ("transfer_sampler", (&sampler).into()),
                    ("restyled", (&restyled).into()),
                ],
            )
            .unwrap();
        let mut encoder = gpu().encoder();
        pass.dispatch(&mut encoder, &bound, [SIZE[0], SIZE[1], 1]);
        gpu().submit(encoder).unwrap();
        assert_eq!(restyled.read(gpu()).unwrap(), found);
    }
}
