// SPDX-License-Identifier: MIT OR Apache-2.0
//! What sheets are drawn of.

use super::{Splats, Surfaces};
use crate::core::Transfer;
use crate::resource::Texture;

/// What a picture is drawn of, and what stands in front of the light.
#[derive(Clone, Copy)]
pub struct SheetInputs<'a, 't> {
    /// Of all volumes of the scene, which act as one.
    pub splats: &'a [Splats],
    /// Colour and opacity of their values.
    pub transfer: &'t Transfer,
    /// Polygons in, before and behind them.
    pub surfaces: Option<&'a Surfaces>,
    /// What the light passes before the first sheet, linear RGB 0..1 over the whole shadow buffer; any float format that filters. Of light
    /// that is only taken away.
    pub light_texture: Option<&'t Texture>,
}

impl<'a, 't> SheetInputs<'a, 't> {
    /// Volumes alone.
    pub fn new(splats: &'a [Splats], transfer: &'t Transfer) -> Self {
        Self { splats, transfer, surfaces: None, light_texture: None }
    }
}
