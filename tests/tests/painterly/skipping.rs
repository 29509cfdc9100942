// SPDX-License-Identifier: MIT OR Apache-2.0
//! Passing over bricks in which nothing is solid changes no bit of any target, and bricks are those of f64.

use crate::gpu::{Random, gpu, shaders};
use crate::surfaces::{PLAIN, Setting, head, parallel_view_of, view_of};
use airlight::core::{DepthRange, Jitter, PerspectiveView};
use airlight::data::{Volume, marschner_lobb, torus_field};
use airlight::painterly::{BrickRanges, IsoForm, IsoVolume, SolidBricks};
use airlight_tests::reference::painterly::classify;
use glam::{Mat4, Vec3, Vec4};

fn ranges(volume: &IsoVolume) -> BrickRanges {
    let mut encoder = gpu().encoder();
    let solid = SolidBricks::new(gpu(), shaders()).unwrap();
    let ranges = solid.ranges(gpu(), &mut encoder, volume).unwrap();
    gpu().submit(encoder).unwrap();
    ranges
}

/// A transfer function of some peaks, and an iso-value that most of them reach.
fn random_transfer(random: &mut Random) -> (Vec<[f32; 4]>, f32) {
    let entries = [2, 3, 8, 17, 64, 256, 301, 1024][random.below(8)];
    let mut table = vec![[0.8_f32, 0.6, 0.4, 0.0]; entries];
    for _ in 0..1 + random.below(4) {
        let (middle, width) = (random.unit(), random.magnitude(0.002, 0.3));
        let height = random.between(0.2, 1.0);
        for (i, entry) in table.iter_mut().enumerate() {
            let away = (i as f64 / (entries - 1) as f64 - middle).abs() / width;
            entry[3] = entry[3].max((height * (1.0 - away)) as f32);
        }
    }
    (table, random.between(0.05, 0.95) as f32)
}

/// Bricks that must be solid and those that may be, in f64: dense samples of opacity over the range of each.
fn bricks_in_f64(setting: &Setting, volume: &IsoVolume) -> Vec<(bool, bool)> {
    let texels = volume.texture.read(gpu()).unwrap();
    let table: Vec<_> =
        setting.table.iter().map(|entry| entry.map(|v| f64::from(half::f16::from_f32(v)))).collect();
    let size = volume.size.map(|side| side as usize);
    let count = size.map(|side| side.div_ceil(8));
    let mut bricks = Vec::new();
    for k in 0..count[0] * count[1] * count[2] {
        let brick = [k % count[0], k / count[0] % count[1], k / count[0] / count[1]];
        let span = |a: usize| (8 * brick[a]).saturating_sub(1)..(8 * brick[a] + 9).min(size[a]);
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for z in span(2) {
            for y in span(1) {
                for x in span(0) {
                    let texel = f64::from(texels[(z * size[1] + y) * size[0] + x]);
                    let value = texel * f64::from(volume.scale) + f64::from(volume.offset);
                    (low, high) = (low.min(value), high.max(value));
                }
            }
        }
        let samples = 2500;
        let greatest = |low: f64, high: f64| {
            let opacity = |i: usize| classify(&table, low + (high - low) * i as f64 / samples as f64)[3];
            (0..=samples).map(opacity).fold(0.0, f64::max)
        };
        let iso = f64::from(setting.settings.iso_value);
        bricks.push((greatest(low, high) >= iso, greatest(low - 1e-4, high + 1e-4) >= iso - 0.01));
    }
    bricks
}

/// Over transfer functions and iso-values, the ranges of bricks found once.
fn skipping_changes_nothing(
    what: &str,
    setting: &mut Setting,
    rounds: usize,
    form: IsoForm,
    random: &mut Random,
) {
    let volume = setting.uploaded();
    let ranges = ranges(&volume);
    let (mut skipped, mut all, mut hits) = (0, 0, 0);
    for round in 0..rounds {
        (setting.table, setting.settings.iso_value) = random_transfer(random);
        let (found, distances) =
            setting.seen_with(&volume, IsoForm { skipping: true, ..form }, Some(&ranges));
        let plain = setting.seen_of(&volume, form);
        assert_eq!(found.hits(), plain.hits(), "{what}, round {round}");
        assert!(found == plain, "{what}, round {round}: targets differ");
        for (k, ((must, may), distance)) in
            bricks_in_f64(setting, &volume).into_iter().zip(&distances).enumerate()
        {
            assert!(!must || *distance == 0, "{what}, round {round}: brick {k} is solid");
            assert!(may || *distance > 0, "{what}, round {round}: brick {k} is empty");
        }
        skipped += distances.iter().filter(|distance| **distance > 0).count();
        all += distances.len();
        hits += plain.hits();
    }
    println!("{what}: {skipped} of {all} bricks empty, {hits} hits");
    assert!(
        skipped * 10 > all && hits > 100 * rounds,
        "{what}: {skipped} of {all} bricks empty, {hits} hits"
    );
}

#[test]
fn skipping_changes_no_bit() {
    let mut random = Random(4242);
    let eye = Vec3::new(0.5, 0.4, 1.0);
    let volumes =
        [("Marschner-Lobb", marschner_lobb([61, 64, 43])), ("torus", torus_field([40, 72, 19], 0.55, 0.2))];
    for (what, volume) in volumes {
        let mut turned = volume.clone();
        turned.world_from_unit = Mat4::from_rotation_y(0.3) * volume.world_from_unit;
        let mut setting = Setting::new(turned.clone(), &view_of(&turned, eye));
        skipping_changes_nothing(what, &mut setting, 10, PLAIN, &mut random);
        // Rays along an axis, on the faces of bricks or beside them; jittered; cut; from within.
        let straight = parallel_view_of(&volume, Vec3::Z, DepthRange::Forward);
        let mut setting = Setting::new(volume.clone(), &straight);
        skipping_changes_nothing(what, &mut setting, 6, PLAIN, &mut random);
        let jitter = IsoForm { jitter: Jitter::Gradient, ..PLAIN };
        setting.settings.clip_planes = vec![Vec4::new(0.3, 0.2, -1.0, 0.2)];
        skipping_changes_nothing(what, &mut setting, 6, jitter, &mut random);
        let within = PerspectiveView {
            eye: Vec3::new(0.05, 0.0, 0.1),
            target: Vec3::X,
            field_of_view: 80.0,
            near: 0.01,
            far: 10.0,
            depth: DepthRange::Forward,
        };
        let mut setting = Setting::new(volume, &within.into());
        setting.settings.steps_per_voxel = 1.3;
        skipping_changes_nothing(what, &mut setting, 6, PLAIN, &mut random);
    }
    let volume = head();
    let mut setting = Setting::new(volume.clone(), &view_of(&volume, Vec3::new(-0.6, 0.3, 1.0)));
    setting.range = None;
    skipping_changes_nothing("head", &mut setting, 3, PLAIN, &mut random);
}

/// Texels that are not finite count as 0, which may be what is solid.
#[test]
fn wild_texels_are_not_passed_over() {
    let volume =
        Volume::new([40; 3], vec![0.0; 64000], torus_field([1; 3], 0.5, 0.2).world_from_unit).unwrap();
    let mut setting = Setting::new(volume.clone(), &view_of(&volume, Vec3::new(0.5, 0.4, 1.0)));
    let uploaded = setting.uploaded();
    let mut texels = vec![-1.0; 64000];
    for (i, texel) in texels.iter_mut().enumerate().step_by(1009) {
        *texel = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY][i / 1009 % 3];
    }
    uploaded.texture.write(gpu(), &texels).unwrap();
    let ranges = ranges(&uploaded);
    setting.table = vec![[1.0, 1.0, 1.0, 0.0], [1.0; 4], [1.0, 1.0, 1.0, 0.0]];
    setting.settings.iso_value = 0.9;
    let form = IsoForm { skipping: true, ..PLAIN };
    let (found, distances) = setting.seen_with(&uploaded, form, Some(&ranges));
    found.check();
    assert!(found == setting.seen_of(&uploaded, PLAIN) && found.hits() > 100, "{}", found.hits());
    assert!(distances.iter().any(|distance| *distance > 0));
    // Without ranges nothing is passed over.
    assert!(found == setting.seen_of(&uploaded, form));
}

#[test]
fn nothing_solid_passes_over_everything() {
    let volume = torus_field([40; 3], 0.5, 0.2);
    let mut setting = Setting::new(volume.clone(), &view_of(&volume, Vec3::ONE));
    setting.table = vec![[1.0, 1.0, 1.0, 0.3]; 5];
    let uploaded = setting.uploaded();
    let form = IsoForm { skipping: true, ..PLAIN };
    let (seen, distances) = setting.seen_with(&uploaded, form, Some(&ranges(&uploaded)));
    assert!(seen.hits() == 0 && distances.iter().all(|distance| *distance == 4096));
}
