// SPDX-License-Identifier: MIT OR Apache-2.0
//! A medium that was measured: magnetic resonance of a head.

use super::super::album::Section;
use super::super::studio::Studio;
use super::setting::Arrangement;
use super::sky::Sky;
use super::volumes;
use crate::command::{CommandError, scans};
use crate::core::{DepthRange, PerspectiveView};
use crate::data::{Bounds, Volume};
use glam::{Mat4, Vec3};

/// Values from which on there is tissue, and from which on it is as dense as can be.
const WINDOW: (f32, f32) = (85.0, 190.0);
/// 1/m where it is as dense as can be.
const EXTINCTION: f32 = 70.0;

/// The brain of the scan, in the light of a lamp.
pub fn brain(studio: &Studio, folder: &str) -> Result<Section, CommandError> {
    let volume = windowed(scans::head()?);
    let arrangement = Arrangement {
        view: PerspectiveView {
            eye: Vec3::new(-0.20, 0.075, 0.36),
            target: Vec3::new(0.0, 0.004, 0.0),
            field_of_view: 21.5,
            near: 0.01,
            far: 10.0,
            depth: DepthRange::Forward,
        },
        sun: (Vec3::new(0.52, 0.70, 0.32), Vec3::new(15.0, 9.6, 5.4)),
        fill: (Vec3::new(-0.9, 0.1, 0.2), Vec3::new(0.28, 0.48, 0.95)),
        medium: (Vec3::new(0.97, 0.94, 0.90), 0.0),
        sky: Sky {
            zenith: Vec3::new(0.004, 0.007, 0.014),
            horizon: Vec3::new(0.010, 0.011, 0.015),
            glow: Vec3::new(0.03, 0.018, 0.009),
            haze: 0.5,
        },
        ground: None,
        exposure: 1.0,
    };
    volumes::section(studio, folder, "A brain by magnetic resonance", &arrangement, &volume, EXTINCTION)
}

/// Density 0..1 in place of the scan's values, its middle in the origin.
fn windowed(mut volume: Volume) -> Volume {
    let (low, high) = WINDOW;
    let [width, height, _] = volume.size.map(|side| side as usize);
    // Light that grazes an edge of one voxel would show its steps.
    for stride in [1, width, width * height] {
        smooth(&mut volume.values, stride);
    }
    volume.values.iter_mut().for_each(|value| *value = ((*value - low) / (high - low)).clamp(0.0, 1.0));
    let middle = Bounds::of(volume.occupied_points()).map_or(Vec3::ZERO, |bounds| bounds.center());
    volume.world_from_unit = Mat4::from_translation(-middle) * volume.world_from_unit;
    volume
}

/// The mean of each value and of those before and behind it, once and twice and once; the first and last ones stay.
fn smooth(values: &mut [f32], stride: usize) {
    let sharp = values.to_vec();
    for (i, value) in values.iter_mut().enumerate().skip(stride).take(sharp.len().saturating_sub(2 * stride))
    {
        *value = 0.25 * (sharp[i - stride] + 2.0 * sharp[i] + sharp[i + stride]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smoothing_keeps_the_sum_and_spreads_along_one_axis() {
        let mut values = vec![0.0; 27];
        values[13] = 4.0;
        smooth(&mut values, 3);
        assert_eq!((values[10], values[13], values[16]), (1.0, 2.0, 1.0));
        assert_eq!(values.iter().sum::<f32>(), 4.0);
        let mut short = vec![1.0, 2.0];
        smooth(&mut short, 3);
        assert_eq!(short, [1.0, 2.0]);
    }
}
