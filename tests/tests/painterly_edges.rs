// SPDX-License-Identifier: MIT OR Apache-2.0
//! Ray casting of iso-surfaces where something is odd: cameras inside, clip planes, wild voxels, thin volumes, nothing solid;
//! lighting and occlusion.
#![allow(clippy::unwrap_used)]

#[path = "support/gpu.rs"]
mod gpu;
#[path = "support/probing.rs"]
mod probing;
#[path = "support/surfaces.rs"]
mod surfaces;

use airlight::core::{DepthRange, Jitter, PerspectiveView, Transfer, TransferError, View};
use airlight::data::{Volume, sphere_field, torus_field};
use airlight::painterly::{IsoForm, IsoRaycast, IsoSettings, IsoVolume, PainterlyError, SurfaceLighting};
use airlight_tests::error::max_absolute;
use airlight_tests::linear;
use glam::{Mat4, Vec3, Vec4};
use gpu::{Probe, Random, gpu, shaders, vector};
use probing::{f, hold, triple, worst};
use surfaces::{PLAIN, SIZE, Setting, hits_are_crossings, parallel_view_of, view_of};

/// From within.
fn inside(eye: Vec3, target: Vec3) -> View {
    PerspectiveView { eye, target, field_of_view: 80.0, near: 0.01, far: 10.0, depth: DepthRange::Reversed }
        .into()
}

#[test]
fn cameras_may_be_inside() {
    let _turn = gpu::turn();
    let volume = torus_field([40; 3], 0.55, 0.2);
    // In the hole of the ring, where nothing is solid.
    let mut setting =
        Setting::new(volume.clone(), &inside(Vec3::new(0.05, 0.0, 0.1), Vec3::new(1.0, 0.1, 0.0)));
    hits_are_crossings("in the hole", &setting, &setting.seen(PLAIN));
    // In what is solid every ray ends at once, and its normal is the ray turned round.
    setting = Setting::new(volume, &inside(Vec3::new(0.55, 0.0, 0.05), Vec3::ZERO));
    let seen = setting.seen(PLAIN);
    seen.check();
    assert!(seen.distance.iter().all(|distance| *distance == 0.0));
    setting.solid(|solid| {
        for (i, ray) in setting.rays(solid).iter().enumerate() {
            let off = triple(&seen.surface[4 * i..4 * i + 3]) + ray.direction;
            assert!(off.length() < 2e-3, "{off:?}");
        }
    });
}

#[test]
fn clip_planes_and_limits_cut() {
    let _turn = gpu::turn();
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
    let _turn = gpu::turn();
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
    let _turn = gpu::turn();
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
    let _turn = gpu::turn();
    let values = (0..400).map(|i| 1.0 - (i / 16) as f32 / 24.0).collect();
    let volume = Volume::new([4, 4, 25], values, sphere_field([1; 3], 0.5).world_from_unit).unwrap();
    let mut setting = Setting::new(volume.clone(), &parallel_view_of(&volume, Vec3::Z, DepthRange::Forward));
    setting.settings.iso_value = 0.99;
    setting.settings.steps_per_voxel = 1.0;
    hits_are_crossings("far face", &setting, &setting.seen(PLAIN));
}

#[test]
fn parallel_rays_are_those_of_an_eye_afar() {
    let _turn = gpu::turn();
    let volume = torus_field([40; 3], 0.55, 0.25);
    let towards = Vec3::new(0.3, 0.6, 1.0).normalize();
    let parallel = parallel_view_of(&volume, towards, DepthRange::Forward);
    let View::Orthographic(view) = parallel else { unreachable!() };
    let far = 800.0;
    let degrees = 2.0 * (0.5 * view.height / far).atan().to_degrees();
    let eye = far * towards;
    let afar = PerspectiveView {
        eye,
        target: Vec3::ZERO,
        field_of_view: degrees,
        near: far - 5.0,
        far: far + 5.0,
        depth: DepthRange::Forward,
    };
    let [by_parallel, by_eye] = [parallel, afar.into()].map(|view| {
        let setting = Setting::new(volume.clone(), &view);
        (setting.seen(PLAIN), setting)
    });
    let mut compared = 0;
    let shift = f64::from(far) - f64::from(view.eye.length());
    for i in 0..by_eye.0.distance.len() {
        let (one, other) = (f(by_parallel.0.distance[i]), f(by_eye.0.distance[i]));
        let normals = [&by_parallel, &by_eye].map(|(seen, _)| triple(&seen.surface[4 * i..4 * i + 3]));
        if one < 0.0 || other < 0.0 || normals[0].dot(vector(towards)) < 0.3 {
            continue;
        }
        compared += 1;
        assert!((one + shift - other).abs() < 0.1 * by_eye.1.voxel(), "{one} {other}");
        assert!((normals[0] - normals[1]).length() < 0.02, "{normals:?}");
    }
    assert!(compared > 400, "{compared}");
}

#[test]
fn wild_and_thin_volumes_give_finite_pictures() {
    let _turn = gpu::turn();
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
    let _turn = gpu::turn();
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
    let _turn = gpu::turn();
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
fn light_is_phong_s() {
    let _turn = gpu::turn();
    let probe = Probe {
        head: "#import airlight::painterly::iso_surface::{SurfaceLighting, phong}",
        body: "let lighting = SurfaceLighting(
                   vec3<f32>(input(0u), input(1u), input(2u)), 0.7, vec3<f32>(2.0, 1.0, 0.5), 0.4, vec3<f32>(0.1, 0.2, 0.3), input(9u));
               let lit = phong(lighting, vec3<f32>(0.9, 0.5, 0.1), vec3<f32>(input(3u), input(4u), input(5u)),
                   vec3<f32>(input(6u), input(7u), input(8u)));
               output(0u, lit.x); output(1u, lit.y); output(2u, lit.z);",
        inputs: 10,
        outputs: 3,
    };
    let mut random = Random(77);
    let mut records = Vec::new();
    let mut expected = Vec::new();
    for _ in 0..500 {
        let [light, normal, view] = [0; 3].map(|_| random.direction());
        let alpha = random.magnitude(1.0, 60.0).floor();
        // R.V with R the light's direction mirrored at the normal and V towards the eye.
        let mirrored = normal * (2.0 * normal.dot(light)) - light;
        let lobe = if normal.dot(light) > 0.0 { mirrored.dot(-view).max(0.0).powf(alpha) } else { 0.0 };
        let facing = normal.dot(light).max(0.0);
        for ((albedo, radiance), ambient) in
            [0.9, 0.5, 0.1].into_iter().zip([2.0, 1.0, 0.5]).zip([0.1, 0.2, 0.3])
        {
            expected.push(albedo * (ambient + 0.7 * facing * radiance) + 0.4 * lobe * radiance);
        }
        for v in [light, normal, view] {
            records.extend(v.to_array().map(|x| x as f32));
        }
        records.push(alpha as f32);
    }
    let found = probe.run(&records);
    hold("radiance", worst(found.iter().map(|x| f(*x)).zip(expected)), 2e-4);
}

/// A sphere before a plane, a point of each: what is hidden is told from what is seen, by distances that a picture of some
/// pixels may have; and a pixel's side is that of projected points.
#[test]
fn occlusion_is_told_by_distances() {
    let _turn = gpu::turn();
    let probe = Probe {
        head: "#import airlight::painterly::iso_surface::{distance_tolerance, is_occluded}",
        body: "let tolerance = distance_tolerance(input(0u), input(1u), 1.0, 0.0);
               output(0u, tolerance);
               output(1u, select(0.0, 1.0, is_occluded(input(2u), input(3u), tolerance)));",
        inputs: 4,
        outputs: 2,
    };
    // A plane seen under an angle: a pixel of 1 cm beside, its distance differs by side times tangent.
    let mut records = Vec::new();
    let mut expected = Vec::new();
    for degrees in [0.0_f64, 20.0, 45.0, 70.0, 85.0] {
        let (side, angle) = (0.01, degrees.to_radians());
        let tolerance = side * angle.tan();
        for (found, hidden) in [
            (5.0 + 1.1 * tolerance + 1e-4, 0.0),
            (5.0 - 0.9 * tolerance, 0.0),
            (5.0 - 1.1 * tolerance - 1e-4, 1.0),
            (1.0, 1.0),
            (-1.0, 0.0),
        ] {
            records.extend([side as f32, -angle.cos() as f32, 5.0, found as f32]);
            expected.push((tolerance, hidden));
        }
    }
    for (found, (tolerance, hidden)) in probe.run(&records).chunks_exact(2).zip(expected) {
        assert!((f(found[0]) - tolerance).abs() < 1e-5 + 1e-3 * tolerance, "{found:?} {tolerance}");
        assert_eq!(f(found[1]), hidden, "{tolerance}");
    }
    let volume = sphere_field([8; 3], 0.5);
    for view in [view_of(&volume, Vec3::ONE), parallel_view_of(&volume, Vec3::ONE, DepthRange::Reversed)] {
        let setting = Setting::new(volume.clone(), &view);
        let camera = setting.camera();
        let matrix = setting.frame.camera.clip_from_world.to_cols_array();
        let probe = Probe {
            head: &format!(
                "#import airlight::core::camera::Camera\n#import airlight::painterly::iso_surface::pixel_side{}",
                probing::MATRIX_AT
            ),
            body: "let m = matrix_at(0u);
                   let camera = Camera(m, m, vec3<f32>(0.0), 0.0, vec2<f32>(64.0, 48.0), 1.0, 0u);
                   output(0u, pixel_side(camera, vec3<f32>(input(16u), input(17u), input(18u))));",
            inputs: 19,
            outputs: 1,
        };
        let point = linear::Vec3::new(0.2, -0.1, 0.3);
        let record: Vec<f32> = matrix.into_iter().chain([0.2, -0.1, 0.3]).collect();
        let side = f(probe.run(&record)[0]);
        let above = camera.project(point + camera.up * side).unwrap();
        let pixels = (above[1] - camera.project(point).unwrap()[1]) * f64::from(SIZE[1]) / 2.0;
        hold("a pixel's side", (pixels - 1.0).abs(), 1e-3);
    }
}

#[test]
fn impossible_surfaces_are_errors() {
    let _turn = gpu::turn();
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
