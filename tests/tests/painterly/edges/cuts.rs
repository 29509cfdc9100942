// SPDX-License-Identifier: MIT OR Apache-2.0
//! Clip planes and the faces of the volume: where rays enter and leave.

use crate::gpu::vector;
use crate::probing::{hold, triple};
use crate::surfaces::{PLAIN, Setting, hits_are_crossings, parallel_view_of, view_of};
use airlight::core::DepthRange;
use airlight::data::{Volume, sphere_field};
use airlight_tests::linear;
use glam::{Mat4, Vec3, Vec4};

#[test]
fn clip_planes_and_limits_cut() {
    let volume = sphere_field([40; 3], 0.7);
    let eye = Vec3::new(0.5, 0.4, 1.0);
    for view in [view_of(&volume, eye), parallel_view_of(&volume, eye, DepthRange::Forward)] {
        let mut setting = Setting::new(volume.clone(), &view);
        let whole = setting.seen(PLAIN);
        // A wedge is left, its normals of any length.
        let planes =
            [Vec4::new(-0.2, 0.1, -3.0, 0.6), Vec4::new(0.0, 0.5, 0.1, 0.1), Vec4::new(1.0, 0.0, 0.0, 0.45)];
        for count in [1, 3] {
            setting.settings.clip_planes = planes[..count].to_vec();
            let seen = setting.seen(PLAIN);
            assert_ne!(seen, whole);
            hits_are_crossings(&format!("{count} planes"), &setting, &seen);
            let caps = cap_errors(&setting, &seen.surface, &seen.distance);
            assert!(caps.len() > 100, "{}", caps.len());
            hold("normals of caps", caps.into_iter().fold(0.0, f64::max), 2e-3);
        }
        // All is cut away.
        setting.settings.clip_planes = vec![Vec4::new(0.0, 0.0, 1.0, -5.0)];
        assert_eq!(setting.seen(PLAIN).hits(), 0);
        setting.settings.clip_planes.clear();
        // Only what is near is seen.
        let hit: Vec<f32> = whole.distance.iter().copied().filter(|distance| *distance >= 0.0).collect();
        let nearest = hit.iter().copied().fold(f32::INFINITY, f32::min);
        setting.settings.distance_limit = nearest + 0.25;
        let near = setting.seen(PLAIN);
        hits_are_crossings("near", &setting, &near);
        assert!(
            near.hits() < whole.hits() && near.distance.iter().all(|distance| *distance <= nearest + 0.25)
        );
    }
}

/// How far normals are from those of the planes that rays enter what is solid by.
fn cap_errors(setting: &Setting, surface: &[f32], distance: &[f32]) -> Vec<f64> {
    setting.solid(|solid| {
        let mut errors = Vec::new();
        for (i, ray) in setting.rays(solid).iter().enumerate() {
            let Some(first) = ray.crossings.first().filter(|first| first.entered && distance[i] >= 0.0)
            else {
                continue;
            };
            let point = ray.origin + ray.direction * first.distance;
            let of = |plane: &[f64; 4]| {
                let normal = linear::Vec3::new(plane[0], plane[1], plane[2]);
                let height = (normal.dot(point) + plane[3]) / normal.length();
                let off = triple(&surface[4 * i..4 * i + 3]) + normal.normalised();
                (height.abs() < 1e-9).then(|| off.length())
            };
            errors.extend(solid.clip_planes.iter().find_map(of));
        }
        errors
    })
}

#[test]
fn rays_that_enter_by_a_face_have_its_normal() {
    let mut volume = sphere_field([24, 20, 16], 1.3);
    let turn = Mat4::from_rotation_z(0.4) * Mat4::from_rotation_y(0.5);
    volume.world_from_unit = turn * volume.world_from_unit;
    let axes = [turn.x_axis, turn.y_axis, turn.z_axis].map(|axis| vector(axis.truncate()));
    for towards_eye in [Vec3::new(0.8, 0.7, 1.0), Vec3::new(-0.8, -0.7, -1.0)] {
        let view = view_of(&volume, turn.transform_vector3(towards_eye));
        let setting = Setting::new(volume.clone(), &view);
        let seen = setting.seen(PLAIN);
        hits_are_crossings("cut sphere", &setting, &seen);
        let mut met = [0; 3];
        setting.solid(|solid| {
            for (i, ray) in setting.rays(solid).iter().enumerate() {
                let Some(first) = ray.crossings.first().filter(|first| first.entered) else { continue };
                let [x, y, z] = solid.unit(ray.origin + ray.direction * first.distance).unwrap();
                for (axis, unit) in [x, y, z].into_iter().enumerate() {
                    let others = (0..3).filter(|a| *a != axis).map(|a| [x, y, z][a]);
                    let away_from_edges = others.into_iter().all(|u| (0.01..=0.99).contains(&u));
                    if unit.min(1.0 - unit) < 1e-9 && away_from_edges {
                        let outward = axes[axis] * (unit - 0.5).signum();
                        let off = triple(&seen.surface[4 * i..4 * i + 3]) - outward;
                        assert!(off.length() < 2e-3, "{off:?}");
                        met[axis] += 1;
                    }
                }
            }
        });
        assert!(met.iter().all(|count| *count > 20), "{met:?}");
    }
}

/// Rays along a plane are cut away whole or not at all.
#[test]
fn rays_along_a_clip_plane_are_cut_by_sides() {
    let volume = sphere_field([40; 3], 0.7);
    let mut setting = Setting::new(volume.clone(), &parallel_view_of(&volume, Vec3::Z, DepthRange::Forward));
    let whole = setting.seen(PLAIN);
    setting.settings.clip_planes = vec![Vec4::new(2.0, 0.0, 0.0, 0.0)];
    let seen = setting.seen(PLAIN);
    assert!(whole.hits() > 400);
    for (i, (found, uncut)) in seen.distance.iter().zip(&whole.distance).enumerate() {
        assert_eq!(*found, if i % 64 < 32 { -1.0 } else { *uncut });
    }
}

/// Solid is only the last half voxel before rays leave.
#[test]
fn the_last_sample_lies_where_rays_leave() {
    let values = (0..400).map(|i| 1.0 - (i / 16) as f32 / 24.0).collect();
    let volume = Volume::new([4, 4, 25], values, sphere_field([1; 3], 0.5).world_from_unit).unwrap();
    let mut setting = Setting::new(volume.clone(), &parallel_view_of(&volume, Vec3::Z, DepthRange::Forward));
    setting.settings.iso_value = 0.99;
    setting.settings.steps_per_voxel = 1.0;
    hits_are_crossings("far face", &setting, &setting.seen(PLAIN));
}
