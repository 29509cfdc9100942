// SPDX-License-Identifier: MIT OR Apache-2.0
//! A bare tree against the light, for what is seen through a medium that bends rays (thesis Fig. 7.7).

use super::{Canvas, Painted, inside, smooth};
use crate::data::Random;
use glam::{Vec2, Vec3};

/// A tree.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tree {
    /// Where it stands.
    pub foot: Vec2,
    /// To its top, about, in halves of the height of the picture.
    pub height: f32,
    /// Another one gives another tree.
    pub seed: u64,
    /// Radiance of wood, linear RGB.
    pub color: Vec3,
}

/// A piece of wood between two places, with its half widths there.
#[derive(Debug, Clone, Copy)]
struct Limb {
    begin: Vec2,
    end: Vec2,
    half_widths: [f32; 2],
}

impl Tree {
    /// The tree over a picture.
    pub fn paint(&self, canvas: &Canvas) -> Painted {
        let coverage = self.coverage(canvas);
        canvas.painted(|pixel, _, _| (self.color, coverage[pixel]))
    }

    /// How much of each pixel is wood, 0..1.
    pub fn coverage(&self, canvas: &Canvas) -> Vec<f32> {
        let mut limbs = Vec::new();
        let mut random = Random::new(self.seed);
        let (trunk, width) = (0.3 * self.height, 0.034 * self.height);
        grow(&mut limbs, &mut random, self.foot, Vec2::Y, trunk, width, 0);
        // The root flares.
        let base = self.foot - Vec2::Y * 0.02 * self.height;
        limbs.push(Limb {
            begin: base,
            end: self.foot + Vec2::Y * 0.1 * self.height,
            half_widths: [1.7 * width, 0.95 * width],
        });
        let mut covered = vec![0.0_f32; canvas.pixels.len()];
        limbs.iter().for_each(|limb| limb.draw(canvas, &mut covered));
        covered
    }
}

/// A bough, in short bent pieces, and the boughs that leave it.
fn grow(
    limbs: &mut Vec<Limb>,
    random: &mut Random,
    from: Vec2,
    towards: Vec2,
    length: f32,
    half_width: f32,
    order: u32,
) {
    const PIECES: u8 = 4;
    const ORDERS: u32 = 8;
    let (mut at, mut direction) = (from, towards);
    let thinner = |piece: u8| half_width * (1.0 - 0.35 * f32::from(piece) / f32::from(PIECES));
    for piece in 0..PIECES {
        // Towards the light, and a little to and fro.
        let sway = random.range(-1.0, 1.0) * if order == 0 { 0.08 } else { 0.2 };
        direction = (direction + sway * direction.perp() + Vec2::Y * 0.05).normalize_or(Vec2::Y);
        let end = at + direction * (length / f32::from(PIECES));
        limbs.push(Limb { begin: at, end, half_widths: [thinner(piece), thinner(piece + 1)] });
        at = end;
        // Twigs from the side.
        let early = order > 0 && piece + 1 < PIECES && random.unit() < 0.35;
        if early && order + 2 < ORDERS {
            let side = if random.unit() < 0.5 { -1.0 } else { 1.0 };
            let away = Vec2::from_angle(side * random.range(0.6, 1.0)).rotate(direction);
            grow(limbs, random, at, away, 0.55 * length, 0.42 * half_width, order + 2);
        }
    }
    if order + 1 >= ORDERS {
        return;
    }
    let (left, right) = (random.range(0.28, 0.62), random.range(0.28, 0.62));
    let mut boughs = vec![left, -right];
    if order < 3 && random.unit() < 0.7 {
        boughs.push(random.range(-0.15, 0.15));
    }
    for angle in boughs {
        let away = Vec2::from_angle(angle).rotate(direction);
        let (longer, wider) = (random.range(0.68, 0.86), random.range(0.6, 0.74));
        grow(limbs, random, at, away, longer * length, wider * half_width, order + 1);
    }
}

impl Limb {
    fn draw(&self, canvas: &Canvas, covered: &mut [f32]) {
        let [width, height] = canvas.size.map(|side| side as f32);
        let pixel = canvas.pixel();
        let room = self.half_widths[0].max(self.half_widths[1]) + pixel;
        let (low, high) = (self.begin.min(self.end) - room, self.begin.max(self.end) + room);
        // In pixels, y down.
        let column = |x: f32| (0.5 * (x * height + width)).clamp(0.0, width) as usize;
        let row = |y: f32| (0.5 * height * (1.0 - y)).clamp(0.0, height) as usize;
        for y in row(high.y)..(row(low.y) + 1).min(height as usize) {
            for x in column(low.x)..(column(high.x) + 1).min(width as usize) {
                let i = y * width as usize + x;
                let here = self.coverage(canvas.place(i), pixel);
                covered[i] = covered[i].max(here);
            }
        }
    }

    /// What is thinner than a pixel covers it in part.
    fn coverage(&self, at: Vec2, pixel: f32) -> f32 {
        let along = self.end - self.begin;
        let part = ((at - self.begin).dot(along) / along.length_squared().max(1e-12)).clamp(0.0, 1.0);
        let half_width = self.half_widths[0] + (self.half_widths[1] - self.half_widths[0]) * part;
        let drawn = half_width.max(0.5 * pixel);
        let thin = smooth(0.0, 1.0, half_width / drawn);
        thin * inside(at.distance(self.begin + part * along) - drawn, pixel)
    }
}
