// SPDX-License-Identifier: MIT OR Apache-2.0
//! Wild voxels, thin volumes, nothing solid, other forms of the pass, and surfaces that are refused.

use super::cameras::inside;
use crate::gpu::{gpu, shaders};
use crate::probing::hold;
use crate::surfaces::{PLAIN, SIZE, Setting, hits_are_crossings, view_of};
use airlight::core::{Jitter, Transfer, TransferError};
use airlight::data::{Volume, sphere_field, torus_field};
use airlight::painterly::{IsoForm, IsoRaycast, IsoSettings, IsoVolume, PainterlyError, SurfaceLighting};
use airlight_tests::error::max_absolute;
use glam::{Mat4, Vec3, Vec4};

#[test]
fn wild_and_thin_volumes_give_finite_pictures() {
    let volume = torus_field([40; 3], 0.55, 0.2);
    let view = view_of(&volume, Vec3::new(0.5, 0.4, 1.0));
    let mut wild = volume.clone();
    for (i, value) in wild.values.iter_mut().enumerate().step_by(97) {
        *value = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -3e38, 60000.0][i / 97 % 5];
    }
    let mut setting = Setting::new(wild.clone(), &view);
    // By the host, which replaces them; then as an engine might leave them to the pass.
    let seen = setting.seen(PLAIN);
    seen.check();
    assert!(seen.hits() > 100);
    setting.volume = volume.clone();
    let uploaded = setting.uploaded();
    let texels: Vec<f32> = wild.values.iter().map(|value| value * 2.0 - 1.0).collect();
    uploaded.texture.write(gpu(), &texels).unwrap();
    let seen = setting.seen_of(&uploaded, PLAIN);
    seen.check();
    assert!(seen.hits() > 100);
    // Where nothing is finite there is texel 0 throughout, which is value 0.5.
    for wild in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        uploaded.texture.write(gpu(), &vec![wild; texels.len()]).unwrap();
        for (iso_value, box_is_seen) in [(0.45, true), (0.55, false)] {
            setting.settings.iso_value = iso_value;
            let seen = setting.seen_of(&uploaded, PLAIN);
            seen.check();
            assert_eq!(seen.hits() > 2000, box_is_seen, "{wild} {iso_value} {}", seen.hits());
        }
    }
    for size in [[1, 20, 20], [20, 1, 1], [1, 1, 1], [20, 20, 1]] {
        let voxels = size.iter().product::<u32>();
        let values =
            (0..voxels).map(|i| (i % 20) as f32 / 19.0 + if voxels == 1 { 1.0 } else { 0.0 }).collect();
        let volume = Volume::new(size, values, volume.world_from_unit).unwrap();
        let setting = Setting::new(volume.clone(), &view);
        hits_are_crossings(&format!("{size:?}"), &setting, &setting.seen(PLAIN));
    }
}

#[test]
fn nothing_solid_is_an_empty_picture() {
    let volume = sphere_field([24; 3], 0.7);
    let mut setting = Setting::new(volume.clone(), &view_of(&volume, Vec3::new(0.5, 0.4, 1.0)));
    setting.table = vec![[1.0, 1.0, 1.0, 0.4]; 3];
    let seen = setting.seen(PLAIN);
    seen.check();
    assert_eq!(seen.hits(), 0);
    let transfer = Transfer::new(gpu(), &setting.table).unwrap();
    assert!(!transfer.is_solid_anywhere(0.5) && transfer.is_solid_anywhere(0.25));
    // Everything solid: the box.
    setting.settings.iso_value = 0.25;
    hits_are_crossings("box", &setting, &setting.seen(PLAIN));
    // The volume behind the eye.
    let back = inside(Vec3::new(0.0, 0.0, 4.0), Vec3::new(0.0, 0.0, 5.0));
    assert_eq!(Setting::new(volume, &back).seen(PLAIN).hits(), 0);
}

#[test]
fn other_forms_see_the_same() {
    let volume = torus_field([40; 3], 0.55, 0.2);
    let mut setting = Setting::new(volume.clone(), &view_of(&volume, Vec3::new(0.5, 0.4, 1.0)));
    setting.lighting.specular = 0.6;
    let plain = setting.seen(PLAIN);
    let alone = setting.seen(IsoForm { distance_only: true, ..PLAIN });
    assert_eq!(alone.distance, plain.distance);
    let deferred = setting.seen(IsoForm { deferred: true, ..PLAIN });
    assert_eq!(
        (&deferred.surface, &deferred.flow, &deferred.distance),
        (&plain.surface, &plain.flow, &plain.distance)
    );
    hold("deferred light", max_absolute(&deferred.color, &plain.color), 0.01);
    for jitter in [Jitter::Gradient, Jitter::BlueNoise] {
        setting.frame.number = 3;
        let jittered = setting.seen(IsoForm { jitter, ..PLAIN });
        assert_ne!(jittered.distance, plain.distance);
        hits_are_crossings(&format!("{jitter:?}"), &setting, &jittered);
        setting.frame.number = 4;
        assert_ne!(setting.seen(IsoForm { jitter, ..PLAIN }).distance, jittered.distance);
    }
}

#[test]
fn impossible_surfaces_are_errors() {
    use PainterlyError as E;
    use TransferError as T;
    for (settings, name) in [
        (IsoSettings { iso_value: 0.0, ..IsoSettings::default() }, "iso-value"),
        (IsoSettings { iso_value: f32::NAN, ..IsoSettings::default() }, "iso-value"),
        (IsoSettings { steps_per_voxel: 100.0, ..IsoSettings::default() }, "steps"),
        (IsoSettings { refinements: 40, ..IsoSettings::default() }, "refinements"),
        (IsoSettings { distance_limit: f32::INFINITY, ..IsoSettings::default() }, "distance limit"),
        (IsoSettings { clip_planes: vec![Vec4::W], ..IsoSettings::default() }, "length"),
        (IsoSettings { clip_planes: vec![Vec4::X; 9], ..IsoSettings::default() }, "9 clip planes"),
    ] {
        let error = settings.check().unwrap_err();
        assert!(error.to_string().starts_with(name), "{error}");
    }
    assert!(matches!(SurfaceLighting::towards(Vec3::ZERO), Err(E::Setting(_))));
    let dark = SurfaceLighting { ambient: Vec3::splat(-0.1), ..SurfaceLighting::towards(Vec3::Y).unwrap() };
    assert!(dark.check().unwrap_err().to_string().starts_with("ambient"));
    let transfer = |table: &[[f32; 4]]| Transfer::new(gpu(), table).err().unwrap();
    assert!(matches!(transfer(&[[0.0; 4]]), T::Entries { given: 1, .. }));
    assert!(matches!(transfer(&vec![[0.0; 4]; 10000]), T::Entries { .. }));
    assert!(matches!(transfer(&[[0.0; 4], [0.0, 0.0, 0.0, 1.5]]), T::Entry { entry: 1, .. }));
    assert!(matches!(transfer(&[[f32::NAN, 0.0, 0.0, 0.0], [0.0; 4]]), T::Entry { entry: 0, .. }));
    let volume = sphere_field([4; 3], 0.5);
    let refused = |range| IsoVolume::new(gpu(), &volume, Some(range)).err().unwrap();
    assert!(matches!(refused([1.0, 1.0]), E::Range(..)) && matches!(refused([0.0, f32::NAN]), E::Range(..)));
    let long = Volume::new([3000, 1, 1], vec![0.0; 3000], Mat4::IDENTITY).unwrap();
    let error = IsoVolume::new(gpu(), &long, None).err().unwrap();
    assert!(matches!(error, E::Volume(_)) && error.to_string().contains("2048"), "{error}");
    let mut setting = Setting::new(volume.clone(), &view_of(&volume, Vec3::ONE));
    let (uploaded, transfer) = (setting.uploaded(), Transfer::new(gpu(), &setting.table).unwrap());
    let pass = IsoRaycast::new(gpu(), shaders(), PLAIN).unwrap();
    assert!(matches!(pass.bind(gpu(), &uploaded, &transfer, [0, 4]), Err(E::Size { .. })));
    let bound = pass.bind(gpu(), &uploaded, &transfer, SIZE).unwrap();
    let mut set = |matrix| {
        setting.frame.world_from_unit = matrix;
        pass.set(gpu(), &bound, &uploaded, &setting.frame, &setting.settings, &setting.lighting)
    };
    assert!(set(Mat4::IDENTITY).is_ok());
    assert!(matches!(set(Mat4::ZERO), Err(E::Space)) && matches!(set(Mat4::NAN), Err(E::Space)));
}
