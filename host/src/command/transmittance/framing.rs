// SPDX-License-Identifier: MIT OR Apache-2.0
//! Camera and light around a medium, with what was not said taken from its box.

use super::flags::Options;
use super::medium::Medium;
use crate::StageError;
use crate::command::CommandError;
use crate::command::fit::Fit;
use crate::command::parse::Projection;
use crate::core::{Camera, DepthRange, Light, OrthographicView, PerspectiveView, View};
use crate::transmittance::MediumLighting;
use glam::Vec3;

/// Of a perspective camera, vertical, degrees.
const FIELD_OF_VIEW: f32 = 35.0;
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
        let target = flags.target.unwrap_or(medium.framed.center());
        let [width, height] = flags.size.map(|side| side as f32);
        let (fov, aspect) = (flags.fov.unwrap_or(FIELD_OF_VIEW), width / height);
        let fit = Fit { center: medium.framed.center(), from: FROM.normalize(), aspect };
        let distance = fit.distance(medium.framed.corners(), fov.clamp(0.1, 170.0));
        let eye = flags.eye.unwrap_or(target + fit.from * distance);
        let away = (medium.bounds.center() - eye).length();
        let radius = medium.bounds.radius().max(1e-4);
        let far = away + 1.1 * radius;
        let depth = DepthRange::Forward;
        let view: View = match flags.camera {
            Projection::Perspective => {
                let near = (away - 1.1 * radius).max(1e-3 * far);
                PerspectiveView { eye, target, field_of_view: fov, near, far, depth }.into()
            }
            Projection::Orthographic => {
                let height = flags.height.unwrap_or_else(|| fit.height(medium.framed.corners()));
                OrthographicView { eye, target, height, near: away - 1.1 * radius, far, depth }.into()
            }
        };
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
