// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pictures of a medium of one radiance as optical depths, whose sum is linear in the extinction: equation 7.13 of the thesis, negated.

use super::InverseError;
use crate::out_of_range::in_range;

/// Least difference of the radiance of the medium and of what is behind it that shows anything.
const LEAST_CONTRAST: f64 = 1e-4;

/// What became of the pixels of a picture that count.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LogCounts {
    /// They have an optical depth.
    pub kept: usize,
    /// Farther from the medium's radiance than what is behind: no extinction makes them so, and 0 comes nearest.
    pub beyond_background: usize,
    /// Beyond the medium's radiance, or nearer to it than the greatest optical depth makes them, which they have.
    pub beyond_medium: usize,
    /// Nothing shows in them, since the medium looks like what is behind; they weigh nothing.
    pub dropped: usize,
}

impl LogCounts {
    /// Those of two pictures.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            kept: self.kept + other.kept,
            beyond_background: self.beyond_background + other.beyond_background,
            beyond_medium: self.beyond_medium + other.beyond_medium,
            dropped: self.dropped + other.dropped,
        }
    }
}

/// Optical depths that are wanted, one a pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct LogTargets {
    /// Optical depths, from 0 to the greatest; 0 where dropped.
    pub depths: Vec<f32>,
    /// The square of what an error of the optical depth is in the picture, times the weight that was given.
    pub weights: Vec<f32>,
    /// What became of the pixels of a weight above 0.
    pub counts: LogCounts,
}

/// What makes optical depths of one channel of a picture: the ratio of picture less medium and background less medium is the
/// transmittance. `medium`: radiance of a medium so thick that nothing shines through; `most`: greatest optical depth, 0.01 to 80;
/// `weights`: how much each pixel counts, 0 or more.
///
/// # Errors
/// [`InverseError::Setting`] for `most`; [`InverseError::Count`] where the pictures differ in size.
pub fn log_targets(
    picture: &[f32],
    background: &[f32],
    weights: &[f32],
    medium: f32,
    most: f32,
) -> Result<LogTargets, InverseError> {
    in_range("greatest optical depth", most, 0.01..=80.0, "from 0.01 to 80")?;
    let needed = picture.len();
    for (name, given) in
        [("pixels of a background", background.len()), ("weights of a picture", weights.len())]
    {
        if given != needed {
            return Err(InverseError::Count { name, needed, given });
        }
    }
    let least = (-f64::from(most)).exp();
    let mut counts = LogCounts::default();
    let mut row = |picture: f32, background: f32, weight: f32| {
        let contrast = f64::from(background) - f64::from(medium);
        let counted = usize::from(weight > 0.0);
        if contrast.abs() < LEAST_CONTRAST {
            counts.dropped += counted;
            return (0.0, 0.0);
        }
        let ratio = (f64::from(picture) - f64::from(medium)) / contrast;
        let through = ratio.clamp(least, 1.0);
        let count = if ratio > 1.0 {
            &mut counts.beyond_background
        } else if ratio < least {
            &mut counts.beyond_medium
        } else {
            &mut counts.kept
        };
        *count += counted;
        // Not -0.
        let depth = (-through.ln()).max(0.0);
        (depth as f32, ((through * contrast).powi(2) * f64::from(weight)) as f32)
    };
    let rows = picture.iter().zip(background).zip(weights);
    let (depths, weights) = rows.map(|((picture, behind), weight)| row(*picture, *behind, *weight)).unzip();
    Ok(LogTargets { depths, weights, counts })
}
