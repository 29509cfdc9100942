// SPDX-License-Identifier: MIT OR Apache-2.0
//! Random holes in f64: Eq. 4 and 5 with the corrections of EQUATIONS.md, 5, and the look-up in two steps.

use crate::reference::noise::{hash, noise};
use std::f64::consts::SQRT_2;

/// What the noise is.
#[derive(Clone, Copy, Debug)]
pub struct Pattern {
    /// Cells across width and height.
    pub cells: [f64; 2],
    /// p.
    pub persistence: f64,
    /// o.
    pub octaves: u32,
    /// Chooses gradients and offsets.
    pub seed: u32,
    /// What the first look-up has travelled, cells.
    pub travel: f64,
    /// Of the second look-up at most, cells.
    pub displacement: f64,
    /// Radians.
    pub turn: f64,
}

/// Where the lattice of an octave lies.
fn offset(seed: u32) -> [f64; 2] {
    let [x, y, _] = hash([0x6f66_6673, u64::from(seed), 0x6f66_6673]);
    [x, y].map(|h| (h / 256) as f64 / 16_777_216.0)
}

impl Pattern {
    /// N of Eq. 5, mapped to 0..1, at a position in cells of the first octave.
    #[must_use]
    pub fn octave_noise(&self, q: [f64; 2]) -> f64 {
        let weights: Vec<f64> = (0..self.octaves as i32)
            .map(|i| self.persistence.powi(i) / f64::from((self.octaves as i32 - i - 1).max(1)))
            .collect();
        let terms = weights.iter().enumerate().map(|(i, weight)| {
            let seed = self.seed.wrapping_add((i as u32).wrapping_mul(2_654_435_769));
            let [x, y] = offset(seed);
            let scale = 2.0_f64.powi(i as i32);
            weight * noise(scale * q[0] + x, scale * q[1] + y, seed)
        });
        0.5 + 0.5 * terms.sum::<f64>() / (weights.iter().sum::<f64>() / SQRT_2)
    }

    /// The noise of a place in the map, 0..1 across and down.
    #[must_use]
    pub fn at(&self, uv: [f64; 2]) -> f64 {
        let q = [uv[0] * self.cells[0], uv[1] * self.cells[1]];
        let seed = self.seed ^ 0x7472_6176;
        let [x, y] = offset(seed);
        let value = SQRT_2 * noise(q[0] + x + self.travel, q[1] + y, seed);
        let angle = self.turn * value;
        let length = self.displacement * value;
        self.octave_noise([q[0] + length * angle.cos(), q[1] + length * angle.sin()])
    }
}
