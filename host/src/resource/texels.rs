// SPDX-License-Identifier: MIT OR Apache-2.0
//! Texels as bytes and as numbers.

use crate::gpu::GpuError;
use half::f16;

/// The bytes of values in a format; floats are rounded to it.
pub(super) fn encode(format: wgpu::TextureFormat, values: &[f32]) -> Result<Vec<u8>, GpuError> {
    use wgpu::TextureFormat as F;
    let unorm = |value: &f32| (value.clamp(0.0, 1.0) * 255.0).round() as u8;
    Ok(match format {
        F::R32Float | F::Rg32Float | F::Rgba32Float => values.iter().flat_map(|v| v.to_le_bytes()).collect(),
        F::R16Float | F::Rg16Float | F::Rgba16Float => {
            values.iter().flat_map(|v| f16::from_f32(*v).to_le_bytes()).collect()
        }
        F::R8Unorm | F::Rg8Unorm | F::Rgba8Unorm => values.iter().map(unorm).collect(),
        F::R32Uint => values.iter().flat_map(|v| (*v as u32).to_le_bytes()).collect(),
        other => return Err(GpuError::Refused(format!("values cannot be written to {other:?}"))),
    })
}

/// Appends the values that bytes hold in a format.
pub(super) fn decode(
    format: wgpu::TextureFormat,
    bytes: &[u8],
    values: &mut Vec<f32>,
) -> Result<(), GpuError> {
    use wgpu::TextureFormat as F;
    match format {
        F::R32Float | F::Rg32Float | F::Rgba32Float | F::Depth32Float => {
            values.extend(bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])));
        }
        F::R16Float | F::Rg16Float | F::Rgba16Float => {
            values.extend(bytes.chunks_exact(2).map(|b| f16::from_le_bytes([b[0], b[1]]).to_f32()));
        }
        F::R8Unorm | F::Rg8Unorm | F::Rgba8Unorm => {
            values.extend(bytes.iter().map(|b| f32::from(*b) / 255.0))
        }
        F::R32Uint => {
            values.extend(bytes.chunks_exact(4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as f32));
        }
        other => return Err(GpuError::Reading(format!("{other:?} cannot be read"))),
    }
    Ok(())
}
