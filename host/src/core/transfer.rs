// SPDX-License-Identifier: MIT OR Apache-2.0
//! Transfer functions of volumes: what colour and opacity a value has.

use crate::gpu::{Gpu, GpuError};
use crate::resource::Texture;
use glam::Vec3;
use half::f16;

/// Why a transfer function is none.
#[derive(Debug, thiserror::Error)]
pub enum TransferError {
    /// A table of the wrong length.
    #[error(
        "a transfer function of {given} entries is impossible: give from 2 to {limit}, the width of a texture"
    )]
    Entries {
        /// How many there are.
        given: usize,
        /// The device's limit.
        limit: u32,
    },
    /// A colour or opacity.
    #[error(
        "entry {entry} of a transfer function is {value:?}: colours must be from 0 to 65504, opacities from 0 to 1"
    )]
    Entry {
        /// Its number.
        entry: usize,
        /// Linear RGB and opacity.
        value: [f32; 4],
    },
    /// Points that are none or not in order.
    #[error("points of a transfer function must rise in value, from 0 to 1, and be at least one")]
    Points,
    /// The device refused it.
    #[error(transparent)]
    Gpu(#[from] GpuError),
}

/// Colour and opacity of one value; between two points both go straight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TransferPoint {
    /// 0..1 of the volume's range.
    pub value: f32,
    /// Linear RGB.
    pub color: Vec3,
    /// 0..1.
    pub opacity: f32,
}

/// A transfer function on the GPU: a row of colours and opacities, the first for value 0 and the last for value 1.
pub struct Transfer {
    /// One row, rgba16float.
    pub texture: Texture,
    opacities: Vec<f32>,
}

impl Transfer {
    /// Uploads a table of linear RGB and opacity, evenly spread over values from 0 to 1, straight in between.
    ///
    /// # Errors
    /// [`TransferError::Entries`], [`TransferError::Entry`].
    pub fn new(gpu: &Gpu, table: &[[f32; 4]]) -> Result<Self, TransferError> {
        let limit = gpu.limits.max_texture_dimension_2d;
        if table.len() < 2 || table.len() > limit as usize {
            return Err(TransferError::Entries { given: table.len(), limit });
        }
        let fits = |[r, g, b, opacity]: &[f32; 4]| {
            [r, g, b].iter().all(|c| (0.0..=65504.0).contains(*c)) && (0.0..=1.0).contains(opacity)
        };
        if let Some(entry) = table.iter().position(|value| !fits(value)) {
            return Err(TransferError::Entry { entry, value: table[entry] });
        }
        let usage = wgpu::TextureUsages::TEXTURE_BINDING;
        let texture = Texture::new(gpu, [table.len() as u32, 1], wgpu::TextureFormat::Rgba16Float, usage);
        texture.write(gpu, table.as_flattened())?;
        let opacities = table.iter().map(|value| f16::from_f32(value[3]).to_f32()).collect();
        Ok(Self { texture, opacities })
    }

    /// Uploads a table of `entries` made from points; before the first and behind the last all is as there.
    ///
    /// # Errors
    /// [`TransferError::Points`] where they do not rise, and as [`Transfer::new`].
    pub fn of_points(gpu: &Gpu, points: &[TransferPoint], entries: usize) -> Result<Self, TransferError> {
        let rising = points.windows(2).all(|pair| pair[0].value < pair[1].value);
        if !rising || points.is_empty() || points.iter().any(|point| !(0.0..=1.0).contains(&point.value)) {
            return Err(TransferError::Points);
        }
        let last = entries.max(2) - 1;
        let table: Vec<_> = (0..entries).map(|i| entry(points, i as f32 / last as f32)).collect();
        Self::new(gpu, &table)
    }

    /// Whether any value is solid at an iso-value; if none is, the picture stays empty.
    pub fn is_solid_anywhere(&self, iso_value: f32) -> bool {
        self.opacities.iter().any(|opacity| *opacity >= iso_value)
    }
}

/// Linear RGB and opacity of a value 0..1. `points`: at least one.
pub(crate) fn entry(points: &[TransferPoint], value: f32) -> [f32; 4] {
    let next = points.partition_point(|point| point.value <= value);
    let (from, to) = (points[next.max(1) - 1], points[next.min(points.len() - 1)]);
    let span = to.value - from.value;
    let share = if span > 0.0 { ((value - from.value) / span).clamp(0.0, 1.0) } else { 0.0 };
    let [r, g, b] = from.color.lerp(to.color, share).to_array();
    [r, g, b, from.opacity + (to.opacity - from.opacity) * share]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_go_straight_from_point_to_point() {
        let point = |value, opacity| TransferPoint { value, color: Vec3::splat(opacity), opacity };
        let points = [point(0.2, 0.5), point(0.6, 1.0), point(0.8, 0.0)];
        for (value, opacity) in [(0.0, 0.5), (0.2, 0.5), (0.4, 0.75), (0.6, 1.0), (0.7, 0.5), (0.9, 0.0)] {
            for channel in entry(&points, value) {
                assert!((channel - opacity).abs() < 1e-6, "{value}: {channel}");
            }
        }
    }
}
