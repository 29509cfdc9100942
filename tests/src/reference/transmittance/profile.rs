// SPDX-License-Identifier: MIT OR Apache-2.0
//! Extinction along a light ray.

/// A part of the ray with even extinction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Where it begins, metres from the near side.
    pub from: f64,
    /// Where it ends.
    pub to: f64,
    /// 1/m.
    pub extinction: f64,
}

/// Stretches on a ray; where they overlap their extinctions add up.
#[derive(Clone, Debug, Default)]
pub struct Profile {
    /// Metres from the near side to the far side.
    pub range: f64,
    /// All of them.
    pub stretches: Vec<Stretch>,
}

impl Profile {
    /// Equal steps over the whole range, one for each value, 1/m.
    #[must_use]
    pub fn of_steps(range: f64, extinctions: &[f64]) -> Self {
        let step = range / extinctions.len() as f64;
        let stretch = |(i, extinction): (usize, &f64)| Stretch {
            from: i as f64 * step,
            to: (i + 1) as f64 * step,
            extinction: *extinction,
        };
        Self { range, stretches: extinctions.iter().enumerate().map(stretch).collect() }
    }

    /// Optical depth from the near side to `x` metres.
    #[must_use]
    pub fn optical_depth(&self, x: f64) -> f64 {
        self.stretches.iter().map(|s| s.extinction * (x.min(s.to) - s.from).max(0.0)).sum()
    }

    /// Transmittance from the near side to `x` metres.
    #[must_use]
    pub fn transmittance(&self, x: f64) -> f64 {
        (-self.optical_depth(x)).exp()
    }

    /// Least and greatest depth with any extinction, metres.
    #[must_use]
    pub fn occupied(&self) -> Option<(f64, f64)> {
        let dense = || self.stretches.iter().filter(|s| s.extinction > 0.0);
        let from = dense().map(|s| s.from).min_by(f64::total_cmp)?;
        Some((from, dense().map(|s| s.to).max_by(f64::total_cmp)?))
    }

    /// The ray cut to the range `from..to`, which is what lies between them.
    #[must_use]
    pub fn cut(&self, from: f64, to: f64) -> Self {
        let cut = |s: &Stretch| Stretch {
            from: (s.from - from).clamp(0.0, to - from),
            to: (s.to - from).clamp(0.0, to - from),
            ..*s
        };
        Self { range: to - from, stretches: self.stretches.iter().map(cut).collect() }
    }

    /// The integral over each stretch of extinction times `value` of depth, summed: the midpoint rule.
    #[must_use]
    pub fn integral(&self, value: impl Fn(f64) -> f64) -> f64 {
        const PARTS: usize = 64;
        let of_stretch = |s: &Stretch| {
            let part = (s.to - s.from) / PARTS as f64;
            (0..PARTS).map(|i| value(s.from + (i as f64 + 0.5) * part)).sum::<f64>() * part * s.extinction
        };
        self.stretches.iter().filter(|s| s.extinction > 0.0).map(of_stretch).sum()
    }
}
