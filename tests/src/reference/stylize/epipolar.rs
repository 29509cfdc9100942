// SPDX-License-Identifier: MIT OR Apache-2.0
//! Eq. 3 along lines towards the epipole, sample by sample.
//!
//! A sample may fall so near to the edge between two texels that single precision cannot tell which one it takes: both are then
//! possible, and results are intervals. They are as wide as the budget of Eq. 3, `1e-6 (1 + dis(t, l) / dis(s, l))`, elsewhere.

use super::Map;

/// The eye in the map, homogeneous: texels and stored depth, times the weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Epipole {
    /// Texels times weight.
    pub x: f64,
    /// Texels times weight.
    pub y: f64,
    /// Depth times weight.
    pub depth: f64,
    /// 0 at infinity.
    pub weight: f64,
}

impl Epipole {
    /// Unit vector from a point of the map, in texels, towards the eye; none where there is no direction.
    #[must_use]
    pub fn direction(&self, [x, y]: [f64; 2]) -> Option<[f64; 2]> {
        let [dx, dy] = [self.x - x * self.weight, self.y - y * self.weight];
        let length = dx.hypot(dy);
        (length > 0.0).then(|| [dx / length, dy / length])
    }

    /// Facing depth at `t` of what extrudes from facing depth `z` at `s` along its view ray: Eq. 3 as printed, and its limit for
    /// an eye at infinity. `s`, `t`: texels, on one line with the epipole. `facing`: 1, or -1 for reversed depth.
    #[must_use]
    pub fn extruded(&self, s: [f64; 2], z: f64, t: [f64; 2], facing: f64) -> f64 {
        if !z.is_finite() {
            return z;
        }
        let eye = facing * self.depth;
        if self.weight == 0.0 {
            // Depth falls along the direction towards the eye by `eye` for each `length` of the map.
            let length = self.x.hypot(self.y);
            let towards = ((s[0] - t[0]) * self.x + (s[1] - t[1]) * self.y) / length;
            return z - towards * eye / length;
        }
        let [x, y, eye] = [self.x, self.y, eye].map(|value| value / self.weight);
        let distance = |[a, b]: [f64; 2]| (a - x).hypot(b - y);
        distance(t) / distance(s) * (z - eye) + eye
    }

    /// How much farther `t` is from the epipole than `s`.
    fn ratio(&self, s: [f64; 2], t: [f64; 2]) -> f64 {
        if self.weight == 0.0 {
            return 1.0;
        }
        let distance = |[a, b]: [f64; 2]| (a - self.x / self.weight).hypot(b - self.y / self.weight);
        distance(t) / distance(s)
    }

    /// Texels along the longer axis from a point to the epipole's place in the map; infinite where it has none. For an eye behind
    /// the light view rays go towards it, and end there.
    fn remaining(&self, [x, y]: [f64; 2]) -> f64 {
        if self.weight == 0.0 {
            return f64::INFINITY;
        }
        (self.x / self.weight - x).abs().max((self.y / self.weight - y).abs())
    }
}

/// Between which facing depths a result lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The least.
    pub least: f64,
    /// The greatest.
    pub greatest: f64,
}

/// A kernel along the lines of a map.
#[derive(Clone, Copy, Debug)]
pub struct Kernel<'a> {
    /// The map.
    pub map: Map<'a>,
    /// The eye in it.
    pub epipole: Epipole,
    /// Texels of the kernel, the own one counted.
    pub width: usize,
    /// Samples may fall into the next texel across the line as well: what resampling to lines half a texel away may do.
    pub spread: bool,
}

/// Nearer samples cannot be told from the epipole, texels.
const LEAST_DISTANCE: f64 = 1e-3;

impl Kernel<'_> {
    fn facing(&self) -> f64 {
        if self.map.far > 0.5 { 1.0 } else { -1.0 }
    }

    /// The texels that a sample may take, and whether it may take none.
    fn texels(&self, s: [f64; 2], by_x: bool, steps: f64) -> (Vec<[usize; 2]>, bool) {
        let size = [self.map.width as f64, self.map.height as f64];
        let minor = usize::from(by_x);
        let slack = 2.5e-7 * (s[minor].abs() + 2.0 * steps) + 1e-6;
        let reach = if self.spread { 0.5 + slack } else { slack };
        let (mut texels, mut none) = (Vec::new(), false);
        let major = s[1 - minor].floor();
        let (low, high) = ((s[minor] - reach).floor(), (s[minor] + reach).floor());
        let mut at = low;
        while at <= high {
            let texel = if by_x { [major, at] } else { [at, major] };
            if texel[0] >= 0.0 && texel[1] >= 0.0 && texel[0] < size[0] && texel[1] < size[1] {
                texels.push(texel.map(|value| value as usize));
            } else {
                none = true;
            }
            at += 1.0;
        }
        (texels, none)
    }

    /// The extremum of what the samples of a texel extrude to it: `towards` the epipole the nearest to the light, or away from
    /// it the farthest.
    fn stage(
        &self,
        x: usize,
        y: usize,
        towards: bool,
        source: &dyn Fn(usize, usize) -> Interval,
    ) -> Interval {
        let t = [x as f64 + 0.5, y as f64 + 0.5];
        let mut found = source(x, y);
        let Some([dx, dy]) = self.epipole.direction(t) else { return found };
        let longer = dx.abs().max(dy.abs());
        let by_x = dx.abs() >= dy.abs();
        if self.epipole.remaining(t) <= LEAST_DISTANCE {
            return found;
        }
        let sign = if towards { 1.0 } else { -1.0 };
        let mut may_have_ended = false;
        for step in 1..self.width {
            let along = sign * step as f64 / longer;
            let s = [t[0] + along * dx, t[1] + along * dy];
            let left = self.epipole.remaining(t) - sign * self.epipole.weight.signum() * step as f64;
            let slack = 3e-7 * (self.epipole.remaining(t).min(1e9) + t[0] + t[1]);
            if left < LEAST_DISTANCE - slack {
                break;
            }
            may_have_ended |= left < LEAST_DISTANCE + slack;
            let (texels, none) = self.texels(s, by_x, step as f64);
            if texels.is_empty() {
                break;
            }
            may_have_ended |= none;
            let budget = 1e-6 * (1.0 + self.epipole.ratio(s, t));
            let mut sample = Interval { least: f64::INFINITY, greatest: f64::NEG_INFINITY };
            for [u, v] in texels {
                let Interval { least, greatest } = source(u, v);
                let extruded = |z| self.epipole.extruded(s, z, t, self.facing());
                sample.least = sample.least.min(extruded(least) - budget);
                sample.greatest = sample.greatest.max(extruded(greatest) + budget);
            }
            if towards {
                found.least = found.least.min(sample.least);
                if !may_have_ended {
                    found.greatest = found.greatest.min(sample.greatest);
                }
            } else {
                found.greatest = found.greatest.max(sample.greatest);
                if !may_have_ended {
                    found.least = found.least.max(sample.least);
                }
            }
        }
        found
    }

    fn original(&self, x: usize, y: usize) -> Interval {
        let depth = self.map.blocker(x, y);
        Interval { least: depth, greatest: depth }
    }

    /// As a shadow map holds it: between the near and the far plane; `keep` of result and original.
    fn held(&self, x: usize, y: usize, found: Interval, keep: fn(f64, f64) -> f64) -> Interval {
        let (original, far) = (self.map.blocker(x, y), self.map.facing(self.map.far));
        let held = |depth: f64| keep(original, depth).clamp(far - 1.0, far);
        Interval { least: held(found.least), greatest: held(found.greatest) }
    }

    /// Facing depth of a texel after blockers were extruded.
    #[must_use]
    pub fn dilated(&self, x: usize, y: usize) -> Interval {
        self.held(x, y, self.stage(x, y, true, &|x, y| self.original(x, y)), f64::min)
    }

    /// Facing depth of a texel after the erosion with the reflected kernel.
    #[must_use]
    pub fn eroded(&self, x: usize, y: usize) -> Interval {
        self.held(x, y, self.stage(x, y, false, &|x, y| self.original(x, y)), f64::max)
    }

    /// Facing depth of a texel after dilation and erosion.
    #[must_use]
    pub fn closed(&self, x: usize, y: usize) -> Interval {
        let dilated = |x, y| self.stage(x, y, true, &|x, y| self.original(x, y));
        self.held(x, y, self.stage(x, y, false, &dilated), f64::min)
    }

    /// Facing depth of a texel after erosion and dilation.
    #[must_use]
    pub fn opened(&self, x: usize, y: usize) -> Interval {
        let eroded = |x, y| self.stage(x, y, false, &|x, y| self.original(x, y));
        self.held(x, y, self.stage(x, y, true, &eroded), f64::max)
    }

    /// True where the lines of neighbouring texels may step along different axes, or begin at the epipole: `spread` does not
    /// cover these.
    #[must_use]
    pub fn diagonal(&self, x: usize, y: usize) -> bool {
        let t = [x as f64 + 0.5, y as f64 + 0.5];
        let Some([dx, dy]) = self.epipole.direction(t) else { return true };
        let slope = dx.abs().min(dy.abs()) / dx.abs().max(dy.abs());
        let remaining = self.epipole.remaining(t);
        let remaining = if remaining.is_finite() { remaining } else { 1e3 };
        1.0 - slope <= 1.5 / remaining || remaining <= 1.0
    }
}

/// True where the view ray to facing depth `z` above the centre of texel `t` meets a texel's piece of the original surface
/// before: a square at the depth of the texel. `slack`: of depth. For a weight of 1.
#[must_use]
pub fn hidden(map: &Map<'_>, epipole: &Epipole, t: [usize; 2], z: f64, slack: f64) -> bool {
    let end = t.map(|value| value as f64 + 0.5);
    let eye = [epipole.x, epipole.y];
    let eye_depth = map.facing(epipole.depth);
    (0..map.height).any(|v| {
        (0..map.width).any(|u| {
            let surface = map.blocker(u, v);
            if [u, v] == t || !surface.is_finite() {
                return false;
            }
            // The part of the ray, 0 at the eye and 1 at the point, above this texel.
            let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
            for (axis, cell) in [u, v].into_iter().enumerate() {
                let (low, high) = (cell as f64, cell as f64 + 1.0);
                let slope = end[axis] - eye[axis];
                if slope.abs() < 1e-12 {
                    if eye[axis] < low || eye[axis] > high {
                        return false;
                    }
                } else {
                    let (a, b) = ((low - eye[axis]) / slope, (high - eye[axis]) / slope);
                    enter = enter.max(a.min(b));
                    leave = leave.min(a.max(b));
                }
            }
            if enter > leave {
                return false;
            }
            let depth = |part: f64| eye_depth + part * (z - eye_depth);
            let (a, b) = (depth(enter), depth(leave));
            a.min(b) - slack <= surface && surface <= a.max(b) + slack
        })
    })
}
