// SPDX-License-Identifier: MIT OR Apache-2.0
//! Where sheets lie.

use super::SplattingError;
use crate::out_of_range::in_range;
use encase::ShaderType;
use glam::{DVec3, UVec2, Vec3};

/// Most sheets.
const MOST: u32 = 4096;

/// The uniform `Sheets` of `splatting/sheets`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct Sheets {
    /// Unit normal, from the side of the light on.
    pub normal: Vec3,
    /// Where the first begins: dot(normal, point), metres.
    pub first: f32,
    /// Of every sheet, metres.
    pub thickness: f32,
    /// How many.
    pub count: u32,
    /// Sheets that one splat reaches at most.
    pub span: u32,
    /// 1 where the sheet nearest to the light is nearest to the eye as well.
    pub front_to_back: u32,
}

/// The uniform `SheetTargets` of `splatting/order_splats`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct SheetTargets {
    /// Groups over the picture.
    pub picture: UVec2,
    /// Groups over the shadow buffer.
    pub shadow: UVec2,
}

/// The uniform `SheetNumber` of `splatting/sheets`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct SheetNumber {
    /// From 0, the sheet nearest to the light.
    pub index: u32,
    /// Padding.
    pub reserved_a: u32,
    /// Padding.
    pub reserved_b: u32,
    /// Padding.
    pub reserved_c: u32,
}

impl SheetNumber {
    /// Of the sheet `index`.
    pub fn new(index: u32) -> Self {
        Self { index, reserved_a: 0, reserved_b: 0, reserved_c: 0 }
    }
}

impl Sheets {
    /// Sheets half-way between two directions, of any length, over `points` with room of `reach` (of a direction: metres) around each.
    /// `view`: in which the eye looks; `light`: in which light goes; one that is none counts as the other, and two as straight down.
    ///
    /// # Errors
    /// [`SplattingError::Setting`] for a number of sheets that is impossible.
    pub fn between(
        view: Vec3,
        light: Vec3,
        count: u32,
        points: &[Vec3],
        reach: impl Fn(Vec3) -> f32,
    ) -> Result<Self, SplattingError> {
        in_range("number of sheets", count as f32, 1.0..=MOST as f32, "from 1 to 4096")?;
        let unit = |direction: Vec3| direction.as_dvec3().try_normalize();
        let light = unit(light).or(unit(view)).unwrap_or(DVec3::NEG_Y);
        let view = unit(view).unwrap_or(light);
        let halfway = if view.dot(light) >= 0.0 { light + view } else { light - view };
        let normal = halfway.normalize();
        let reach = reach(normal.as_vec3());
        let heights = points.iter().map(|point| normal.dot(point.as_dvec3()));
        let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), h| (a.min(h), b.max(h)));
        let (low, high) = if low <= high { (low, high) } else { (0.0, 0.0) };
        let reach = f64::from(reach);
        let thickness = ((high - low + 2.0 * reach) / f64::from(count)).max(1e-9) * (1.0 + 1e-6);
        let span = (2.0 * reach / thickness).ceil() as u32 + 1;
        Ok(Self {
            normal: normal.as_vec3(),
            first: (low - reach) as f32,
            thickness: thickness as f32,
            count,
            span: span.min(count),
            front_to_back: u32::from(view.dot(light) >= 0.0),
        })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn rays_cross_sheets_at_forty_five_degrees_or_more() {
        let light = Vec3::NEG_Y;
        for angle in 0..=180 {
            let (sine, cosine) = (angle as f32).to_radians().sin_cos();
            let view = Vec3::new(sine, -cosine, 0.0);
            let sheets = Sheets::between(view, light, 64, &[Vec3::ZERO, Vec3::ONE], |_| 0.1).unwrap();
            assert!(sheets.normal.dot(light) > 0.707 && sheets.normal.dot(view).abs() > 0.707, "{angle}");
            // At the right angle rounding decides.
            assert!(angle == 90 || (sheets.front_to_back == 1) == (angle < 90), "{angle}");
        }
    }

    #[test]
    fn all_points_lie_within_and_nonsense_has_a_normal() {
        for (view, light) in [(Vec3::X, Vec3::NAN), (Vec3::ZERO, Vec3::Z), (Vec3::ZERO, Vec3::ZERO)] {
            let points = [Vec3::splat(-2.0), Vec3::new(1.0, 3.0, 0.0)];
            let sheets = Sheets::between(view, light, 10, &points, |_| 0.25).unwrap();
            assert!((sheets.normal.length() - 1.0).abs() < 1e-6);
            for point in points {
                let height = sheets.normal.dot(point) - sheets.first;
                assert!(height > 0.249 && height < 10.0 * sheets.thickness - 0.249, "{height}");
            }
        }
        assert!(Sheets::between(Vec3::X, Vec3::X, 0, &[], |_| 0.0).is_err());
        assert!(Sheets::between(Vec3::X, Vec3::X, 5000, &[], |_| 0.0).is_err());
        assert!(Sheets::between(Vec3::X, Vec3::X, 8, &[], |_| 0.0).unwrap().thickness > 0.0);
    }
}
