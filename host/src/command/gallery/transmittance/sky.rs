// SPDX-License-Identifier: MIT OR Apache-2.0
//! What lies behind a medium: a sky, and ground where there is one.

use crate::core::Camera;
use glam::{Vec3, Vec4};

/// A sky that brightens towards the horizon and around the sun. Linear RGB radiance throughout.
pub struct Sky {
    /// Straight up.
    pub zenith: Vec3,
    /// At the horizon.
    pub horizon: Vec3,
    /// Added around the sun.
    pub glow: Vec3,
    /// How far the horizon's colour reaches up: sine of an elevation.
    pub haze: f32,
}

impl Sky {
    /// Radiance from a direction of length 1, with the sun towards `sun`.
    pub fn radiance(&self, direction: Vec3, sun: Vec3) -> Vec3 {
        let up = 1.0 - (-direction.y.max(0.0) / self.haze).exp();
        let near = direction.dot(sun).max(0.0);
        self.horizon.lerp(self.zenith, up) + self.glow * (0.6 * near.powi(6) + 0.4 * near.powi(40))
    }
}

/// Directions of the view rays through all pixels, row by row from the top.
pub fn directions(camera: &Camera, [width, height]: [u32; 2]) -> Vec<Vec3> {
    let direction = |index: u32| {
        let across = 2.0 * ((index % width) as f32 + 0.5) / width as f32 - 1.0;
        let down = 1.0 - 2.0 * ((index / width) as f32 + 0.5) / height as f32;
        let far = camera.world_from_clip * Vec4::new(across, down, camera.far_depth, 1.0);
        (far.truncate() / far.w - camera.eye).normalize_or_zero()
    };
    (0..width * height).map(direction).collect()
}
