// SPDX-License-Identifier: MIT OR Apache-2.0
//! Camera and light around a volume, with what was not said taken from what is solid.

use super::flags::Options;
use super::matter::Matter;
use crate::StageError;
use crate::command::CommandError;
use crate::command::camera::Subject;
use crate::command::parse::LightSpelling;
use crate::core::{Camera, direction_from_angles};
use crate::painterly::{IsoSettings, SurfaceLighting};
use glam::{Vec2, Vec3};

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
        let center = solid.bounds.center();
        // The planes hold the whole volume, which turns about the middle of what is solid.
        let corners = matter.volume.bounds().corners();
        let reach = corners.iter().map(|corner| corner.distance(center)).fold(1e-4, f32::max);
        let points: Vec<Vec3> = solid.points().collect();
        let subject = Subject { center, points: &points, ball: (center, reach), from: FROM, turn: 0.0 };
        let view = flags.view.view(&subject, flags.size);
        let far = view.far();
        // The picture says what is seen, also where rays do not divide it evenly.
        let mut camera = Camera::new(&view, flags.size).map_err(StageError::Camera)?;
        camera.viewport = Vec2::from(flags.source_size().map(|side| side as f32));
        let towards = match flags.light {
            LightSpelling::Directional { azimuth, elevation } => direction_from_angles(azimuth, elevation),
            // Refused before.
            LightSpelling::Spot { .. } | LightSpelling::Point { .. } | LightSpelling::Area { .. } => FROM,
        };
        let mut lighting = SurfaceLighting::towards(towards)?;
        lighting.radiance *= flags.exposure;
        lighting.ambient *= flags.exposure;
        // Rays to the corners of the far plane are longer than the plane is far.
        let surface = flags.surface((4.0 * far).clamp(f32::MIN_POSITIVE, 1e7));
        Ok(Self { camera, surface, lighting })
    }
}
