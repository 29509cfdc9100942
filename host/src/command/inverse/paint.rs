// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pictures that are painted by code over rendered views, so that anyone can repeat them: marks, glowing veins, grades and silhouettes.
//!
//! A place in a picture is x to the right and y up from its middle, in halves of its height.

mod grade;
mod lava;
mod marks;
mod tree;

pub use grade::Grade;
pub use lava::Lava;
pub use marks::{Logo, Mark};
pub use tree::Tree;

use glam::{Vec2, Vec3};

/// A picture in linear light.
#[derive(Debug, Clone, PartialEq)]
pub struct Canvas {
    size: [u32; 2],
    pixels: Vec<Vec3>,
}

/// A picture with what was changed of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Painted {
    /// The picture.
    pub canvas: Canvas,
    /// How much of each pixel is paint, 0..1: weights where the rest is not to count.
    pub coverage: Vec<f32>,
}

impl Canvas {
    /// A picture of linear RGB radiance, rows from the top; pixels that are missing are black, those too many are left out.
    pub fn new(size: [u32; 2], mut pixels: Vec<Vec3>) -> Self {
        let size = size.map(|side| side.max(1));
        pixels.resize(size[0] as usize * size[1] as usize, Vec3::ZERO);
        Self { size, pixels }
    }

    /// Linear RGB radiance, rows from the top.
    pub fn pixels(&self) -> &[Vec3] {
        &self.pixels
    }

    /// The place of the middle of a pixel, counted in rows from the top.
    fn place(&self, pixel: usize) -> Vec2 {
        let (width, height) = (self.size[0] as usize, self.size[1] as f32);
        let middle = Vec2::new((pixel % width) as f32, (pixel / width) as f32) + 0.5;
        Vec2::new(2.0 * middle.x - self.size[0] as f32, height - 2.0 * middle.y) / height
    }

    /// Length of the side of a pixel in halves of the height.
    fn pixel(&self) -> f32 {
        2.0 / self.size[1] as f32
    }

    /// Paint over the picture: of each place and what is there its colour and how much of it covers, 0..1.
    fn painted(&self, paint: impl Fn(usize, Vec2, Vec3) -> (Vec3, f32)) -> Painted {
        let paints = self.pixels.iter().enumerate().map(|(pixel, before)| {
            let (color, coverage) = paint(pixel, self.place(pixel), *before);
            (before.lerp(color, coverage), coverage)
        });
        let (pixels, coverage) = paints.unzip();
        Painted { canvas: Self { size: self.size, pixels }, coverage }
    }

    /// The luminance that few pixels exceed: that of the 98th of 100, of those that are not black.
    fn bright(&self) -> f32 {
        let mut lights: Vec<f32> =
            self.pixels.iter().map(|color| luminance(*color)).filter(|light| *light > 1e-6).collect();
        lights.sort_unstable_by(f32::total_cmp);
        lights.get(lights.len() * 98 / 100).copied().unwrap_or(1.0)
    }
}

/// Relative luminance of linear RGB (ITU-R BT.709).
fn luminance(color: Vec3) -> f32 {
    color.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}

/// How much of a pixel of side `pixel` lies inside a shape whose border is `distance` away, negative inside.
fn inside(distance: f32, pixel: f32) -> f32 {
    (0.5 - distance / pixel).clamp(0.0, 1.0)
}

/// From 0 at `low` to 1 at `high`, smooth at both; `low` may be the greater.
fn smooth(low: f32, high: f32, value: f32) -> f32 {
    let part = ((value - low) / (high - low)).clamp(0.0, 1.0);
    part * part * (3.0 - 2.0 * part)
}

#[cfg(test)]
mod tests;
