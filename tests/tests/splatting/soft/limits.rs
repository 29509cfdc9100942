// SPDX-License-Identifier: MIT OR Apache-2.0
//! A light that is a point, nonsense, and lights that are refused.

use super::half_planes::corners;
use super::lights::{lamp, sun};
use crate::gpu::{gpu, shaders};
use crate::probing::f;
use crate::sheets::{self, colored, metres, parallel, shoot, splats};
use crate::soft_light::Lit;
use airlight::core::Light;
use airlight::data::cloud;
use airlight::splatting::{
    LightTransport, SheetFrame, SheetInputs, SheetLighting, SheetPicture, SheetSettings, SoftShadows, Splats,
    SplattingError,
};
use glam::Vec3;

#[test]
fn a_point_of_light_casts_hard_shadows() {
    let mut volume = cloud([24, 14, 20], 5);
    volume.values.iter_mut().for_each(|value| *value /= 3.0);
    let bounds = volume.bounds();
    let splats = splats(&volume);
    let transfer = colored([Vec3::ONE, Vec3::new(0.9, 0.5, 0.2)]);
    for degrees in [35.0_f32, 140.0] {
        let angle = degrees.to_radians();
        let way = Vec3::new(angle.sin(), -0.2, -angle.cos()).normalize();
        let view = Vec3::NEG_Z;
        let margin = 0.05 * (bounds.max - bounds.min).max_element();
        let light = Light::directional(-way, Vec3::ONE, bounds.min - margin, bounds.max + margin).unwrap();
        let height = 1.2 * (bounds.max - bounds.min).max_element();
        let frame =
            SheetFrame { camera: parallel(view, height, 40), light, lighting: SheetLighting::new(4.0) };
        let settings = SheetSettings { count: 32, light_size: [128; 2], ..SheetSettings::default() };
        let hard = shoot(&splats, &transfer, settings, &frame);
        let shot = |size: f32| {
            let transport = LightTransport::Soft(SoftShadows::new(size));
            shoot(&splats, &transfer, SheetSettings { transport, ..settings }, &frame)
        };
        let error = |soft: &sheets::Shot| {
            let pairs = hard.picture.iter().zip(&soft.picture).filter(|(a, _)| **a < 0.9999);
            let (squares, all) =
                pairs.fold((0.0, 0.0), |(s, a), (x, y)| (s + f(x - y).powi(2), a + f(*x).powi(2)));
            (squares / all).sqrt()
        };
        let (none, some) = (error(&shot(0.0)), error(&shot(20.0)));
        println!("light at {degrees}: a point of light is off by {none:.5}, one of 20 degrees by {some:.4}");
        assert!(none < 0.01 && some > 2.0 * none, "{degrees}: {none} {some}");
    }
}

#[test]
fn nonsense_leaves_no_hole() {
    let wild = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 3e38, -3e38, 1e30, -1e30, 0.0];
    for light in [sun(Vec3::Y), lamp(Vec3::Y * 6.0)] {
        for size in [0.0, if light.kind == 0 { 60.0 } else { 1e6 }] {
            let lit = Lit::new(light, Vec3::new(0.0, -0.5, 0.8), 40, &corners(), 40, &SoftShadows::new(size));
            let first = (0..1600).map(|i| wild[(i * 7) % 8]).collect();
            let last = (0..1600).map(|i| wild[(i * 5 + i / 40) % 8]).collect();
            for pictures in lit.shadows(&[first, last], &[0, 17, 39]) {
                let sound = |share: &f32| (0.0..=1.0).contains(share);
                assert!(pictures.iter().flatten().all(sound), "{light:?} {size}");
            }
        }
    }
    let mut volume = cloud([12, 14, 10], 5);
    for (place, value) in [f32::NAN, f32::INFINITY, -1.0, 3e38].into_iter().enumerate() {
        volume.values[700 + place] = value;
    }
    let splats = splats(&volume);
    for extinction in [0.0, 1e6] {
        let transport = LightTransport::Soft(SoftShadows::new(30.0));
        let settings =
            SheetSettings { count: 20, light_size: [40; 2], transport, ..SheetSettings::default() };
        let lighting = SheetLighting::new(extinction);
        let frame = SheetFrame { camera: parallel(Vec3::NEG_Z, 3.0, 16), light: sun(Vec3::X), lighting };
        assert!(shoot(&splats, &colored([Vec3::ONE; 2]), settings, &frame).is_sound());
    }
}

#[test]
fn impossible_lights_are_refused() {
    let splats = Splats::new(gpu(), shaders(), &metres([4; 3], |_| 0.5), 0.0, None).unwrap();
    let transfer = colored([Vec3::ONE; 2]);
    let new = |soft: SoftShadows, side: u32| {
        let transport = LightTransport::Soft(soft);
        let settings =
            SheetSettings { count: 8, light_size: [side; 2], transport, ..SheetSettings::default() };
        let inputs = SheetInputs::new(std::slice::from_ref(&splats), &transfer);
        SheetPicture::new(gpu(), shaders(), inputs, settings, [8; 2])
    };
    let set = |soft: SoftShadows, light: Light| {
        let frame =
            SheetFrame { camera: parallel(Vec3::NEG_Z, 9.0, 8), light, lighting: SheetLighting::new(1.0) };
        new(soft, 16).unwrap().set(gpu(), &frame).map(|_| ())
    };
    assert!(matches!(new(SoftShadows::new(1.0), 6000), Err(SplattingError::Setting(_))));
    for soft in [
        SoftShadows::new(-1.0),
        SoftShadows::new(f32::NAN),
        SoftShadows::new(61.0),
        SoftShadows { filling: f32::NAN, ..SoftShadows::new(1.0) },
        SoftShadows { deepest: -1.0, ..SoftShadows::new(1.0) },
    ] {
        assert!(matches!(set(soft, sun(Vec3::Y)), Err(SplattingError::Setting(_))), "{soft:?}");
    }
    assert!(set(SoftShadows::new(1.0), sun(Vec3::Y)).is_ok());
    assert!(set(SoftShadows::new(61.0), lamp(Vec3::Y * 20.0)).is_ok());
    for place in [Vec3::ZERO, Vec3::Y * 2.0, Vec3::splat(f32::MAX)] {
        let light = Light { position: place, ..lamp(Vec3::Y) };
        assert!(
            matches!(set(SoftShadows::new(1.0), light), Err(SplattingError::LightBehind { .. })),
            "{place}"
        );
    }
}
