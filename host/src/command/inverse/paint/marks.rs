// SPDX-License-Identifier: MIT OR Apache-2.0
//! Logos: marks of a few plain shapes, as imprinted into a volume (thesis Fig. 7.5).

use super::{Canvas, Painted, inside, luminance};
use glam::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// What is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    /// A disc in a crown of rays, long and short.
    Sun,
    /// A leaf with its stem and veins.
    Leaf,
}

/// A mark on a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Logo {
    /// What is drawn.
    pub mark: Mark,
    /// Its middle.
    pub middle: Vec2,
    /// From its middle to its farthest point, halves of the height.
    pub radius: f32,
    /// By how much it is turned to the left, radians.
    pub turn: f32,
    /// How much of the light and shade beneath stays, 0..1.
    pub shade: f32,
}

/// Deep orange.
const RAY: Vec3 = Vec3::new(0.85, 0.16, 0.015);
/// Golden.
const DISC: Vec3 = Vec3::new(0.95, 0.58, 0.04);
/// Grass.
const BLADE: Vec3 = Vec3::new(0.06, 0.42, 0.07);
/// Pale.
const VEIN: Vec3 = Vec3::new(0.55, 0.82, 0.25);

impl Logo {
    /// The mark over a picture of a medium. `matter`: opacity of the medium a pixel, 0..1, since paint holds only on it; 1 where there is none.
    /// Its colours are as bright as the bright parts of the picture.
    pub fn paint(&self, canvas: &Canvas, matter: &[f32]) -> Painted {
        let bright = canvas.bright();
        let pixel = canvas.pixel() / self.radius;
        let (sine, cosine) = self.turn.sin_cos();
        canvas.painted(|i, place, before| {
            let away = (place - self.middle) / self.radius;
            let at = Vec2::new(cosine * away.x + sine * away.y, cosine * away.y - sine * away.x);
            let (color, coverage) = self.mark.at(at, pixel);
            let light = 1.0 - self.shade + self.shade * (luminance(before) / bright).min(1.5);
            (bright * light * color, coverage * matter.get(i).copied().unwrap_or(1.0).clamp(0.0, 1.0))
        })
    }
}

impl Mark {
    /// Colour and coverage at a place in the circle of radius 1 that holds the mark; `pixel`: side of a pixel.
    fn at(self, at: Vec2, pixel: f32) -> (Vec3, f32) {
        match self {
            Self::Sun => sun(at, pixel),
            Self::Leaf => leaf(at, pixel),
        }
    }
}

/// Layers from below: a colour and how much of a pixel it covers.
fn layers(layers: &[(Vec3, f32)]) -> (Vec3, f32) {
    let (mut color, mut coverage) = (Vec3::ZERO, 0.0);
    for (over, part) in layers {
        color = color * (1.0 - part) + *over * *part;
        coverage = coverage * (1.0 - part) + part;
    }
    // Of what is covered, not mixed with nothing.
    (if coverage > 0.0 { color / coverage } else { Vec3::ZERO }, coverage)
}

fn sun(at: Vec2, pixel: f32) -> (Vec3, f32) {
    const RAYS: f32 = 8.0;
    let wedge = |shift: f32, long: f32, wide: f32| {
        // All rays folded onto one that points to the right.
        let turn = TAU / RAYS;
        let angle = (at.y.atan2(at.x) + shift * turn).rem_euclid(turn) - 0.5 * turn;
        let folded = at.length() * Vec2::new(angle.cos(), angle.sin().abs());
        triangle(folded, 0.56, long, wide)
    };
    let rays = wedge(0.5, 1.0, 0.15).min(wedge(0.0, 0.8, 0.11));
    layers(&[(RAY, inside(rays, pixel)), (DISC, inside(at.length() - 0.47, pixel))])
}

/// Distance from the upper half of a triangle about the x axis: from `begin`, where it is `wide` high, to its tip at `end`.
fn triangle(at: Vec2, begin: f32, end: f32, wide: f32) -> f32 {
    let slope = Vec2::new(wide, end - begin).normalize();
    (begin - at.x).max((at - Vec2::new(end, 0.0)).dot(slope))
}

fn leaf(at: Vec2, pixel: f32) -> (Vec3, f32) {
    // The blade is what two circles share, from tip (0, 0.98) to (0, -0.55); its middle rib runs on as the stem.
    let (tip, foot, half_width) = (0.98, -0.55, 0.44);
    let (half, middle) = (0.5 * (tip - foot), 0.5 * (tip + foot));
    let radius = (half * half + half_width * half_width) / (2.0 * half_width);
    let blade = (Vec2::new(at.x.abs() + radius - half_width, at.y - middle)).length() - radius;
    // The rib bends a little, and gets thinner towards the tip.
    let bend = |y: f32| 0.06 * (PI * (y - foot) / (tip - foot)).sin() * if y < foot { 2.0 } else { 0.4 };
    let rib_half = 0.03 * (1.0 - 0.6 * ((at.y - foot) / (tip - foot)).clamp(0.0, 1.0));
    let rib = ((at.x - bend(at.y)).abs() - rib_half).max(at.y - 0.8).max(-0.97 - at.y);
    let stem = rib.max(at.y - foot - 0.1);
    // Side veins rise from the rib, on both sides, and stop before the edge.
    let mut veins = rib.max(foot - at.y);
    for i in 0..5_u8 {
        let from = foot + 0.16 + 0.24 * f32::from(i);
        let begin = Vec2::new(0.0, from);
        let reach = 0.5 - 0.05 * f32::from(i);
        let end = begin + Vec2::new(0.62, 0.55) * reach;
        veins = veins.min(segment(Vec2::new(at.x.abs(), at.y), begin, end) - 0.014);
    }
    let veins = veins.max(blade + 0.045);
    layers(&[(BLADE, inside(blade, pixel)), (BLADE, inside(stem, pixel)), (VEIN, inside(veins, pixel))])
}

/// Distance from a straight line between two points.
pub(super) fn segment(at: Vec2, begin: Vec2, end: Vec2) -> f32 {
    let along = end - begin;
    let part = ((at - begin).dot(along) / along.length_squared().max(1e-12)).clamp(0.0, 1.0);
    at.distance(begin + part * along)
}
