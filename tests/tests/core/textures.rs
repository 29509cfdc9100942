// SPDX-License-Identifier: MIT OR Apache-2.0
//! Textures of every format that the host writes and reads.

use crate::gpu::gpu;
use airlight::Texture;

#[test]
fn textures_come_back_as_they_went() {
    use wgpu::TextureFormat as F;
    // Rows whose bytes are no multiple of 256, and layers.
    for (format, channels, scale) in [
        (F::R32Float, 1, 1.0),
        (F::Rgba32Float, 4, 1.0),
        (F::Rgba16Float, 4, 1.0 / 1024.0),
        (F::Rgba8Unorm, 4, 1.0 / 255.0),
        (F::R32Uint, 1, 1.0),
    ] {
        let texture = Texture::array(gpu(), [7, 5, 3], format, wgpu::TextureUsages::TEXTURE_BINDING);
        let values: Vec<f32> = (0..7 * 5 * 3 * channels).map(|i| (i % 256) as f32 * scale).collect();
        texture.write(gpu(), &values).unwrap();
        let back = texture.read(gpu()).unwrap();
        assert!(back.iter().zip(&values).all(|(b, v)| (b - v).abs() < 1e-6), "{format:?}");
        assert_eq!(back.len(), values.len());
        assert!(texture.write(gpu(), &values[1..]).is_err(), "{format:?}");
    }
}
