// SPDX-License-Identifier: MIT OR Apache-2.0
//! Transfer functions and what they read, as pictures.

use super::Easel;
use crate::command::CommandError;
use crate::{Gpu, Texture};
use glam::{Vec3, Vec4};

/// Pixels of the frame around a function in the corner of a picture.
const FRAME: usize = 3;

/// A transfer function over black, sRGB, 4 bytes a texel, and its side.
pub fn function(gpu: &Gpu, map: &Texture) -> Result<(u32, Vec<u8>), CommandError> {
    let texels = map.read(gpu)?;
    let color = |texel: &[f32]| [srgb(texel[0]), srgb(texel[1]), srgb(texel[2]), 255];
    Ok((map.size()[0], texels.chunks_exact(4).flat_map(color).collect()))
}

/// Lays a function into the lower right corner of a picture, a quarter as high.
pub fn inset(picture: &mut [u8], [width, height]: [u32; 2], (side, texels): &(u32, Vec<u8>)) {
    let [width, height] = [width as usize, height as usize];
    let (shown, margin) = ((height / 4).max(1), height / 30);
    let outer = shown + 2 * FRAME;
    if outer + margin > width.min(height) {
        return;
    }
    let corner = [width - margin - outer, height - margin - outer];
    for y in 0..outer {
        for x in 0..outer {
            let inside = |place: usize| (FRAME..FRAME + shown).contains(&place);
            let color = if inside(x) && inside(y) {
                let texel = |place: usize| (place - FRAME) * *side as usize / shown;
                let first = 4 * (texel(y) * *side as usize + texel(x));
                [texels[first], texels[first + 1], texels[first + 2]]
            } else {
                [232, 228, 218]
            };
            let first = 4 * ((corner[1] + y) * width + corner[0] + x);
            picture[first..first + 3].copy_from_slice(&color);
        }
    }
}

/// What a function with the default properties reads: amber as far as a ray is lit, blue with its length.
pub fn rays(gpu: &Gpu, easel: &Easel<'_>, scattered: &Texture) -> Result<Vec<u8>, CommandError> {
    let (camera, medium) = (&easel.stage.camera, &easel.stage.medium);
    let [width, height] = easel.size;
    let depths = easel.stage.pictures.depth.read(gpu)?;
    let visibility = scattered.read(gpu)?;
    let color = |index: usize| {
        let (x, y) = (index as u32 % width, index as u32 / width);
        let across = 2.0 * (x as f32 + 0.5) / width as f32 - 1.0;
        let down = 1.0 - 2.0 * (y as f32 + 0.5) / height as f32;
        let place = camera.world_from_clip * Vec4::new(across, down, depths[index], 1.0);
        let length = (place.truncate() / place.w).distance(camera.eye) / medium.distance_limit;
        let color = Vec3::new(1.0, 0.50, 0.10) * visibility[4 * index + 3].clamp(0.0, 1.0)
            + Vec3::new(0.0, 0.30, 0.85) * length.clamp(0.0, 1.0);
        let byte = |value: f32| (value.clamp(0.0, 1.0) * 255.0).round() as u8;
        [byte(color.x), byte(color.y), byte(color.z), 255]
    };
    Ok((0..(width * height) as usize).flat_map(color).collect())
}

fn srgb(value: f32) -> u8 {
    let value = value.clamp(0.0, 1.0);
    let encoded = if value <= 0.003_130_8 { 12.92 * value } else { 1.055 * value.powf(1.0 / 2.4) - 0.055 };
    (encoded * 255.0).round() as u8
}
