// SPDX-License-Identifier: MIT OR Apache-2.0
//! Short lines on pictures: where strokes are, and which way they run.

use crate::painterly::Stroke;

/// Lines on a picture of 4 bytes a pixel.
pub struct Marks<'a> {
    /// Columns and rows.
    pub size: [u32; 2],
    /// 4 bytes a pixel.
    pub pixels: &'a mut [u8],
}

impl Marks<'_> {
    /// A line with round ends where a stroke is, `length` and `width` pixels.
    pub fn stroke(&mut self, stroke: &Stroke, length: f32, width: f32, color: [u8; 3]) {
        let middle = [0, 1].map(|axis| stroke.position[axis] * self.size[axis] as f32);
        let half = 0.5 * length;
        let (x, y) = (half * stroke.orientation.cos(), half * stroke.orientation.sin());
        let reach = half + 0.5 * width + 1.0;
        let [columns, rows] = [0, 1].map(|axis| {
            let low = (middle[axis] - reach).max(0.0) as u32;
            low..((middle[axis] + reach).max(0.0) as u32 + 1).min(self.size[axis])
        });
        for row in rows {
            for column in columns.clone() {
                let (px, py) = (column as f32 + 0.5 - middle[0], row as f32 + 0.5 - middle[1]);
                let along = ((px * x + py * y) / (half * half).max(1e-6)).clamp(-1.0, 1.0);
                let distance = (px - along * x).hypot(py - along * y);
                let share = (0.5 * width + 0.5 - distance).clamp(0.0, 1.0);
                let start = 4 * (row as usize * self.size[0] as usize + column as usize);
                for (old, new) in self.pixels[start..].iter_mut().zip(color) {
                    *old = (f32::from(*old) + share * (f32::from(new) - f32::from(*old))).round() as u8;
                }
            }
        }
    }
}

/// A colour for an orientation: the wheel goes round once as a stroke is turned by half a turn.
pub fn orientation_color(orientation: f32) -> [u8; 3] {
    let channel = |third: f32| {
        let phase = 2.0 * orientation - third * std::f32::consts::TAU / 3.0;
        (255.0 * (0.46 + 0.34 * phase.cos())) as u8
    };
    [channel(0.0), channel(1.0), channel(2.0)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::painterly::StrokeState;
    use glam::{Vec2, Vec3};

    #[test]
    fn marks_lie_where_strokes_are_and_as_they_run() {
        let stroke = |orientation: f32| Stroke {
            point: Vec3::ZERO,
            hash: 0,
            color: Vec3::ONE,
            opacity: 1.0,
            position: Vec2::new(0.25, 0.5),
            size: 8.0,
            aspect: 0.5,
            orientation,
            layer: 0,
            state: StrokeState::Stays,
        };
        for (orientation, on, off) in
            [(0.0, (8, 10), (5, 13)), (std::f32::consts::FRAC_PI_2, (5, 13), (8, 10))]
        {
            let mut pixels = vec![0; 20 * 20 * 4];
            Marks { size: [20, 20], pixels: &mut pixels }.stroke(&stroke(orientation), 8.0, 2.0, [200; 3]);
            let at = |(x, y): (usize, usize)| pixels[4 * (20 * y + x)];
            assert!(at((5, 10)) > 190 && at(on) > 190 && at(off) == 0, "{orientation}");
        }
        let [one, other] = [0.3, 0.3 + std::f32::consts::PI].map(orientation_color);
        assert!(one.iter().zip(other).all(|(a, b)| a.abs_diff(b) < 2));
    }
}
