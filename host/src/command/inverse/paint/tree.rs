// SPDX-License-Identifier: MIT OR Apache-2.0
//! A tree against the light, from a sapling to its full height, for what is seen through a medium that bends rays (thesis Fig. 7.7).

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
    /// From a bare stem (0) to the whole tree (1).
    pub growth: f32,
    /// Radiance of wood, linear RGB.
    pub wood: Vec3,
    /// Radiance of leaves, linear RGB; none where it is winter.
    pub leaves: Option<Vec3>,
}

/// Orders of boughs, the trunk's included.
const ORDERS: u32 = 8;
/// Straight pieces of a bough.
const PIECES: u8 = 4;

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
        let mut grown = Growth {
            limbs: Vec::new(),
            tips: Vec::new(),
            random: Random::new(self.seed),
            growth: self.growth,
        };
        let growth = self.growth.clamp(0.0, 1.0);
        let (trunk, width) = (0.3 * self.height, 0.034 * self.height * (0.25 + 0.75 * growth));
        grown.bough(self.foot, Vec2::Y, trunk, width, 0);
        // The root flares.
        for step in 0..6_u8 {
            let [low, high] = [step, step + 1].map(|step| f32::from(step) / 6.0);
            let at = |up: f32| self.foot + Vec2::Y * 0.08 * up * self.height;
            let half_widths = [low, high].map(|up| width * (0.9 + 0.85 * (1.0 - up) * (1.0 - up)));
            grown.limbs.push(Limb { begin: at(low), end: at(high), half_widths });
        }
        let mut wood = vec![0.0_f32; canvas.pixels.len()];
        grown.limbs.iter().for_each(|limb| limb.draw(canvas, &mut wood));
        let mut leaves = vec![0.0_f32; canvas.pixels.len()];
        if self.leaves.is_some() {
            let mut random = Random::new(self.seed.wrapping_add(1));
            for tip in &grown.tips {
                let size = self.height * random.range(0.006, 0.014);
                let away = Vec2::from_angle(random.range(0.0, std::f32::consts::TAU)) * size;
                let leaf =
                    Limb { begin: *tip - away, end: *tip + away, half_widths: [0.7 * size, 0.3 * size] };
                leaf.draw(canvas, &mut leaves);
            }
        }
        canvas.painted(|pixel, place, _| {
            // Nothing below the ground.
            let above = inside(self.foot.y - place.y, canvas.pixel());
            let (wood, leaf) = (wood[pixel] * above, leaves[pixel]);
            let coverage = wood + leaf - wood * leaf;
            let color =
                self.leaves.map_or(self.wood, |color| self.wood.lerp(color, leaf / coverage.max(1e-6)));
            (color, coverage)
        })
    }
}

/// A tree as it grows.
struct Growth {
    limbs: Vec<Limb>,
    /// Where leaves are.
    tips: Vec<Vec2>,
    random: Random,
    growth: f32,
}

impl Growth {
    /// How long a bough of an order is by now, 0..1 of what it will be.
    fn grown(&self, order: u32) -> f32 {
        smooth(0.0, 2.5, self.growth.clamp(0.0, 1.0) * (ORDERS as f32 + 2.5) - order as f32)
    }

    /// A bough, in short bent pieces, and the boughs that leave it.
    fn bough(&mut self, from: Vec2, towards: Vec2, length: f32, half_width: f32, order: u32) {
        let grown = if order == 0 { 0.4 + 0.6 * self.grown(1) } else { self.grown(order) };
        let (mut at, mut direction) = (from, towards);
        let thinner = |piece: u8| half_width * (1.0 - 0.35 * f32::from(piece) / f32::from(PIECES));
        for piece in 0..PIECES {
            // Towards the light, and a little to and fro.
            let sway = self.random.range(-1.0, 1.0) * if order == 0 { 0.08 } else { 0.2 };
            direction = (direction + sway * direction.perp() + Vec2::Y * 0.05).normalize_or(Vec2::Y);
            let end = at + direction * (grown * length / f32::from(PIECES));
            if grown > 0.0 {
                self.limbs.push(Limb { begin: at, end, half_widths: [thinner(piece), thinner(piece + 1)] });
                if order + 3 >= ORDERS || (order > 0 && half_width < 0.2 * length * (1.0 - self.growth)) {
                    self.tips.push(end);
                }
            }
            at = end;
            // Twigs from the side.
            let early = order > 0 && piece + 1 < PIECES && self.random.unit() < 0.35;
            if early && order + 2 < ORDERS {
                let side = if self.random.unit() < 0.5 { -1.0 } else { 1.0 };
                let away = Vec2::from_angle(side * self.random.range(0.6, 1.0)).rotate(direction);
                self.bough(at, away, 0.55 * length, 0.42 * half_width, order + 2);
            }
        }
        if order + 1 >= ORDERS {
            return;
        }
        let (left, right) = (self.random.range(0.28, 0.62), self.random.range(0.28, 0.62));
        let mut boughs = vec![left, -right];
        if order < 3 && self.random.unit() < 0.7 {
            boughs.push(self.random.range(-0.15, 0.15));
        }
        for angle in boughs {
            let away = Vec2::from_angle(angle).rotate(direction);
            let (longer, wider) = (self.random.range(0.66, 0.84), self.random.range(0.6, 0.74));
            self.bough(at, away, longer * length, wider * half_width, order + 1);
        }
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
