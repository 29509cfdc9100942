// SPDX-License-Identifier: MIT OR Apache-2.0
//! How many voxels are solved for, and which.

use super::error::SolveError;
use super::field::{Field, numbers};
use super::options::{SolveOptions, Wanted};
use super::studio::Seen;
use super::volumes::voxels_of;
use crate::command::CommandError;
use crate::inverse::{Basis, Channels, InverseError, Regulariser, Silhouette, Unknown, touched, visual_hull};
use glam::Mat4;

/// A volume that is solved for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Property {
    Emission,
    Albedo,
    Extinction,
}

impl Property {
    /// Those of a stage, in the solver's order.
    pub fn of(wanted: Wanted) -> Vec<Self> {
        match wanted {
            Wanted::Emission => vec![Self::Emission],
            Wanted::Albedo => vec![Self::Albedo],
            Wanted::Both => vec![Self::Emission, Self::Albedo],
            Wanted::Extinction => vec![Self::Extinction],
            Wanted::Light => Vec::new(),
        }
    }

    /// As files are called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Emission => "emission",
            Self::Albedo => "albedo",
            Self::Extinction => "extinction",
        }
    }

    /// Greatest value.
    fn high(self) -> f32 {
        match self {
            Self::Albedo => 1.0,
            Self::Emission | Self::Extinction => 1e30,
        }
    }

    /// Voxels. `volume`: those of the volume.
    pub fn size(self, flags: &SolveOptions, place: Mat4, volume: [u32; 3]) -> [u32; 3] {
        let own = match self {
            Self::Emission => flags.emission_resolution,
            Self::Albedo => flags.albedo_resolution,
            Self::Extinction => None,
        };
        own.or(flags.resolution).map_or(volume, |count| voxels_of(place, count))
    }

    /// Which voxels are solved for.
    ///
    /// # Errors
    /// [`InverseError::Count`].
    pub fn solved(
        self,
        flags: &SolveOptions,
        place: Mat4,
        size: [u32; 3],
        extinction: &Field,
        seen: &[Seen],
    ) -> Result<Vec<bool>, InverseError> {
        let voxels = size.iter().map(|side| *side as usize).product();
        let mut solved = if self == Self::Extinction || flags.keep_empty {
            vec![true; voxels]
        } else {
            let dense: Vec<bool> = extinction.values.iter().map(|value| value.max_element() > 0.0).collect();
            touched(size, Basis::from(flags.basis), extinction.size, &dense)?
        };
        if flags.hull {
            let silhouettes: Vec<Silhouette<'_>> = seen
                .iter()
                .filter_map(|seen| {
                    Some(Silhouette { camera: &seen.loaded.camera, mask: seen.loaded.mask.as_deref()? })
                })
                .collect();
            let hull = visual_hull(size, place, &silhouettes)?;
            solved.iter_mut().zip(hull).for_each(|(solved, inside)| *solved &= inside);
        }
        Ok(solved)
    }

    /// For the solver.
    pub fn unknown(
        self,
        flags: &SolveOptions,
        solved: Vec<bool>,
        start: &Field,
        channels: Channels,
    ) -> Unknown {
        Unknown {
            size: start.size,
            solved,
            start: numbers(&start.values, channels),
            high: self.high(),
            regulariser: Regulariser {
                laplacian: flags.laplacian,
                smallness: flags.smallness,
                oneness: flags.oneness,
            },
        }
    }
}

/// Refuses masks and volumes that leave nothing.
///
/// # Errors
/// [`SolveError::NoVoxels`].
pub fn some(wanted: Wanted, solved: &[Vec<bool>]) -> Result<(), CommandError> {
    if solved.iter().flatten().any(|solved| *solved) {
        return Ok(());
    }
    Err(SolveError::NoVoxels(wanted.name()).into())
}
