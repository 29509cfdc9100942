// SPDX-License-Identifier: MIT OR Apache-2.0
//! A picture that no method drew, for any ray there is.

use super::baking::texels;
use crate::gpu::{self, Random, gpu};
use crate::probing::f;
use airlight::core::{Camera, Light};
use airlight::scattering::{Inputs, Medium};
use airlight::stylize::{PickScene, RayProperty};
use airlight::{Buffer, Texture};
use airlight_tests::linear;
use airlight_tests::reference::camera::Camera as ReferenceCamera;
use airlight_tests::reference::stylize::transfer as reference;
use glam::Vec3;
use std::collections::BTreeMap;
use wgpu::TextureFormat::{R32Float, Rgba16Float};

/// A picture that no method drew: any camera, any light, any depth, any scattered light.
pub struct Synthetic {
    pub reference: ReferenceCamera,
    pub camera: Camera,
    pub light: Light,
    pub source: reference::Source,
    pub medium: Medium,
    pub buffers: [Buffer; 3],
    pub depth: Texture,
    pub shadow_map: Texture,
    pub scattered: Texture,
}

pub const SIZE: [u32; 2] = [24, 16];

impl Synthetic {
    pub fn new(random: &mut Random) -> Self {
        let reference = random.camera(1.5);
        let camera = gpu::host_camera(&reference, SIZE);
        let towards = random.light(&reference);
        let matrix = gpu::light_matrix(towards, linear::Vec3::new(0.0, 0.0, 0.0), 10.0, 1.0);
        let radiance = Vec3::from([0; 3].map(|_| random.between(0.0, 12.0) as f32));
        let mut light = gpu::host_light(towards, matrix, 1.0, radiance);
        let mut source = reference::Source::Towards(gpu::vector(light.direction));
        if random.unit() < 0.4 {
            let place = reference.eye + random.direction() * random.between(1.0, 8.0);
            light = Light { kind: 2, position: gpu::host_vector(place), radius: 0.1, ..light };
            source = reference::Source::At(gpu::vector(light.position));
        }
        let [width, height] = SIZE.map(|side| side as usize);
        let depth: Vec<f32> = (0..width * height)
            .map(|i| {
                if random.unit() < 0.2 {
                    return reference.far_depth as f32;
                }
                let ndc = ReferenceCamera::pixel_ndc(i % width, i / width, width, height);
                let point = reference.eye + reference.ray(ndc) * random.magnitude(0.5, 40.0);
                reference.project(point).unwrap()[2].clamp(0.0, 1.0) as f32
            })
            .collect();
        let scattered: Vec<f32> = (0..width * height)
            .flat_map(|_| [0, 1, 2, 3].map(|i| random.between(0.0, if i == 3 { 1.0 } else { 6.0 }) as f32))
            .collect();
        let medium = Medium::new(0.05, Vec3::ONE, random.between(-0.9, 0.9) as f32, 20.0).unwrap();
        let buffers = [
            Buffer::uniform(gpu(), &camera),
            Buffer::uniform(gpu(), &light),
            Buffer::uniform(gpu(), &medium),
        ];
        let depth = gpu::texture(SIZE, R32Float, &depth);
        let shadow_map = gpu::texture([1, 1], R32Float, &[1.0]);
        let scattered = gpu::texture(SIZE, Rgba16Float, &scattered);
        Self { reference, camera, light, source, medium, buffers, depth, shadow_map, scattered }
    }

    pub fn inputs(&self) -> Inputs<'_> {
        let [camera, light, medium] = &self.buffers;
        Inputs {
            camera,
            light,
            medium,
            depth: &self.depth,
            shadow_map: &self.shadow_map,
            shadow_views: None,
            shadow_maps: None,
            light_texture: None,
        }
    }

    pub fn scene<'a>(&'a self, movements: &'a BTreeMap<String, Vec3>) -> PickScene<'a> {
        let (camera, medium, inputs) = (&self.camera, &self.medium, self.inputs());
        PickScene { camera, medium, inputs, scattered: &self.scattered, movements }
    }

    /// The property of every pixel.
    pub fn properties(&self, of: RayProperty, limit: f64) -> Vec<f64> {
        let [width, height] = SIZE.map(|side| side as usize);
        let depth = self.depth.read(gpu()).unwrap();
        let scattered = texels(&self.scattered);
        let of = match of {
            RayProperty::Visibility => reference::Property::Visibility,
            RayProperty::Depth => reference::Property::Depth,
            RayProperty::LightAngle => reference::Property::LightAngle,
            RayProperty::PictureAngle => reference::Property::PictureAngle,
            RayProperty::VisibleDepth => unreachable!(),
        };
        (0..width * height)
            .map(|i| {
                let ndc = ReferenceCamera::pixel_ndc(i % width, i / width, width, height);
                let ray = [scattered[i][3], self.reference.distance(ndc, f(depth[i])), limit];
                reference::property(of, &self.reference, 1.5, ndc, self.source, ray)
            })
            .collect()
    }

    /// Sine of the angle between the ray of each pixel and the light.
    pub fn sines(&self) -> Vec<f64> {
        let angles = self.properties(RayProperty::LightAngle, 1.0);
        angles.into_iter().map(|angle| (angle * std::f64::consts::PI).sin()).collect()
    }
}
