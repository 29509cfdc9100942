// SPDX-License-Identifier: MIT OR Apache-2.0
//! How the samples of a march are shifted from pixel to pixel: the host's side of `core/jitter`.

use crate::data::{BLUE_NOISE_SIDE, blue_noise};
use crate::gpu::{Gpu, GpuError};
use crate::resource::Texture;

/// How the samples of a march are shifted from pixel to pixel and from frame to frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Jitter {
    /// Not at all: in the middle of each step.
    #[default]
    None,
    /// By interleaved gradient noise: the mean over 3x3 pixels is good.
    Gradient,
    /// By blue noise from a tile: what is left of the noise is of high frequency.
    BlueNoise,
}

impl Jitter {
    /// The definition of a pass that marches; none without jitter.
    pub(crate) fn definition(self) -> Option<&'static str> {
        match self {
            Self::None => None,
            Self::Gradient => Some("JITTER_GRADIENT"),
            Self::BlueNoise => Some("JITTER_BLUE_NOISE"),
        }
    }
}

/// The tile of blue noise as an r32float texture.
///
/// # Errors
/// [`GpuError`].
pub fn blue_noise_texture(gpu: &Gpu) -> Result<Texture, GpuError> {
    let side = BLUE_NOISE_SIDE as u32;
    let usage = wgpu::TextureUsages::TEXTURE_BINDING;
    let texture = Texture::new(gpu, [side, side], wgpu::TextureFormat::R32Float, usage);
    texture.write(gpu, blue_noise())?;
    Ok(texture)
}
