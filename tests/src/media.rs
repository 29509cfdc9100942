// SPDX-License-Identifier: MIT OR Apache-2.0
//! Media along light rays that transmittance maps are measured on, the same for `airlight bench` and the tests.

use std::f64::consts::PI;

/// Range of the rays, metres.
pub const RANGE: f64 = 8.0;
/// Steps of even extinction of a ray of the table.
pub const STEPS: usize = 128;
/// Rays of each kind and optical depth in the table.
pub const EACH: usize = 8;
/// Optical depths of the table.
pub const OPTICAL_DEPTHS: [f64; 4] = [0.5, 2.0, 8.0, 16.0];

/// Kinds of media along a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Medium {
    /// Smooth, and fills the range.
    Smooth,
    /// Noisy blobs.
    Smoke,
    /// Few stretches with sharp edges.
    Boxes,
    /// Boxes within 10 to 40 % of the range.
    ShortBoxes,
    /// Noisy blobs within 10 to 40 % of the range.
    ShortBursts,
}

impl Medium {
    /// All kinds, as the table has them.
    pub const ALL: [Self; 5] = [Self::Smooth, Self::Smoke, Self::Boxes, Self::ShortBoxes, Self::ShortBursts];

    /// Its name in rows.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Smooth => "smooth",
            Self::Smoke => "smoke",
            Self::Boxes => "boxes",
            Self::ShortBoxes => "short_boxes",
            Self::ShortBursts => "short_bursts",
        }
    }
}

/// Uniform random numbers, the same from run to run: xorshift of 64 bits. The state is not 0.
pub struct Uniform(pub u64);

impl Uniform {
    /// In [0, 1).
    pub fn unit(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Extinction in 1/m of a ray of `steps` steps over [`RANGE`], of the optical depth `total`. `unit`: random numbers in [0, 1).
pub fn medium(kind: Medium, steps: usize, total: f64, unit: &mut dyn FnMut() -> f64) -> Vec<f32> {
    let mut between = |low: f64, high: f64| low + (high - low) * unit();
    let place = |i: usize| (i as f64 + 0.5) / steps as f64;
    let mut values: Vec<f64> = match kind {
        Medium::Smooth => {
            let waves: Vec<[f64; 2]> =
                (0..3).map(|_| [between(-0.25, 0.25), between(0.0, 2.0 * PI)]).collect();
            let value = |x: f64| {
                let of = |(k, wave): (usize, &[f64; 2])| wave[0] * ((k + 1) as f64 * PI * x + wave[1]).cos();
                1.0 + waves.iter().enumerate().map(of).sum::<f64>()
            };
            (0..steps).map(|i| value(place(i))).collect()
        }
        Medium::Smoke => blobs(steps, (0.0, 1.0), &mut between),
        Medium::ShortBursts => {
            let ends = part(&mut between);
            let mut values = blobs(steps, ends, &mut between);
            for (i, value) in values.iter_mut().enumerate() {
                if !(ends.0..ends.1).contains(&place(i)) {
                    *value = 0.0;
                }
            }
            values
        }
        Medium::Boxes | Medium::ShortBoxes => {
            let (low, high) = if kind == Medium::Boxes { (0.0, 1.0) } else { part(&mut between) };
            let mut values = vec![0.0; steps];
            for _ in 0..3 {
                let from = between(low, low + 0.85 * (high - low));
                let to = (from + between(0.05, 0.2) * (high - low)).min(high);
                let strength = between(0.3, 1.0);
                for (i, value) in values.iter_mut().enumerate() {
                    if (from..to).contains(&place(i)) {
                        *value += strength;
                    }
                }
            }
            // Never empty.
            values[((0.5 * (low + high)) * steps as f64) as usize] += 0.3;
            values
        }
    };
    let sum: f64 = values.iter().sum::<f64>() * RANGE / steps as f64;
    for value in &mut values {
        *value *= total / sum;
    }
    values.into_iter().map(|value| value as f32).collect()
}

/// Ends of 10 to 40 % of the range.
fn part(between: &mut impl FnMut(f64, f64) -> f64) -> (f64, f64) {
    let width = between(0.1, 0.4);
    let low = between(0.0, 1.0 - width);
    (low, low + width)
}

/// Six noisy blobs about the part of the range between `low` and `high`.
fn blobs(steps: usize, (low, high): (f64, f64), between: &mut impl FnMut(f64, f64) -> f64) -> Vec<f64> {
    let width = high - low;
    let all: Vec<[f64; 3]> = (0..6)
        .map(|_| [low + width * between(0.1, 0.9), width * between(0.02, 0.1), between(0.2, 1.0)])
        .collect();
    let value =
        |x: f64| all.iter().map(|[at, width, s]| s * (-((x - at) / width).powi(2)).exp()).sum::<f64>();
    (0..steps)
        .map(|i| value((i as f64 + 0.5) / steps as f64) * between(0.6, 1.4))
        .map(|v| if v < 0.02 { 0.0 } else { v })
        .collect()
}

/// The rays of the table: [`EACH`] of each kind at each optical depth, in this order.
#[must_use]
pub fn table() -> Vec<Vec<f32>> {
    let mut random = Uniform(2011);
    let mut rays = Vec::new();
    for kind in Medium::ALL {
        for total in OPTICAL_DEPTHS {
            rays.extend((0..EACH).map(|_| medium(kind, STEPS, total, &mut || random.unit())));
        }
    }
    rays
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn media_have_their_optical_depth_and_fill_what_they_say() {
        let rays = table();
        assert_eq!(rays.len(), Medium::ALL.len() * OPTICAL_DEPTHS.len() * EACH);
        for (i, ray) in rays.iter().enumerate() {
            let kind = Medium::ALL[i / (OPTICAL_DEPTHS.len() * EACH)];
            let total = OPTICAL_DEPTHS[i / EACH % OPTICAL_DEPTHS.len()];
            assert!(ray.iter().all(|value| *value >= 0.0));
            let sum: f64 = ray.iter().map(|value| f64::from(*value)).sum::<f64>() * RANGE / STEPS as f64;
            assert!((sum / total - 1.0).abs() < 1e-5, "{kind:?}: {sum}");
            let dense = |value: &f32| *value > 0.0;
            let first = ray.iter().position(dense).unwrap_or(0);
            let last = ray.iter().rposition(dense).unwrap_or(0);
            let filled = (last + 1 - first) as f64 / STEPS as f64;
            match kind {
                Medium::Smooth => assert!(filled > 0.99),
                Medium::ShortBoxes | Medium::ShortBursts => assert!(filled < 0.42, "{kind:?}: {filled}"),
                Medium::Smoke | Medium::Boxes => {}
            }
        }
        assert_eq!(rays, table());
    }
}
