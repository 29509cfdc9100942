// SPDX-License-Identifier: MIT OR Apache-2.0
//! Colours ridges and valleys.

use super::{IsoBound, PainterlyError};
use crate::gpu::Gpu;
use crate::out_of_range::in_range;
use crate::pass::{Bound, Pass};
use crate::resource::{Buffer, Sampler, Texture};
use crate::shaders::Shaders;
use airlight_validate::Definitions;
use encase::ShaderType;
use glam::Vec3;

/// The uniform `RidgeParameters` of `painterly/ridges`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct RidgeParameters {
    /// Curvature of the table's last column and row, 1/m.
    pub range: f32,
    /// 0 for no streaks, 1 for colours from none to twice as bright.
    pub streak_strength: f32,
    /// Padding.
    pub reserved_a: f32,
    /// Padding.
    pub reserved_b: f32,
}

impl RidgeParameters {
    /// A table that ends at curvatures of `range`, 1/m, and streaks of a strength, 0 to 1.
    ///
    /// # Errors
    /// [`PainterlyError::Setting`].
    pub fn new(range: f32, streak_strength: f32) -> Result<Self, PainterlyError> {
        let name = "range of curvatures";
        in_range(name, range, f32::MIN_POSITIVE..=65504.0, "above 0, at most 65504 1/m")?;
        in_range("strength of streaks", streak_strength, 0.0..=1.0, "from 0 to 1")?;
        Ok(Self { range, streak_strength, reserved_a: 0.0, reserved_b: 0.0 })
    }
}

/// A table of colours over both principal curvatures, on the GPU.
pub struct CurvatureTable {
    /// Columns for the greater curvature, rows for the lesser; rgba16float.
    pub texture: Texture,
}

impl CurvatureTable {
    /// Uploads a square table of linear RGB and how much of it, 0 to 1, row by row: the first column and row are for the
    /// curvature -range, the last for range.
    ///
    /// # Errors
    /// [`PainterlyError::Table`], [`PainterlyError::Entry`].
    pub fn new(gpu: &Gpu, side: usize, table: &[[f32; 4]]) -> Result<Self, PainterlyError> {
        let limit = gpu.limits.max_texture_dimension_2d;
        if side < 2 || side > limit as usize || table.len() != side * side {
            return Err(PainterlyError::Table { given: table.len(), side, limit });
        }
        let fits = |[r, g, b, share]: &[f32; 4]| {
            [r, g, b].iter().all(|c| (0.0..=65504.0).contains(*c)) && (0.0..=1.0).contains(share)
        };
        if let Some(entry) = table.iter().position(|value| !fits(value)) {
            return Err(PainterlyError::Entry { entry, value: table[entry] });
        }
        let usage = wgpu::TextureUsages::TEXTURE_BINDING;
        let texture = Texture::new(gpu, [side as u32; 2], wgpu::TextureFormat::Rgba16Float, usage);
        texture.write(gpu, table.as_flattened())?;
        Ok(Self { texture })
    }

    /// A table of one colour for ridges, which are convex across, and one for valleys, which are concave across; surfaces that
    /// bend alike in both directions, or not at all, stay as they are.
    ///
    /// # Errors
    /// As [`CurvatureTable::new`].
    pub fn of_ridges_and_valleys(gpu: &Gpu, ridge: Vec3, valley: Vec3) -> Result<Self, PainterlyError> {
        const SIDE: usize = 65;
        let curvature = |i: usize| 2.0 * i as f32 / (SIDE - 1) as f32 - 1.0;
        let entry = |i: usize| {
            let (one, two) = (curvature(i % SIDE), curvature(i / SIDE));
            // How much more it bends outwards than inwards and along, and the other way round.
            let [out, inwards] = [one - two.abs(), -two - one.abs()].map(|share| share.clamp(0.0, 1.0));
            let color = if out >= inwards { ridge } else { valley };
            [color.x, color.y, color.z, out.max(inwards)]
        };
        Self::new(gpu, SIDE, &(0..SIDE * SIDE).map(entry).collect::<Vec<_>>())
    }
}

/// Colours a surface by its curvatures.
pub struct Ridges {
    plain: Pass,
    streaked: Pass,
    sampler: Sampler,
}

/// Colours before and after, bound.
pub struct RidgesBound {
    bound: Bound,
    parameters: Buffer,
    streaked: bool,
    /// Linear RGB, and 1 where the surface is seen, else 0; rgba16float.
    pub tinted: Texture,
}

impl Ridges {
    /// Builds both passes, with streaks and without.
    ///
    /// # Errors
    /// [`PainterlyError::Pass`].
    pub fn new(gpu: &Gpu, shaders: &Shaders) -> Result<Self, PainterlyError> {
        let pass = |definitions| Pass::compute_with(gpu, shaders, "painterly/ridges", &definitions);
        Ok(Self {
            plain: pass(Definitions::new())?,
            streaked: pass(Definitions::new().flag("STREAKS"))?,
            sampler: Sampler::linear(gpu),
        })
    }

    /// Binds what rays have written, a table, and streaks of [`super::Advect`] if there are any.
    ///
    /// # Errors
    /// [`PainterlyError::NoCurvature`], [`PainterlyError::Pass`].
    pub fn bind(
        &self,
        gpu: &Gpu,
        rays: &IsoBound,
        table: &CurvatureTable,
        streaks: Option<&Texture>,
        parameters: &RidgeParameters,
    ) -> Result<RidgesBound, PainterlyError> {
        let targets = &rays.targets;
        let curvature = targets.curvature.as_ref().ok_or(PainterlyError::NoCurvature)?;
        let [width, height, _] = targets.color.size();
        let tinted = Texture::storage(gpu, [width, height], wgpu::TextureFormat::Rgba16Float);
        let parameters = Buffer::uniform(gpu, parameters);
        let mut resources = vec![
            ("parameters", (&parameters).into()),
            ("color", (&targets.color).into()),
            ("curvature", curvature.into()),
            ("table", (&table.texture).into()),
            ("linear_sampler", (&self.sampler).into()),
            ("tinted", (&tinted).into()),
        ];
        resources.extend(streaks.map(|texture| ("streaks", texture.into())));
        let pass = if streaks.is_some() { &self.streaked } else { &self.plain };
        let bound = pass.bind(gpu, &resources)?;
        Ok(RidgesBound { bound, parameters, streaked: streaks.is_some(), tinted })
    }

    /// Changes range and strength from the next recorded frame on.
    pub fn set(&self, gpu: &Gpu, bound: &RidgesBound, parameters: &RidgeParameters) {
        bound.parameters.write(gpu, parameters);
    }

    /// Records the colours of all pixels.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, bound: &RidgesBound) {
        let [width, height, _] = bound.tinted.size();
        let pass = if bound.streaked { &self.streaked } else { &self.plain };
        pass.dispatch(encoder, &bound.bound, [width, height, 1]);
    }
}
