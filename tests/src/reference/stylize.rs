// SPDX-License-Identifier: MIT OR Apache-2.0
//! Morphology of shadow maps, every texel of every window looked at: with a box or a disc, and along view rays
//! (stylized scattering, Eq. 3); and random holes. Depth grows away from the light where `far` is 1, towards it where that is
//! 0; what is not finite counts as `far`. Windows are cut at the border of the map.

mod epipolar;
pub mod holes;
mod morphology;
pub mod transfer;

pub use epipolar::{Epipole, Interval, Kernel, hidden};
pub use morphology::{Element, Morphology};

/// A shadow map.
#[derive(Clone, Copy, Debug)]
pub struct Map<'a> {
    /// Stored depths, row after row.
    pub depth: &'a [f32],
    /// Texels in x.
    pub width: usize,
    /// Texels in y.
    pub height: usize,
    /// Depth of an empty texel: 1 forward, 0 reversed.
    pub far: f64,
}

impl Map<'_> {
    /// Stored depth of a texel, `far` where it is not finite.
    #[must_use]
    pub fn stored(&self, x: usize, y: usize) -> f64 {
        let depth = f64::from(self.depth[y * self.width + x]);
        if depth.is_finite() { depth } else { self.far }
    }

    /// Depth that grows away from the light; infinite where there is no blocker.
    #[must_use]
    pub fn blocker(&self, x: usize, y: usize) -> f64 {
        let (depth, far) = (self.facing(self.stored(x, y)), self.facing(self.far));
        if depth >= far { f64::INFINITY } else { depth.max(far - 1.0) }
    }

    /// A stored depth as one that grows away from the light, or back.
    #[must_use]
    pub fn facing(&self, depth: f64) -> f64 {
        if self.far > 0.5 { depth } else { -depth }
    }
}
