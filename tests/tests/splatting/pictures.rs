// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pictures by sheets of splats: constant volumes are constant, batches and sorting change no bit, nothing and nonsense have
//! defined pictures, and a ball has the normals of a ball.

use crate::gpu::{gpu, shaders};
use crate::sheets::{self, colored, metres, parallel, shoot, splats};
use airlight::core::{Camera, DepthRange, Light, PerspectiveView};
use airlight::data::{Volume, cloud};
use airlight::splatting::{
    Shading, SheetFrame, SheetInputs, SheetLighting, SheetPicture, SheetSettings, Splats, SplattingError,
    light_around,
};
use glam::Vec3;

fn perspective(eye: Vec3, size: [u32; 2]) -> Camera {
    let (target, depth) = (Vec3::ZERO, DepthRange::Reversed);
    let view = PerspectiveView { eye, target, field_of_view: 40.0, near: 0.01, far: 100.0, depth };
    Camera::perspective(&view, size).unwrap()
}

fn sun(direction: Vec3, volume: &Volume) -> Light {
    let bounds = volume.bounds();
    Light::directional(-direction, Vec3::new(3.0, 2.0, 1.0), bounds.min - 2.5, bounds.max + 2.5).unwrap()
}

fn few(count: u32) -> SheetSettings {
    SheetSettings { count, light_size: [32; 2], ..SheetSettings::default() }
}

#[test]
fn footprints_of_a_constant_volume_add_up_to_a_constant() {
    let volume = metres([28, 12, 28], |_| 0.5);
    let splats = splats(&volume);
    let transfer = colored([Vec3::ONE; 2]);
    let mut worst = [0.0_f64; 2];
    for [turn, tilt] in [[0.0_f32, 0.0], [0.3, 0.25], [1.0, 0.5], [0.785, 0.7]] {
        let direction = Vec3::new(tilt.sin() * turn.cos(), -tilt.cos(), tilt.sin() * turn.sin());
        let way = 12.0 / f64::from(direction.y.abs());
        // Light from the other side of the normal tilts the sheets.
        let light = Vec3::new(-0.4, -1.0, 0.3).normalize();
        for count in [1, 15] {
            let lighting = SheetLighting::new((2.0 / way) as f32);
            // Pixels of a seventh of a voxel, so that they see all of the lattice.
            let frame =
                SheetFrame { camera: parallel(direction, 3.0, 21), light: sun(light, &volume), lighting };
            let shot = shoot(&splats, &transfer, few(count), &frame);
            for pixel in shot.picture.chunks_exact(4) {
                worst[0] = worst[0].max((-f64::from(pixel[3]).ln() - 1.0).abs());
            }
            // Around the middle of the shadow buffer, where light rays go through both large faces.
            let depth = 12.0 / f64::from(light.y.abs()) / way;
            for texels in shot.shadow.chunks_exact(4 * 32).skip(13).take(7) {
                for texel in texels.chunks_exact(4).skip(13).take(7) {
                    let found = -(f64::from(texel[0]) / 3.0).ln();
                    worst[1] = worst[1].max((found / depth - 1.0).abs());
                }
            }
        }
    }
    println!("optical depth of pixels and of texels of the shadow buffer from that of the slab: {worst:.5?}");
    assert!(worst.iter().all(|worst| *worst < 0.01), "{worst:?}");
}

/// Two thin clouds of one kind: what comes from them is as the inverse squares of their distances from a point light.
#[test]
fn light_of_a_point_falls_off_with_the_square_of_the_distance() {
    let position = Vec3::new(-16.0, 0.0, 0.0);
    // Balls of a metre and a half, 8 and 24 m from the light.
    let ball = |place: Vec3, x: f32| f32::from((place - Vec3::new(x, 0.0, 0.0)).length() < 1.6);
    let volume = metres([22, 6, 6], |place| 1e-3 * (ball(place, -8.0) + ball(place, 8.0)));
    let splats = [splats(&volume)];
    let corners: Vec<Vec3> =
        airlight::data::Bounds { min: volume.bounds().min - 2.0, max: volume.bounds().max + 2.0 }
            .corners()
            .into();
    let lighting = airlight::Lighting::Point { position, intensity: Vec3::splat(500.0), radius: 0.01 };
    let light = light_around(&lighting, &corners).unwrap();
    let transfer = colored([Vec3::ONE; 2]);
    let frame =
        SheetFrame { camera: parallel(Vec3::NEG_Z, 24.0, 96), light, lighting: SheetLighting::new(10.0) };
    let settings = SheetSettings { light_size: [128; 2], ..few(64) };
    let inputs = SheetInputs::new(&splats, &transfer);
    let shot = sheets::shoot_all(inputs, settings, &frame);
    let side = |far: bool| -> f64 {
        let pixels = shot.picture.chunks_exact(4).enumerate();
        pixels.filter(|(index, _)| (index % 96 >= 48) == far).map(|(_, pixel)| f64::from(pixel[0])).sum()
    };
    // The mean of 1 / d^2 over a ball of radius R and a Gaussian of variance V is (1 + R^2 / (5 d^2) + V / d^2) / d^2.
    let mean = |d: f64| (1.0 + (1.6_f64.powi(2) / 5.0 + 0.49) / (d * d)) / (d * d);
    let expected = mean(8.0) / mean(24.0);
    let ratio = side(false) / side(true);
    println!("{ratio} of {expected}");
    assert!((ratio / expected - 1.0).abs() < 0.02, "{ratio}");
}

/// Over the whole shadow buffer, row for row.
#[test]
fn light_textures_lie_over_the_shadow_buffer() {
    let (volume, frame) = cloud_frame(60.0);
    let none = [Splats::new(gpu(), shaders(), &volume, 10.0, None).unwrap()];
    let transfer = colored([Vec3::ONE; 2]);
    let image = airlight::data::LightImage::from_function([32, 32], |at| Vec3::new(at.x, at.y, 0.25));
    let texture = airlight::light_texture(gpu(), &image).unwrap();
    let position = Vec3::new(0.4, 0.5, 9.0);
    let local = airlight::Lighting::Point { position, intensity: frame.light.radiance, radius: 0.1 };
    let local = light_around(&local, &volume.bounds().corners()).unwrap();
    for light in [frame.light, local] {
        let inputs = SheetInputs { light_texture: Some(&texture), ..SheetInputs::new(&none, &transfer) };
        let shot = sheets::shoot_all(inputs, few(4), &SheetFrame { light, ..frame });
        for (index, texel) in shot.shadow.chunks_exact(4).enumerate() {
            let [x, y] = [index % 32, index / 32].map(|place| (place as f32 + 0.5) / 32.0);
            let expected = Vec3::new(x, y, 0.25) * Vec3::new(3.0, 2.0, 1.0);
            let found = Vec3::from_slice(texel);
            assert!((found - expected).abs().max_element() < 4e-3, "{index}: {found} {expected}");
        }
    }
}

fn cloud_frame(degrees: f32) -> (Volume, SheetFrame) {
    let mut volume = cloud([24, 14, 20], 5);
    volume.values.iter_mut().for_each(|value| *value /= 3.0);
    let angle = degrees.to_radians();
    let light = sun(Vec3::new(angle.sin(), -0.2, -angle.cos()).normalize(), &volume);
    let lighting = SheetLighting { g: 0.5, ambient: Vec3::splat(0.1), ..SheetLighting::new(4.0) };
    let camera = perspective(Vec3::new(0.3, 0.5, 9.0), [48, 32]);
    (volume, SheetFrame { camera, light, lighting })
}

#[test]
fn batches_sorting_and_repetition_change_no_bit() {
    for shading in [Shading::Scattering, Shading::Phong] {
        for degrees in [35.0, 140.0] {
            let (volume, frame) = cloud_frame(degrees);
            let whole = splats(&volume);
            let parts = Splats::new(gpu(), shaders(), &volume, 0.0, Some(1000)).unwrap();
            assert!(whole.batches() == 1 && parts.batches() > 3 && whole.count() == parts.count());
            let lit =
                volume.values.iter().filter(|value| half::f16::from_f32(**value).to_f32() > 0.0).count();
            assert_eq!(whole.count(), lit as u64);
            let transfer = colored([Vec3::ONE, Vec3::new(0.9, 0.5, 0.2)]);
            let settings = SheetSettings { shading, ..few(20) };
            let first = shoot(&whole, &transfer, settings, &frame);
            assert!(first.picture.chunks_exact(4).any(|pixel| pixel[0] > 0.01 && pixel[3] < 0.9));
            assert!(first.same(&shoot(&whole, &transfer, settings, &frame)), "{shading:?} {degrees}: twice");
            assert!(
                first.same(&shoot(&parts, &transfer, settings, &frame)),
                "{shading:?} {degrees}: batches"
            );
            let scanning = SheetSettings { scanning: true, ..settings };
            for splats in [&whole, &parts] {
                assert!(
                    first.same(&shoot(splats, &transfer, scanning, &frame)),
                    "{shading:?} {degrees}: scanning"
                );
            }
        }
    }
}

#[test]
fn no_splats_are_no_medium() {
    let (volume, frame) = cloud_frame(60.0);
    let none = Splats::new(gpu(), shaders(), &volume, 10.0, None).unwrap();
    assert_eq!((none.count(), none.batches()), (0, 0));
    for scanning in [false, true] {
        let settings = SheetSettings { scanning, ..few(9) };
        let shot = shoot(&none, &colored([Vec3::ONE; 2]), settings, &frame);
        assert!(shot.picture.chunks_exact(4).all(|pixel| pixel == [0.0, 0.0, 0.0, 1.0]));
        assert!(shot.shadow.chunks_exact(4).all(|texel| texel[..3] == [3.0, 2.0, 1.0]));
    }
}

#[test]
fn nonsense_leaves_no_hole() {
    let (mut volume, frame) = cloud_frame(60.0);
    for (place, value) in
        [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, 3e38, 1e-30].into_iter().enumerate()
    {
        let middle = (10 * 14 + 7) * 24 + 8;
        volume.values[middle + place] = value;
    }
    let splats = splats(&volume);
    // 3e38 is infinite in a half float and 1e-30 nothing.
    let halves = volume.values.iter().map(|value| half::f16::from_f32(*value).to_f32());
    assert_eq!(splats.count(), halves.filter(|value| value.is_finite() && *value > 0.0).count() as u64);
    let transfer = colored([Vec3::ONE; 2]);
    let view = Vec3::new(-0.3, -0.5, -9.0).normalize();
    let inside = perspective(Vec3::new(0.2, 0.1, 0.3), [48, 32]);
    let lights = [view, -view, Vec3::X];
    let spots = [Vec3::new(0.1, 0.0, 0.2), Vec3::new(0.3, 0.5, 9.0)].map(|position| {
        Light::spot(position, Vec3::ZERO, 40.0, 20.0, Vec3::splat(20.0), 0.05, 0.05, 30.0).unwrap()
    });
    let all = lights.iter().map(|direction| sun(*direction, &volume)).chain(spots);
    for light in all {
        for camera in [frame.camera, inside, parallel(view, 5.0, 40)] {
            for shading in [Shading::Scattering, Shading::Phong] {
                let settings = SheetSettings { shading, ..few(12) };
                for extinction in [4.0, 1e6] {
                    let lighting = SheetLighting { extinction, ..frame.lighting };
                    let shot = shoot(&splats, &transfer, settings, &SheetFrame { camera, light, lighting });
                    assert!(shot.is_sound(), "{light:?} {camera:?} {shading:?} {extinction}");
                    assert!(shot.picture.chunks_exact(4).all(|pixel| pixel[3] <= 1.0));
                }
            }
        }
    }
}

#[test]
fn impossible_settings_are_refused() {
    let (volume, frame) = cloud_frame(60.0);
    let splats = splats(&volume);
    let transfer = colored([Vec3::ONE; 2]);
    let inputs = SheetInputs::new(std::slice::from_ref(&splats), &transfer);
    let new = |settings, size| SheetPicture::new(gpu(), shaders(), inputs, settings, size);
    for (settings, size) in [
        (few(0), [48, 32]),
        (few(5000), [48, 32]),
        (few(8), [0, 32]),
        (SheetSettings { light_size: [0, 4], ..few(8) }, [48, 32]),
    ] {
        assert!(matches!(new(settings, size), Err(SplattingError::Setting(_))));
    }
    let picture = new(few(8), [32, 32]).unwrap();
    assert!(matches!(picture.set(gpu(), &frame), Err(SplattingError::Viewport { .. })));
    let picture = new(few(8), [48, 32]).unwrap();
    for lighting in [
        SheetLighting { extinction: f32::NAN, ..frame.lighting },
        SheetLighting { extinction: -1.0, ..frame.lighting },
        SheetLighting { g: 1.0, ..frame.lighting },
        SheetLighting { ambient: Vec3::splat(f32::INFINITY), ..frame.lighting },
        SheetLighting { shininess: 0.0, ..frame.lighting },
    ] {
        let refused = picture.set(gpu(), &SheetFrame { lighting, ..frame });
        assert!(matches!(refused, Err(SplattingError::Setting(_))));
    }
}

/// Where a ray along `direction` enters the ball about the origin; its normal there.
fn normal_of_ball(offset: Vec3, direction: Vec3, radius: f32) -> Option<Vec3> {
    let square = radius * radius - offset.length_squared();
    (square > 0.0).then(|| (offset - direction * square.sqrt()) / radius)
}

#[test]
fn a_ball_lit_by_phong_has_the_normals_of_a_ball() {
    // Rises from 0 to 1 over two voxels.
    let radius = 11.0_f32;
    let volume = metres([30; 3], |place| ((radius + 1.0 - place.length()) / 2.0).clamp(0.0, 1.0));
    let splats = splats(&volume);
    let transfer = colored([Vec3::ONE; 2]);
    let view = Vec3::new(-0.2, -0.3, -0.9).normalize();
    let side = 40;
    let camera = parallel(view, 24.0, side);
    let [right, up] = [0, 1].map(|row| camera.clip_from_world.row(row).truncate().normalize());
    for degrees in [0.0_f32, 50.0] {
        let angle = degrees.to_radians();
        let way = view * angle.cos() + right * angle.sin();
        let light = sun(way, &volume);
        let lighting = SheetLighting { diffuse: 1.0, specular: 0.0, ..SheetLighting::new(1.5) };
        let settings = SheetSettings { shading: Shading::Phong, light_size: [256; 2], ..few(256) };
        let shot = shoot(&splats, &transfer, settings, &SheetFrame { camera, light, lighting });
        let (mut sum, mut worst, mut pixels) = (0.0_f32, 0.0_f32, 0);
        for (index, pixel) in shot.picture.chunks_exact(4).enumerate() {
            let [x, y] = [index as u32 % side, index as u32 / side].map(|i| (i as f32 + 0.5) / side as f32);
            let offset = right * (24.0 * (x - 0.5)) + up * (24.0 * (0.5 - y));
            let Some(normal) = normal_of_ball(offset, view, radius) else { continue };
            let [to_eye, to_light] = [view, way].map(|way| -normal.dot(way));
            // Where either grazes the ball, the layer is no plane.
            // Where it faces the light, one percent of brightness is seven degrees.
            if to_eye < 0.5 || !(0.5..0.95).contains(&to_light) {
                continue;
            }
            // A layer that rises from nothing to opaque, however it does: light and sight are taken by it in proportion to the
            // inverse cosines, so that cos^2 / (cos + cos of the eye) of what falls in comes out.
            let brightness = |cosine: f32| 3.0 / std::f32::consts::PI * cosine * cosine / (cosine + to_eye);
            let (mut low, mut high) = (0.0_f32, 1.0);
            for _ in 0..40 {
                let middle = 0.5 * (low + high);
                let below = brightness(middle) < pixel[0];
                (low, high) = if below { (middle, high) } else { (low, middle) };
            }
            let error = (low.acos() - to_light.acos()).to_degrees().abs();
            (sum, worst, pixels) = (sum + error, worst.max(error), pixels + 1);
        }
        let mean = sum / pixels as f32;
        println!(
            "light at {degrees} degrees from the view, {pixels} pixels: {mean:.2} degrees off, {worst:.2} at most"
        );
        assert!(pixels > 250 && mean < 2.5 && worst < 8.0, "{degrees}: {mean} {worst}");
    }
}
