// SPDX-License-Identifier: MIT OR Apache-2.0
//! Camera and light around a volume, with what was not said taken from what is solid.

use super::flags::Options;
use super::matter::Matter;
use crate::StageError;
use crate::command::CommandError;
use crate::command::fit::Fit;
use crate::command::parse::{LightSpelling, Projection};
use crate::core::{Camera, DepthRange, OrthographicView, PerspectiveView, View, direction_from_angles};
use crate::painterly::{IsoSettings, SurfaceLighting};
use glam::{Vec2, Vec3};

/// Of a perspective camera, vertical, degrees.
const FIELD_OF_VIEW: f32 = 35.0;
/// From the middle to the eye.
const FROM: Vec3 = Vec3::new(-0.4, 0.15, 1.0);

/// What the passes are given.
pub struct Framing {
    /// The camera, for as many pixels as there are rays.
    pub camera: Camera,
    /// Which surface is seen.
    pub surface: IsoSettings,
    /// In which light.
    pub lighting: SurfaceLighting,
}

impl Framing {
    /// Takes what was not said from what is solid. The camera stands still, and sees all of it however it turns.
    ///
    /// # Errors
    /// Misuse: values that no camera or surface can have.
    pub fn new(flags: &Options, matter: &Matter) -> Result<Self, CommandError> {
        let solid = &matter.solid;
        let target = flags.target.unwrap_or(solid.bounds.center());
        let [width, height] = flags.size.map(|side| side as f32);
        let fov = flags.fov.unwrap_or(FIELD_OF_VIEW);
        let fit = Fit { center: solid.bounds.center(), from: FROM.normalize(), aspect: width / height };
        let distance = fit.distance(solid.points(), fov.clamp(0.1, 170.0));
        let eye = flags.eye.unwrap_or(target + fit.from * distance);
        // The planes hold the whole volume, which turns about the middle of what is solid.
        let corners = matter.volume.bounds().corners();
        let reach = corners.iter().map(|corner| corner.distance(fit.center)).fold(1e-4, f32::max);
        let away = fit.center.distance(eye);
        let far = away + 1.1 * reach;
        let depth = DepthRange::Forward;
        let view: View = match flags.camera {
            Projection::Perspective => {
                let near = (away - 1.1 * reach).max(1e-3 * far);
                PerspectiveView { eye, target, field_of_view: fov, near, far, depth }.into()
            }
            Projection::Orthographic => {
                let height = flags.height.unwrap_or_else(|| fit.height(solid.points()));
                OrthographicView { eye, target, height, near: away - 1.1 * reach, far, depth }.into()
            }
        };
        // The picture says what is seen, also where rays do not divide it evenly.
        let mut camera = Camera::new(&view, flags.size).map_err(StageError::Camera)?;
        camera.viewport = Vec2::from(flags.source_size().map(|side| side as f32));
        let towards = match flags.light {
            LightSpelling::Directional { azimuth, elevation } => direction_from_angles(azimuth, elevation),
            // Refused before.
            LightSpelling::Spot { .. } | LightSpelling::Point { .. } => FROM,
        };
        let mut lighting = SurfaceLighting::towards(towards)?;
        lighting.radiance *= flags.exposure;
        lighting.ambient *= flags.exposure;
        // Rays to the corners of the far plane are longer than the plane is far.
        let surface = flags.surface((4.0 * far).clamp(f32::MIN_POSITIVE, 1e7));
        Ok(Self { camera, surface, lighting })
    }
}
