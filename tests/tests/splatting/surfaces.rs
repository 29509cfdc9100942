// SPDX-License-Identifier: MIT OR Apache-2.0
//! Surfaces in light that spreads: where it spreads by nothing they are lit as by hard light, an area light's penumbra on them has the width
//! of the closed form, and scattered light gets behind them.

use crate::gpu::{gpu, host_vector};
use crate::sheet_scene::{camera, directions, light, small_cloud};
use crate::sheets::{Shot, colored, metres, shoot_all, splats};
use airlight::core::{Camera, DepthRange, Light, OrthographicView};
use airlight::data::{Bounds, Mesh, cuboid, plane, sphere};
use airlight::splatting::{
    LightTransport, ScatteringSettings, SheetFrame, SheetInputs, SheetLighting, SheetSettings, SoftShadows,
    Splats, Surfaces,
};
use glam::{Mat4, Vec2, Vec3};

const RADIANCE: [f64; 3] = [9.0, 8.0, 6.0];

fn shot(volumes: &[Splats], meshes: &[Mesh], settings: SheetSettings, frame: &SheetFrame) -> Shot {
    let transfer = colored([Vec3::ONE; 2]);
    let surfaces = Surfaces::new(gpu(), meshes).unwrap();
    shoot_all(
        SheetInputs { surfaces: Some(&surfaces), ..SheetInputs::new(volumes, &transfer) },
        settings,
        frame,
    )
}

fn scattering(cone: f32, back: bool) -> LightTransport {
    LightTransport::Scattering(ScatteringSettings { cone, free_path: 1.0, back, sweeps: 2 })
}

#[test]
fn light_that_spreads_by_nothing_is_hard() {
    let size = [60, 40];
    let volume = small_cloud();
    let volumes = [splats(&volume)];
    for (degrees, spot) in [(75.0, true), (120.0, false)] {
        let [view, way] = directions(degrees);
        let [ahead, along] = [view, way].map(host_vector);
        let facing = glam::Quat::from_rotation_arc(Vec3::Y, -(ahead + along).normalize());
        let wall = Mat4::from_rotation_translation(facing, (ahead + along).normalize() * 2.6);
        let meshes = [
            sphere(0.5, 48, 24).transformed(Mat4::from_translation(Vec3::new(0.4, 0.1, -0.2))),
            cuboid(Vec3::splat(0.6)).transformed(Mat4::from_translation(along * -2.5)),
            plane(Vec2::splat(7.0), 1).transformed(wall),
        ];
        let bounds =
            meshes.iter().filter_map(Mesh::bounds).fold(volume.bounds(), |all: Bounds, own| all.union(&own));
        let (_, camera) = camera(view, false, size);
        let (_, light) = light(way, spot, RADIANCE, [bounds.min - 0.3, bounds.max + 0.3]);
        let lighting = SheetLighting { ambient: Vec3::splat(0.02), specular: 0.1, ..SheetLighting::new(2.0) };
        let frame = SheetFrame { camera, light, lighting };
        let settings = SheetSettings { count: 96, light_size: [320; 2], ..SheetSettings::default() };
        let hard = shot(&volumes, &meshes, settings, &frame);
        // A cone of half a degree holds a ten-thousandth of what is scattered.
        let ways = [
            ("soft", LightTransport::Soft(SoftShadows::new(0.0))),
            ("forward", scattering(0.5, false)),
            ("back", scattering(0.5, true)),
        ];
        for (name, transport) in ways {
            let other = shot(&volumes, &meshes, SheetSettings { transport, ..settings }, &frame);
            assert!(other.is_sound());
            let (mut far, mut error, mut all) = (0, 0.0, 0.0);
            for (a, b) in hard.picture.chunks_exact(4).zip(other.picture.chunks_exact(4)) {
                assert!((a[3] - b[3]).abs() < 0.01, "{degrees} {name}: {a:?} {b:?}");
                let [off, own] = [(a[0] - b[0]).powi(2), a[0] * a[0]];
                // At shadow edges a texel decides.
                if off > 0.1 * 0.1 * own + 1e-4 {
                    far += 1;
                } else {
                    error += off;
                    all += own;
                }
            }
            let rmse = (error / all).sqrt();
            println!(
                "{degrees} degrees, spot {spot}, {name}: {rmse:.4}, {far} of 2400 pixels off by more than a tenth"
            );
            assert!(far < 100 && rmse < 0.02, "{degrees} {name}: {far} {rmse}");
        }
    }
}

/// A camera of parallel rays, and where its pixels meet the height `height`.
fn above(direction: Vec3, height: f32) -> (Camera, Vec<Vec3>) {
    let side = 96;
    let target = Vec3::Y * height;
    let eye = target - 40.0 * direction;
    let view =
        OrthographicView { eye, target, height: 6.0, near: 0.0, far: 80.0, depth: DepthRange::Forward };
    let camera = Camera::orthographic(&view, [side; 2]).unwrap();
    let point = |index: u32| {
        let ndc = Vec2::new((index % side) as f32 + 0.5, (index / side) as f32 + 0.5) / side as f32;
        let near = camera
            .world_from_clip
            .project_point3((ndc * Vec2::new(2.0, -2.0) + Vec2::new(-1.0, 1.0)).extend(0.0));
        near + direction * ((height - near.y) / direction.y)
    };
    (camera, (0..side * side).map(point).collect())
}

/// Places at which a profile of place and share crosses 10, 50 and 90 percent.
fn crossings(profile: &mut [(f32, f32)]) -> [f32; 3] {
    profile.sort_by(|a, b| a.0.total_cmp(&b.0));
    let means: Vec<(f32, f32)> = profile
        .chunks(24)
        .map(|part| {
            let sum = part.iter().fold((0.0, 0.0), |sum, own| (sum.0 + own.0, sum.1 + own.1));
            (sum.0 / part.len() as f32, sum.1 / part.len() as f32)
        })
        .collect();
    [0.1, 0.5, 0.9].map(|level| {
        let pair = means.windows(2).find(|pair| pair[0].1 < level && pair[1].1 >= level).unwrap();
        pair[0].0 + (level - pair[0].1) / (pair[1].1 - pair[0].1) * (pair[1].0 - pair[0].0)
    })
}

#[test]
fn the_penumbra_of_a_half_plane_on_a_floor_has_its_width() {
    // Over x < 0 at the height 0, 4 m above the floor. The floor is open: what no back follows is no solid.
    let depth = 4.0_f32;
    let meshes = [
        plane(Vec2::new(12.0, 14.0), 1).transformed(Mat4::from_translation(Vec3::new(-6.0, 0.0, 0.0))),
        plane(Vec2::splat(14.0), 1).transformed(Mat4::from_translation(Vec3::NEG_Y * depth)),
    ];
    let lights = [
        (Light::directional(Vec3::Y, Vec3::ONE, Vec3::splat(-12.0), Vec3::splat(12.0)).unwrap(), 14.0_f32),
        (Light::point(Vec3::Y * 9.0, Vec3::splat(100.0), 0.01, 0.1, 40.0).unwrap(), 2.4),
    ];
    for (light, size) in lights {
        for direction in [Vec3::new(-0.6, -0.8, 0.0), Vec3::new(-0.8, -0.6, 0.1)] {
            let direction = direction.normalize();
            let (camera, points) = above(direction, -depth);
            let lighting = SheetLighting { diffuse: 1.0, specular: 0.0, ..SheetLighting::new(1.0) };
            let transport = LightTransport::Soft(SoftShadows::new(size));
            let settings =
                SheetSettings { count: 64, light_size: [384; 2], transport, ..SheetSettings::default() };
            let picture = shot(&[], &meshes, settings, &SheetFrame { camera, light, lighting });
            let mut profile = Vec::new();
            for (pixel, point) in picture.picture.chunks_exact(4).zip(&points) {
                if point.x.abs() > 2.4 || point.z.abs() > 1.5 {
                    continue;
                }
                let to_light = light.position - *point;
                let clear = if light.kind == 0 {
                    1.0
                } else {
                    100.0 * to_light.normalize().y / (to_light.length_squared() + 1e-4)
                };
                profile.push((point.x, pixel[0] * std::f32::consts::PI / (clear * 0.5)));
            }
            // The albedo is that of the lit end.
            let lit: Vec<f32> = profile.iter().filter(|at| at.0 > 2.0).map(|at| at.1).collect();
            let full = lit.iter().sum::<f32>() / lit.len() as f32;
            profile.iter_mut().for_each(|at| at.1 /= full);
            let width = if light.kind == 0 {
                2.0 * (0.5 * size.to_radians()).tan() * depth
            } else {
                size * depth / 9.0
            };
            let [low, middle, high] = crossings(&mut profile);
            let found = (high - low) / (0.8 * width);
            println!(
                "light {}, eye along {direction:.2}: width {found:.3}, middle off by {:.3} of it",
                light.kind,
                middle / width
            );
            assert!((found - 1.0).abs() < 0.1 && (middle / width).abs() < 0.06, "{found} {middle}");
            let dark = profile.iter().filter(|at| at.0 < -width).map(|at| at.1).fold(0.0, f32::max);
            assert!(dark < 0.03, "{dark}");
        }
    }
}

#[test]
fn what_lies_behind_a_surface_does_not_shade_it() {
    let ball = [sphere(0.5, 96, 48).transformed(Mat4::from_translation(Vec3::Y * 0.9))];
    // A slab that lets nothing through, below the ball; rays past the ball's edge end in it.
    let mut slab = metres([40, 4, 40], |_| 1.0);
    slab.world_from_unit = Mat4::from_scale(Vec3::splat(0.1)) * slab.world_from_unit;
    let towards = Vec3::new(0.6, 0.7, 0.2).normalize();
    let light = Light::directional(towards, Vec3::splat(3.0), Vec3::splat(-2.4), Vec3::splat(2.4)).unwrap();
    let eye = Vec3::new(-0.5, -0.7, -0.5).normalize();
    let (camera, _) = above(eye, 0.9);
    let lighting =
        SheetLighting { diffuse: 1.0, specular: 0.0, ambient: Vec3::ZERO, ..SheetLighting::new(60.0) };
    for transport in
        [LightTransport::Direct, scattering(20.0, false), LightTransport::Soft(SoftShadows::new(2.0))]
    {
        let settings =
            SheetSettings { count: 64, light_size: [128; 2], transport, ..SheetSettings::default() };
        let frame = SheetFrame { camera, light, lighting };
        let [alone, both] =
            [&[][..], &[splats(&slab)][..]].map(|volumes| shot(volumes, &ball, settings, &frame));
        let (mut worst, mut count) = (0.0_f32, 0);
        for (pixel, (alone, both)) in
            alone.picture.chunks_exact(4).zip(both.picture.chunks_exact(4)).enumerate()
        {
            // Where the ball is seen, and its normal is known.
            let ndc = Vec2::new((pixel % 96) as f32 + 0.5, (pixel / 96) as f32 + 0.5) / 96.0;
            let ndc = ndc * Vec2::new(2.0, -2.0) + Vec2::new(-1.0, 1.0);
            let origin = camera.world_from_clip.project_point3(ndc.extend(0.0)) - Vec3::Y * 0.9;
            let along = origin.dot(eye);
            let square = 0.47 * 0.47 - (origin.length_squared() - along * along);
            if square <= 0.0 {
                continue;
            }
            let cosine = (origin + eye * (-along - square.sqrt())).normalize().dot(towards);
            if cosine > 0.12 {
                count += 1;
                worst = worst.max((both[0] / alone[0] - 1.0).abs());
            }
        }
        println!("{transport:?}: {worst:.4} at most of {count} pixels");
        assert!(count > 100 && worst < 0.03, "{transport:?}: {worst} of {count}");
    }
}

#[test]
fn scattered_light_gets_behind_surfaces() {
    // A fog of 4 m about a plate of 1.6 m, over a floor.
    let mut fog = metres([20; 3], |_| 0.5);
    fog.world_from_unit = Mat4::from_scale(Vec3::splat(0.2)) * fog.world_from_unit;
    let volumes = [splats(&fog)];
    let plate = cuboid(Vec3::new(1.6, 0.1, 1.6));
    let floor = plane(Vec2::splat(6.0), 1).transformed(Mat4::from_translation(Vec3::NEG_Y * 1.6));
    let light = Light::directional(Vec3::Y, Vec3::splat(6.0), Vec3::splat(-4.0), Vec3::splat(4.0)).unwrap();
    // Means of what surfaces reflect over points of a height, as they are seen through the fog.
    let means = |meshes: &[Mesh], direction: Vec3, height: f32, wanted: &dyn Fn(Vec3) -> bool| {
        let (camera, points) = above(direction.normalize(), height);
        [LightTransport::Direct, scattering(60.0, false), scattering(60.0, true)].map(|transport| {
            let settings =
                SheetSettings { count: 40, light_size: [48; 2], transport, ..SheetSettings::default() };
            let [dull, bright] = [0.0, 1.0].map(|diffuse| {
                let lighting = SheetLighting {
                    g: 0.2,
                    diffuse,
                    specular: 0.0,
                    ambient: Vec3::ZERO,
                    ..SheetLighting::new(0.6)
                };
                shot(&volumes, meshes, settings, &SheetFrame { camera, light, lighting })
            });
            let own = bright.picture.iter().zip(&dull.picture).step_by(4).zip(&points);
            let own = own.filter(|(_, point)| wanted(**point));
            let (sum, count) =
                own.fold((0.0, 0), |(sum, count), ((bright, dull), _)| (sum + bright - dull, count + 1));
            assert!(count > 20, "{count}");
            sum / count as f32
        })
    };
    let both = [plate.clone(), floor];
    let down = Vec3::new(-0.8, -0.6, 0.0);
    let shade = means(&both, down, -1.6, &|point: Vec3| point.x.abs().max(point.z.abs()) < 0.35);
    let sun = means(&both, down, -1.6, &|point: Vec3| point.x > 1.2 && point.x < 1.6 && point.z.abs() < 0.5);
    println!("in the plate's shadow {shade:?}, beside it {sun:?}");
    // Some 15 % of the light are scattered on, by some 0.4 m, 0.8 m from the shadow's edges.
    assert!(shade[0] == 0.0 && (0.01..0.03).contains(&(shade[1] / sun[1])), "{shade:?} {sun:?}");
    assert!(shade[2] > 1.02 * shade[1] && sun[1] > 1.1 * sun[0] && sun[2] > sun[1], "{shade:?} {sun:?}");
    // From below; of the plate what turns its back to the light.
    let under = means(&[plate], Vec3::new(-0.3, 0.95, 0.0), -0.05, &|point: Vec3| {
        point.x.abs().max(point.z.abs()) < 0.7
    });
    println!("underside {under:?}");
    assert!(under[0] == 0.0 && under[1] == 0.0 && under[2] > 0.01 * sun[2], "{under:?}");
}
