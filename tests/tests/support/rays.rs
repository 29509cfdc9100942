// SPDX-License-Identifier: MIT OR Apache-2.0
//! Many light rays in one map: a volume of one row, a column of voxels a ray, under a light that shines along −z.
#![allow(dead_code, clippy::unwrap_used)]

use crate::gpu::{Random, gpu, host_light, light_matrix, shaders};
use airlight::core::{Light, Reading, VolumeTexture};
use airlight::data::Volume;
use airlight::transmittance::{MapSettings, Query, TransmittanceError, TransmittanceMap, Voxels};
pub use airlight_tests::media::Medium;
use airlight_tests::reference::transmittance::Profile;
use airlight_tests::{linear, media};
use glam::{Mat4, Vec3};

/// Half the range of the map, metres, and of its width.
pub const HALF: f64 = 0.5 * RANGE;
/// The range of the map, metres.
pub const RANGE: f64 = media::RANGE;

/// A light that shines along −z: depth 0 is at z = 4 m.
pub fn light_along_z(far_depth: f64) -> Light {
    let towards = linear::Vec3::from([0.0, 0.0, 1.0]);
    let matrix = light_matrix(towards, linear::Vec3::from([0.0; 3]), HALF, far_depth);
    host_light(towards, matrix, far_depth, Vec3::ONE)
}

/// Extinctions in 1/m, from the light on, of each ray; all of one length.
pub struct Rays {
    /// Ray by ray.
    pub extinctions: Vec<Vec<f32>>,
}

impl Rays {
    /// The same rays as the references see them.
    pub fn profiles(&self) -> Vec<Profile> {
        let wide = |ray: &Vec<f32>| ray.iter().map(|value| f64::from(*value)).collect::<Vec<_>>();
        self.extinctions.iter().map(|ray| Profile::of_steps(RANGE, &wide(ray))).collect()
    }

    /// The volume.
    pub fn volume(&self) -> Volume {
        let (width, length) = (self.extinctions.len(), self.extinctions[0].len());
        let value = |i: usize| self.extinctions[i % width][length - 1 - i / width];
        let values = (0..width * length).map(value).collect();
        let side = RANGE as f32;
        let space = Mat4::from_translation(Vec3::splat(-HALF as f32)) * Mat4::from_scale(Vec3::splat(side));
        Volume::new([width as u32, 1, length as u32], values, space).unwrap()
    }

    /// The point at `depth`, 0..1, on a ray.
    pub fn point(&self, ray: usize, depth: f64) -> Vec3 {
        let x = (ray as f64 + 0.5) / self.extinctions.len() as f64 * RANGE - HALF;
        Vec3::new(x as f32, 0.0, (HALF - depth * RANGE) as f32)
    }

    /// Settings of a map with a texel a ray.
    pub fn settings(&self, form: airlight::transmittance::Form, coefficients: u32) -> MapSettings {
        MapSettings::new(form, coefficients, [self.extinctions.len() as u32, 1])
    }

    /// The map of the volume.
    pub fn map(&self, settings: MapSettings, light: &Light) -> Result<TransmittanceMap, TransmittanceError> {
        let map = TransmittanceMap::new(gpu(), settings, light)?;
        let volume = VolumeTexture::new(gpu(), &self.volume(), 1.0, Reading::Nearest)?;
        let voxels = Voxels::new(gpu(), shaders(), settings, Reading::Nearest)?;
        let bound = voxels.bind(gpu(), &map, &volume)?;
        let mut encoder = gpu().encoder();
        voxels.record(&mut encoder, &bound);
        gpu().submit(encoder)?;
        Ok(map)
    }

    /// Transmittance of every ray at every depth, ray by ray.
    pub fn transmittances(&self, settings: MapSettings, monotone: bool, depths: &[f64]) -> Vec<Vec<f32>> {
        let map = self.map(settings, &light_along_z(1.0)).unwrap();
        let points: Vec<Vec3> = (0..self.extinctions.len())
            .flat_map(|ray| depths.iter().map(move |depth| (ray, *depth)))
            .map(|(ray, depth)| self.point(ray, depth))
            .collect();
        ask(&map, monotone, &points).chunks(depths.len()).map(<[f32]>::to_vec).collect()
    }
}

/// Transmittance at points.
pub fn ask(map: &TransmittanceMap, monotone: bool, points: &[Vec3]) -> Vec<f32> {
    let query = Query::new(gpu(), shaders(), map.settings, monotone).unwrap();
    let bound = query.bind(gpu(), map, points).unwrap();
    let mut encoder = gpu().encoder();
    query.record(&mut encoder, &bound).unwrap();
    gpu().submit(encoder).unwrap();
    bound.read(gpu()).unwrap()
}

/// Extinction of a ray of `length` steps, of the optical depth `total`.
pub fn medium(kind: Medium, length: usize, total: f64, random: &mut Random) -> Vec<f32> {
    media::medium(kind, length, total, &mut || random.unit())
}
