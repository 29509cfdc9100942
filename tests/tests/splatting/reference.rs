// SPDX-License-Identifier: MIT OR Apache-2.0
//! A small cloud in sheets of splats against an f64 ray marcher with the same optical model, for more and more sheets; with a
//! transfer function that is no straight line; two clouds as one; and sheets from front to back against those from back to front.

use crate::gpu::gpu;
use crate::sheet_scene::{self, directions, field_of, small_cloud};
use crate::sheets::{Shot, colored, shoot, shoot_all, splats};
use airlight::core::{Camera, Light, Transfer, TransferPoint};
use airlight::data::{Volume, cloud};
use airlight::splatting::{SheetFrame, SheetInputs, SheetLighting, SheetSettings};
use airlight_tests::linear::Vec3;
use airlight_tests::reference::camera::Camera as ReferenceCamera;
use airlight_tests::reference::light::Light as ReferenceLight;
use airlight_tests::reference::splatting::{Medium, Ramp, Scene};
use glam::Mat4 as HostMat4;

const SIZE: [u32; 2] = [64, 40];
const ALBEDO: [[f64; 3]; 2] = [[0.95, 0.6, 0.3], [0.5, 0.7, 0.9]];
const MEDIUM: Medium = Medium { albedo: ALBEDO, extinction: 3.0, ambient: [0.02, 0.03, 0.05], g: 0.4 };
const RADIANCE: [f64; 3] = [9.0, 8.0, 6.0];

fn camera(direction: Vec3, parallel: bool) -> (ReferenceCamera, Camera) {
    sheet_scene::camera(direction, parallel, SIZE)
}

/// A light that goes in a direction at the cloud's middle.
fn light(direction: Vec3, spot: bool, volume: &Volume) -> (ReferenceLight, Light) {
    let bounds = volume.bounds();
    sheet_scene::light(direction, spot, RADIANCE, [bounds.min - 0.5, bounds.max + 0.5])
}

fn lighting() -> SheetLighting {
    let ambient = MEDIUM.ambient.map(|x| x as f32).into();
    SheetLighting { ambient, g: MEDIUM.g as f32, ..SheetLighting::new(MEDIUM.extinction as f32) }
}

/// Root of the mean square of differences of radiance over that of the truth, and greatest difference of transmittance.
fn differences<'a>(found: &Shot, truth: impl Iterator<Item = &'a [f64; 4]>) -> [f64; 2] {
    let (mut error, mut all, mut clear) = (0.0, 0.0, 0.0_f64);
    for (found, truth) in found.picture.chunks_exact(4).zip(truth) {
        for channel in 0..3 {
            error += (f64::from(found[channel]) - truth[channel]).powi(2);
            all += truth[channel].powi(2);
        }
        clear = clear.max((f64::from(found[3]) - truth[3]).abs());
    }
    assert!(all > 0.0);
    [(error / all).sqrt(), clear]
}

#[test]
fn a_cloud_is_what_a_ray_marcher_makes_of_it() {
    let volume = small_cloud();
    let field = field_of(&volume);
    let splats = splats(&volume);
    let transfer = colored(ALBEDO.map(|color| color.map(|x| x as f32).into()));
    let size = SIZE.map(|side| side as usize);
    for (degrees, parallel, spot) in
        [(40.0, false, false), (40.0, true, true), (130.0, true, false), (130.0, false, true)]
    {
        let name = format!("{degrees} degrees, parallel {parallel}, spot {spot}");
        let [view, way] = directions(degrees);
        let (reference, camera) = camera(view, parallel);
        let (reference_light, light) = light(way, spot, &volume);
        let radiance = RADIANCE.map(|x| if spot { 30.0 * x } else { x });
        let scene = Scene { field: &field, medium: MEDIUM, light: reference_light, radiance, step: 0.08 };
        let truth = scene.picture(&reference, size);
        let frame = SheetFrame { camera, light, lighting: lighting() };
        let errors = [16, 32, 64, 128].map(|count| {
            let settings = SheetSettings { count, light_size: [192; 2], ..SheetSettings::default() };
            let shot = shoot(&splats, &transfer, settings, &frame);
            let [radiance, transmittance] = differences(&shot, truth.iter());
            println!("{name}, {count} sheets: radiance {radiance:.5}, transmittance {transmittance:.5}");
            radiance
        });
        assert!(errors[1] <= 0.03 && errors[3] <= 0.005, "{name}: {errors:?}");
        assert!(errors.windows(2).all(|pair| pair[1] < pair[0]), "{name}: {errors:?}");
    }
}

/// Clear up to one value and opaque from another on; the colour goes straight from value 0 to value 1.
fn ramp([clear, opaque]: [f64; 2]) -> Transfer {
    let [none, full] = ALBEDO.map(|color| glam::Vec3::from(color.map(|x| x as f32)));
    let point = |value: f64, opacity| {
        let value = value as f32;
        TransferPoint { value, color: none.lerp(full, value), opacity }
    };
    let points = [point(0.0, 0.0), point(clear, 0.0), point(opaque, 1.0), point(1.0, 1.0)];
    Transfer::of_points(gpu(), &points, 1025).unwrap()
}

/// What is classified is the mean of a sheet, not voxels: so a surface comes out where the field has it, and the sharper the
/// thinner the sheets are.
#[test]
fn a_surface_in_a_cloud_is_what_a_ray_marcher_makes_of_it() {
    let volume = small_cloud();
    let field = field_of(&volume);
    let splats = splats(&volume);
    let values = [0.3, 0.5];
    for degrees in [40.0, 130.0] {
        let [view, way] = directions(degrees);
        let (reference, camera) = camera(view, false);
        let (reference_light, light) = light(way, false, &volume);
        let matter = Ramp { matter: &field, values };
        let scene =
            Scene { field: &matter, medium: MEDIUM, light: reference_light, radiance: RADIANCE, step: 0.02 };
        let truth = scene.picture(&reference, SIZE.map(|side| side as usize));
        let frame = SheetFrame { camera, light, lighting: lighting() };
        let errors = [32, 64, 128, 256].map(|count| {
            let settings = SheetSettings { count, light_size: [256; 2], ..SheetSettings::default() };
            let shot = shoot(&splats, &ramp(values), settings, &frame);
            let [radiance, transmittance] = differences(&shot, truth.iter());
            println!(
                "{degrees} degrees, {count} sheets: radiance {radiance:.5}, transmittance {transmittance:.5}"
            );
            radiance
        });
        assert!(errors[2] <= 0.03 && errors[3] <= 0.01, "{degrees}: {errors:?}");
        assert!(errors.windows(2).all(|pair| pair[1] < 0.8 * pair[0]), "{degrees}: {errors:?}");
    }
}

/// A volume elsewhere, with `share` of its values.
fn moved(volume: &Volume, by: glam::Vec3, share: f32) -> Volume {
    let turn = HostMat4::from_translation(by) * HostMat4::from_rotation_y(0.6);
    Volume {
        size: volume.size,
        values: volume.values.iter().map(|value| value * share).collect(),
        world_from_unit: turn * volume.world_from_unit,
    }
}

#[test]
fn two_clouds_are_what_a_ray_marcher_makes_of_their_sum() {
    let transfer = colored(ALBEDO.map(|color| color.map(|x| x as f32).into()));
    let small = cloud([20, 10, 18], 8);
    for (name, apart) in [("overlapping", 0.8_f32), ("side by side", 3.4)] {
        // Of unequal voxels; values stay below 1 where they add up.
        let volumes = [
            moved(&small_cloud(), glam::Vec3::new(-0.5 * apart, 0.1, 0.2), 0.5),
            moved(&small, glam::Vec3::new(0.5 * apart, -0.2, 0.0), 0.5 / 3.0),
        ];
        let fields = volumes.each_ref().map(field_of);
        let splats = volumes.each_ref().map(splats);
        let whole = {
            let [a, b] = volumes.each_ref().map(Volume::bounds);
            let (low, high) = (a.min.min(b.min), a.max.max(b.max));
            let space = HostMat4::from_translation(low) * HostMat4::from_scale(high - low);
            Volume::new([1; 3], vec![0.0], space).unwrap()
        };
        for degrees in [40.0, 130.0] {
            let [view, way] = directions(degrees);
            let (reference, camera) = camera(view, true);
            let (reference_light, light) = light(way, false, &whole);
            let scene = Scene {
                field: &fields[..],
                medium: MEDIUM,
                light: reference_light,
                radiance: RADIANCE,
                step: 0.08,
            };
            let truth = scene.picture(&reference, SIZE.map(|side| side as usize));
            let frame = SheetFrame { camera, light, lighting: lighting() };
            let settings = SheetSettings { count: 96, light_size: [256; 2], ..SheetSettings::default() };
            let shot = shoot_all(SheetInputs::new(&splats, &transfer), settings, &frame);
            let [radiance, transmittance] = differences(&shot, truth.iter());
            println!("{name}, {degrees} degrees: radiance {radiance:.5}, transmittance {transmittance:.5}");
            assert!(radiance <= 0.01, "{name}, {degrees}: {radiance}");
            // Each of them matters.
            for one in &splats {
                let alone = shoot(one, &transfer, settings, &frame);
                assert!(differences(&alone, truth.iter())[0] > 0.2, "{name}, {degrees}");
            }
        }
    }
}

/// Voxels `from` to `to` along x as a volume by themselves.
fn part(volume: &Volume, from: u32, to: u32) -> Volume {
    let [width, height, slices] = volume.size;
    let rows = volume.values.chunks_exact(width as usize);
    let values = rows.flat_map(|row| row[from as usize..to as usize].to_vec()).collect();
    let [from, to, width] = [from, to, width].map(|side| side as f32);
    let place = HostMat4::from_translation(glam::Vec3::X * (from / width));
    let stretch = HostMat4::from_scale(glam::Vec3::new((to - from) / width, 1.0, 1.0));
    let size = [(to - from) as u32, height, slices];
    Volume::new(size, values, volume.world_from_unit * place * stretch).unwrap()
}

#[test]
fn a_cloud_in_two_halves_is_the_whole() {
    let volume = small_cloud();
    let transfer = colored(ALBEDO.map(|color| color.map(|x| x as f32).into()));
    let halves = [part(&volume, 0, 13), part(&volume, 13, 32)].map(|half| splats(&half));
    let whole = splats(&volume);
    assert_eq!(halves.iter().map(airlight::splatting::Splats::count).sum::<u64>(), whole.count());
    for (degrees, count) in [(40.0, 64), (130.0, 37)] {
        let [view, way] = directions(degrees);
        let (_, camera) = camera(view, false);
        let (_, light) = light(way, true, &volume);
        let frame = SheetFrame { camera, light, lighting: lighting() };
        let settings = SheetSettings { count, light_size: [192; 2], ..SheetSettings::default() };
        let one = shoot(&whole, &transfer, settings, &frame);
        let two = shoot_all(SheetInputs::new(&halves, &transfer), settings, &frame);
        let greatest = one.picture.iter().copied().fold(0.0_f32, f32::max);
        let difference = one.picture.iter().zip(&two.picture).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        println!("{degrees} degrees: at most {:.6} of the greatest value", difference / greatest);
        // Places of voxels are rounded otherwise, and a half float rounds by 0.0005 of itself.
        assert!(difference <= 0.001 * greatest, "{degrees}: {difference} of {greatest}");
    }
}

#[test]
fn the_reference_has_converged() {
    let volume = small_cloud();
    let field = field_of(&volume);
    let [view, way] = directions(40.0);
    let (camera, _) = camera(view, false);
    let (light, _) = light(way, false, &volume);
    let scene = |step| Scene { field: &field, medium: MEDIUM, light, radiance: RADIANCE, step };
    let mut worst = 0.0_f64;
    for (x, y) in [(32, 20), (20, 15), (40, 28), (28, 24)] {
        let ndc = ReferenceCamera::pixel_ndc(x, y, 64, 40);
        let [coarse, fine] = [0.08, 0.02].map(|step| scene(step).ray(camera.origin(ndc), camera.ray(ndc)));
        for channel in 0..4 {
            worst = worst.max((coarse[channel] / fine[channel] - 1.0).abs());
        }
    }
    println!("a quarter of the step changes {worst:.5}");
    assert!(worst < 0.005, "{worst}");
}

#[test]
fn front_to_back_agrees_with_back_to_front() {
    let volume = small_cloud();
    let splats = splats(&volume);
    let transfer = colored(ALBEDO.map(|color| color.map(|x| x as f32).into()));
    // A fifth of a degree turns the light by next to nothing and the sheets by a right angle: what differs is that the same
    // field is cut along other planes, which falls with the number of sheets.
    let mut differ = Vec::new();
    for count in [32, 128] {
        let [front, back] = [89.9, 90.1].map(|degrees| {
            let [view, way] = directions(degrees);
            let (_, camera) = camera(view, false);
            let (_, light) = light(way, false, &volume);
            let settings = SheetSettings { count, light_size: [192; 2], ..SheetSettings::default() };
            shoot(&splats, &transfer, settings, &SheetFrame { camera, light, lighting: lighting() })
        });
        let back: Vec<[f64; 4]> =
            back.picture.chunks_exact(4).map(|pixel| [0, 1, 2, 3].map(|i| f64::from(pixel[i]))).collect();
        let [radiance, transmittance] = differences(&front, back.iter());
        println!("{count} sheets: radiance {radiance:.5}, transmittance {transmittance:.5}");
        differ.push(radiance);
    }
    assert!(differ[1] < 0.02 && differ[1] < 0.6 * differ[0], "{differ:?}");
}
