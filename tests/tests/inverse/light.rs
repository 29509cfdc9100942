// SPDX-License-Identifier: MIT OR Apache-2.0
//! Light that single scattering sends to the eye, by opacity shadow maps, against fine marching in f64.

use crate::gpu::{self, Random, gpu, shaders};
use airlight::core::MeshBuffers;
use airlight::data::{EnvironmentLight, plane};
use airlight::inverse::{Channels, InverseError, LightMaps, LightPasses, ShadowCasters};
use airlight::{Lighting, Texture};
use airlight_tests::linear::Vec3;
use airlight_tests::reference::inverse::{
    DirectionalLight, Grid, LocalLight, VolumeBox, local_grid, scattered_grid,
};
use glam::{Mat4, Quat, Vec2};
use std::f64::consts::PI;

const SIZE: [u32; 3] = [32; 3];
/// Steps of the reference.
const FINE: usize = 160;

fn count(size: [u32; 3]) -> usize {
    size.iter().map(|side| *side as usize).product()
}

/// A cloud: balls of different density, some of them cut by faces of the box, deep enough to be dark behind. 1/m.
fn cloud(size: [u32; 3], random: &mut Random) -> Vec<f32> {
    let balls: Vec<(Vec3, f64, f64)> = (0..12)
        .map(|_| {
            let middle = Vec3::from([0; 3].map(|_| random.between(0.0, 1.0)));
            (middle, random.between(0.12, 0.3), random.between(1.0, 5.0))
        })
        .collect();
    let field = |unit: Vec3| {
        let ball = |(middle, radius, density): &(Vec3, f64, f64)| {
            let way = unit - *middle;
            density * (-way.dot(way) / (radius * radius)).exp()
        };
        balls.iter().map(ball).sum()
    };
    let grid = Grid::from_fn(size.map(|side| side as usize), field);
    grid.values.into_iter().map(|value| value as f32).collect()
}

fn grid(size: [u32; 3], values: &[f32], factor: f64) -> Grid {
    Grid {
        size: size.map(|side| side as usize),
        values: values.iter().map(|value| factor * f64::from(*value)).collect(),
    }
}

fn volume(size: [u32; 3], values: &[f32], channels: Channels) -> Texture {
    let (format, spread): (_, Vec<f32>) = match channels {
        Channels::One => (wgpu::TextureFormat::R32Float, values.to_vec()),
        Channels::Rgb => {
            let all = values.iter().flat_map(|value| FACTORS.map(|factor| factor as f32 * value));
            (wgpu::TextureFormat::Rgba32Float, all.collect())
        }
    };
    let texture = Texture::volume(gpu(), size, format);
    texture.write(gpu(), &spread).unwrap();
    texture
}

/// What channels of the extinction are multiplied by; the fourth is none.
const FACTORS: [f64; 4] = [1.0, 0.5, 2.0, 0.0];

/// Turned, not a cube and not in the middle of the world.
fn placed() -> Mat4 {
    let turned = Quat::from_rotation_y(0.4) * Quat::from_rotation_x(0.2);
    Mat4::from_rotation_translation(turned, glam::Vec3::new(0.3, 1.0, -0.2))
        * Mat4::from_scale(glam::Vec3::new(2.0, 1.4, 1.8))
        * Mat4::from_translation(glam::Vec3::splat(-0.5))
}

/// Upright, its edges along the axes of the world.
fn upright() -> Mat4 {
    Mat4::from_scale(glam::Vec3::new(2.0, 1.4, 1.8)) * Mat4::from_translation(glam::Vec3::splat(-0.5))
}

fn boxed(world_from_unit: Mat4) -> VolumeBox {
    VolumeBox::new(gpu::matrix(world_from_unit)).unwrap()
}

fn maps(texels: u32) -> LightMaps {
    LightMaps { texels, layers: texels, shadow_texels: 512 }
}

fn passes(channels: Channels, maps: LightMaps) -> LightPasses {
    LightPasses::new(gpu(), shaders(), channels).unwrap().with_maps(maps).unwrap()
}

fn sun(towards: Vec3, irradiance: f64) -> DirectionalLight {
    DirectionalLight { towards: towards.normalised(), radiance: irradiance, solid_angle: 1.0 }
}

fn lighting(light: &DirectionalLight) -> Lighting {
    Lighting::directional(
        gpu::host_vector(light.towards),
        glam::Vec3::splat((light.radiance * light.solid_angle) as f32),
    )
}

/// Root of the mean square and greatest error, of the greatest value.
fn errors(found: impl Iterator<Item = f32>, expected: &Grid) -> [f64; 2] {
    let most = expected.values.iter().copied().fold(0.0, f64::max);
    let (mut square, mut worst) = (0.0, 0.0_f64);
    for (value, expected) in found.zip(&expected.values) {
        let off = (f64::from(value) - expected) / most;
        square += off * off;
        worst = worst.max(off.abs());
    }
    [(square / expected.values.len() as f64).sqrt(), worst]
}

#[test]
fn light_of_many_directions_is_that_of_fine_marching() {
    let mut random = Random(3);
    let extinction = cloud(SIZE, &mut random);
    let dense = grid(SIZE, &extinction, 1.0);
    let texture = volume(SIZE, &extinction, Channels::One);
    // The camera of other tests looks along -z: behind it, beside it, from above, from below, and along axes exactly.
    for (name, world_from_unit, towards) in [
        ("behind the camera", placed(), Vec3::new(0.1, 0.2, 1.0)),
        ("askew", placed(), Vec3::new(-0.7, 0.6, -0.5)),
        ("from below", placed(), Vec3::new(0.3, -1.0, 0.1)),
        ("straight up", upright(), Vec3::new(0.0, 1.0, 0.0)),
        ("along an axis", upright(), Vec3::new(-1.0, 0.0, 0.0)),
        ("nearly along an axis", upright(), Vec3::new(0.02, 0.0, 1.0)),
        ("along a diagonal", upright(), Vec3::new(1.0, -1.0, 1.0)),
    ] {
        let light = sun(towards, 3.0);
        let expected = scattered_grid(
            &boxed(world_from_unit),
            &dense,
            &[light],
            SIZE.map(|side| side as usize),
            FINE,
            |_, _| 1.0,
        );
        for texels in [64, 96] {
            let passes = passes(Channels::One, maps(texels));
            let found =
                passes.scattered(gpu(), &texture, world_from_unit, SIZE, &[lighting(&light)], None).unwrap();
            let [root, worst] = errors(found.read(gpu()).unwrap().into_iter(), &expected);
            println!("{name}, {texels} texels: {:.2} % RMS, {:.2} % at worst", 100.0 * root, 100.0 * worst);
            assert!(root < 0.003 && worst < 0.015, "{name}, {texels} texels: {root} {worst}");
        }
    }
}

#[test]
fn channels_and_grids_of_other_sizes_have_their_own_light() {
    let mut random = Random(5);
    let size = [20, 24, 18];
    let other = [11, 9, 14];
    let extinction = cloud(size, &mut random);
    let texture = volume(size, &extinction, Channels::Rgb);
    let directions = [Vec3::new(0.3, 0.9, 0.2), Vec3::new(-0.8, 0.1, 0.4), Vec3::new(0.1, -0.7, 0.8)];
    let colours = [[2.0, 1.0, 0.5], [0.0, 3.0, 1.0], [1.0, 0.2, 4.0]];
    let lights: Vec<Lighting> = directions
        .iter()
        .zip(colours)
        .map(|(towards, colour)| {
            let direction = gpu::host_vector(towards.normalised());
            EnvironmentLight { direction, irradiance: glam::DVec3::from(colour).as_vec3() }.into()
        })
        .collect();
    // Maps that it chooses itself.
    let passes = LightPasses::new(gpu(), shaders(), Channels::Rgb).unwrap();
    let found = passes.scattered(gpu(), &texture, placed(), other, &lights, None).unwrap();
    let found = found.read(gpu()).unwrap();
    for channel in 0..3 {
        let own: Vec<DirectionalLight> =
            directions.iter().zip(colours).map(|(towards, colour)| sun(*towards, colour[channel])).collect();
        let expected = scattered_grid(
            &boxed(placed()),
            &grid(size, &extinction, FACTORS[channel]),
            &own,
            other.map(|side| side as usize),
            FINE,
            |_, _| 1.0,
        );
        let [root, worst] = errors(found.iter().skip(channel).step_by(4).copied(), &expected);
        println!("channel {channel}: {:.2} % RMS, {:.2} % at worst", 100.0 * root, 100.0 * worst);
        assert!(root < 0.003 && worst < 0.015, "{channel}: {root} {worst}");
    }
}

/// Light through a box of the same extinction everywhere fades with the way to the light.
#[test]
fn an_even_box_fades_as_it_should() {
    let extinction = 2.3_f32;
    let texture = volume([1; 3], &[extinction], Channels::One);
    let size = [16, 12, 10];
    let mut worst = 0.0_f64;
    for world_from_unit in [upright(), placed()] {
        let inside = boxed(world_from_unit);
        for towards in [
            Vec3::new(0.0, 1.0, 0.0),
            Vec3::new(0.0, 0.0, -1.0),
            Vec3::new(0.4, -0.8, 0.3),
            Vec3::new(1.0, 0.01, 0.0),
        ] {
            let light = sun(towards, 4.0 * PI);
            let passes = passes(Channels::One, maps(24));
            let found =
                passes.scattered(gpu(), &texture, world_from_unit, size, &[lighting(&light)], None).unwrap();
            for (index, value) in found.read(gpu()).unwrap().into_iter().enumerate() {
                let at = [index % 16, index / 16 % 12, index / 192];
                let unit = [0, 1, 2].map(|axis| (at[axis] as f64 + 0.5) / f64::from(size[axis]));
                let along = inside.unit_direction(light.towards).to_array();
                let way = (0..3).map(|axis| {
                    let room = if along[axis] > 0.0 { 1.0 - unit[axis] } else { -unit[axis] };
                    if along[axis].abs() < 1e-6 { f64::INFINITY } else { room / along[axis] }
                });
                let expected = (-f64::from(extinction) * way.fold(f64::INFINITY, f64::min)).exp();
                worst = worst.max((f64::from(value) - expected).abs());
            }
        }
    }
    println!("worst error {worst:.1e}");
    assert!(worst < 1e-4, "{worst}");
}

#[test]
fn spots_and_points_shine_from_outside_and_within() {
    let mut random = Random(9);
    let extinction = cloud(SIZE, &mut random);
    let dense = grid(SIZE, &extinction, 1.0);
    let texture = volume(SIZE, &extinction, Channels::One);
    let (radius, intensity) = (0.2_f32, glam::Vec3::splat(5.0));
    let spot =
        |position: [f32; 3], target: [f32; 3], outer_degrees: f32, inner_degrees: f32| Lighting::Spot {
            position: position.into(),
            target: target.into(),
            outer_degrees,
            inner_degrees,
            intensity,
            radius,
        };
    let point = |position: [f32; 3]| Lighting::Point { position: position.into(), intensity, radius };
    let passes = passes(Channels::One, maps(96));
    for (name, light) in [
        ("a spot on all of it", spot([2.5, 3.5, -1.5], [0.3, 1.0, -0.2], 40.0, 30.0)),
        ("a spot on a part", spot([-2.0, 1.5, 1.0], [0.5, 1.2, -0.2], 12.0, 4.0)),
        ("a spot within", spot([0.2, 1.3, -0.1], [0.9, 0.6, 0.3], 75.0, 20.0)),
        ("a point near by", point([1.4, 2.2, 0.6])),
        ("a point within", point([0.35, 1.05, -0.3])),
    ] {
        let (position, cone) = match light {
            Lighting::Spot { position, target, outer_degrees, inner_degrees, .. } => {
                let axis = gpu::vector(target - position).normalised();
                let cosine = |degrees: f32| f64::from(degrees).to_radians().cos();
                (position, Some((axis, [cosine(inner_degrees), cosine(outer_degrees)])))
            }
            Lighting::Point { position, .. } | Lighting::Directional { towards: position, .. } => {
                (position, None)
            }
        };
        let own =
            LocalLight { position: gpu::vector(position), radius: f64::from(radius), intensity: 5.0, cone };
        let expected = local_grid(&boxed(placed()), &dense, &own, SIZE.map(|side| side as usize), FINE);
        let found = passes.scattered(gpu(), &texture, placed(), SIZE, &[light], None).unwrap();
        let [root, worst] = errors(found.read(gpu()).unwrap().into_iter(), &expected);
        println!("{name}: {:.2} % RMS, {:.2} % at worst", 100.0 * root, 100.0 * worst);
        assert!(root < 0.003 && worst < 0.015, "{name}: {root} {worst}");
    }
}

#[test]
fn a_plate_casts_its_shadow() {
    let mut random = Random(4);
    let extinction = cloud(SIZE, &mut random);
    let dense = grid(SIZE, &extinction, 1.0);
    let texture = volume(SIZE, &extinction, Channels::One);
    // One far above the volume and one within it.
    for (height, half) in [(4.0_f64, 0.6_f64), (1.1, 0.5)] {
        let lifted = Mat4::from_translation(glam::Vec3::new(0.2, height as f32, -0.1));
        let plate = plane(Vec2::splat(2.0 * half as f32), 1).transformed(lifted);
        let bounds = plate.bounds().unwrap();
        let meshes = [MeshBuffers::new(gpu(), &plate)];
        let casters = ShadowCasters { raster: gpu::raster(), meshes: &meshes, bounds };
        let towards = Vec3::new(0.15, 1.0, 0.1).normalised();
        let local = Vec3::new(0.4, 6.0, 0.2);
        let lights = [
            lighting(&sun(towards, 3.0)),
            Lighting::Spot {
                position: gpu::host_vector(local),
                target: glam::Vec3::new(0.3, 1.0, -0.2),
                outer_degrees: 30.0,
                inner_degrees: 25.0,
                intensity: glam::Vec3::splat(60.0),
                radius: 0.1,
            },
            Lighting::Point {
                position: gpu::host_vector(local),
                intensity: glam::Vec3::splat(60.0),
                radius: 0.1,
            },
        ];
        for (kind, light) in lights.iter().enumerate() {
            // Share of the way past the rim of the plate at which a light ray goes by: 0 and less meets it.
            let past = |point: Vec3| {
                let towards = if kind == 0 { towards } else { (local - point).normalised() };
                let way = (height - point.y) / towards.y;
                let at = point + towards * way;
                let aside = (at.x - 0.2).abs().max((at.z + 0.1).abs()) - half;
                if way < 0.0 { 1.0 } else { aside }
            };
            let passes = passes(Channels::One, maps(64));
            let open = passes.scattered(gpu(), &texture, placed(), SIZE, &[*light], None).unwrap();
            let shaded = passes.scattered(gpu(), &texture, placed(), SIZE, &[*light], Some(casters)).unwrap();
            let [open, shaded] = [&open, &shaded].map(|volume| volume.read(gpu()).unwrap());
            let inside = boxed(placed());
            let mut seen = [0; 2];
            for index in 0..count(SIZE) {
                let unit = [index % 32, index / 32 % 32, index / 1024].map(|i| (i as f64 + 0.5) / 32.0);
                let point = inside.world(Vec3::from(unit));
                let aside = past(point);
                // Not within a texel or two of the shadow's rim, nor on the plate itself.
                if aside.abs() < 0.03 || (point.y - height).abs() < 0.01 {
                    continue;
                }
                let lit = aside > 0.0;
                seen[usize::from(lit)] += 1;
                let expected = if lit { open[index] } else { 0.0 };
                assert!(
                    (shaded[index] - expected).abs() <= 1e-5 * expected,
                    "{kind} {height} {point:?}: {} {expected}",
                    shaded[index]
                );
            }
            println!("plate at {height} m, light {kind}: {} voxels in its shadow, {} not", seen[0], seen[1]);
            assert!(seen.iter().all(|count| *count > 200), "{seen:?}");
            if kind == 0 {
                let visible = |point: Vec3, _: Vec3| f64::from(u8::from(past(point) > 0.0));
                let expected = scattered_grid(
                    &inside,
                    &dense,
                    &[sun(towards, 3.0)],
                    SIZE.map(|side| side as usize),
                    FINE,
                    visible,
                );
                let [root, _] = errors(shaded.into_iter(), &expected);
                println!("plate at {height} m: {:.2} % RMS", 100.0 * root);
                // The rim is soft by the width of a texel.
                assert!(root < 0.02, "{root}");
            }
        }
    }
}

#[test]
fn black_lights_are_black_and_impossible_ones_are_refused() {
    let texture = volume([2; 3], &[1.0; 8], Channels::One);
    let passes = passes(Channels::One, maps(8));
    let light = |lights: &[Lighting]| passes.scattered(gpu(), &texture, placed(), [4; 3], lights, None);
    for lights in [vec![], vec![Lighting::directional(glam::Vec3::Y, glam::Vec3::ZERO)]] {
        assert_eq!(light(&lights).unwrap().read(gpu()).unwrap(), vec![0.0; 64]);
    }
    for radiance in [f32::NAN, f32::INFINITY, -1.0] {
        let refused = light(&[Lighting::directional(glam::Vec3::Y, glam::Vec3::new(1.0, radiance, 1.0))]);
        assert!(matches!(refused.err(), Some(InverseError::Setting(_))));
    }
    for towards in [glam::Vec3::ZERO, glam::Vec3::NAN] {
        let refused = light(&[Lighting::directional(towards, glam::Vec3::ONE)]);
        assert!(matches!(refused.err(), Some(InverseError::Light(_))));
    }
    let nowhere = Lighting::Point { position: glam::Vec3::INFINITY, intensity: glam::Vec3::ONE, radius: 0.1 };
    assert!(matches!(light(&[nowhere]).err(), Some(InverseError::Light(_))));
    for wrong in [
        LightMaps { texels: 0, ..maps(8) },
        LightMaps { layers: 5000, ..maps(8) },
        LightMaps { shadow_texels: 1, ..maps(8) },
    ] {
        let refused = LightPasses::new(gpu(), shaders(), Channels::One).unwrap().with_maps(wrong);
        assert!(matches!(refused.err(), Some(InverseError::Setting(_))));
    }
    let flat = Mat4::from_scale(glam::Vec3::new(1.0, 0.0, 1.0));
    let sun = [Lighting::directional(glam::Vec3::Y, glam::Vec3::ONE)];
    let refused = passes.scattered(gpu(), &texture, flat, [4; 3], &sun, None);
    assert!(matches!(refused.err(), Some(InverseError::Camera)));
    let refused = passes.scattered(gpu(), &texture, placed(), [1024; 3], &sun, None);
    assert!(matches!(refused.err(), Some(InverseError::Memory { .. })));
    let coloured = volume([2; 3], &[1.0; 8], Channels::Rgb);
    let refused = passes.scattered(gpu(), &coloured, placed(), [4; 3], &sun, None);
    assert!(matches!(refused.err(), Some(InverseError::Count { .. })));
}
