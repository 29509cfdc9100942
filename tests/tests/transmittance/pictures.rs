// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pictures of volumes that are lit through transmittance maps, against marches in f64, closed forms and energy.

use crate::gpu::{gpu, shaders};
use crate::media::{PIXELS, SIZE, Setting, bounds, lighting, orthographic, perspective, split};
use crate::probing::hold;
use airlight::core::{DepthRange, Reading, VolumeTexture, VolumeTextureError};
use airlight::data::{Volume, burst, cloud};
use airlight::transmittance::{
    Composite, Form, MapSettings, MediumLighting, ParticleBuffer, ParticlePicture, Precision,
    TransmittanceError, TransmittanceMap, VolumePicture,
};
use airlight::validate::Definitions;
use airlight::{Buffer, Pass, Resource, Texture};
use airlight_tests::error::{max_absolute, relative_rmse};
use airlight_tests::reference::phase::henyey_greenstein;
use glam::{Mat4, Vec3};
use std::f64::consts::PI;

fn a_cloud() -> (Volume, Setting) {
    let mut volume = cloud([40, 24, 32], 9);
    volume.world_from_unit = Mat4::from_rotation_y(0.6) * volume.world_from_unit;
    let view = perspective(Vec3::new(4.0, 2.0, 8.0), DepthRange::Forward);
    let setting = Setting::new(&view, Vec3::new(0.5, 0.8, 0.3), bounds(&volume), lighting());
    (volume, setting)
}

/// A cloud under light from above, where most of the map's range is cloud, of an optical depth of 3 and of 10.
#[test]
fn a_cloud_through_maps_is_the_march_in_f64() {
    let thin = [(Form::Extinction, 4, 0.03), (Form::Extinction, 16, 0.015), (Form::Bounded, 4, 0.015)];
    let dense = [(Form::Extinction, 16, 0.015), (Form::Bounded, 8, 0.015)];
    for (density, maps) in [(0.3, &thin[..]), (1.0, &dense[..])] {
        let mut volume = cloud([40, 24, 32], 9);
        volume.values.iter_mut().for_each(|value| *value *= density);
        let view = perspective(Vec3::new(4.0, 2.0, 8.0), DepthRange::Forward);
        let setting = Setting::new(&view, Vec3::Y, bounds(&volume), lighting());
        let (radiance, through) = split(&setting.marched(&volume, true));
        assert!(through.iter().filter(|t| **t < 0.4).count() > 200, "there is no cloud");
        let (brute, seen) = split(&setting.volume(&volume, Reading::Linear, None));
        hold("the shader's reference", relative_rmse(&brute, &radiance), 0.01);
        hold("transmittance to the background", relative_rmse(&seen, &through), 0.002);
        for (form, count, budget) in maps {
            let settings = MapSettings::new(*form, *count, [128, 128]);
            let (found, seen) = split(&setting.volume(&volume, Reading::Linear, Some(settings)));
            hold(&format!("{density}, {form:?} {count}"), relative_rmse(&found, &radiance), *budget);
            hold("the same against the shader's reference", relative_rmse(&found, &brute), *budget);
            hold("transmittance to the background", relative_rmse(&seen, &through), 0.002);
        }
    }
}

/// The same cloud at an optical depth of 10 in a turned box under a slanting light, where it fills half the range and less.
/// Only a bounded map of 8 coefficients and more keeps to 1.5 % there. That the others do not is known: an edge of optical
/// depth 10 within an eighth of the range is beyond four cosines.
#[test]
fn a_dense_cloud_under_a_slanting_light_wants_bounded_maps() {
    let (volume, setting) = a_cloud();
    let (radiance, _) = split(&setting.marched(&volume, true));
    let of = |what: &str, map: Option<MapSettings>| {
        let error = relative_rmse(&split(&setting.volume(&volume, Reading::Linear, map)).0, &radiance);
        println!("{what}: {error:.4}");
        error
    };
    hold("the shader's reference", of("reference", None), 0.01);
    let map = |form, count| of(&format!("{form:?} {count}"), Some(MapSettings::new(form, count, [128, 128])));
    hold("bounded, 8", map(Form::Bounded, 8), 0.015);
    let (four, sixteen) = (map(Form::Extinction, 4), map(Form::Extinction, 16));
    assert!(four > 0.03 && sixteen > 0.015, "no longer a known failure: {four} {sixteen}");
    assert!(sixteen < 0.06 && four < 0.6, "{four} {sixteen}");
}

#[test]
fn surfaces_cut_the_medium_before_any_camera() {
    let (volume, _) = a_cloud();
    let views = [
        perspective(Vec3::new(1.0, 3.0, 7.0), DepthRange::Reversed),
        orthographic(Vec3::new(-4.0, 3.0, 8.0), 6.0, DepthRange::Forward),
        orthographic(Vec3::new(-4.0, -3.0, 8.0), 6.0, DepthRange::Reversed),
        // Within the medium.
        perspective(Vec3::new(0.3, 0.2, 0.4), DepthRange::Forward),
    ];
    for view in views {
        let mut setting = Setting::new(&view, Vec3::new(-0.5, 0.8, 0.3), bounds(&volume), lighting());
        let whole = setting.volume(&volume, Reading::Linear, None);
        let middle = setting.camera.clip_from_world * Vec3::new(-0.2, -0.2, 0.1).extend(1.0);
        for (i, depth) in setting.depth.iter_mut().enumerate() {
            if i % 64 < 40 {
                *depth = middle.z / middle.w;
            }
        }
        let found = setting.volume(&volume, Reading::Linear, None);
        assert_eq!(found[160..256], whole[160..256]);
        let (radiance, through) = split(&found);
        let (expected, left) = split(&setting.marched(&volume, true));
        hold("radiance", relative_rmse(&radiance, &expected), 0.015);
        hold("transmittance", relative_rmse(&through, &left), 0.01);
        let cut = relative_rmse(&through, &split(&whole).1);
        assert!(cut > 0.05, "the surface cuts nothing: {cut}");
        // Steps of a voxel do not meet the faces of voxels.
        let (nearest, _) = split(&setting.volume(&volume, Reading::Nearest, None));
        let (expected, _) = split(&setting.marched(&volume, false));
        hold("nearest voxels", relative_rmse(&nearest, &expected), 0.1);
    }
}

#[test]
fn an_even_box_is_its_closed_form() {
    let extinction = 0.8_f64;
    let values = vec![extinction as f32; 512];
    let space = Mat4::from_translation(Vec3::NEG_ONE) * Mat4::from_scale(Vec3::splat(2.0));
    let volume = Volume::new([8; 3], values, space).unwrap();
    let view = orthographic(Vec3::new(0.0, 0.0, 5.0), 1.9, DepthRange::Forward);
    let setting = Setting::new(&view, Vec3::Y, bounds(&volume), lighting());
    let phase = henyey_greenstein(0.0, 0.4);
    for (map, budget) in [(None, 1e-3), (Some(MapSettings::new(Form::Bounded, 4, [256, 256])), 5e-3)] {
        let found = setting.volume(&volume, Reading::Nearest, map);
        let mut worst = 0.0_f64;
        for (i, pixel) in found.chunks_exact(4).enumerate() {
            // Across the middle, where rays enter by the front.
            if (10..54).contains(&(i % 64)) {
                let below = 1.0 - 0.95 * (1.0 - 2.0 * ((i / 64) as f64 + 0.5) / 48.0);
                let through = (-2.0 * extinction).exp();
                let lit = (-extinction * below).exp() * (1.0 - through) * phase;
                worst = worst.max((f64::from(pixel[0]) / (f64::from(0.95_f32) * 3.0 * lit) - 1.0).abs());
                worst = worst.max((f64::from(pixel[3]) / through - 1.0).abs());
            }
        }
        hold(&format!("{map:?}"), worst, budget);
    }
}

/// Thin, of albedo 1 and without preference: over the sphere it sends what it takes from the light.
#[test]
fn a_thin_medium_scatters_what_it_takes() {
    let mut volume = cloud([20, 12, 16], 3);
    let voxel: f64 = volume.world_from_unit.determinant().abs().into();
    let voxel = voxel / f64::from(20 * 12 * 16);
    volume.values.iter_mut().for_each(|value| *value *= 1e-3);
    let taken = 3.0 * voxel * volume.values.iter().map(|v| f64::from(*v)).sum::<f64>();
    let scatters = MediumLighting::new(Vec3::ONE, 0.0, 100.0).unwrap();
    for eye in [Vec3::new(0.0, 0.0, 9.0), Vec3::new(5.0, 6.0, -3.0)] {
        let view = orthographic(eye, 8.0, DepthRange::Forward);
        let setting = Setting::new(&view, Vec3::new(0.3, 1.0, 0.2), bounds(&volume), scatters);
        let pixel = (8.0 / 48.0_f64).powi(2);
        for map in [None, Some(MapSettings::new(Form::Extinction, 4, [64, 64]))] {
            let found = setting.volume(&volume, Reading::Linear, map);
            let sent: f64 = found.chunks_exact(4).map(|p| f64::from(p[0]) * pixel * 4.0 * PI).sum();
            hold("power sent over power taken, less one", (sent / taken - 1.0).abs(), 0.01);
        }
    }
}

#[test]
fn wild_values_and_depths_give_finite_pictures() {
    let (mut volume, mut setting) = a_cloud();
    for (i, value) in volume.values.iter_mut().enumerate().step_by(7) {
        *value = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -3e38, 60000.0][i / 7 % 5];
    }
    setting.depth[..64].fill(f32::NAN);
    for map in [None, Some(MapSettings::new(Form::Extinction, 4, [32, 32]))] {
        for reading in [Reading::Linear, Reading::Nearest] {
            let picture = setting.volume(&volume, reading, map);
            assert!(picture.iter().all(|v| v.is_finite()) && picture.iter().any(|v| *v > 0.01));
        }
    }
}

#[test]
fn compute_is_the_same_picture_and_it_goes_over_a_background() {
    let (volume, setting) = a_cloud();
    let drawn = setting.volume(&volume, Reading::Linear, None);
    let uploaded = VolumeTexture::new(gpu(), &volume, 1.0, Reading::Linear).unwrap();
    let definitions = Definitions::new().flag("REFERENCE").flag("LINEAR");
    let pass = Pass::compute_with(gpu(), shaders(), "transmittance/march_volume", &definitions).unwrap();
    let picture = Texture::storage(gpu(), SIZE, wgpu::TextureFormat::Rgba16Float);
    let (light, sampler) = (Buffer::uniform(gpu(), &setting.light), airlight::Sampler::linear(gpu()));
    setting.with(|view| {
        let resources: [(&str, Resource<'_>); 9] = [
            ("camera", view.camera.into()),
            ("light", (&light).into()),
            ("lighting", view.lighting.into()),
            ("volume", (&uploaded.space).into()),
            ("extinction", (&uploaded.texture).into()),
            ("volume_sampler", (&sampler).into()),
            ("brick_distances", (&uploaded.brick_distances).into()),
            ("depth", view.depth.into()),
            ("picture", (&picture).into()),
        ];
        let bound = pass.bind(gpu(), &resources).unwrap();
        let mut encoder = gpu().encoder();
        pass.dispatch(&mut encoder, &bound, [SIZE[0], SIZE[1], 1]);
        gpu().submit(encoder).unwrap();
    });
    let computed = picture.read(gpu()).unwrap();
    hold("compute against fragment", max_absolute(&computed, &drawn), 1e-3);
    let surface = Texture::storage(gpu(), SIZE, wgpu::TextureFormat::Rgba16Float);
    surface.write(gpu(), &[0.5, f32::NAN, 2.0, 1.0].repeat(PIXELS)).unwrap();
    let over = Composite::new(gpu(), shaders()).unwrap().run(gpu(), &surface, &picture).unwrap();
    for (found, pixel) in over.read(gpu()).unwrap().chunks_exact(4).zip(computed.chunks_exact(4)) {
        for (i, behind) in [0.5, 0.0, 2.0].into_iter().enumerate() {
            let expected = pixel[i] + pixel[3] * behind;
            assert!((found[i] - expected).abs() <= 1e-3 * expected + 1e-6, "{found:?} {pixel:?}");
        }
    }
}

#[test]
fn impossible_pictures_are_errors() {
    for (albedo, g, limit, name) in [
        (1.1, 0.0, 10.0, "albedo"),
        (f32::NAN, 0.0, 10.0, "albedo"),
        (0.5, 1.0, 10.0, "g"),
        (0.5, 0.0, 0.0, "distance limit"),
        (0.5, 0.0, f32::INFINITY, "distance limit"),
    ] {
        let error = MediumLighting::new(Vec3::splat(albedo), g, limit).unwrap_err();
        assert!(error.to_string().starts_with(name), "{error}");
    }
    let (volume, setting) = a_cloud();
    let settings =
        MapSettings { precision: Precision::Half, ..MapSettings::new(Form::Extinction, 4, [8, 8]) };
    let map = TransmittanceMap::new(gpu(), settings, &setting.light).unwrap();
    let [nearest, linear] = [Reading::Nearest, Reading::Linear]
        .map(|reading| VolumeTexture::new(gpu(), &volume, 1.0, reading).unwrap());
    let lit = VolumePicture::new(gpu(), shaders(), settings, true, Reading::Linear).unwrap();
    let reference = VolumePicture::reference(gpu(), shaders(), Reading::Linear).unwrap();
    let other = MapSettings { coefficients: 8, ..settings };
    let eight = VolumePicture::new(gpu(), shaders(), other, false, Reading::Linear).unwrap();
    let particles = ParticlePicture::new(gpu(), shaders(), other, false).unwrap();
    let buffer = ParticleBuffer::new(gpu(), &burst(3, 1)).unwrap();
    setting.with(|view| {
        use TransmittanceError as E;
        assert!(lit.bind(gpu(), view, &map, &linear).is_ok());
        assert!(matches!(lit.bind(gpu(), view, &map, &nearest), Err(E::Volume(VolumeTextureError::Filter))));
        assert!(matches!(eight.bind(gpu(), view, &map, &linear), Err(E::OtherMap { .. })));
        assert!(matches!(particles.bind(gpu(), view, &map, &buffer), Err(E::OtherMap { .. })));
        assert!(matches!(reference.bind(gpu(), view, &map, &linear), Err(E::Reference(_))));
        assert!(matches!(lit.bind_reference(gpu(), view, &map.light, &linear), Err(E::Reference(_))));
    });
}
