// SPDX-License-Identifier: MIT OR Apache-2.0
//! Brush textures: three that are computed, or those of the caller.

use super::StrokeError;
use crate::data::{Random, linear_from_srgb};
use crate::gpu::Gpu;
use crate::resource::{Sampler, Texture};

/// Width and height of a brush in the texture; other images are resampled to it.
pub const BRUSH_SIZE: [u32; 2] = [128, 32];

/// The image of a brush: a stroke from left to right.
#[derive(Debug, Clone, PartialEq)]
pub struct BrushImage {
    size: [u32; 2],
    /// Linear, premultiplied.
    texels: Vec<[f32; 4]>,
}

impl BrushImage {
    /// From linear premultiplied texels, row by row from the top, 0..1: RGB that tints multiply, and opacity.
    ///
    /// # Errors
    /// [`StrokeError::Brush`].
    pub fn new(size: [u32; 2], texels: Vec<[f32; 4]>) -> Result<Self, StrokeError> {
        let [width, height] = size;
        let wrong = |reason| StrokeError::Brush { width, height, values: 4 * texels.len(), reason };
        if width == 0 || height == 0 || u64::from(width) * u64::from(height) != texels.len() as u64 {
            return Err(wrong("four numbers a pixel are needed, and at least one pixel"));
        }
        if texels.iter().flatten().any(|value| !(0.0..=1.0).contains(value)) {
            return Err(wrong("every number must lie between 0 and 1"));
        }
        if texels.iter().all(|texel| texel[3] == 0.0) {
            return Err(wrong("it is nowhere opaque"));
        }
        Ok(Self { size, texels })
    }

    /// From sRGB-encoded bytes with straight alpha, four a pixel, as a PNG has them.
    ///
    /// # Errors
    /// [`StrokeError::Brush`].
    pub fn from_srgb(size: [u32; 2], bytes: &[u8]) -> Result<Self, StrokeError> {
        let texel = |b: &[u8]| {
            let alpha = f32::from(b[3]) / 255.0;
            let linear = |byte: u8| linear_from_srgb(f32::from(byte) / 255.0) * alpha;
            [linear(b[0]), linear(b[1]), linear(b[2]), alpha]
        };
        Self::new(size, bytes.chunks_exact(4).map(texel).collect())
    }

    /// The mean over the box of an output texel; where that is smaller than a texel, the value at its middle, interpolated.
    fn resampled(&self, [width, height]: [u32; 2]) -> Vec<[f32; 4]> {
        let [from_width, from_height] = self.size;
        let weights = |index: u32, count: u32, of: u32| -> Vec<(u32, f32)> {
            let scale = of as f32 / count as f32;
            let (middle, half) = ((index as f32 + 0.5) * scale - 0.5, scale.max(1.0));
            let (first, last) = ((middle - half).ceil() as i64, (middle + half).floor() as i64);
            let tap = |at: i64| {
                (at.clamp(0, i64::from(of) - 1) as u32, (1.0 - (at as f32 - middle).abs() / half).max(0.0))
            };
            let taps: Vec<_> = (first..=last).map(tap).collect();
            let sum: f32 = taps.iter().map(|tap| tap.1).sum();
            taps.into_iter().map(|(at, weight)| (at, weight / sum)).collect()
        };
        let columns: Vec<_> = (0..width).map(|x| weights(x, width, from_width)).collect();
        let mut result = Vec::with_capacity((width * height) as usize);
        for y in 0..height {
            let rows = weights(y, height, from_height);
            for taps in &columns {
                let mut sum = [0.0_f32; 4];
                for (row, by_row) in &rows {
                    for (column, by_column) in taps {
                        let texel = self.texels[(row * from_width + column) as usize];
                        for (sum, value) in sum.iter_mut().zip(texel) {
                            *sum += by_row * by_column * value;
                        }
                    }
                }
                result.push(sum.map(|value| value.clamp(0.0, 1.0)));
            }
        }
        result
    }
}

/// Brushes on the GPU.
pub struct Brushes {
    /// An array of brushes with mipmaps, rgba8unorm, premultiplied.
    pub texture: Texture,
    /// Linear, with mipmaps.
    pub sampler: Sampler,
    mean_opacities: Vec<f32>,
}

impl Brushes {
    /// Uploads brushes.
    ///
    /// # Errors
    /// [`StrokeError::NoBrush`].
    pub fn new(gpu: &Gpu, images: &[BrushImage]) -> Result<Self, StrokeError> {
        if images.is_empty() {
            return Err(StrokeError::NoBrush);
        }
        let [width, height] = BRUSH_SIZE;
        let levels = width.max(height).ilog2() + 1;
        let raw = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("brushes"),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: images.len() as u32 },
            mip_level_count: levels,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8Unorm,
            usage: wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::COPY_DST
                | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let mut mean_opacities = Vec::new();
        for (layer, image) in images.iter().enumerate() {
            let mut size = BRUSH_SIZE;
            let mut texels = image.resampled(size);
            mean_opacities.push(texels.iter().map(|texel| texel[3]).sum::<f32>() / texels.len() as f32);
            for level in 0..levels {
                upload(gpu, &raw, level, layer as u32, size, &texels);
                (size, texels) = halved(size, &texels);
            }
        }
        let dimension = wgpu::TextureViewDimension::D2Array;
        Ok(Self {
            texture: Texture::whole(raw, dimension),
            sampler: Sampler::linear_levels(gpu),
            mean_opacities,
        })
    }

    /// The three computed brushes: bristles, a dab, dry bristles.
    ///
    /// # Errors
    /// As [`Brushes::new`].
    pub fn procedural(gpu: &Gpu) -> Result<Self, StrokeError> {
        Self::new(gpu, &procedural_brushes(7))
    }

    /// How many there are.
    pub fn count(&self) -> u32 {
        self.mean_opacities.len() as u32
    }

    /// Mean opacity over the quad of a brush; of all of them where none is given.
    pub fn mean_opacity(&self, brush: Option<u32>) -> f32 {
        let all = || self.mean_opacities.iter().sum::<f32>() / self.mean_opacities.len() as f32;
        brush.and_then(|brush| self.mean_opacities.get(brush as usize).copied()).unwrap_or_else(all)
    }
}

fn upload(
    gpu: &Gpu,
    raw: &wgpu::Texture,
    level: u32,
    layer: u32,
    [width, height]: [u32; 2],
    texels: &[[f32; 4]],
) {
    let bytes: Vec<u8> = texels.iter().flatten().map(|value| (value * 255.0).round() as u8).collect();
    gpu.queue.write_texture(
        wgpu::TexelCopyTextureInfo {
            texture: raw,
            mip_level: level,
            origin: wgpu::Origin3d { x: 0, y: 0, z: layer },
            aspect: wgpu::TextureAspect::All,
        },
        &bytes,
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(4 * width),
            rows_per_image: Some(height),
        },
        wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
    );
}

/// The next mipmap: means of two by two texels, of sides that are powers of two.
fn halved([width, height]: [u32; 2], texels: &[[f32; 4]]) -> ([u32; 2], Vec<[f32; 4]>) {
    let size = [(width / 2).max(1), (height / 2).max(1)];
    let at = |x: u32, y: u32| texels[(y.min(height - 1) * width + x.min(width - 1)) as usize];
    let mut result = Vec::with_capacity((size[0] * size[1]) as usize);
    for y in 0..size[1] {
        for x in 0..size[0] {
            let four =
                [at(2 * x, 2 * y), at(2 * x + 1, 2 * y), at(2 * x, 2 * y + 1), at(2 * x + 1, 2 * y + 1)];
            result.push(std::array::from_fn(|channel| 0.25 * four.iter().map(|t| t[channel]).sum::<f32>()));
        }
    }
    (size, result)
}

/// Three brushes: a loaded brush whose bristles leave streaks, a round dab, and a dry brush that breaks up towards its end.
/// Each lighter and darker by its streaks, with ends that fade.
pub fn procedural_brushes(seed: u64) -> Vec<BrushImage> {
    let size = [2 * BRUSH_SIZE[0], 2 * BRUSH_SIZE[1]];
    let streaks = Noise::new(seed, 4, 22);
    let hairs = Noise::new(seed + 1, 3, 52);
    let ends = Noise::new(seed + 2, 2, 18);
    let breaks = Noise::new(seed + 3, 26, 40);
    let grain = Noise::new(seed + 4, 60, 40);
    let brush = |texel: &dyn Fn(f32, f32) -> (f32, f32)| {
        let [width, height] = size;
        let texels = (0..width * height).map(|index| {
            let u = (index % width) as f32 / width as f32 + 0.5 / width as f32;
            let v = (index / width) as f32 / height as f32 + 0.5 / height as f32;
            let (opacity, tone) = texel(u, v);
            // The outermost texels are clear, so that quads have no edges.
            let rim = smooth(0.0, 0.03, u.min(1.0 - u)) * smooth(0.0, 0.08, v.min(1.0 - v));
            let alpha = (opacity * rim).clamp(0.0, 1.0);
            let grey = tone.clamp(0.0, 1.0) * alpha;
            [grey, grey, grey, alpha]
        });
        BrushImage { size, texels: texels.collect() }
    };
    let across = |v: f32| 2.0 * (v - 0.5).abs();
    let bristles = |u: f32, v: f32| {
        let streak = 0.6 * streaks.at(u, v) + 0.4 * hairs.at(u, v);
        let begin = 0.02 + 0.10 * ends.at(0.0, v) + 0.08 * across(v).powi(2);
        let end = 0.98 - 0.22 * ends.at(1.0, v) - 0.12 * across(v).powi(2);
        let along = smooth(begin, begin + 0.06, u) * (1.0 - smooth(end - 0.22, end, u));
        let side = 1.0 - smooth(0.72, 0.98, across(v) + 0.2 * (streaks.at(u, v) - 0.5));
        // Paint thins out along the way, first between the bristles.
        let loaded = smooth(0.05 + 0.35 * u * u, 0.35 + 0.4 * u * u, streak + 0.35);
        (0.96 * along * side * loaded, 0.72 + 0.28 * smooth(0.2, 0.8, streak))
    };
    let dab = |u: f32, v: f32| {
        let streak = 0.5 * streaks.at(u, v) + 0.3 * hairs.at(u, v) + 0.2 * grain.at(u, v);
        let radius = ((2.0 * u - 1.0).abs().powf(2.6) + across(v).powf(2.2)).powf(0.42);
        let edge = 0.86 + 0.14 * (grain.at(u, v) - 0.5) + 0.2 * (streaks.at(u, v) - 0.5);
        (0.97 * (1.0 - smooth(edge - 0.16, edge, radius)), 0.78 + 0.22 * smooth(0.25, 0.75, streak))
    };
    let dry = |u: f32, v: f32| {
        let streak = 0.35 * streaks.at(u, v) + 0.65 * hairs.at(u, v);
        let begin = 0.01 + 0.14 * ends.at(0.3, v);
        let end = 0.99 - 0.3 * ends.at(0.7, v);
        let along = smooth(begin, begin + 0.04, u) * (1.0 - smooth(end - 0.12, end, u));
        let side = 1.0 - smooth(0.78, 0.98, across(v) + 0.15 * (hairs.at(u, v) - 0.5));
        let paint = streak + 0.45 * (breaks.at(u, v) - 0.5) + 0.3 * (1.0 - u) - 0.12;
        (0.95 * along * side * smooth(0.32, 0.5, paint), 0.7 + 0.3 * smooth(0.3, 0.75, streak))
    };
    vec![brush(&bristles), brush(&dab), brush(&dry)]
}

/// 0 to 1 without corners as `x` goes from `low` to `high`.
fn smooth(low: f32, high: f32, x: f32) -> f32 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Random numbers on a grid over the unit square, interpolated.
struct Noise {
    columns: usize,
    rows: usize,
    values: Vec<f32>,
}

impl Noise {
    fn new(seed: u64, columns: usize, rows: usize) -> Self {
        let mut random = Random::new(seed);
        let values = (0..(columns + 1) * (rows + 1)).map(|_| random.unit()).collect();
        Self { columns, rows, values }
    }

    fn at(&self, u: f32, v: f32) -> f32 {
        let (x, y) = (u.clamp(0.0, 0.9999) * self.columns as f32, v.clamp(0.0, 0.9999) * self.rows as f32);
        let (column, row) = (x as usize, y as usize);
        let value = |dx: usize, dy: usize| self.values[(row + dy) * (self.columns + 1) + column + dx];
        let (s, t) = (smooth(0.0, 1.0, x.fract()), smooth(0.0, 1.0, y.fract()));
        let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
        mix(mix(value(0, 0), value(1, 0), s), mix(value(0, 1), value(1, 1), s), t)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn brushes_are_opaque_within_and_clear_at_their_edges() {
        let brushes = procedural_brushes(7);
        assert_eq!(brushes, procedural_brushes(7));
        for brush in &brushes {
            let [width, height] = brush.size;
            let alpha = |x: u32, y: u32| brush.texels[(y * width + x) as usize][3];
            let edge = (0..width).flat_map(|x| [alpha(x, 0), alpha(x, height - 1)]);
            let ends = (0..height).flat_map(|y| [alpha(0, y), alpha(width - 1, y)]);
            assert!(edge.chain(ends).all(|alpha| alpha < 0.02));
            let mean = brush.texels.iter().map(|t| t[3]).sum::<f32>() / brush.texels.len() as f32;
            assert!((0.3..0.8).contains(&mean), "{mean}");
            let middle = (0..height).map(|y| alpha(width / 3, y)).filter(|alpha| *alpha > 0.8).count();
            assert!(middle as u32 > height / 4, "{middle}");
        }
    }

    #[test]
    fn images_are_resampled_without_change_of_their_mean() {
        let texel = |i: u32| [0.2, 0.1, 0.0, (i % 7) as f32 / 7.0];
        for size in [[128, 32], [256, 64], [300, 77], [13, 5], [1, 1]] {
            let image = BrushImage::new(size, (1..=size[0] * size[1]).map(texel).collect()).unwrap();
            let mean = |texels: &[[f32; 4]]| texels.iter().map(|t| t[3]).sum::<f32>() / texels.len() as f32;
            let resampled = image.resampled(BRUSH_SIZE);
            assert_eq!(resampled.len(), 4096);
            assert!((mean(&resampled) - mean(&image.texels)).abs() < 0.02, "{size:?}");
            assert!(resampled.iter().all(|t| (t[0] - 0.2).abs() < 1e-5 && t[2] == 0.0));
        }
    }

    #[test]
    fn impossible_images_are_refused() {
        assert!(BrushImage::new([2, 2], vec![[0.5; 4]; 3]).is_err());
        assert!(BrushImage::new([0, 2], Vec::new()).is_err());
        assert!(BrushImage::new([1, 1], vec![[f32::NAN; 4]]).is_err());
        assert!(BrushImage::new([1, 1], vec![[0.0; 4]]).is_err());
        let of_bytes = BrushImage::from_srgb([1, 1], &[255, 0, 188, 128]).unwrap();
        assert!((of_bytes.texels[0][0] - 128.0 / 255.0).abs() < 1e-6);
        assert!((of_bytes.texels[0][2] - 0.5029 * 128.0 / 255.0).abs() < 1e-3);
    }
}
