// SPDX-License-Identifier: MIT OR Apache-2.0
//! Many light rays in one map: a volume of one row, a column of voxels a ray, under a light that shines along −z.
#![allow(dead_code, clippy::unwrap_used)]

use crate::gpu::{Random, gpu, host_light, light_matrix, shaders};
use airlight::core::Light;
use airlight::data::Volume;
use airlight::transmittance::{
    MapSettings, Query, Reading, TransmittanceError, TransmittanceMap, VolumeTexture, Voxels,
};
use airlight_tests::linear;
use airlight_tests::reference::transmittance::Profile;
use glam::{Mat4, Vec3};
use std::f64::consts::PI;

/// Half the range of the map, metres, and of its width.
pub const HALF: f64 = 4.0;
/// The range of the map, metres.
pub const RANGE: f64 = 2.0 * HALF;

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

/// Kinds of media along a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Medium {
    /// Smooth, and fills the range.
    Smooth,
    /// Noisy blobs.
    Smoke,
    /// Few stretches with sharp edges.
    Boxes,
    /// Boxes within 10 to 40 % of the range.
    ShortBoxes,
}

/// Extinction of a ray of `length` steps, of the optical depth `total`.
pub fn medium(kind: Medium, length: usize, total: f64, random: &mut Random) -> Vec<f32> {
    let unit = |i: usize| (i as f64 + 0.5) / length as f64;
    let mut values: Vec<f64> = match kind {
        Medium::Smooth => {
            let waves: Vec<[f64; 2]> =
                (0..3).map(|_| [random.between(-0.25, 0.25), random.between(0.0, 2.0 * PI)]).collect();
            let value = |x: f64| {
                let of = |(k, wave): (usize, &[f64; 2])| wave[0] * ((k + 1) as f64 * PI * x + wave[1]).cos();
                1.0 + waves.iter().enumerate().map(of).sum::<f64>()
            };
            (0..length).map(|i| value(unit(i))).collect()
        }
        Medium::Smoke => {
            let blobs: Vec<[f64; 3]> = (0..6)
                .map(|_| [random.between(0.1, 0.9), random.between(0.02, 0.1), random.between(0.2, 1.0)])
                .collect();
            let value = |x: f64| {
                blobs.iter().map(|[at, width, s]| s * (-((x - at) / width).powi(2)).exp()).sum::<f64>()
            };
            (0..length)
                .map(|i| value(unit(i)) * random.between(0.6, 1.4))
                .map(|v| if v < 0.02 { 0.0 } else { v })
                .collect()
        }
        Medium::Boxes | Medium::ShortBoxes => {
            let (low, high) = if kind == Medium::Boxes {
                (0.0, 1.0)
            } else {
                let width = random.between(0.1, 0.4);
                let low = random.between(0.0, 1.0 - width);
                (low, low + width)
            };
            let mut values = vec![0.0; length];
            for _ in 0..3 {
                let from = random.between(low, low + 0.85 * (high - low));
                let to = (from + random.between(0.05, 0.2) * (high - low)).min(high);
                let strength = random.between(0.3, 1.0);
                for (i, value) in values.iter_mut().enumerate() {
                    if (from..to).contains(&unit(i)) {
                        *value += strength;
                    }
                }
            }
            // Never empty.
            values[((0.5 * (low + high)) * length as f64) as usize] += 0.3;
            values
        }
    };
    let sum: f64 = values.iter().sum::<f64>() * RANGE / length as f64;
    for value in &mut values {
        *value *= total / sum;
    }
    values.into_iter().map(|value| value as f32).collect()
}
