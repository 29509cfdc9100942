// SPDX-License-Identifier: MIT OR Apache-2.0
//! Several shadow maps of one light: cascades of a directional light, faces of a point light. A
//! light ray belongs to the first of them that holds it. One map counts as an array of one.

use super::picture::ViewRay;
use super::shadow_map::{RectifiedTexel, ShadowMap};
use crate::linear::{Mat4, Vec3};

/// A stretch of a view ray that sees the light, and the view that its light rays belong to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LitRun {
    /// Where it begins, metres from the origin of the ray.
    pub from: f64,
    /// Where it ends, metres from the origin of the ray.
    pub to: f64,
    /// Index of the view; none where no view holds the light rays, which counts as lit.
    pub view: Option<usize>,
}

/// View, column and row of a texel (none for no view at all), and the depth that it gives.
type Candidate = (Option<(usize, i64, i64)>, f64);

/// The shadow maps of one light, perspective or orthographic.
#[derive(Clone, Debug)]
pub struct ShadowViews<'a> {
    maps: &'a [ShadowMap<'a>],
    world_from_clip: Vec<Mat4>,
}

impl<'a> ShadowViews<'a> {
    /// # Panics
    /// If a matrix is singular or a map has not the size that it states.
    #[must_use]
    pub fn new(maps: &'a [ShadowMap<'a>]) -> Self {
        assert!(maps.iter().all(|map| map.depth.len() == map.width * map.height), "size of a shadow map");
        let inverse = |map: &ShadowMap<'_>| map.clip_from_world.inverse().expect("a regular matrix");
        Self { maps, world_from_clip: maps.iter().map(inverse).collect() }
    }

    /// The first view that holds the light ray through a point.
    #[must_use]
    pub fn view_of(&self, point: Vec3) -> Option<usize> {
        self.maps.iter().position(|map| {
            let [x, y, _, w] = map.clip_from_world.apply_point(point);
            w > 0.0 && x.abs() <= w && y.abs() <= w
        })
    }

    /// World to the clip space of a view.
    #[must_use]
    pub fn clip_from_world(&self, view: usize) -> Mat4 {
        self.maps[view].clip_from_world
    }

    /// What `depth_of` gives for the first blocker on the light ray through `point` (none without a
    /// blocker), for the texel that holds the light ray and for those within `edge` texels of it.
    #[must_use]
    pub fn look_up(&self, point: Vec3, edge: f64, depth_of: impl Fn(Option<Vec3>) -> f64) -> RectifiedTexel {
        let mut nominal = None;
        let mut candidates: Vec<Candidate> = Vec::new();
        let mut settled = false;
        for (view, map) in self.maps.iter().enumerate() {
            if map.clip_from_world.apply_point(point)[3] <= 0.0 {
                continue;
            }
            let [x, y, _] = map.project(point);
            let inside =
                |x: f64, y: f64| x >= 0.0 && y >= 0.0 && x < map.width as f64 && y < map.height as f64;
            let ndc = [2.0 * x / map.width as f64 - 1.0, 1.0 - 2.0 * y / map.height as f64];
            let depth_at = |x: i64, y: i64| {
                depth_of(map.texel(x, y).map(|stored| {
                    let [x, y, z, w] = self.world_from_clip[view].apply([ndc[0], ndc[1], stored, 1.0]);
                    Vec3::new(x, y, z) * w.recip()
                }))
            };
            if inside(x, y) && nominal.is_none() {
                nominal = Some(depth_at(x.floor() as i64, y.floor() as i64));
            }
            settled = true;
            for (x, y) in
                [(x - edge, y - edge), (x + edge, y - edge), (x - edge, y + edge), (x + edge, y + edge)]
            {
                if inside(x, y) {
                    let (x, y) = (x.floor() as i64, y.floor() as i64);
                    candidates.push((Some((view, x, y)), depth_at(x, y)));
                } else {
                    settled = false;
                }
            }
            if settled {
                break;
            }
        }
        if !settled {
            candidates.push((None, depth_of(None)));
        }
        let z = nominal.unwrap_or_else(|| depth_of(None));
        RectifiedTexel {
            z,
            low: candidates.iter().fold(z, |low, candidate| low.min(candidate.1)),
            high: candidates.iter().fold(z, |high, candidate| high.max(candidate.1)),
            ambiguous: candidates.iter().any(|candidate| candidate.0 != candidates[0].0),
        }
    }

    /// The lit stretches of a view ray in order, exact: adjoining ones of one view are one.
    ///
    /// # Panics
    /// For a ray without end.
    #[must_use]
    pub fn lit_runs(&self, ray: &ViewRay) -> Vec<LitRun> {
        assert!(ray.end.is_finite(), "a view ray without end");
        let lines: Vec<Line> = self.maps.iter().map(|map| Line::new(&map.clip_from_world, ray)).collect();
        // Where the ray may pass from one view to another.
        let mut borders = vec![ray.begin, ray.end];
        for line in &lines {
            borders.push(line.root(3, 0.0));
            borders.extend([(0, -1.0), (0, 1.0), (1, -1.0), (1, 1.0)].map(|(axis, at)| line.root(axis, at)));
        }
        let mut runs = Runs(Vec::new());
        for piece in pieces(borders, ray.begin, ray.end).windows(2) {
            let (from, to) = (piece[0], piece[1]);
            let Some(view) = self.view_of(ray.at(0.5 * (from + to))) else {
                runs.lit(from, to, None);
                continue;
            };
            let (map, line) = (&self.maps[view], &lines[view]);
            let mut edges = line.grid(0, map.width, 0.0, from, to);
            edges.extend(line.grid(1, map.height, 0.0, from, to));
            for piece in pieces(edges, from, to).windows(2) {
                self.texel(&mut runs, view, line, piece[0], piece[1]);
            }
        }
        runs.0
    }

    /// The lit part of a piece of a ray within one texel.
    fn texel(&self, runs: &mut Runs, view: usize, line: &Line, from: f64, to: f64) {
        let map = &self.maps[view];
        let [x, y, _, w] = line.at(0.5 * (from + to));
        let texel = |ndc: f64, count: usize| {
            ((0.5 + 0.5 * ndc) * count as f64).floor().clamp(0.0, count as f64 - 1.0) as i64
        };
        let Some(stored) = map.texel(texel(x / w, map.width), texel(-y / w, map.height)) else {
            runs.lit(from, to, Some(view));
            return;
        };
        let away = if map.far_depth > 0.5 { 1.0 } else { -1.0 };
        for part in pieces(vec![line.root(2, stored)], from, to).windows(2) {
            let [_, _, z, w] = line.at(0.5 * (part[0] + part[1]));
            if away * (z / w - stored) <= 0.0 {
                runs.lit(part[0], part[1], Some(view));
            }
        }
    }
}

struct Runs(Vec<LitRun>);

impl Runs {
    fn lit(&mut self, from: f64, to: f64, view: Option<usize>) {
        match self.0.last_mut() {
            Some(last) if last.to == from && last.view == view => last.to = to,
            _ => self.0.push(LitRun { from, to, view }),
        }
    }
}

/// The places within an interval in order, with its two ends: the borders of its pieces, none of
/// which is empty.
pub(super) fn pieces(mut places: Vec<f64>, from: f64, to: f64) -> Vec<f64> {
    places.retain(|&place| place > from && place < to);
    places.push(from);
    places.push(to);
    places.sort_unstable_by(f64::total_cmp);
    places.dedup();
    places
}

/// A view ray in a clip space: all four coordinates are affine in the distance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    start: [f64; 4],
    slope: [f64; 4],
}

impl Line {
    pub(super) fn new(clip_from_world: &Mat4, ray: &ViewRay) -> Self {
        Self {
            start: clip_from_world.apply_point(ray.origin),
            slope: clip_from_world.apply_direction(ray.direction),
        }
    }

    /// The clip coordinates at a distance, metres.
    fn at(&self, distance: f64) -> [f64; 4] {
        std::array::from_fn(|axis| self.start[axis] + self.slope[axis] * distance)
    }

    /// The distance at which a coordinate over w has a value (or w itself vanishes, for axis 3);
    /// not finite if it never has.
    fn root(&self, axis: usize, value: f64) -> f64 {
        if axis == 3 {
            return -self.start[3] / self.slope[3];
        }
        -(self.start[axis] - value * self.start[3]) / (self.slope[axis] - value * self.slope[3])
    }

    /// The distances between two at which the ray crosses the lines of a grid of `count` texels over
    /// the map, shifted by `shift` texels. w is positive between them.
    pub(super) fn grid(&self, axis: usize, count: usize, shift: f64, from: f64, to: f64) -> Vec<f64> {
        let texels = |distance: f64| {
            let clip = self.at(distance);
            (0.5 + 0.5 * clip[axis] / clip[3]) * count as f64
        };
        // Monotone in the distance where w has one sign. The ends themselves may be where w is 0.
        let (a, b) = (texels(from), texels(to));
        let bound = |value: f64, otherwise: f64| {
            if value.is_finite() { value.clamp(-1.0, count as f64 + 1.0) } else { otherwise }
        };
        let all = !(a.is_finite() && b.is_finite());
        let first = if all { 0.0 } else { bound(a.min(b), 0.0).floor() - 1.0 };
        let last = if all { count as f64 } else { bound(a.max(b), count as f64).ceil() + 1.0 };
        (first as i64..=last as i64)
            .map(|line| self.root(axis, 2.0 * (line as f64 + shift) / count as f64 - 1.0))
            .filter(|&place| place > from && place < to)
            .collect()
    }
}
