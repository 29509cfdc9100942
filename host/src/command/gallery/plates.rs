// SPDX-License-Identifier: MIT OR Apache-2.0
//! Intermediate buffers as pictures.

use crate::command::CommandError;
use crate::{Gpu, Texture};

/// A grey picture.
pub struct Grey {
    /// Pixels a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// One byte a pixel.
    pub pixels: Vec<u8>,
}

/// |a - b| times `factor`, as radiance; `b` as it is read back.
pub fn difference(gpu: &Gpu, a: &Texture, b: &[f32], factor: f32) -> Result<Texture, CommandError> {
    let [width, height, _] = a.size();
    let values: Vec<f32> =
        a.read(gpu)?.iter().zip(b).map(|(a, b)| ((a - b).abs() * factor).min(6e4)).collect();
    let texture = Texture::storage(gpu, [width, height], a.raw.format());
    texture.write(gpu, &values)?;
    Ok(texture)
}

/// Maps of depths, stretched over the range that occurs; texels without a blocker are white. Layers are side by
/// side, three to a row.
pub fn depth(gpu: &Gpu, map: &Texture) -> Result<Grey, CommandError> {
    let [width, height, layers] = map.size();
    let (values, [width, height]) = side_by_side(&map.read(gpu)?, [width, height, layers]);
    let blockers = || values.iter().copied().filter(|value| *value < 1.0);
    let least = blockers().fold(1.0, f32::min);
    let greatest = blockers().fold(0.0, f32::max).max(least + 1e-6);
    let grey =
        |value: f32| if value >= 1.0 { 255 } else { (235.0 * (value - least) / (greatest - least)) as u8 };
    Ok(halved(width, height, values.into_iter().map(grey).collect()))
}

/// The values of a texture of one channel with its layers side by side, three to a row; empty places are 1.
fn side_by_side(values: &[f32], [width, height, layers]: [u32; 3]) -> (Vec<f32>, [u32; 2]) {
    let columns = layers.min(3);
    let size = [width * columns, height * layers.div_ceil(columns)];
    let mut placed = vec![1.0; size[0] as usize * size[1] as usize];
    for (line, row) in values.chunks(width as usize).enumerate() {
        let (layer, y) = (line as u32 / height, line as u32 % height);
        let start = (layer / columns * height + y) * size[0] + layer % columns * width;
        placed[start as usize..][..row.len()].copy_from_slice(row);
    }
    (placed, size)
}

/// Filtered bases, the first of each of eight layers, in two rows of four.
pub fn bases(gpu: &Gpu, texture: &Texture) -> Result<Grey, CommandError> {
    let [width, height, layers] = texture.size().map(|side| side as usize);
    let values = texture.read(gpu)?;
    let (columns, rows) = (4, 2);
    let mut pixels = vec![0; width * columns * height * rows];
    for tile in 0..layers.min(columns * rows) {
        let corner = (tile / columns * height) * width * columns + tile % columns * width;
        for y in 0..height {
            for x in 0..width {
                let value = values[((tile * height + y) * width + x) * 4];
                pixels[corner + y * width * columns + x] = (value * 255.0).round() as u8;
            }
        }
    }
    let once = halved((width * columns) as u32, (height * rows) as u32, pixels);
    Ok(halved(once.width, once.height, once.pixels))
}

/// Cells of a rank structure weighted by transmittance: which share of the texels left of its block lies before its chunk.
pub fn cells(gpu: &Gpu, texture: &Texture) -> Result<Grey, CommandError> {
    let [width, height, _] = texture.size();
    // Chunks by blocks, equally many.
    let blocks = width.isqrt().max(1);
    let words = texture.read_words(gpu)?;
    let share = |(index, cell): (usize, &[u32])| {
        let texels = 32.0 * f64::from(index as u32 % blocks).max(1.0);
        (f64::from(cell[1]) / 65535.0 / texels * 255.0).round() as u8
    };
    let pixels = words.chunks_exact(2).enumerate().map(share).collect();
    Ok(halved(width, height, pixels))
}

/// Half the size, by means of 2x2 pixels, where that leaves anything.
fn halved(width: u32, height: u32, pixels: Vec<u8>) -> Grey {
    if width < 2 || height < 2 {
        return Grey { width, height, pixels };
    }
    let (half_width, half_height) = (width / 2, height / 2);
    let at = |x: u32, y: u32| u32::from(pixels[(y * width + x) as usize]);
    let mut halves = Vec::with_capacity((half_width * half_height) as usize);
    for y in 0..half_height {
        for x in 0..half_width {
            let sum =
                at(2 * x, 2 * y) + at(2 * x + 1, 2 * y) + at(2 * x, 2 * y + 1) + at(2 * x + 1, 2 * y + 1);
            halves.push(((sum + 2) / 4) as u8);
        }
    }
    Grey { width: half_width, height: half_height, pixels: halves }
}
