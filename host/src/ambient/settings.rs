// SPDX-License-Identifier: MIT OR Apache-2.0
//! How occlusion is looked for and blurred.

use super::AmbientError;
use crate::out_of_range::in_range;
use encase::ShaderType;
use glam::UVec2;

/// Most directions a pixel.
const MOST_SAMPLES: u32 = 256;
/// Most steps along each.
const MOST_STEPS: u32 = 256;
/// Greatest side of the sampling pattern.
const MOST_SIDE: u32 = 16;

/// The uniform `OcclusionSettings` of `ambient/occluders`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct OcclusionSettings {
    /// Occluders count up to this distance, metres.
    pub radius: f32,
    /// How thick what is seen is taken to be, metres.
    pub thickness: f32,
    /// Sine of the elevation over the tangent plane from which on something occludes.
    pub bias: f32,
    /// Directions a pixel; slices of the hemisphere with horizons and bit masks.
    pub samples: u32,
    /// Steps along each.
    pub steps: u32,
    /// Side of the square of pixels that have different directions.
    pub side: u32,
    /// Frame of a temporal pattern; 0 for a static one.
    pub frame: u32,
    /// Padding.
    pub reserved_a: u32,
}

impl OcclusionSettings {
    /// Eight directions of three steps in 8x8 pixels, as in the thesis. `radius`: metres up to which occluders count.
    pub fn new(radius: f32) -> Self {
        Self { radius, thickness: radius, bias: 0.03, samples: 8, steps: 3, side: 8, frame: 0, reserved_a: 0 }
    }

    /// Whether they are possible.
    ///
    /// # Errors
    /// [`AmbientError::Setting`].
    pub fn check(&self) -> Result<(), AmbientError> {
        let above = f32::MIN_POSITIVE..=1e15;
        in_range("radius of occlusion", self.radius, above.clone(), "above 0 and at most 1e15 metres")?;
        in_range("thickness of occluders", self.thickness, above, "above 0 and at most 1e15 metres")?;
        in_range("bias of occlusion", self.bias, 0.0..=1.0, "from 0 to 1")?;
        in_range("number of directions", self.samples as f32, 1.0..=MOST_SAMPLES as f32, "from 1 to 256")?;
        in_range("number of steps", self.steps as f32, 1.0..=MOST_STEPS as f32, "from 1 to 256")?;
        in_range("side of the sampling pattern", self.side as f32, 1.0..=MOST_SIDE as f32, "from 1 to 16")?;
        Ok(())
    }
}

/// The uniform `BentBlur` of `ambient/bent_blur`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct BentBlur {
    /// (1, 0) or (0, 1).
    pub axis: UVec2,
    /// Pixels that are averaged.
    pub taps: u32,
    /// Metres from the tangent plane at which a neighbour counts no more.
    pub reach: f32,
    /// Cosine between normals at which a neighbour counts no more.
    pub least_cosine: f32,
    /// Padding.
    pub reserved_a: f32,
    /// Padding.
    pub reserved_b: f32,
    /// Padding.
    pub reserved_c: f32,
}

impl BentBlur {
    /// Over the sampling pattern along an axis of the picture, 0 or 1.
    pub(crate) fn over(settings: &OcclusionSettings, axis: usize) -> Self {
        Self {
            axis: UVec2::AXES[axis],
            taps: settings.side,
            reach: 0.25 * settings.radius,
            least_cosine: 0.6,
            reserved_a: 0.0,
            reserved_b: 0.0,
            reserved_c: 0.0,
        }
    }
}
