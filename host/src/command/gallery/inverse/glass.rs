// SPDX-License-Identifier: MIT OR Apache-2.0
//! A sphere of glass with streaks, in a bright room.

use crate::data::fractal_noise;
use crate::{Gpu, GpuError, Texture};
use glam::{Mat4, Vec3};
use wgpu::TextureFormat::R32Float;

/// Metres from the middle to the surface.
pub const RADIUS: f32 = 1.0;
/// Half of a side of the box about it, metres.
pub const HALF: f32 = 1.15;
/// Voxels along a side.
const SIDE: u32 = 64;
/// Metres of a step of bent rays.
pub const STEP: f32 = 0.036;
/// Over what part of the radius glass begins.
const EDGE: f32 = 0.35;

/// Its index of refraction.
pub struct Glass {
    values: Vec<f32>,
}

impl Glass {
    /// `strength`: index over 1 deep inside; `streaks`: by how much it differs there.
    pub fn new(strength: f32, streaks: f32, seed: u64) -> Self {
        let place = |i: u32| {
            let voxel = Vec3::new((i % SIDE) as f32, (i / SIDE % SIDE) as f32, (i / (SIDE * SIDE)) as f32);
            ((voxel + 0.5) / SIDE as f32 * 2.0 - 1.0) * HALF
        };
        let index = |at: Vec3| {
            let part = ((RADIUS - at.length()) / (EDGE * RADIUS)).clamp(0.0, 1.0);
            let inside = part * part * (3.0 - 2.0 * part);
            let noise = fractal_noise(seed, 2.2 * at + 9.0, 2) - 0.5;
            1.0 + inside * (strength + streaks * 2.0 * noise)
        };
        Self { values: (0..SIDE * SIDE * SIDE).map(|i| index(place(i))).collect() }
    }

    /// From the box 0..1 to the world, metres.
    pub fn place() -> Mat4 {
        Mat4::from_translation(Vec3::splat(-HALF)) * Mat4::from_scale(Vec3::splat(2.0 * HALF))
    }

    /// For passes.
    pub fn texture(&self, gpu: &Gpu) -> Result<Texture, GpuError> {
        let texture = Texture::volume(gpu, [SIDE; 3], R32Float);
        texture.write(gpu, &self.values)?;
        Ok(texture)
    }

    /// The direction in which a ray leaves the box; none of one that misses the glass.
    pub fn leaves(&self, eye: Vec3, way: Vec3) -> Option<Vec3> {
        // The sphere is all of the box that bends.
        let (along, square) = (-eye.dot(way), eye.length_squared());
        let miss = square - along * along;
        if along <= 0.0 || miss >= RADIUS * RADIUS {
            return None;
        }
        let begin = along - (RADIUS * RADIUS - miss).sqrt();
        let (mut at, mut way) = (eye + begin * way, way);
        for _ in 0..(8.0 * RADIUS / STEP) as u32 {
            let aside = HALF / SIDE as f32;
            let slope = [Vec3::X, Vec3::Y, Vec3::Z]
                .map(|axis| self.index(at + aside * axis) - self.index(at - aside * axis));
            let turned = way * self.index(at) + Vec3::from(slope) * (STEP / (2.0 * aside));
            at += STEP * way;
            way = turned.normalize_or(way);
            if at.length_squared() > RADIUS * RADIUS && at.dot(way) > 0.0 {
                break;
            }
        }
        Some(way)
    }

    fn index(&self, at: Vec3) -> f32 {
        let last = (SIDE - 1) as f32;
        let voxel =
            ((at / HALF + 1.0) * (0.5 * SIDE as f32) - 0.5).clamp(Vec3::ZERO, Vec3::splat(last - 1e-3));
        let low = voxel.floor();
        let part = voxel - low;
        let [x, y, z] = low.to_array().map(|side| side as usize);
        let side = SIDE as usize;
        let row = |y: usize, z: usize| {
            let first = (z * side + y) * side + x;
            self.values[first] + (self.values[first + 1] - self.values[first]) * part.x
        };
        let slice = |z: usize| row(y, z) + (row(y + 1, z) - row(y, z)) * part.y;
        slice(z) + (slice(z + 1) - slice(z)) * part.z
    }
}

/// Radiance of the room in a direction of length 1: a bright wall, a window's glow, a warm floor.
pub fn room(way: Vec3) -> Vec3 {
    let up = way.y;
    let wall =
        Vec3::new(0.62, 0.66, 0.70).lerp(Vec3::new(0.92, 0.95, 0.98), (0.5 + 1.2 * up).clamp(0.0, 1.0));
    let floor = Vec3::new(0.46, 0.36, 0.27);
    let edge = ((up + 0.30) / 0.12).clamp(0.0, 1.0);
    let edge = edge * edge * (3.0 - 2.0 * edge);
    let side = (0.5 + 0.5 * (2.0 * way.x.atan2(way.z)).sin()).powi(2);
    floor.lerp(wall, edge) * (0.88 + 0.24 * side)
}
