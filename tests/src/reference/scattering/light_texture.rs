// SPDX-License-Identifier: MIT OR Apache-2.0
//! Light textures.

use super::picture::ViewRay;
use super::views::Line;
use crate::linear::{Mat4, Vec3};

/// A light texture: what of the light passes, by the place of the light ray in the shadow map.
#[derive(Clone, Copy, Debug)]
pub struct LightTexture<'a> {
    /// Three values a texel, [0, 1], row-major, row 0 at the top.
    pub rgb: &'a [f32],
    /// Texels of a row.
    pub width: usize,
    /// Number of rows.
    pub height: usize,
    /// World to a clip space over which the texture lies; none for that of the shadow map that the
    /// light ray belongs to.
    pub clip_from_world: Option<Mat4>,
    /// What passes outside of the clip space: 1 for a directional light, 0 for a spot.
    pub outside: f64,
}

impl LightTexture<'_> {
    /// The distances between two, metres from a view ray's origin, at which the texture's interpolation
    /// passes from one texel to the next; w of the clip space is positive between them.
    #[must_use]
    pub fn creases(&self, view: Option<Mat4>, ray: &ViewRay, from: f64, to: f64) -> Vec<f64> {
        let Some(clip_from_world) = self.clip_from_world.or(view) else { return Vec::new() };
        let line = Line::new(&clip_from_world, ray);
        let mut places = line.grid(0, self.width, 0.5, from, to);
        places.extend(line.grid(1, self.height, 0.5, from, to));
        // The border, where the value outside begins.
        places.extend(line.grid(0, 1, 0.0, from, to));
        places.extend(line.grid(1, 1, 0.0, from, to));
        places
    }

    /// What passes through a world point's light ray, with the clip space of the view that it belongs
    /// to, if any. Bilinear, clamped to the edge.
    ///
    /// # Panics
    /// If the texture has not the size that it states.
    #[must_use]
    pub fn at(&self, view: Option<Mat4>, point: Vec3) -> [f64; 3] {
        assert_eq!(self.rgb.len(), 3 * self.width * self.height, "size of the light texture");
        let Some(clip_from_world) = self.clip_from_world.or(view) else { return [self.outside; 3] };
        let [x, y, _, w] = clip_from_world.apply_point(point);
        if w <= 0.0 || x.abs() > w || y.abs() > w {
            return [self.outside; 3];
        }
        let axis = |unit: f64, count: usize| {
            let place = (unit * count as f64 - 0.5).clamp(0.0, count as f64 - 1.0);
            let first = place.floor() as usize;
            (first, (first + 1).min(count - 1), place - first as f64)
        };
        let (left, right, across) = axis(0.5 + 0.5 * x / w, self.width);
        let (top, bottom, down) = axis(0.5 - 0.5 * y / w, self.height);
        std::array::from_fn(|channel| {
            let texel = |x: usize, y: usize| f64::from(self.rgb[3 * (y * self.width + x) + channel]);
            let row = |y: usize| texel(left, y) * (1.0 - across) + texel(right, y) * across;
            row(top) * (1.0 - down) + row(bottom) * down
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texture_is_bilinear_with_its_first_row_at_the_top() {
        let clip = Mat4::from_rows([
            [1.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0, 0.0],
            [0.0, 0.0, 1.0, 0.0],
            [0.0, 0.0, 0.0, 1.0],
        ]);
        let rgb: Vec<f32> = [0.0, 1.0, 0.25, 0.5].iter().flat_map(|&v| [v, 2.0 * v, 1.0 - v]).collect();
        let texture = LightTexture { rgb: &rgb, width: 2, height: 2, clip_from_world: None, outside: 0.7 };
        let at = |x: f64, y: f64| texture.at(Some(clip), Vec3::new(x, y, 0.0));
        assert_eq!(at(-0.9, 0.9), [0.0, 0.0, 1.0]);
        assert_eq!(at(0.5, 0.6), [1.0, 2.0, 0.0]);
        assert_eq!(at(0.0, 0.5)[0], 0.5);
        assert_eq!(at(-0.5, 0.0)[0], 0.125);
        assert_eq!(at(1.1, 0.0), [0.7; 3]);
        assert_eq!(texture.at(None, Vec3::default()), [0.7; 3]);
    }
}
