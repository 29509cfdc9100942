// SPDX-License-Identifier: MIT OR Apache-2.0
//! Camera and light around the volumes, with what was not said taken from their box.

use super::flags::{Options, ShadingSpelling};
use super::volumes::Volumes;
use crate::StageError;
use crate::command::CommandError;
use crate::command::camera::{Subject, all_around};
use crate::core::{Camera, Light};
use crate::data::Bounds;
use crate::splatting::{SheetLighting, light_around};
use glam::Vec3;

/// From the middle to the eye.
const FROM: Vec3 = Vec3::new(-0.4, 0.1, 1.0);
/// What a directional light gives a surface that faces it.
const RADIANCE: Vec3 = Vec3::new(16.0, 14.2, 11.7);
/// The same, of what reflects like surfaces do.
const RADIANCE_OF_SURFACES: Vec3 = Vec3::new(8.0, 7.1, 5.9);
/// Most radiant intensity: that of half floats, less what rounding adds.
const MOST_INTENSITY: f32 = 60_000.0;
/// Mean cosine of the phase function.
const G: f32 = 0.2;

/// What does not change from frame to frame.
pub struct Framing {
    /// The light, whose buffer holds all splats.
    pub light: Light,
    /// Of the medium.
    pub lighting: SheetLighting,
    center: Vec3,
    points: Vec<Vec3>,
    ball: (Vec3, f32),
}

impl Framing {
    /// Takes what was not said from the box around what is seen.
    ///
    /// # Errors
    /// Misuse: values that no light can have, or a light in the midst of the volumes.
    pub fn new(flags: &Options, volumes: &Volumes) -> Result<Self, CommandError> {
        let framed = &volumes.framed;
        let usual = match flags.shading {
            ShadingSpelling::Scattering => RADIANCE,
            ShadingSpelling::Phong => RADIANCE_OF_SURFACES,
        };
        let radiance = flags.radiance.unwrap_or_else(|| {
            let radiance = flags.light.radiance_as(usual, framed);
            radiance * (MOST_INTENSITY / radiance.max_element()).min(1.0)
        });
        let light = light_around(&flags.light.lighting(radiance), &volumes.points)?;
        let lighting = SheetLighting {
            ambient: flags.ambient,
            g: flags.g.unwrap_or(G),
            ..SheetLighting::new(volumes.extinction)
        };
        let center = framed.center();
        let points = match flags.frames {
            Some(_) => all_around(center, framed.corners()),
            None => framed.corners().to_vec(),
        };
        let whole = Bounds::of(volumes.points.iter().copied()).unwrap_or(*framed);
        let ball = (whole.center(), whole.radius().max(1e-4));
        Ok(Self { light, lighting, center, points, ball })
    }

    /// The camera of a frame.
    ///
    /// # Errors
    /// Misuse: values that no camera can have.
    pub fn camera(&self, flags: &Options, frame: u32) -> Result<Camera, CommandError> {
        let turn = flags.turned(frame);
        let subject =
            Subject { center: self.center, points: &self.points, ball: self.ball, from: FROM, turn };
        let view = flags.view.view(&subject, flags.size);
        Ok(Camera::new(&view, flags.size).map_err(StageError::Camera)?)
    }
}
