// SPDX-License-Identifier: MIT OR Apache-2.0
//! Which map is built, and how large.

use super::TransmittanceError;
use crate::gpu::Gpu;
use airlight_validate::Definitions;

/// What a map stores.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Form {
    /// Extinction as a cosine series over the range: an extinction transmittance map.
    Extinction,
    /// The same over the occupied interval of each texel.
    Bounded,
    /// Extinction as a Fourier series with the range as period: a Fourier opacity map.
    Opacity,
    /// Transmittance as a cosine series: a transmittance function map. From volumes only.
    Function,
    /// Transmittance as a Fourier series with the range as period. From volumes only.
    FunctionPeriodic,
    /// Total and six power moments of optical depth; 8 coefficients, 7 of them used.
    PowerMoments,
    /// Total and two complex trigonometric moments; 8 coefficients, 5 of them used.
    TrigonometricMoments,
}

impl Form {
    /// All forms.
    pub const ALL: [Self; 7] = [
        Self::Extinction,
        Self::Bounded,
        Self::Opacity,
        Self::Function,
        Self::FunctionPeriodic,
        Self::PowerMoments,
        Self::TrigonometricMoments,
    ];

    /// True for moments of optical depth.
    pub fn moments(self) -> bool {
        matches!(self, Self::PowerMoments | Self::TrigonometricMoments)
    }

    fn flags(self) -> &'static [&'static str] {
        match self {
            Self::Extinction => &[],
            Self::Bounded => &["BOUNDED"],
            Self::Opacity => &["PERIODIC"],
            Self::Function => &["FUNCTION"],
            Self::FunctionPeriodic => &["FUNCTION", "PERIODIC"],
            Self::PowerMoments => &["POWER"],
            Self::TrigonometricMoments => &["TRIGONOMETRIC"],
        }
    }
}

/// Bits of a coefficient.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Precision {
    /// rgba32float.
    Single,
    /// rgba16float.
    Half,
}

/// What map is built.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MapSettings {
    /// What it stores.
    pub form: Form,
    /// Numbers a texel: 4, 8 or 16; 8 for moments.
    pub coefficients: u32,
    /// Columns and rows.
    pub size: [u32; 2],
    /// Bits of a coefficient.
    pub precision: Precision,
}

impl MapSettings {
    /// Settings in 32 bits.
    pub fn new(form: Form, coefficients: u32, size: [u32; 2]) -> Self {
        Self { form, coefficients, size, precision: Precision::Single }
    }

    /// Checks them.
    ///
    /// # Errors
    /// [`TransmittanceError`].
    pub fn check(&self, gpu: &Gpu) -> Result<(), TransmittanceError> {
        let (offered, list): (&[u32], _) =
            if self.form.moments() { (&[8], "8") } else { (&[4, 8, 16], "4, 8 or 16") };
        if !offered.contains(&self.coefficients) {
            let (form, given) = (self.form, self.coefficients);
            return Err(TransmittanceError::Coefficients { form, given, offered: list });
        }
        if self.form.moments() && self.precision == Precision::Half {
            return Err(TransmittanceError::HalfMoments(self.form));
        }
        let limit = gpu.limits.max_texture_dimension_2d;
        if self.size.iter().any(|side| *side == 0 || *side > limit) {
            let size = self.size.to_vec();
            return Err(TransmittanceError::Size { what: "a transmittance map", size, limit });
        }
        Ok(())
    }

    /// Layers of four coefficients.
    pub fn layers(&self) -> u32 {
        self.coefficients / 4
    }

    /// Format of the layers.
    pub fn format(&self) -> wgpu::TextureFormat {
        match self.precision {
            Precision::Single => wgpu::TextureFormat::Rgba32Float,
            Precision::Half => wgpu::TextureFormat::Rgba16Float,
        }
    }

    /// Definitions of the form, which all its passes share.
    pub(super) fn form_definitions(&self) -> Definitions {
        let mut definitions = Definitions::new().set("COEFFICIENTS", self.coefficients as i32);
        for flag in self.form.flags() {
            definitions = definitions.flag(*flag);
        }
        definitions
    }

    /// Definitions of the passes that read such a map; an engine's own pass over `transmittance/transmittance_map` wants
    /// the same.
    pub fn reading_definitions(&self) -> Definitions {
        let definitions = self.form_definitions();
        let filters = self.precision == Precision::Half && self.form != Form::Bounded;
        if filters { definitions.flag("FILTERED") } else { definitions }
    }

    /// The same with the Fejér window, where the form has one.
    pub(super) fn lighting_definitions(&self, monotone: bool) -> Definitions {
        let definitions = self.reading_definitions();
        let windowed = monotone && matches!(self.form, Form::Extinction | Form::Bounded);
        if windowed { definitions.flag("MONOTONE") } else { definitions }
    }

    /// Definitions of the passes that build it.
    pub(super) fn building_definitions(&self) -> Definitions {
        let definitions = self.form_definitions();
        match self.precision {
            Precision::Single => definitions,
            Precision::Half => definitions.flag("RGBA16FLOAT"),
        }
    }
}
