// SPDX-License-Identifier: MIT OR Apache-2.0
//! A view over a light from above, with a shadow map of the test's own.

use crate::gpu::{self, gpu};
use airlight::scattering::Medium;
use airlight::{Buffer, Stage};
use airlight_tests::linear;
use airlight_tests::reference::camera::Camera as ReferenceCamera;
use glam::Vec3;
use wgpu::TextureFormat::R32Float;

/// A level view over a directional light from straight above, with a shadow map of the test's.
pub struct Synthetic {
    pub view: airlight::core::PerspectiveView,
    pub stage: Stage,
}

impl Synthetic {
    pub const PICTURE: [u32; 2] = [160, 90];

    /// `blocked`: whether the light ray at x, z is blocked high above everything.
    pub fn new(medium: Medium, light: Vec3, blocked: impl Fn(f64, f64) -> bool) -> Self {
        let scene = gpu::torus_over_plane();
        let mut view = scene.view;
        (view.eye, view.target) = (Vec3::new(-3.0, 0.0, 0.0), Vec3::new(0.0, 0.4, 0.3));
        view.far = medium.distance_limit;
        let mut stage = scene.stage(Self::PICTURE, [64, 64]);
        stage.camera = airlight::core::Camera::perspective(&view, Self::PICTURE).unwrap();
        stage.medium = medium;
        let towards = gpu::vector(light);
        let matrix = gpu::light_matrix(towards, linear::Vec3::new(0.0, 0.0, 0.0), 64.0, 1.0);
        stage.light = gpu::host_light(towards, matrix, 1.0, Vec3::new(10.0, 9.0, 8.0));
        stage.camera_buffer = Buffer::uniform(gpu(), &stage.camera);
        stage.light_buffer = Buffer::uniform(gpu(), &stage.light);
        stage.medium_buffer = Buffer::uniform(gpu(), &stage.medium);
        let size = 2048;
        let inverse = matrix.inverse().unwrap();
        let mut texels = vec![1.0_f32; size * size];
        for (i, texel) in texels.iter_mut().enumerate() {
            let ndc = ReferenceCamera::pixel_ndc(i % size, i / size, size, size);
            let [x, _, z, _] = inverse.apply([ndc[0], ndc[1], 0.5, 1.0]);
            if blocked(x, z) {
                *texel = 0.0;
            }
        }
        stage.pictures.shadow_map = gpu::texture([size as u32; 2], R32Float, &texels);
        // A wall far away on one side, nothing on the other.
        let [width, height] = Self::PICTURE.map(|side| side as usize);
        let camera = gpu::reference_camera(&view, Self::PICTURE);
        let depth: Vec<f32> = (0..width * height)
            .map(|i| {
                if i % width < width / 2 {
                    return 1.0;
                }
                let direction = camera.pixel_ray(i % width, i / width, width, height);
                camera.project(camera.eye + direction * 9.0).unwrap()[2] as f32
            })
            .collect();
        stage.pictures.depth = gpu::texture(Self::PICTURE, R32Float, &depth);
        Self { view, stage }
    }

    /// Direction and length of each pixel's ray.
    pub fn rays(&self) -> Vec<(linear::Vec3, f64)> {
        let [width, height] = Self::PICTURE.map(|side| side as usize);
        let camera = gpu::reference_camera(&self.view, Self::PICTURE);
        let depth = self.stage.pictures.depth.read(gpu()).unwrap();
        let limit = f64::from(self.stage.medium.distance_limit);
        (0..width * height)
            .map(|i| {
                let ndc = ReferenceCamera::pixel_ndc(i % width, i / width, width, height);
                (camera.ray(ndc), camera.distance(ndc, f64::from(depth[i])).min(limit))
            })
            .collect()
    }
}
