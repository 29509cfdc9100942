// SPDX-License-Identifier: MIT OR Apache-2.0
//! Bounds of a slice, searched for by sampling and narrowing down.

use std::f64::consts::PI;

use super::light_ray;
use crate::reference::scattering::frame::Frame;
use crate::reference::scattering::local_light::{Cone, LocalLight};

/// Samples of a slice in the searches.
const SAMPLES: usize = 2048;

/// The least and greatest angle in [0, π] whose light rays lie in the outer cone; none if none do.
pub(super) fn cone(frame: &Frame, light: &LocalLight, phi: f64) -> Option<(f64, f64)> {
    let Cone::Spot { direction, cosines: [_, outer] } = light.cone else { return Some((0.0, PI)) };
    let axis = -direction.normalised();
    let cosine = |alpha: f64| light_ray(frame, phi, alpha).dot(axis);
    let inside = |alpha: f64| cosine(alpha) >= outer;
    let mut samples: Vec<f64> = (0..=SAMPLES).map(|i| PI * i as f64 / SAMPLES as f64).collect();
    samples.push(highest(0.0, PI, cosine));
    samples.sort_unstable_by(f64::total_cmp);
    let first = samples.iter().position(|&alpha| inside(alpha))?;
    let last = samples.iter().rposition(|&alpha| inside(alpha))?;
    let border = |mut without: f64, mut within: f64| {
        for _ in 0..60 {
            let middle = 0.5 * (without + within);
            if inside(middle) { within = middle } else { without = middle }
        }
        within
    };
    let low = if first == 0 { 0.0 } else { border(samples[first - 1], samples[first]) };
    let high = samples.get(last + 1).map_or(PI, |&outside| border(outside, samples[last]));
    Some((low, high))
}

/// Where a function is greatest between two angles: sampled, then narrowed down about the best.
fn highest(from: f64, to: f64, function: impl Fn(f64) -> f64) -> f64 {
    let at = |i: usize| from + (to - from) * i as f64 / SAMPLES as f64;
    let best = (0..=SAMPLES).max_by(|&i, &j| function(at(i)).total_cmp(&function(at(j)))).unwrap_or(0);
    let (mut low, mut high) = (at(best.saturating_sub(1)), at((best + 1).min(SAMPLES)));
    let mut found = at(best);
    for _ in 0..80 {
        let (left, right) = ((2.0 * low + high) / 3.0, (low + 2.0 * high) / 3.0);
        for place in [left, right] {
            if function(place) > function(found) {
                found = place;
            }
        }
        if function(left) < function(right) { low = left } else { high = right }
    }
    found
}

/// The greatest value of a function between two angles.
pub(super) fn greatest(from: f64, to: f64, function: impl Fn(f64) -> f64) -> f64 {
    function(highest(from, to, &function))
}
