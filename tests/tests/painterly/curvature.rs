// SPDX-License-Identifier: MIT OR Apache-2.0
//! Principal curvatures of surfaces in volumes, against closed forms of spheres, tori, cylinders, planes and saddles.

use crate::bending::{CURVED, bends, boxes, field, hold_curvatures, hold_directions};
use crate::gpu::{gpu, shaders};
use crate::probing::hold;
use crate::surfaces::{self, PLAIN, Setting, parallel_view_of, view_of};
use airlight::core::{DepthRange, PerspectiveView, View};
use airlight::data::Volume;
use airlight::painterly::{IsoForm, SolidBricks};
use airlight_tests::linear::Vec3 as Point;
use airlight_tests::reference::painterly::principal_curvatures;
use glam::{Mat4, Vec3};

#[test]
fn spheres_bend_by_their_radius_in_any_box() {
    let radius = 0.6;
    for (what, size, world_from_unit) in boxes() {
        let volume = field(size, world_from_unit, |p| 0.5 - 0.5 * (p.length() - radius));
        let setting = Setting::new(volume.clone(), &view_of(&volume, Vec3::new(0.5, 0.4, 1.0)));
        let found = bends(&setting, CURVED);
        hold_curvatures(&format!("sphere, {what}"), &found, |_| [1.0 / radius; 2]);
        // Alike all around: no direction. Half floats leave a trace.
        let directed = found.iter().filter(|bend| bend.double != [0.0; 2]).count() as f64;
        hold("share with a direction", directed / found.len() as f64, 0.02);
    }
}

#[test]
fn curvatures_are_in_metres() {
    for (metre, radius) in [(1e-3_f32, 0.6e-3_f64), (500.0, 300.0)] {
        let volume = field([72; 3], Mat4::from_scale(Vec3::splat(metre)) * boxes()[0].2, |p| {
            0.5 - 0.5 * (p.length() - radius) / f64::from(metre)
        });
        let setting = Setting::new(volume.clone(), &view_of(&volume, Vec3::new(0.5, 0.4, 1.0)));
        hold_curvatures("sphere of another size", &bends(&setting, CURVED), |_| [1.0 / radius; 2]);
    }
}

/// A torus about the z axis: curvatures at a point, and direction around its tube, which is that of the greater.
fn torus(major: f64, minor: f64) -> (impl Fn(Point) -> [f64; 2], impl Fn(Point) -> Point) {
    let away = move |p: Point| (p.x.hypot(p.y) - major, p.z);
    let curvatures = move |p: Point| {
        let (out, up) = away(p);
        [1.0 / minor, out / out.hypot(up) / p.x.hypot(p.y)]
    };
    let around = move |p: Point| {
        let (out, up) = away(p);
        let ring = p.x.hypot(p.y);
        Point::new(-up * p.x / ring, -up * p.y / ring, out).normalised()
    };
    (curvatures, around)
}

#[test]
fn tori_bend_as_they_should_in_any_box() {
    let (major, minor) = (0.58, 0.27);
    let (curvatures, around) = torus(major, minor);
    for (i, (what, size, world_from_unit)) in boxes().into_iter().enumerate() {
        let volume =
            field(size, world_from_unit, |p| 0.5 - 0.5 * ((p.x.hypot(p.y) - major).hypot(p.z) - minor));
        let eye = Vec3::new(0.5, 0.4, 1.0);
        let view =
            if i == 1 { parallel_view_of(&volume, eye, DepthRange::Reversed) } else { view_of(&volume, eye) };
        let setting = Setting::new(volume.clone(), &view);
        let found = bends(&setting, CURVED);
        hold_curvatures(&format!("torus, {what}"), &found, &curvatures);
        let shown = hold_directions(&format!("torus, {what}"), &setting, &found, &around);
        assert!(shown > found.len() * 9 / 10, "{shown} of {}", found.len());
    }
}

#[test]
fn cylinders_bend_around_their_axis() {
    let axis = Point::new(0.5, 1.0, -0.3).normalised();
    let radius = 0.5;
    let out = |p: Point| p.without(axis);
    for (what, size, world_from_unit) in boxes() {
        let volume = field(size, world_from_unit, |p| 0.5 - 0.5 * (out(p).length() - radius));
        let setting = Setting::new(volume.clone(), &view_of(&volume, Vec3::new(0.8, 0.3, 0.7)));
        let found: Vec<_> = bends(&setting, CURVED)
            .into_iter()
            .filter(|bend| (out(bend.point).length() - radius).abs() < 0.1 * setting.voxel())
            .collect();
        hold_curvatures(&format!("cylinder, {what}"), &found, |_| [1.0 / radius, 0.0]);
        let shown = hold_directions(&format!("cylinder, {what}"), &setting, &found, |p| out(p).cross(axis));
        assert!(shown > found.len() * 9 / 10, "{shown} of {}", found.len());
    }
}

#[test]
fn hollows_are_concave_whichever_values_are_solid() {
    let radius = 0.7;
    let within: View = PerspectiveView {
        eye: Vec3::new(0.15, -0.1, 0.2),
        target: Vec3::new(1.0, 0.2, -0.4),
        field_of_view: 80.0,
        near: 0.01,
        far: 10.0,
        depth: DepthRange::Forward,
    }
    .into();
    for sign in [1.0, -1.0] {
        let volume = field([80; 3], boxes()[0].2, |p| 0.5 - 0.5 * sign * (p.length() - radius));
        let outside = view_of(&volume, Vec3::new(0.5, 0.4, 1.0));
        // Seen from outside the ball is solid, from within what is around it.
        for (view, convex) in [(&outside, 1.0), (&within, -1.0)] {
            let mut setting = Setting::new(volume.clone(), view);
            if sign * convex < 0.0 {
                setting.table.reverse();
            }
            let found = bends(&setting, CURVED);
            hold_curvatures(&format!("{sign} {convex}"), &found, |_| [convex / radius; 2]);
        }
    }
}

#[test]
fn saddles_bend_both_ways() {
    // Solid below the height 0.4 x^2 - 0.7 y^2 + 0.2 x y.
    let bend = [[0.8, 0.2, 0.0], [0.2, -1.4, 0.0], [0.0; 3]];
    let slope = 0.3;
    let volume = field([48, 44, 40], boxes()[0].2, |p| {
        0.5 + slope * (0.4 * p.x * p.x - 0.7 * p.y * p.y + 0.2 * p.x * p.y - p.z)
    });
    let setting = Setting::new(volume.clone(), &view_of(&volume, Vec3::new(0.3, 0.2, 1.0)));
    let exact = |p: Point| {
        let gradient = Point::new(0.8 * p.x + 0.2 * p.y, -1.4 * p.y + 0.2 * p.x, -1.0) * slope;
        principal_curvatures(gradient, &bend.map(|row: [f64; 3]| row.map(|entry| entry * slope)), -1.0)
    };
    let mut found = bends(&setting, CURVED);
    // Where values were cut to 0..1, and near the sides, the field is another.
    found.retain(|bend| bend.point.x.abs() < 0.8 && bend.point.y.abs() < 0.8);
    hold_curvatures("saddle", &found, |p| exact(p).map(|(curvature, _)| curvature));
    assert!(found.iter().all(|bend| bend.curvatures[0] > 0.05 && bend.curvatures[1] < -0.05));
    let direction = |p: Point| {
        let [one, two] = exact(p);
        if one.0.abs() > two.0.abs() { one.1 } else { two.1 }
    };
    // Elsewhere either of both may be the greater.
    found.retain(|bend| {
        let [one, two] = exact(bend.point);
        (one.0.abs() / two.0.abs()).ln().abs() > 0.1
    });
    let shown = hold_directions("saddle", &setting, &found, direction);
    assert!(shown > 300 && shown * 10 > found.len() * 9, "{shown} of {}", found.len());
}

#[test]
fn planes_and_faces_do_not_bend() {
    for normal in [Point::new(0.0, 0.0, 1.0), Point::new(0.3, -0.5, 1.0).normalised()] {
        let volume = field([64; 3], boxes()[0].2, |p| 0.5 - 0.25 * p.dot(normal));
        let setting = Setting::new(volume.clone(), &view_of(&volume, Vec3::new(0.1, 0.2, 1.0)));
        let found = bends(&setting, CURVED);
        assert!(found.len() > 300);
        // Texels are half floats: of what they round a thousandth of a voxel is left.
        let most = found.iter().flat_map(|bend| bend.curvatures).fold(0.0, |a: f64, k| a.max(k.abs()));
        hold("plane, curvature times voxel", most * setting.voxel(), 1e-3);
        assert!(found.iter().all(|bend| bend.double == [0.0; 2]));
    }
    // All is solid: the box itself is seen, and what a clip plane cuts.
    let volume = field([24; 3], boxes()[2].2, |p| 0.75 + 0.1 * (7.0 * p.x).sin() * p.y);
    let mut setting = Setting::new(volume.clone(), &view_of(&volume, Vec3::new(0.5, 0.4, 1.0)));
    for clip_planes in [Vec::new(), vec![glam::Vec4::new(0.1, -0.3, -1.0, 0.2)]] {
        setting.settings.clip_planes = clip_planes;
        let seen = setting.seen(CURVED);
        seen.check();
        assert!(seen.hits() > 400 && seen.curvature.iter().all(|v| *v == 0.0));
    }
}

#[test]
fn wild_voxels_and_steps_stay_finite() {
    let volume = field([40; 3], boxes()[0].2, |p| 0.5 - 0.5 * (p.length() - 0.6));
    let view = view_of(&volume, Vec3::new(0.5, 0.4, 1.0));
    let mut setting = Setting::new(volume.clone(), &view);
    let uploaded = setting.uploaded();
    let mut texels = uploaded.texture.read(gpu()).unwrap();
    for (i, texel) in texels.iter_mut().enumerate().step_by(97) {
        *texel = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -65504.0, 60000.0][i / 97 % 5];
    }
    uploaded.texture.write(gpu(), &texels).unwrap();
    let seen = setting.seen_of(&uploaded, CURVED);
    seen.check();
    assert!(seen.hits() > 100);
    // Nothing but 0 and 1, alternating or not, and a single voxel.
    let binary = |wave: f64| {
        field([40; 3], boxes()[0].2, move |p| if (wave * p.x).sin() * p.y + p.z > 0.0 { 1.0 } else { 0.0 })
    };
    let mut spike = vec![0.0; 1000];
    spike[555] = 1.0;
    let others = [
        binary(1.0),
        binary(60.0),
        Volume::new([10; 3], spike, boxes()[3].2).unwrap(),
        Volume::new([1, 20, 20], (0..400).map(|i| (i % 20) as f32 / 19.0).collect(), boxes()[0].2).unwrap(),
        Volume::new([2; 3], vec![0.0, 1.0, 1.0, 0.0, 1.0, 0.0, 0.0, 1.0], boxes()[1].2).unwrap(),
    ];
    for volume in others {
        setting = Setting::new(volume.clone(), &view_of(&volume, Vec3::new(0.5, 0.4, 1.0)));
        let seen = setting.seen(CURVED);
        seen.check();
        assert!(seen.hits() > 0);
        for texel in seen.curvature.chunks_exact(4) {
            let size = texel[2].hypot(texel[3]);
            assert!(texel[0] >= texel[1] && (size == 0.0 || (size - 1.0).abs() < 2e-3), "{texel:?}");
        }
    }
}

#[test]
fn curvature_changes_no_other_target_and_skipping_no_bit_of_it() {
    let setting = surfaces::head_setting(Vec3::new(0.3, 0.2, 1.0));
    let volume = setting.uploaded();
    let mut curved = setting.seen_of(&volume, CURVED);
    curved.check();
    let skipping = IsoForm { skipping: true, ..CURVED };
    let mut encoder = gpu().encoder();
    let ranges = SolidBricks::new(gpu(), shaders()).unwrap().ranges(gpu(), &mut encoder, &volume).unwrap();
    gpu().submit(encoder).unwrap();
    let (skipped, bricks) = setting.seen_with(&volume, skipping, Some(&ranges));
    assert!(bricks.iter().any(|distance| *distance > 0));
    assert_eq!(skipped, curved);
    let deferred = setting.seen_with(&volume, IsoForm { deferred: true, ..skipping }, Some(&ranges)).0;
    assert_eq!(deferred.curvature, curved.curvature);
    assert!(curved.curvature.iter().filter(|v| **v != 0.0).count() > 2 * curved.hits());
    curved.curvature.clear();
    assert_eq!(curved, setting.seen_of(&volume, PLAIN));
    assert!(setting.seen_of(&volume, IsoForm { distance_only: true, ..CURVED }).curvature.is_empty());
}
