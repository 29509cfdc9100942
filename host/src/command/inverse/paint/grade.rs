// SPDX-License-Identifier: MIT OR Apache-2.0
//! Contrast and colour of a whole picture.

use super::{Canvas, luminance};
use glam::Vec3;

/// A change of contrast, saturation and of the colours of shade and light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grade {
    /// Exponent of the luminance over that of `middle`: 1 changes nothing, 2 doubles contrast in stops.
    pub contrast: f32,
    /// The luminance that stays, over that of the bright parts of the picture.
    pub middle: f32,
    /// 0 grey, 1 as it is.
    pub saturation: f32,
    /// Factor of what is dark, linear RGB.
    pub shade: Vec3,
    /// Factor of what is bright, linear RGB.
    pub light: Vec3,
}

impl Default for Grade {
    /// Changes nothing.
    fn default() -> Self {
        Self { contrast: 1.0, middle: 0.4, saturation: 1.0, shade: Vec3::ONE, light: Vec3::ONE }
    }
}

impl Grade {
    /// The picture, graded. Black stays black.
    pub fn apply(&self, canvas: &Canvas) -> Canvas {
        let bright = canvas.bright();
        let middle = self.middle * bright;
        let graded = canvas.pixels.iter().map(|color| {
            let before = luminance(*color);
            if before <= 0.0 {
                return Vec3::ZERO;
            }
            let after = middle * (before / middle).powf(self.contrast);
            let grey = Vec3::splat(before);
            let color = (grey + (*color - grey) * self.saturation).max(Vec3::ZERO) * (after / before);
            let tone = super::smooth(0.0, 1.0, after / bright);
            color * self.shade.lerp(self.light, tone)
        });
        Canvas { size: canvas.size, pixels: graded.collect() }
    }
}
