// SPDX-License-Identifier: MIT OR Apache-2.0
//! A scene in an environment, by the passes and by rays.

use super::super::studio::Studio;
use crate::ambient::{BentForm, Blurring, ConeLight, ConeLightForm, OcclusionSettings, Sampling};
use crate::command::CommandError;
use crate::command::ambient::shown::{self, Seen};
use crate::command::ambient::studio::Ground;
use crate::command::ambient::{LOW_PASS, traced};
use crate::command::environments::environment;
use crate::core::Camera;
use crate::data::Environment;
use crate::scenes::AmbientScene;
use crate::{StageError, Texture};
use std::path::Path;

/// Rays a pixel of traced pictures.
const RAYS: u32 = 192;

/// Bent normals as the thesis has them.
pub const BENT: BentForm = BentForm {
    sampling: Sampling::Hemisphere,
    blurring: Blurring::Difference,
    occlusion_only: false,
    halved: false,
};

/// What was found in each pixel, row by row.
pub type Found = Vec<Option<Seen>>;

/// Light of a map as cones can follow it, before the map itself.
pub struct Backdrop {
    /// Behind the surfaces.
    pub map: Environment,
    /// What lights them.
    pub low_passed: Environment,
    /// The same in cones.
    pub cones: ConeLight,
    /// Of pictures.
    pub exposure: f32,
}

impl Backdrop {
    /// One of the program's maps.
    pub fn new(studio: &Studio, name: &str) -> Result<Self, CommandError> {
        let map = environment(Path::new(name))?;
        let low_passed = map.resized(LOW_PASS);
        let cones = ConeLight::new(&studio.gpu, &studio.shaders, &low_passed, ConeLightForm::default())?;
        let exposure = if name == "forest" { 0.9 } else { 1.1 };
        Ok(Self { map, low_passed, cones, exposure })
    }
}

/// A scene and its camera.
pub struct Easel<'a> {
    /// The device.
    pub studio: &'a Studio,
    /// What is drawn.
    pub scene: AmbientScene,
    /// From where.
    pub camera: Camera,
}

impl<'a> Easel<'a> {
    /// At the size of the studio's pictures.
    pub fn new(studio: &'a Studio, scene: AmbientScene) -> Result<Self, CommandError> {
        let camera = Camera::new(&scene.view.into(), studio.size).map_err(StageError::Camera)?;
        Ok(Self { studio, scene, camera })
    }

    /// What the camera sees.
    pub fn ground(&self) -> Result<Ground<'_>, CommandError> {
        Ground::new((&self.studio.gpu, &self.studio.shaders), &self.scene.mesh, &self.camera)
    }

    /// Eight directions of three steps as far as the scene needs.
    pub fn settings(&self) -> OcclusionSettings {
        OcclusionSettings { thickness: self.scene.thickness, ..OcclusionSettings::new(self.scene.radius) }
    }

    /// By rays instead, which all occluders block, in the light of each map.
    pub fn traced<const COUNT: usize>(&self, maps: [&Environment; COUNT]) -> [Found; COUNT] {
        let all = traced::trace_under(&self.scene.mesh, maps.map(Some), &self.camera, RAYS, None, 1);
        std::array::from_fn(|light| all.iter().map(|seen| seen.map(|seen| seen[light])).collect())
    }

    /// Numbers by rays. `radius`: metres up to which occluders count, less the farther they are.
    pub fn traced_within(&self, radius: f32) -> Found {
        traced::trace(&self.scene.mesh, None, &self.camera, RAYS, Some(radius), 1)
    }

    /// Lit surfaces before a map: pixels to look at.
    pub fn lit(&self, found: &Found, backdrop: &Backdrop) -> Result<Vec<u8>, CommandError> {
        let radiance = shown::before(found, &backdrop.map, &self.camera);
        let texture = self.image(&radiance)?;
        self.studio.pixels(&texture, backdrop.exposure)
    }

    /// Numbers 0..1 in grey or colour: pixels to look at.
    pub fn numbers(&self, found: &Found, colour: impl Fn(&Seen) -> [f32; 3]) -> Vec<u8> {
        let byte = |value: f32| (value.clamp(0.0, 1.0) * 255.0).round() as u8;
        let pixel = |seen: &Option<Seen>| {
            let [r, g, b] = seen.as_ref().map_or([0; 3], |seen| colour(seen).map(byte));
            [r, g, b, 255]
        };
        found.iter().flat_map(pixel).collect()
    }

    /// Linear RGBA on the device.
    fn image(&self, radiance: &[f32]) -> Result<Texture, CommandError> {
        let (format, usage) = (wgpu::TextureFormat::Rgba32Float, wgpu::TextureUsages::TEXTURE_BINDING);
        let texture = Texture::new(&self.studio.gpu, self.studio.size, format, usage);
        texture.write(&self.studio.gpu, radiance)?;
        Ok(texture)
    }
}

/// RMS of how radiance differs from what is true, of the RMS of that, over surfaces of both.
pub fn error(found: &Found, truth: &Found) -> f64 {
    let both = found.iter().zip(truth).filter_map(|(found, truth)| found.zip(*truth));
    let sums = both.fold([0.0; 2], |sums, (found, truth)| {
        let wrong = (found.radiance - truth.radiance).as_dvec3().length_squared();
        [sums[0] + wrong, sums[1] + truth.radiance.as_dvec3().length_squared()]
    });
    (sums[0] / sums[1].max(1e-30)).sqrt()
}
