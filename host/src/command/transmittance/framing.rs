// SPDX-License-Identifier: MIT OR Apache-2.0
//! Camera and light around a medium, with what was not said taken from its box.

use super::flags::Options;
use super::medium::Medium;
use crate::StageError;
use crate::command::CommandError;
use crate::command::camera::Subject;
use crate::core::{Camera, Light};
use crate::transmittance::MediumLighting;
use glam::Vec3;

/// From the medium to the eye.
const FROM: Vec3 = Vec3::new(-0.4, 0.1, 1.0);

/// What the passes are given.
pub struct Framing {
    /// The camera.
    pub camera: Camera,
    /// The light, whose map holds the medium.
    pub light: Light,
    /// How the medium scatters.
    pub lighting: MediumLighting,
}

impl Framing {
    /// Takes what was not said from the box of the medium.
    ///
    /// # Errors
    /// Misuse: values that no camera or medium can have.
    pub fn new(flags: &Options, medium: &Medium) -> Result<Self, CommandError> {
        let (bounds, framed) = (&medium.bounds, &medium.framed);
        let ball = (bounds.center(), bounds.radius().max(1e-4));
        let points = framed.corners();
        let subject = Subject { center: framed.center(), points: &points, ball, from: FROM, turn: 0.0 };
        let view = flags.view.view(&subject, flags.size);
        let far = view.far();
        let camera = Camera::new(&view, flags.size).map_err(StageError::Camera)?;
        let light = medium.light(flags.light.lighting(flags.radiance)).map_err(StageError::Light)?;
        Ok(Self {
            camera,
            light,
            // Rays to the corners of the far plane are longer than the plane is far.
            lighting: MediumLighting::new(flags.albedo, flags.g, (4.0 * far).min(1e7))?,
        })
    }
}
