// SPDX-License-Identifier: MIT OR Apache-2.0
//! What lies behind a medium: a sky, or one colour.

use super::CommandError;
use crate::core::{Camera, Drawing, Light, Pictures, Raster, Sky};
use crate::{Gpu, Shaders};
use glam::Vec3;

/// A clear afternoon.
const ZENITH: Vec3 = Vec3::new(0.025, 0.075, 0.25);
/// Its haze.
const HORIZON: Vec3 = Vec3::new(0.18, 0.26, 0.38);
/// What lies below, in haze too.
const GROUND: Vec3 = Vec3::new(0.1, 0.14, 0.19);

/// Draws what lies behind, without any mesh. `background`: one linear RGB radiance; where there is none, a sky.
///
/// # Errors
/// A failure of the device.
pub fn behind(
    (gpu, shaders): (&Gpu, &Shaders),
    camera: &Camera,
    light: &Light,
    background: Option<Vec3>,
) -> Result<Pictures, CommandError> {
    let sky = background
        .map_or_else(|| Sky::new(ZENITH, HORIZON, GROUND), |colour| Sky::new(colour, colour, colour));
    let drawing = Drawing {
        camera,
        light,
        sky: &sky,
        meshes: &[],
        shadow_map: [1, 1],
        views: None,
        light_texture: None,
        samples: 1,
    };
    Ok(Raster::new(gpu, shaders)?.draw(gpu, &drawing)?)
}
