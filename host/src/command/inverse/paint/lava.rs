// SPDX-License-Identifier: MIT OR Apache-2.0
//! A plume of smoke as that of an active volcano: a glow from inside, and veins that run up it (thesis Fig. 7.1 and 7.6).

use super::{Canvas, Painted, luminance, smooth};
use crate::data::{fractal_noise, turbulence};
use glam::Vec3;

/// Opacity from which on a pixel counts as part of the plume.
const MATTER: f32 = 0.15;
/// Rows over which the outline of the plume is smoothed, over all rows of it.
const OUTLINE: f32 = 0.05;

/// What is painted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lava {
    /// Azimuth of the eye around the plume, radians from +z towards +x: veins of views from several sides are then those of one plume.
    pub azimuth: f32,
    /// Another one gives other veins.
    pub seed: u64,
    /// Radiance of the hottest veins over that of the bright parts of the picture.
    pub radiance: f32,
    /// How far up veins glow, over the height of the plume.
    pub reach: f32,
}

impl Lava {
    /// The plume on fire. `matter`: opacity of the plume a pixel, 0..1, without which nothing is painted.
    pub fn paint(&self, canvas: &Canvas, matter: &[f32]) -> Painted {
        let opaque = |pixel: usize| matter.get(pixel).copied().unwrap_or(0.0).clamp(0.0, 1.0);
        let Some(outline) = Outline::of(canvas, opaque) else {
            return canvas.painted(|_, _, before| (before, 0.0));
        };
        let bright = canvas.bright();
        canvas.painted(|pixel, _, before| {
            let (across, up) = outline.place(pixel);
            let heat = self.heat(across, up);
            // Red light from the foot, and what is far up as it was.
            let near = smooth(0.95, 0.0, up / self.reach.max(1e-3));
            let cast = Vec3::ONE.lerp(Vec3::new(0.55, 0.1, 0.035), near);
            let grey = Vec3::splat(luminance(before));
            let smoke = grey.lerp(before, 0.3 + 0.7 * (1.0 - near)) * cast;
            let coverage = smooth(0.0, 2.0 * MATTER, opaque(pixel));
            (smoke + bright * self.radiance * ember(heat) * opaque(pixel), coverage)
        })
    }

    /// 0..1 at a place of the plume: `across` from -1 at its left side to 1 at its right, `up` from 0 to 1.
    fn heat(&self, across: f32, up: f32) -> f32 {
        // On a cylinder, half of which is seen.
        let angle = self.azimuth + across.clamp(-1.0, 1.0).asin();
        let at = Vec3::new(1.2 * angle.sin(), 5.0 * up, 1.2 * angle.cos());
        let warp = |lane: u64| fractal_noise(self.seed.wrapping_add(lane), 1.5 * at, 3) - 0.5;
        let warped = at * Vec3::new(1.4, 0.9, 1.4) + 1.6 * Vec3::new(warp(1), warp(2), warp(3));
        // Turbulence has creases, and they are the veins: broad at the foot, thin where they end.
        let height = smooth(1.0, 0.1, up / self.reach.max(1e-3));
        let crease = turbulence(self.seed.wrapping_add(4), warped, 2);
        let width = 0.08 + 0.24 * height;
        let vein = smooth(width, 0.15 * width, crease);
        let patches = smooth(0.3, 0.6, fractal_noise(self.seed.wrapping_add(9), 1.1 * at, 2));
        // Inside, near the foot, all glows.
        let core = 0.6 * smooth(0.35, 0.0, up) * (1.0 - 0.7 * across * across);
        (vein * height.sqrt() * (0.45 + 0.55 * patches) + core * (0.5 + 0.5 * vein)).clamp(0.0, 1.0)
    }
}

/// From black over red and orange to yellow, 0..1; linear RGB, the red channel of the hottest 1.
fn ember(heat: f32) -> Vec3 {
    Vec3::new(heat.powf(1.2), 0.55 * heat.powf(2.8), 0.12 * heat.powf(5.0))
}

/// Left and right sides of the plume in each row, and its first and last row.
struct Outline {
    width: usize,
    rows: [usize; 2],
    sides: Vec<[f32; 2]>,
}

impl Outline {
    fn of(canvas: &Canvas, opaque: impl Fn(usize) -> f32) -> Option<Self> {
        let [width, height] = canvas.size.map(|side| side as usize);
        let seen = |y: usize| {
            let mut part = (0..width).filter(|x| opaque(y * width + x) >= MATTER);
            let first = part.next()?;
            Some([first as f32, part.last().unwrap_or(first) as f32])
        };
        let found: Vec<Option<[f32; 2]>> = (0..height).map(seen).collect();
        let first = found.iter().position(Option::is_some)?;
        let last = found.iter().rposition(Option::is_some)?;
        let reach = ((OUTLINE * (last - first) as f32) as usize).max(1);
        let sides = (0..height).map(|y| {
            // Rows above and below have the sides of the nearest of it.
            let y = y.clamp(first, last);
            let near = &found[y.saturating_sub(reach).max(first)..=(y + reach).min(last)];
            let some: Vec<[f32; 2]> = near.iter().flatten().copied().collect();
            let mean =
                |side: usize| some.iter().map(|sides| sides[side]).sum::<f32>() / some.len().max(1) as f32;
            [mean(0), mean(1).max(mean(0) + 1.0)]
        });
        let sides = sides.collect();
        Some(Self { width, rows: [first, last], sides })
    }

    /// Where a pixel is: -1 at the left side to 1 at the right, 0 at the foot to 1 at the top.
    fn place(&self, pixel: usize) -> (f32, f32) {
        let (x, y) = (pixel % self.width, pixel / self.width);
        let [left, right] = self.sides[y];
        let [first, last] = self.rows;
        let up = (last as f32 - y as f32) / (last - first).max(1) as f32;
        ((2.0 * x as f32 - left - right) / (right - left), up.clamp(0.0, 1.0))
    }
}
