// SPDX-License-Identifier: MIT OR Apache-2.0
//! Polygons and volumes in one picture, against an f64 ray marcher that tries every ray against every triangle: shadows of
//! polygons before, within and behind the volume, and the whole picture.

use crate::gpu::{gpu, shaders};
use crate::sheet_scene::{camera, directions, field_of, light, small_cloud};
use crate::sheets::{Shot, colored, metres, shoot_all, splats};
use airlight::core::Light;
use airlight::data::{Bounds, Mesh, Volume, cuboid, plane, sphere, torus};
use airlight::splatting::{
    SheetFrame, SheetInputs, SheetLighting, SheetSettings, Splats, SplattingError, Surfaces,
};
use airlight_tests::linear::Vec3;
use airlight_tests::reference::camera::Camera as ReferenceCamera;
use airlight_tests::reference::splatting::polygons::{Hit, Mixed, Reflection, Triangle};
use airlight_tests::reference::splatting::{Medium, Scene};
use glam::{Mat4, Vec2};

const SIZE: [u32; 2] = [60, 40];
const RADIANCE: [f64; 3] = [9.0, 8.0, 6.0];
const ALBEDO: [[f64; 3]; 2] = [[0.95, 0.6, 0.3], [0.5, 0.7, 0.9]];
const REFLECTION: Reflection = Reflection { diffuse: 0.8, specular: 0.3, shininess: 24.0 };

fn medium(extinction: f64) -> Medium {
    Medium { albedo: ALBEDO, extinction, ambient: [0.02, 0.03, 0.05], g: 0.4 }
}

fn lighting(medium: &Medium) -> SheetLighting {
    let ambient = medium.ambient.map(|x| x as f32).into();
    SheetLighting { ambient, g: medium.g as f32, ..SheetLighting::new(medium.extinction as f32) }
}

/// A ball within the volume, a ring between it and the light, a wall behind it all.
fn meshes(view: Vec3, way: Vec3) -> Vec<Mesh> {
    let host = |v: Vec3| glam::Vec3::new(v.x as f32, v.y as f32, v.z as f32);
    let (view, way) = (host(view), host(way));
    let facing = |direction| glam::Quat::from_rotation_arc(glam::Vec3::Y, direction);
    let placed =
        |mesh: Mesh, rotation, place| mesh.transformed(Mat4::from_rotation_translation(rotation, place));
    vec![
        placed(sphere(0.5, 16, 10), glam::Quat::IDENTITY, glam::Vec3::new(0.4, 0.1, -0.2))
            .with_albedo(glam::Vec3::new(0.8, 0.3, 0.2)),
        placed(torus(0.7, 0.15, 24, 12), facing((way + 0.4 * glam::Vec3::X).normalize()), way * -2.8)
            .with_albedo(glam::Vec3::new(0.3, 0.6, 0.3)),
        placed(plane(Vec2::splat(7.0), 1), facing(-(view + way).normalize()), (view + way).normalize() * 2.6)
            .with_albedo(glam::Vec3::splat(0.6)),
        placed(cuboid(glam::Vec3::splat(0.5)), facing(way), view * 1.4 + glam::Vec3::new(-0.8, 0.5, 0.0)),
    ]
}

fn triangles(meshes: &[Mesh]) -> Vec<Triangle> {
    let reference = |v: glam::Vec3| Vec3::new(f64::from(v.x), f64::from(v.y), f64::from(v.z));
    let of_mesh = |mesh: &Mesh| -> Vec<Triangle> {
        let corner = |index: &u32| *index as usize;
        let of = |three: &[u32]| Triangle {
            corners: [0, 1, 2].map(|i| reference(mesh.positions[corner(&three[i])])),
            normals: [0, 1, 2].map(|i| reference(mesh.normals[corner(&three[i])])),
            color: reference(mesh.albedos[corner(&three[0])]).to_array(),
        };
        mesh.indices.chunks_exact(3).map(of).collect()
    };
    meshes.iter().flat_map(of_mesh).collect()
}

/// Least and greatest corner of what is in the picture.
fn bounds(volume: &Volume, meshes: &[Mesh]) -> [glam::Vec3; 2] {
    let all =
        meshes.iter().filter_map(Mesh::bounds).fold(volume.bounds(), |all: Bounds, own| all.union(&own));
    [all.min - 0.3, all.max + 0.3]
}

fn picture(volume: &[Splats], meshes: &[Mesh], settings: SheetSettings, frame: &SheetFrame) -> Shot {
    let transfer = colored(ALBEDO.map(|color| color.map(|x| x as f32).into()));
    let surfaces = Surfaces::new(gpu(), meshes).unwrap();
    let inputs = SheetInputs { surfaces: Some(&surfaces), ..SheetInputs::new(volume, &transfer) };
    shoot_all(inputs, settings, frame)
}

/// A thin fog, of voxels of 0.15 m: light goes through it unhindered.
fn fog() -> Volume {
    let mut volume = metres([16, 10, 16], |_| 0.5);
    volume.world_from_unit = Mat4::from_scale(glam::Vec3::splat(0.15)) * volume.world_from_unit;
    volume
}

/// Side of the shadow buffers of these tests.
const SIDE: u32 = 1024;

/// Side of a texel of the shadow buffer where it holds a point, metres.
fn texel_at(light: &Light, spot: bool, way: Vec3, point: Vec3) -> f64 {
    let across = f64::from(light.clip_from_world.row(0).truncate().length());
    let depth = if spot { (point + way * 8.0).dot(way) } else { 1.0 };
    2.0 * depth / (across * f64::from(SIDE))
}

/// Whether a point of a surface sees the light, where all points around it, as far as texels may be mistaken, agree.
fn lit_by_rays(mixed: &Mixed<'_>, point: Vec3, hit: &Hit, texel: f64) -> Option<bool> {
    let towards = mixed.scene.light.towards(point);
    let right = towards.cross(Vec3::new(0.3, 0.8, 0.5)).normalised();
    let up = right.cross(towards);
    let facing = hit.normal.dot(towards) > 0.0;
    let lit = facing && mixed.sees_light(point + hit.normal * 1e-5);
    // The point is moved off the surface by 1.5 texels, and one of four texels around it decides.
    let around = [
        (0.0, 0.0),
        (3.0, 0.0),
        (-3.0, 0.0),
        (0.0, 3.0),
        (0.0, -3.0),
        (2.0, 2.0),
        (-2.0, 2.0),
        (2.0, -2.0),
        (-2.0, -2.0),
    ];
    let same = around.iter().all(|(a, b)| {
        let moved = point + right * (a * texel) + up * (b * texel) + hit.normal * (3.0 * texel);
        (facing && mixed.sees_light(moved)) == lit
    });
    same.then_some(lit)
}

#[test]
fn shadows_of_polygons_are_those_of_rays() {
    let volume = fog();
    let field = field_of(&volume);
    let splats = [splats(&volume)];
    let clear = Medium { ambient: [0.0; 3], ..medium(1e-7) };
    for (degrees, spot) in [(30.0, false), (75.0, true), (120.0, false), (150.0, true)] {
        let [view, way] = directions(degrees);
        let meshes = meshes(view, way);
        let (reference, camera) = camera(view, false, SIZE);
        let (reference_light, light) = light(way, spot, RADIANCE, bounds(&volume, &meshes));
        let settings = SheetSettings { count: 24, light_size: [SIDE; 2], ..SheetSettings::default() };
        let lighting = SheetLighting { diffuse: 1.0, specular: 0.0, ..lighting(&clear) };
        let shot = picture(&splats, &meshes, settings, &SheetFrame { camera, light, lighting });
        let triangles = triangles(&meshes);
        let scene =
            Scene { field: &field, medium: clear, light: reference_light, radiance: RADIANCE, step: 1.0 };
        let mixed = Mixed { scene, triangles: &triangles, reflection: REFLECTION };
        let (mut lit, mut dark, mut edges, mut wrong) = (0, 0, 0, 0);
        for y in 0..SIZE[1] as usize {
            for x in 0..SIZE[0] as usize {
                let ndc = ReferenceCamera::pixel_ndc(x, y, SIZE[0] as usize, SIZE[1] as usize);
                let (origin, direction) = (reference.origin(ndc), reference.ray(ndc));
                let Some(hit) = mixed.first(origin, direction) else { continue };
                let point = origin + direction * hit.distance;
                let cosine = hit.normal.dot(reference_light.towards(point));
                let full = reference_light.irradiance(point);
                // Where light grazes the surface, a texel covers more of it than the picture shows.
                if full < 1e-6 || cosine.abs() < 0.15 {
                    continue;
                }
                let found = f64::from(shot.picture[4 * (y * SIZE[0] as usize + x)]);
                let radiance = RADIANCE[0] * if spot { 30.0 } else { 1.0 };
                let share = found / (radiance * full / std::f64::consts::PI * hit.color[0] * cosine.abs());
                let Some(truth) = lit_by_rays(&mixed, point, &hit, texel_at(&light, spot, way, point)) else {
                    edges += 1;
                    continue;
                };
                if truth {
                    lit += 1
                } else {
                    dark += 1
                }
                let right = if truth { (share - 1.0).abs() < 0.01 } else { share.abs() < 1e-4 };
                wrong += usize::from(!right);
            }
        }
        println!(
            "{degrees} degrees, spot {spot}: {lit} lit, {dark} in shadow, {edges} at edges, {wrong} wrong"
        );
        assert!(lit > 250 && dark > 70 && edges < 300, "{degrees}: {lit} {dark} {edges}");
        assert_eq!(wrong, 0, "{degrees}");
    }
}

#[test]
fn mixed_pictures_are_what_a_ray_marcher_makes_of_them() {
    let volume = small_cloud();
    let field = field_of(&volume);
    let splats = [splats(&volume)];
    let medium = medium(2.0);
    for (degrees, parallel, spot) in [(40.0, false, false), (130.0, false, true), (75.0, true, false)] {
        let [view, way] = directions(degrees);
        let meshes = meshes(view, way);
        let (reference, camera) = camera(view, parallel, SIZE);
        let (reference_light, light) = light(way, spot, RADIANCE, bounds(&volume, &meshes));
        let radiance = RADIANCE.map(|x| if spot { 30.0 * x } else { x });
        let scene = Scene { field: &field, medium, light: reference_light, radiance, step: 0.1 };
        let triangles = triangles(&meshes);
        let mixed = Mixed { scene, triangles: &triangles, reflection: REFLECTION };
        let truth = mixed.picture(&reference, SIZE.map(|side| side as usize));
        let frame = SheetFrame { camera, light, lighting: lighting(&medium) };
        let size = SIZE.map(|side| side as usize);
        let at_edge = |index: usize| {
            let ndc = ReferenceCamera::pixel_ndc(index % size[0], index / size[0], size[0], size[1]);
            let (origin, direction) = (reference.origin(ndc), reference.ray(ndc));
            mixed.first(origin, direction).is_some_and(|hit| {
                let point = origin + direction * hit.distance;
                let grazed = hit.normal.dot(reference_light.towards(point)).abs() < 0.15;
                grazed || lit_by_rays(&mixed, point, &hit, texel_at(&light, spot, way, point)).is_none()
            })
        };
        let edge: Vec<bool> = (0..truth.len()).map(at_edge).collect();
        let errors = [32, 128].map(|count| {
            let settings = SheetSettings { count, light_size: [SIDE; 2], ..SheetSettings::default() };
            let shot = picture(&splats, &meshes, settings, &frame);
            assert!(shot.is_sound());
            let (mut error, mut all, mut far, mut opaque, mut apart) = (0.0, 0.0, 0_u32, 0, 0);
            for (index, (found, truth)) in shot.picture.chunks_exact(4).zip(&truth).enumerate() {
                // At silhouettes rounding decides what a pixel's middle hits.
                if (found[3] == 0.0) != (truth[3] == 0.0) {
                    apart += 1;
                    continue;
                }
                opaque += usize::from(found[3] == 0.0);
                if edge[index] {
                    continue;
                }
                let off = (0..3).map(|c| (f64::from(found[c]) - truth[c]).powi(2)).sum::<f64>();
                let own = truth[..3].iter().map(|x| x * x).sum::<f64>();
                far += u32::from(off > 0.05 * 0.05 * own + 1e-5);
                error += off;
                all += own;
            }
            let rmse = (error / all).sqrt();
            println!("{degrees} degrees, parallel {parallel}, spot {spot}, {count} sheets: {rmse:.4}, {far} pixels off by more than 5 %, {opaque} opaque");
            assert!(apart <= 5 && opaque > 600 && edge.iter().filter(|edge| **edge).count() < 300);
            [rmse, f64::from(far) / truth.len() as f64]
        });
        assert!(errors[1][0] <= 0.03 && errors[1][1] <= 0.03, "{degrees}: {errors:?}");
    }
}

#[test]
fn polygons_are_there_without_splats_and_meshes_without_triangles_are_refused() {
    let [view, way] = directions(60.0);
    let meshes = meshes(view, way);
    let volume = fog();
    let (_, camera) = camera(view, false, SIZE);
    let (_, light) = light(way, false, RADIANCE, bounds(&volume, &meshes));
    let frame = SheetFrame { camera, light, lighting: lighting(&medium(1e-9)) };
    let settings = SheetSettings { count: 16, light_size: [256; 2], ..SheetSettings::default() };
    let none = Splats::new(gpu(), shaders(), &volume, 10.0, None).unwrap();
    let thin = picture(&[splats(&volume)], &meshes, settings, &frame);
    let empty = picture(&[none], &meshes, settings, &frame);
    let alone = picture(&[], &meshes, settings, &frame);
    for (name, other) in [("empty", &empty), ("alone", &alone)] {
        let off = thin.picture.iter().zip(&other.picture).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        println!("{name}: {off}");
        assert!(off < 2e-3, "{name}: {off}");
    }
    assert!(matches!(Surfaces::new(gpu(), &[]), Err(SplattingError::NoPolygons)));
    assert!(matches!(Surfaces::new(gpu(), &[Mesh::default()]), Err(SplattingError::NoPolygons)));
}
