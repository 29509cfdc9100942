// SPDX-License-Identifier: MIT OR Apache-2.0
//! What is impossible with transmittance maps.

use super::{Form, Precision};
use crate::core::VolumeTextureError;
use crate::gpu::GpuError;
use crate::pass::PassError;

/// Why a map cannot be built or asked.
#[derive(Debug, thiserror::Error)]
pub enum TransmittanceError {
    /// A number of coefficients that is not offered.
    #[error("{form:?} maps of {given} coefficients are not offered: take {offered}")]
    Coefficients {
        /// The form.
        form: Form,
        /// What was asked for.
        given: u32,
        /// What there is.
        offered: &'static str,
    },
    /// Moments in half floats.
    #[error(
        "{0:?} maps need 32 bits: half floats lose the matrix of the moments, so take `Precision::Single`"
    )]
    HalfMoments(Form),
    /// A size.
    #[error("{what} of {size:?} is impossible: every side must lie between 1 and {limit} on this device")]
    Size {
        /// What has the size.
        what: &'static str,
        /// Its sides.
        size: Vec<u32>,
        /// The device's limit.
        limit: u32,
    },
    /// A light that has no range.
    #[error(
        "the light's map reaches {0} m along the light: a directional light is needed, and a range that is positive and finite"
    )]
    Range(f32),
    /// Particles in a map whose sides lean.
    #[error(
        "particles want a map whose near and far side lie across the light: fit it by `Light::directional_around_balls`"
    )]
    Leaning,
    /// A map of another kind.
    #[error("a {given:?} map was bound to passes for {expected:?}: build them with the same settings")]
    OtherMap {
        /// The map's settings.
        given: Box<super::MapSettings>,
        /// The passes' settings.
        expected: Box<super::MapSettings>,
    },
    /// Particles cannot be added up.
    #[error("{0:?} maps cannot be splatted, {1}")]
    Splat(Form, &'static str),
    /// Blending wants another precision.
    #[error("{0:?} layers cannot be blended on every device: take `Precision::Half`, or `SplatFixed`")]
    Blend(Precision),
    /// Too large for one binding.
    #[error(
        "fixed-point sums of {bytes} bytes exceed the {limit} of a storage buffer: take a smaller map or fewer coefficients"
    )]
    Sums {
        /// Bytes that are needed.
        bytes: u64,
        /// The device's limit.
        limit: u64,
    },
    /// How a medium scatters.
    #[error("{name} of {value} is impossible: it must be {range}")]
    Lighting {
        /// Which number.
        name: &'static str,
        /// What was given.
        value: f32,
        /// What is possible.
        range: &'static str,
    },
    /// A map was given to the reference, or a light alone to a pass for maps.
    #[error("the reference {0}")]
    Reference(&'static str),
    /// A volume cannot be uploaded or read so.
    #[error(transparent)]
    Volume(#[from] VolumeTextureError),
    /// A pass failed.
    #[error(transparent)]
    Pass(#[from] PassError),
}

impl From<GpuError> for TransmittanceError {
    fn from(error: GpuError) -> Self {
        Self::Pass(error.into())
    }
}
