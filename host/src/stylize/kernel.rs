// SPDX-License-Identifier: MIT OR Apache-2.0
//! Operators, structuring elements, and the widths of kernels.

use super::StylizeError;
use std::str::FromStr;

/// A morphological operator on blockers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Operator {
    /// Blockers grow.
    Dilation,
    /// Blockers shrink.
    Erosion,
    /// A dilation, then the erosion that undoes it where nothing was closed: holes are filled.
    Closing,
    /// An erosion, then the dilation that undoes it where something is left: small blockers vanish.
    Opening,
}

impl Operator {
    /// Its dilations (true) and erosions (false), in order.
    pub(super) fn dilations(self) -> &'static [bool] {
        match self {
            Self::Dilation => &[true],
            Self::Erosion => &[false],
            Self::Closing => &[true, false],
            Self::Opening => &[false, true],
        }
    }
}

/// A structuring element of k = 2 r + 1 texels across.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Element {
    /// The square of k x k texels. Its cost does not depend on k up to 63; from 65 on windows of windows are taken,
    /// twice as many reads up to 1055, three times as many up to 16927.
    Box,
    /// The texels with `dx^2 + dy^2 <= r^2`. Its cost grows like k.
    Disc,
}

/// The width of a kernel in texels: odd, at least 1. Wider than the map is fine.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Width(u32);

impl Width {
    /// A width.
    ///
    /// # Errors
    /// [`StylizeError::Width`] for an even number.
    pub fn new(texels: u32) -> Result<Self, StylizeError> {
        if texels.is_multiple_of(2) {
            return Err(StylizeError::Width(f64::from(texels)));
        }
        Ok(Self(texels))
    }

    /// The width nearest to a number of texels, which may come from between two key frames: odd, at least 1.
    pub fn nearest(texels: f32) -> Self {
        // Above 2^24 every f32 is even.
        let below = if texels >= 1.0 { texels.min(16_777_216.0) as u32 } else { 0 };
        Self(below / 2 * 2 + 1)
    }

    /// Texels.
    pub fn texels(self) -> u32 {
        self.0
    }

    /// The texels on each side of the middle.
    pub fn radius(self) -> u32 {
        self.0 / 2
    }
}

impl TryFrom<f64> for Width {
    type Error = StylizeError;

    fn try_from(texels: f64) -> Result<Self, StylizeError> {
        if !(1.0..=f64::from(u32::MAX)).contains(&texels) || texels.fract() != 0.0 {
            return Err(StylizeError::Width(texels));
        }
        Self::new(texels as u32)
    }
}

impl FromStr for Width {
    type Err = StylizeError;

    fn from_str(text: &str) -> Result<Self, StylizeError> {
        let texels: f64 = text.trim().parse().map_err(|_| StylizeError::WidthText(text.to_owned()))?;
        Self::try_from(texels)
    }
}

/// Windows whose Minkowski sum is the window of `radius`: for each the radius, at most 31, and the stride.
pub(super) fn windows(mut radius: u32) -> Vec<(u32, u32)> {
    const LONGEST_RADIUS: u32 = 31;
    const STRIDE: u32 = 16;
    let mut windows = Vec::new();
    let mut stride = 1;
    while radius > LONGEST_RADIUS {
        // What is left over is a radius of 16 to 31: wide enough to leave no gap between two strides.
        let strides = radius / STRIDE - 1;
        windows.push((radius - strides * STRIDE, stride));
        radius = strides;
        stride *= STRIDE;
    }
    windows.push((radius, stride));
    windows
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn windows_of_windows_have_no_gaps() {
        for radius in (0..5000).chain([8191, 16383, 32767]) {
            let windows = windows(radius);
            let mut reach = 0;
            for (own, stride) in &windows {
                assert!(*own <= 31 && *stride <= 2 * reach + 1, "radius {radius}: {windows:?}");
                reach += own * stride;
            }
            assert_eq!(reach, radius, "{windows:?}");
        }
        assert_eq!([31, 32, 527, 528, 8463].map(|radius| windows(radius).len()), [1, 2, 2, 3, 3]);
    }

    #[test]
    fn impossible_widths_are_errors() {
        for width in [0.0, 2.0, 10.0, -3.0, 2.5, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -0.0] {
            let error = Width::try_from(width).unwrap_err();
            assert!(matches!(error, StylizeError::Width(_)), "{error}");
        }
        assert!(matches!(Width::new(0), Err(StylizeError::Width(_))));
        for text in ["", "wide", "4", "NaN", "-5", "1e400"] {
            assert!(text.parse::<Width>().is_err(), "{text}");
        }
        assert_eq!("11".parse::<Width>().unwrap(), Width::new(11).unwrap());
        assert_eq!(Width::try_from(1e6 + 1.0).unwrap().radius(), 500_000);
    }
}
