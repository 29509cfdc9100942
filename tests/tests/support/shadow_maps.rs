// SPDX-License-Identifier: MIT OR Apache-2.0
//! Shadow maps that the tests of stylization write.

use crate::gpu::{self, Random};
use airlight::Texture;
use wgpu::TextureFormat::R32Float;

/// A map of such depths.
pub fn texture(size: [u32; 2], values: &[f32]) -> Texture {
    gpu::texture(size, R32Float, values)
}

/// Depths at random, a part of them empty, some not finite.
pub fn random_map(random: &mut Random, [width, height]: [u32; 2], far: f32) -> Vec<f32> {
    let wild = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    let empty = random.between(0.0, 0.9);
    (0..width * height)
        .map(|_| match random.unit() {
            x if x < 0.02 => wild[random.below(3)],
            x if x < empty => far,
            _ => random.unit() as f32,
        })
        .collect()
}
