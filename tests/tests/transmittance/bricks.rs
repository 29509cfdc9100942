// SPDX-License-Identifier: MIT OR Apache-2.0
//! Passing over empty bricks changes neither a map nor a picture.

use crate::gpu::{gpu, shaders};
use airlight::core::{Bricks, Camera, DepthRange, Light, PerspectiveView, Reading, VolumeTexture};
use airlight::data::Volume;
use airlight::transmittance::{
    Form, MapSettings, MediumLighting, MediumView, TransmittanceMap, VolumePicture, Voxels,
};
use airlight::{Buffer, Texture};
use glam::{Mat4, Vec3};

const SIZE: [u32; 2] = [48, 32];

/// Balls of extinction, far apart, in a box that lies askew.
fn volume() -> Volume {
    let size = [70_u32, 52, 60];
    let balls = [([12.0, 10.0, 14.0], 5.0), ([50.0, 40.0, 44.0], 7.0), ([60.0, 9.0, 30.0], 4.0_f32)];
    let mut values = Vec::new();
    for z in 0..size[2] {
        for y in 0..size[1] {
            for x in 0..size[0] {
                let at = Vec3::new(x as f32, y as f32, z as f32);
                let inside =
                    |(middle, radius): &([f32; 3], f32)| (at - Vec3::from(*middle)).length() < *radius;
                values.push(if balls.iter().any(inside) { 3.0 } else { 0.0 });
            }
        }
    }
    let space = Mat4::from_rotation_y(0.5)
        * Mat4::from_translation(Vec3::splat(-1.0))
        * Mat4::from_scale(Vec3::splat(2.0));
    Volume::new(size, values, space).unwrap()
}

/// The layers of a map of the volume and its picture; without settings the picture of the reference.
fn drawn(uploaded: &VolumeTexture, reading: Reading, settings: Option<MapSettings>) -> (Vec<f32>, Vec<f32>) {
    let bounds = volume().bounds();
    let light = Light::directional(Vec3::new(0.4, 0.8, 0.3), Vec3::ONE, bounds.min, bounds.max).unwrap();
    let view = PerspectiveView {
        eye: Vec3::new(1.0, 1.5, 4.0),
        target: Vec3::ZERO,
        field_of_view: 45.0,
        near: 0.1,
        far: 20.0,
        depth: DepthRange::Forward,
    };
    let camera = Camera::perspective(&view, SIZE).unwrap();
    let depth = Texture::storage(gpu(), SIZE, wgpu::TextureFormat::R32Float);
    depth.write(gpu(), &vec![camera.far_depth; (SIZE[0] * SIZE[1]) as usize]).unwrap();
    let lighting = MediumLighting::new(Vec3::ONE, 0.3, 100.0).unwrap();
    let [camera, lighting] = [Buffer::uniform(gpu(), &camera), Buffer::uniform(gpu(), &lighting)];
    let seen = MediumView { camera: &camera, lighting: &lighting, depth: &depth };
    let mut encoder = gpu().encoder();
    let Some(settings) = settings else {
        let light = Buffer::uniform(gpu(), &light);
        let pass = VolumePicture::reference(gpu(), shaders(), reading).unwrap();
        let bound = pass.bind_reference(gpu(), &seen, &light, uploaded).unwrap();
        pass.record(&mut encoder, &bound);
        gpu().submit(encoder).unwrap();
        return (Vec::new(), bound.picture.read(gpu()).unwrap());
    };
    let map = TransmittanceMap::new(gpu(), settings, &light).unwrap();
    let voxels = Voxels::new(gpu(), shaders(), settings, reading).unwrap();
    voxels.record(&mut encoder, &voxels.bind(gpu(), &map, uploaded).unwrap());
    let pass = VolumePicture::new(gpu(), shaders(), settings, false, reading).unwrap();
    let bound = pass.bind(gpu(), &seen, &map, uploaded).unwrap();
    pass.record(&mut encoder, &bound);
    gpu().submit(encoder).unwrap();
    (map.coefficients.read(gpu()).unwrap(), bound.picture.read(gpu()).unwrap())
}

fn greatest(a: &[f32], b: &[f32]) -> f32 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

#[test]
fn maps_and_pictures_are_the_same_with_bricks_and_without() {
    let volume = volume();
    for reading in [Reading::Linear, Reading::Nearest] {
        let plain = VolumeTexture::new(gpu(), &volume, 1.0, reading).unwrap();
        let mut bricked = VolumeTexture::new(gpu(), &volume, 1.0, reading).unwrap();
        Bricks::new(gpu(), shaders()).unwrap().give(gpu(), &mut bricked).unwrap();
        let distances = bricked.brick_distances.read_words(gpu()).unwrap();
        assert!(distances.contains(&0) && distances.iter().any(|distance| *distance > 1), "{distances:?}");
        let mut all: Vec<Option<MapSettings>> = Form::ALL
            .iter()
            .map(|form| Some(MapSettings::new(*form, if form.moments() { 8 } else { 4 }, [40, 40])))
            .collect();
        all.push(None);
        for settings in all {
            let (with, without) = (drawn(&bricked, reading, settings), drawn(&plain, reading, settings));
            assert!(without.1.chunks_exact(4).any(|pixel| pixel[3] < 0.3), "nothing to see");
            let sums = settings.is_some_and(|s| matches!(s.form, Form::Function | Form::FunctionPeriodic));
            if sums {
                // Empty runs are projected as wholes, not step by step.
                assert!(greatest(&with.0, &without.0) < 1e-5, "{settings:?}");
                assert!(greatest(&with.1, &without.1) < 1e-3, "{settings:?}");
            } else {
                assert!(with == without, "{settings:?} {reading:?}: {}", greatest(&with.1, &without.1));
            }
        }
    }
}
