// SPDX-License-Identifier: MIT OR Apache-2.0
//! Media before a camera, on the GPU and in f64.
#![allow(dead_code, clippy::unwrap_used)]

use crate::gpu::{gpu, matrix, shaders, vector};
use airlight::core::{
    Camera, DepthRange, Light, OrthographicView, PerspectiveView, Reading, View, VolumeTexture,
};
use airlight::data::{Particles, Volume};
use airlight::transmittance::{
    MapSettings, MediumLighting, MediumView, ParticleBuffer, ParticlePicture, SplatFixed, TransmittanceMap,
    VolumePicture, Voxels,
};
use airlight::{Buffer, Texture};
use airlight_tests::reference::camera::Camera as ReferenceCamera;
use airlight_tests::reference::transmittance::{Grid, View as ReferenceView};
use glam::Vec3;

/// Columns and rows of all pictures.
pub const SIZE: [u32; 2] = [64, 48];
/// Their pixels.
pub const PIXELS: usize = 64 * 48;

/// A camera, a depth buffer and a light, on both sides.
pub struct Setting {
    /// The camera.
    pub camera: Camera,
    /// The light.
    pub light: Light,
    /// How the medium scatters.
    pub lighting: MediumLighting,
    /// Depth buffer, row by row.
    pub depth: Vec<f32>,
}

impl Setting {
    /// Before empty space. `bounds`: least and greatest corner of what the map holds.
    pub fn new(view: &View, towards: Vec3, bounds: [Vec3; 2], lighting: MediumLighting) -> Self {
        let camera = Camera::new(view, SIZE).unwrap();
        let light = Light::directional(towards, Vec3::new(3.0, 2.5, 2.0), bounds[0], bounds[1]).unwrap();
        Self { camera, light, lighting, depth: vec![camera.far_depth; PIXELS] }
    }

    /// What passes are given.
    pub fn with<T>(&self, of: impl FnOnce(&MediumView<'_>) -> T) -> T {
        let depth = Texture::storage(gpu(), SIZE, wgpu::TextureFormat::R32Float);
        depth.write(gpu(), &self.depth).unwrap();
        let [camera, lighting] =
            [Buffer::uniform(gpu(), &self.camera), Buffer::uniform(gpu(), &self.lighting)];
        of(&MediumView { camera: &camera, lighting: &lighting, depth: &depth })
    }

    /// The volume through a map, or by the reference that the shader has.
    pub fn volume(&self, volume: &Volume, reading: Reading, map: Option<MapSettings>) -> Vec<f32> {
        let uploaded = VolumeTexture::new(gpu(), volume, 1.0, reading).unwrap();
        self.with(|view| {
            let mut encoder = gpu().encoder();
            let bound = if let Some(settings) = map {
                let map = TransmittanceMap::new(gpu(), settings, &self.light).unwrap();
                let voxels = Voxels::new(gpu(), shaders(), settings, reading).unwrap();
                voxels.record(&mut encoder, &voxels.bind(gpu(), &map, &uploaded).unwrap());
                let pass = VolumePicture::new(gpu(), shaders(), settings, false, reading).unwrap();
                let bound = pass.bind(gpu(), view, &map, &uploaded).unwrap();
                pass.record(&mut encoder, &bound);
                bound
            } else {
                let light = Buffer::uniform(gpu(), &self.light);
                let pass = VolumePicture::reference(gpu(), shaders(), reading).unwrap();
                let bound = pass.bind_reference(gpu(), view, &light, &uploaded).unwrap();
                pass.record(&mut encoder, &bound);
                bound
            };
            gpu().submit(encoder).unwrap();
            bound.picture.read(gpu()).unwrap()
        })
    }

    /// The particles, and the transmittances at their middles.
    pub fn particles(&self, particles: &Particles, settings: MapSettings) -> (Vec<f32>, Vec<f32>) {
        let map = TransmittanceMap::new(gpu(), settings, &self.light).unwrap();
        let buffer = ParticleBuffer::new(gpu(), particles).unwrap();
        let splat = SplatFixed::new(gpu(), shaders(), settings).unwrap();
        let splatted = splat.bind(gpu(), &map, &buffer).unwrap();
        self.with(|view| {
            let pass = ParticlePicture::new(gpu(), shaders(), settings, false).unwrap();
            let bound = pass.bind(gpu(), view, &map, &buffer).unwrap();
            let mut encoder = gpu().encoder();
            splat.record(&mut encoder, &splatted).unwrap();
            pass.record(gpu(), &mut encoder, &bound).unwrap();
            gpu().submit(encoder).unwrap();
            let mut lit = bound.transmittances.read_floats(gpu()).unwrap();
            lit.truncate(particles.list.len());
            (bound.picture.read(gpu()).unwrap(), lit)
        })
    }

    /// The particles without a map, by the reference that the shader has, and the transmittances at their middles.
    pub fn summed(&self, particles: &Particles) -> (Vec<f32>, Vec<f32>) {
        let buffer = ParticleBuffer::new(gpu(), particles).unwrap();
        let light = Buffer::uniform(gpu(), &self.light);
        self.with(|view| {
            let pass = ParticlePicture::reference(gpu(), shaders()).unwrap();
            let bound = pass.bind_reference(gpu(), view, &light, &buffer).unwrap();
            let mut encoder = gpu().encoder();
            pass.record(gpu(), &mut encoder, &bound).unwrap();
            gpu().submit(encoder).unwrap();
            let mut lit = bound.transmittances.read_floats(gpu()).unwrap();
            lit.truncate(particles.list.len());
            (bound.picture.read(gpu()).unwrap(), lit)
        })
    }

    /// The same in f64.
    pub fn reference<T>(&self, of: impl FnOnce(&ReferenceView<'_>) -> T) -> T {
        let far = f64::from(self.camera.far_depth);
        let camera = ReferenceCamera::from_matrix(matrix(self.camera.clip_from_world), far).unwrap();
        of(&ReferenceView {
            camera: &camera,
            width: SIZE[0] as usize,
            height: SIZE[1] as usize,
            depth: &self.depth,
            distance_limit: f64::from(self.lighting.distance_limit),
            light: vector(self.light.direction),
            radiance: self.light.radiance.to_array().map(f64::from),
            albedo: self.lighting.albedo.to_array().map(f64::from),
            g: f64::from(self.lighting.g),
        })
    }

    /// The volume in f64, steps a quarter of a voxel.
    pub fn marched(&self, volume: &Volume, linear: bool) -> Vec<f64> {
        let grid = Grid {
            size: volume.size.map(|side| side as usize),
            values: &volume.values,
            unit_from_world: matrix(volume.world_from_unit).inverse().unwrap(),
            linear,
        };
        let bounds = volume.bounds();
        let centre = vector(0.5 * (bounds.min + bounds.max));
        let radius = 0.5 * f64::from((bounds.max - bounds.min).length());
        let step = 0.25 * f64::from(volume.voxel());
        self.reference(|view| view.marched(|p| grid.extinction(p), (centre, radius), step))
    }
}

/// Albedos that differ, scattering forward.
pub fn lighting() -> MediumLighting {
    MediumLighting::new(Vec3::new(0.95, 0.9, 0.8), 0.4, 100.0).unwrap()
}

/// Towards the origin.
pub fn perspective(eye: Vec3, depth: DepthRange) -> View {
    PerspectiveView { eye, target: Vec3::ZERO, field_of_view: 40.0, near: 0.1, far: 60.0, depth }.into()
}

/// Towards the origin, `height` metres high.
pub fn orthographic(eye: Vec3, height: f32, depth: DepthRange) -> View {
    OrthographicView { eye, target: Vec3::ZERO, height, near: 0.0, far: 20.0, depth }.into()
}

/// Corners of the box of a volume.
pub fn bounds(volume: &Volume) -> [Vec3; 2] {
    [volume.bounds().min, volume.bounds().max]
}

/// Radiance alone, or transmittance to the background alone.
pub fn split<T: Copy>(picture: &[T]) -> (Vec<T>, Vec<T>) {
    let radiance = picture.chunks_exact(4).flat_map(|pixel| pixel[..3].to_vec()).collect();
    (radiance, picture.chunks_exact(4).map(|pixel| pixel[3]).collect())
}
