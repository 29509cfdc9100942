// SPDX-License-Identifier: MIT OR Apache-2.0
//! Sheets of splats: what a homogeneous slab lets through at any angle between eye and light, and that nothing is lost between
//! sheets.

use airlight::core::{Camera, DepthRange, Light, OrthographicView, PerspectiveView, Transfer, TransferPoint};
use airlight::data::Volume;

use crate::gpu::{gpu, shaders};
use airlight::splatting::{SheetFrame, SheetInputs, SheetLighting, SheetPicture, SheetSettings, Splats};
use glam::{Mat4, Vec3};

/// Opacity is the value, colour white.
fn straight() -> Transfer {
    let point = |value| TransferPoint { value, color: Vec3::ONE, opacity: value };
    Transfer::of_points(gpu(), &[point(0.0), point(1.0)], 1024).unwrap()
}

/// A box of halves of voxels of a metre, its middle in the origin.
fn slab(size: [u32; 3]) -> Volume {
    let sides = Vec3::from(size.map(|side| side as f32));
    let space = Mat4::from_translation(-0.5 * sides) * Mat4::from_scale(sides);
    Volume::new(size, vec![0.5; (size[0] * size[1] * size[2]) as usize], space).unwrap()
}

fn light_along(direction: Vec3, volume: &Volume) -> Light {
    let bounds = volume.bounds();
    Light::directional(-direction, Vec3::ONE, bounds.min - 3.0, bounds.max + 3.0).unwrap()
}

/// Transmittances in the middle of the picture and of the shadow buffer.
fn transmitted(volume: &Volume, camera: Camera, light: Light, extinction: f32, count: u32) -> [f64; 2] {
    let splats = Splats::new(gpu(), shaders(), volume, 0.0, None).unwrap();
    let settings = SheetSettings { count, light_size: [64; 2], ..SheetSettings::default() };
    let size = [camera.viewport.x as u32, camera.viewport.y as u32];
    let (splats, transfer) = (std::slice::from_ref(&splats), straight());
    let inputs = SheetInputs::new(splats, &transfer);
    let picture = SheetPicture::new(gpu(), shaders(), inputs, settings, size).unwrap();
    let lighting = SheetLighting::new(2.0 * extinction);
    picture.set(gpu(), &SheetFrame { camera, light, lighting }).unwrap();
    let mut encoder = gpu().encoder();
    picture.record(gpu(), &mut encoder).unwrap();
    gpu().submit(encoder).unwrap();
    let middle = |texture: &airlight::Texture, channel: usize| {
        let [width, height, _] = texture.size().map(|side| side as usize);
        let texels = texture.read(gpu()).unwrap();
        f64::from(texels[((height / 2) * width + width / 2) * 4 + channel])
    };
    [middle(&picture.picture, 3), middle(picture.shadow(), 0)]
}

#[test]
fn a_slab_lets_through_what_beer_and_lambert_say() {
    // Wide enough that the ray at the steepest angle leaves by the large faces.
    let volume = slab([40, 12, 24]);
    let thickness = 12.0_f64;
    let mut worst = [0.0_f64; 2];
    for angle in [0.0_f32, 30.0, 70.0, 89.0, 91.0, 120.0, 150.0] {
        for tau in [0.5_f64, 2.0, 4.0, 7.0] {
            // The light from straight above; the eye turns about z, seen from the slab's middle.
            let light = light_along(Vec3::NEG_Y, &volume);
            // At 89 and 91 degrees view rays would run within the slab: tilt both instead.
            let half = (0.5 * angle).to_radians();
            let view_direction = Vec3::new(half.sin(), -half.cos(), 0.0);
            let light_direction = Vec3::new(-half.sin(), -half.cos(), 0.0);
            let (view_direction, light) = if angle < 90.0 {
                (view_direction, light_along(light_direction, &volume))
            } else {
                // Against each other: the eye from below.
                let rest = (0.5 * (180.0 - angle)).to_radians();
                let eye = Vec3::new(rest.sin(), rest.cos(), 0.0);
                let down = Vec3::new(rest.sin(), -rest.cos(), 0.0);
                let _ = light;
                (eye, light_along(down, &volume))
            };
            let way = thickness / f64::from(view_direction.y.abs());
            let light_way = thickness / f64::from(light.direction.y.abs());
            let extinction = (tau / way) as f32;
            let camera = Camera::orthographic(
                &OrthographicView {
                    eye: -40.0 * view_direction,
                    target: Vec3::ZERO,
                    height: 8.0,
                    near: 0.0,
                    far: 100.0,
                    depth: DepthRange::Forward,
                },
                [33; 2],
            )
            .unwrap();
            let [seen, lit] = transmitted(&volume, camera, light, extinction, 48);
            for (i, (found, tau)) in [(seen, tau), (lit, tau * light_way / way)].into_iter().enumerate() {
                let expected = (-tau).exp();
                let error = (found - expected).abs();
                let allowed = if tau <= 4.0 { 0.01 * expected } else { 2e-4 };
                worst[i] = worst[i].max(error / allowed);
                println!("{angle} degrees, tau {tau:.3}: {found:.6} for {expected:.6}");
                assert!(error <= allowed, "{angle} degrees, tau {tau}: {found} for {expected}");
            }
        }
    }
    println!("worst share of what is allowed: {worst:.2?}");
}

/// Above, eye and light lie alike to the slab, so that sheets are parallel to it. Here they are as they happen to be, and so is the
/// lattice of the voxels.
#[test]
fn a_slab_at_any_tilt_to_the_sheets_lets_through_the_same() {
    let mut volume = slab([40, 12, 40]);
    volume.world_from_unit = Mat4::from_rotation_y(0.3) * volume.world_from_unit;
    let mut worst = [0.0_f64; 2];
    let mut tilts: f32 = 0.0;
    // Between the direction of the eye and straight down, and between the directions of eye and light, degrees.
    for (tilt, angle) in [
        (15.0_f32, 0.0_f32),
        (30.0, 30.0),
        (-10.0, 60.0),
        (0.0, 60.0),
        (-35.0, 89.0),
        (-35.0, 91.0),
        (0.0, 120.0),
        (-55.0, 110.0),
        (0.0, 150.0),
        (-30.0, 150.0),
        (25.0, 150.0),
    ] {
        let direction = |degrees: f32| {
            let (sine, cosine) = degrees.to_radians().sin_cos();
            Vec3::new(sine, -cosine, 0.0)
        };
        let (view, way) = (direction(tilt), direction(tilt + angle));
        assert!(
            (view.dot(way).acos().to_degrees() - angle).abs() < 0.1 && view.y.abs().min(way.y.abs()) > 0.49
        );
        let halfway = if view.dot(way) >= 0.0 { way + view } else { way - view }.normalize();
        tilts = tilts.max(halfway.y.abs().acos().to_degrees());
        for tau in [1.0_f64, 4.0, 7.0] {
            let [seen_way, lit_way] = [view, way].map(|way| 12.0 / f64::from(way.y.abs()));
            let light = light_along(way, &volume);
            let orthographic = OrthographicView {
                eye: -40.0 * view,
                target: Vec3::ZERO,
                height: 8.0,
                near: 0.0,
                far: 100.0,
                depth: DepthRange::Forward,
            };
            let camera = Camera::orthographic(&orthographic, [33; 2]).unwrap();
            let [seen, lit] = transmitted(&volume, camera, light, (tau / seen_way) as f32, 48);
            for (i, (found, tau)) in [(seen, tau), (lit, tau * lit_way / seen_way)].into_iter().enumerate() {
                let expected = (-tau).exp();
                let error = (found - expected).abs();
                let allowed = if tau <= 4.0 { 0.01 * expected } else { 2e-4 };
                worst[i] = worst[i].max(error / allowed);
                assert!(error <= allowed, "{tilt} and {angle} degrees, tau {tau}: {found} for {expected}");
            }
        }
    }
    println!("sheets tilted by up to {tilts:.0} degrees; worst share of what is allowed: {worst:.2?}");
    assert!(tilts > 30.0);
}

#[test]
fn a_perspective_camera_in_any_volume_sees_the_same() {
    // Unequal, turned and skewed voxels; the ray through the middle of both large faces.
    let mut volume = slab([30, 16, 30]);
    let skew = Mat4::from_cols_array(&[
        0.1, 0.02, 0.0, 0.0, 0.03, 0.2, 0.01, 0.0, 0.0, -0.01, 0.15, 0.0, 1.0, 2.0, 3.0, 1.0,
    ]);
    volume.world_from_unit = skew * volume.world_from_unit;
    let ahead = skew.transform_vector3(Vec3::NEG_Y);
    let view = PerspectiveView {
        eye: skew.transform_point3(Vec3::ZERO) - 30.0 * ahead,
        target: skew.transform_point3(Vec3::ZERO),
        field_of_view: 40.0,
        near: 0.01,
        far: 100.0,
        depth: DepthRange::Reversed,
    };
    let camera = Camera::perspective(&view, [33; 2]).unwrap();
    let bounds = volume.bounds();
    let light =
        Light::directional(Vec3::new(0.3, 1.0, 0.2), Vec3::ONE, bounds.min - 0.7, bounds.max + 0.7).unwrap();
    let way = 16.0 * f64::from(ahead.length());
    for tau in [1.0, 3.0] {
        let [seen, _] = transmitted(&volume, camera, light, (tau / way) as f32, 64);
        println!("tau {tau}: {seen:.6} for {:.6}", (-tau).exp());
        assert!((seen / (-tau).exp() - 1.0).abs() < 0.01, "{seen}");
    }
}
