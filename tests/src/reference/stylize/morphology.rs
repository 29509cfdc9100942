// SPDX-License-Identifier: MIT OR Apache-2.0
//! Boxes and discs.

use super::Map;

/// The structuring element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Element {
    /// |dx| <= r and |dy| <= r.
    Box,
    /// dx dx + dy dy <= r r.
    Disc,
}

/// A structuring element of a radius on a map.
#[derive(Clone, Copy, Debug)]
pub struct Morphology<'a> {
    /// The map.
    pub map: Map<'a>,
    /// The element.
    pub element: Element,
    /// Its radius in texels.
    pub radius: i64,
}

impl Morphology<'_> {
    /// The best of `value` over the window of a texel.
    fn best(
        &self,
        x: usize,
        y: usize,
        value: &dyn Fn(usize, usize) -> f64,
        better: fn(f64, f64) -> f64,
    ) -> f64 {
        let mut best = value(x, y);
        let [x, y] = [x as i64, y as i64];
        let [right, bottom] = [self.map.width as i64 - 1, self.map.height as i64 - 1];
        for v in (y - self.radius).max(0)..=(y + self.radius).min(bottom) {
            for u in (x - self.radius).max(0)..=(x + self.radius).min(right) {
                let (dx, dy) = (u - x, v - y);
                let holds = match self.element {
                    Element::Box => true,
                    Element::Disc => dx * dx + dy * dy <= self.radius * self.radius,
                };
                if holds {
                    best = better(best, value(u as usize, v as usize));
                }
            }
        }
        best
    }

    /// Nearer to the light, and farther.
    fn orders(&self) -> [fn(f64, f64) -> f64; 2] {
        if self.map.far > 0.5 { [f64::min, f64::max] } else { [f64::max, f64::min] }
    }

    /// Stored depth of a texel after a dilation of blockers.
    #[must_use]
    pub fn dilated(&self, x: usize, y: usize) -> f64 {
        self.best(x, y, &|x, y| self.map.stored(x, y), self.orders()[0])
    }

    /// Stored depth of a texel after an erosion of blockers.
    #[must_use]
    pub fn eroded(&self, x: usize, y: usize) -> f64 {
        self.best(x, y, &|x, y| self.map.stored(x, y), self.orders()[1])
    }

    /// Stored depth of a texel after a closing.
    #[must_use]
    pub fn closed(&self, x: usize, y: usize) -> f64 {
        self.best(x, y, &|x, y| self.dilated(x, y), self.orders()[1])
    }

    /// Stored depth of a texel after an opening.
    #[must_use]
    pub fn opened(&self, x: usize, y: usize) -> f64 {
        self.best(x, y, &|x, y| self.eroded(x, y), self.orders()[0])
    }
}
