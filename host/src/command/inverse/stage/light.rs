// SPDX-License-Identifier: MIT OR Apache-2.0
//! A stage that solves for light, of a medium that is known.

use super::{Left, Stages, in_the_dark, only};
use crate::command::CommandError;
use crate::command::inverse::discs::LitDiscs;
use crate::command::inverse::error::SolveError;
use crate::command::inverse::field::{colours, numbers, reduced};
use crate::command::inverse::light::Illumination;
use crate::command::inverse::options::{StrategySpelling, Wanted};
use crate::command::inverse::studio::Look;
use crate::inverse::{LightSolver, LightUnknown, Medium, Solved};
use glam::Vec3;
use std::sync::Arc;

impl Stages<'_> {
    /// Light of discs all around, instead of that which there was.
    pub(super) fn light(&self, look: &Look) -> Result<Left, CommandError> {
        let Self { studio, flags, seen, .. } = *self;
        let (gpu, channels) = (studio.gpu, studio.channels);
        let some = |values: &[Vec3]| values.iter().any(|value| value.max_element() > 0.0);
        if !some(&look.extinction.values) || !some(&look.albedo.values) {
            return Err(SolveError::NoScattering.into());
        }
        let before = look.lights.first().cloned().unwrap_or_else(Illumination::dark);
        let mut begun = LitDiscs::near(&flags.discs, &before);
        begun.radiance.iter_mut().for_each(|radiance| *radiance = reduced(*radiance, channels));
        let known = in_the_dark(look);
        let extinction = studio.medium(&known, 0)?.extinction.clone();
        let volumes = studio.disc_volumes(&begun, &extinction)?;
        let scattered = look.albedo.texture(gpu, channels)?;
        // Light stands where the albedo stands in a solve for it, and the albedo where light does.
        let medium = Arc::new(Medium { extinction, scattered, index: studio.index.clone() });
        let projector = studio.projector(Solved::Albedo, channels)?;
        let targets = self.targets(&projector, &known, |_| Ok(Arc::clone(&medium)))?;
        let unknown = LightUnknown {
            volumes,
            start: numbers(&begun.radiance, channels),
            smallness: flags.smallness,
            strategy: flags.discs.light_strategy.unwrap_or(StrategySpelling::Volumes).into(),
        };
        let mut solver = LightSolver::new(gpu, studio.shaders, projector, targets, unknown)?;
        let descent = self.descend(Wanted::Light, &mut solver)?;
        let with = |solutions: &[Vec<f32>]| {
            let found = solutions.first().map(Vec::as_slice).unwrap_or_default();
            let found = LitDiscs { radiance: colours(found, channels), ..begun.clone() };
            Look { lights: vec![Arc::new(Illumination::Discs(found))], ..look.clone() }
        };
        let (look, residuals) =
            self.choose(Wanted::Light, &descent, look, with, |look| self.squares(look))?;
        let counts = vec![None; seen.len()];
        Ok(Left { look, residuals: only(residuals, channels), volumes: Vec::new(), counts })
    }
}
