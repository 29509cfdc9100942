// SPDX-License-Identifier: MIT OR Apache-2.0
//! What sheets are drawn of.

use super::Splats;
use crate::core::Transfer;
use crate::resource::Texture;

/// What a picture is drawn of, and what stands in front of the light.
#[derive(Clone, Copy)]
pub struct SheetInputs<'a> {
    /// Of all volumes of the scene, which act as one.
    pub splats: &'a [Splats],
    /// Colour and opacity of their values.
    pub transfer: &'a Transfer,
    /// What the light passes before the first sheet, linear RGB 0..1 over the whole shadow buffer; any float format that filters.
    pub light_texture: Option<&'a Texture>,
}
