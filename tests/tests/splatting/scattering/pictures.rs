// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pictures in scattered light: order, nonsense, and settings that are refused.

use crate::gpu::{gpu, shaders};
use crate::probing::f;
use crate::sheets::{self, colored, metres, shoot, splats};
use airlight::core::{Camera, DepthRange, Light, PerspectiveView};
use airlight::data::cloud;
use airlight::splatting::{
    LightTransport, ScatteringSettings, Shading, SheetFrame, SheetInputs, SheetLighting, SheetPicture,
    SheetSettings, SplattingError,
};
use glam::Vec3;

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
