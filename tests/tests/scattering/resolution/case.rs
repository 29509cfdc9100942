// SPDX-License-Identifier: MIT OR Apache-2.0
//! Scenes of the gallery with their rectified maps, and passes run over them.

use crate::gpu::{self, gpu, shaders};
use airlight::core::Jitter;
use airlight::scattering::{
    Along, Inputs, Interpolated, March, Rectification, Reduced, Resolution, Upsample, Weighting,
};
use airlight::{Stage, Texture, scenes};
use airlight_tests::reference::camera::Camera as ReferenceCamera;
use airlight_tests::reference::scattering as reference;

pub fn submit(record: impl FnOnce(&mut wgpu::CommandEncoder)) {
    let mut encoder = gpu().encoder();
    record(&mut encoder);
    gpu().submit(encoder).unwrap();
}

pub fn rectified(inputs: &Inputs<'_>) -> Rectification {
    let map = Rectification::new(gpu(), shaders(), [512, 512]).unwrap();
    let bound = map.bind(gpu(), inputs).unwrap();
    submit(|encoder| map.record(encoder, &bound));
    map
}

/// A scene of the gallery with its rectified map.
pub struct Case {
    pub stage: Stage,
    pub map: Rectification,
    pub view: airlight::core::PerspectiveView,
    pub size: [u32; 2],
}

impl Case {
    pub fn new(name: &str, size: [u32; 2]) -> Self {
        let scene = scenes::scene(name).unwrap().unwrap();
        let view = scene.setting().view.perspective().unwrap();
        let stage = Stage::new(gpu(), gpu::raster(), &scene.setting(), size, [1024, 1024]).unwrap();
        let map = rectified(&stage.inputs());
        Self { stage, map, view, size }
    }

    /// The exact picture over a map that was rectified for the camera reduced by `factor`.
    pub fn exact(&self, map: &Rectification, factor: u32) -> reference::Picture {
        let [width, height] = self.size.map(|side| side as usize);
        let camera = gpu::reference_camera(&self.view, self.size);
        let reduced = self.stage.camera.reduced(factor);
        let reduced = ReferenceCamera::from_matrix(gpu::matrix(reduced.clip_from_world), 1.0).unwrap();
        let limit = self.stage.medium.distance_limit;
        let rectification = gpu::read_back(&reduced, self.stage.light.direction, limit, map);
        let depth = self.stage.pictures.depth.read(gpu()).unwrap();
        let scene = reference::Scene {
            camera: &camera,
            light: gpu::reference_light(&self.stage.light),
            medium: gpu::reference_medium(&self.stage.medium),
            depth: &depth,
            width,
            height,
        };
        reference::picture(&scene, &rectification, &map.rectified.read(gpu()).unwrap(), 1)
    }

    pub fn march(&self, inputs: &Inputs<'_>, along: &Along<'_>, viewport: [u32; 2]) -> March {
        self.jittered(inputs, along, Jitter::None, 0, viewport)
    }

    pub fn jittered(
        &self,
        inputs: &Inputs<'_>,
        along: &Along<'_>,
        jitter: Jitter,
        frame: u32,
        viewport: [u32; 2],
    ) -> March {
        let march = March::jittered(gpu(), shaders(), along, Weighting::Average, jitter, viewport).unwrap();
        march.set_frame(gpu(), frame).unwrap();
        let bound = march.bind(gpu(), inputs, along).unwrap();
        submit(|encoder| march.record(encoder, &bound));
        march
    }

    pub fn reduced(&self, resolution: Resolution) -> Reduced {
        let reduced = Reduced::new(gpu(), shaders(), &self.stage.camera, resolution).unwrap();
        let bound = reduced.bind(gpu(), &self.stage.inputs()).unwrap();
        submit(|encoder| reduced.record(encoder, &bound));
        reduced
    }

    pub fn upsampled(&self, reduced: &Reduced, scattered: &Texture, interpolated: Interpolated) -> Vec<f32> {
        let upsample = Upsample::new(gpu(), shaders(), interpolated, self.size).unwrap();
        let bound = upsample.bind(gpu(), &self.stage.inputs(), reduced, scattered).unwrap();
        submit(|encoder| upsample.record(encoder, &bound));
        upsample.scattered.read(gpu()).unwrap()
    }
}

pub fn channels(texels: &[f32], keep: std::ops::Range<usize>) -> Vec<f32> {
    texels.chunks_exact(4).flat_map(|texel| texel[keep.clone()].to_vec()).collect()
}
