// SPDX-License-Identifier: MIT OR Apache-2.0
//! Projective rows (thesis 4.4.2, EQUATIONS.md 1.7 and 2.2): a directional light's rectification
//! that maps straight lines to straight lines. Columns are projective in the distance from the eye
//! of a perspective camera, and linear for an orthographic one.

use super::picture::{Picture, Scene, Start, ViewRay};
use super::shadow_map::{RectifiedTexel, ShadowMap};
use super::slice::GUARD;
use super::stretch::{Stretch, stretch_visibility};
use super::views::ShadowViews;
use super::visibility::Visibility;
use crate::linear::Vec3;
use crate::reference::camera::Camera;

/// Least ratio of the nearest to the farthest column.
const LEAST_NEAR: f64 = 1e-3;
/// Sine of the angle between an orthographic view and the light below which they are parallel.
const PARALLEL: f64 = 1e-4;

/// Why there are no projective rows, or none worth having.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Failure {
    /// The camera or the light is not finite, or the light's direction is zero.
    Impossible,
    /// A view ray, or the border of the picture, points at the light.
    LightInView,
    /// A view ray, or the border of the picture, points away from the light.
    AntipodeInView,
    /// An orthographic camera looks along the light or against it.
    ParallelView,
    /// The farthest column lies this many times as far as the nearest.
    Oblique(f64),
}

/// Projective rows of one camera and light.
#[derive(Clone, Debug, PartialEq)]
pub struct Projective {
    /// The eye, or the centre of an orthographic near plane, world, metres.
    pub origin: Vec3,
    /// Unit vectors of X (along the view, at right angles to the light), Y and Z (away from the light).
    pub axes: [Vec3; 3],
    /// Least X over the corners of the frustum, metres, but at least `far * 1e-3` for a perspective
    /// camera.
    pub near: f64,
    /// Greatest X over the corners, metres.
    pub far: f64,
    /// Greatest over least X of the corners, before the least is raised. Infinite for an orthographic
    /// camera whose least X is not positive.
    pub ratio: f64,
    /// Range of Y/X over the corners; of Y in metres for an orthographic camera.
    pub y: [f64; 2],
    /// Range of Z/X over the corners; of `Z − X drift` in metres for an orthographic camera.
    pub z: [f64; 2],
    /// Of an orthographic camera: what Z changes by along a view ray while X grows by one, and the
    /// X that a metre of a ray covers.
    pub orthographic: Option<Drift>,
    /// Bounds of the splits in X, metres: one more than splits.
    pub bounds: Vec<f64>,
    /// Texels of a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
}

/// How the view rays of an orthographic camera run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drift {
    /// Change of Z while X grows by one.
    pub z_over_x: f64,
    /// Change of X over a metre of a ray.
    pub x_over_t: f64,
}

/// Which light, if any, is in the closed cone of a perspective camera's view rays, by its clip space.
#[must_use]
pub fn light_in_view(camera: &Camera, towards_light: Vec3) -> Option<Failure> {
    let inside = |direction: Vec3| {
        let [x, y, _, w] = camera.clip_from_world.apply_direction(direction);
        w > 0.0 && x.abs() <= w && y.abs() <= w
    };
    if inside(towards_light) {
        Some(Failure::LightInView)
    } else if inside(-towards_light) {
        Some(Failure::AntipodeInView)
    } else {
        None
    }
}

/// Least and greatest of some numbers.
fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(v), b.max(v)])
}

impl Projective {
    /// The rows of a camera, a direction towards the light, the greatest distance along view rays
    /// (metres, may be infinite if the far plane is not), a map of `width` texels in `height` rows, and
    /// a number of splits (always 1 for an orthographic camera).
    ///
    /// # Errors
    /// [`Failure`], but never [`Failure::Oblique`]: see [`Self::oblique`].
    ///
    /// # Panics
    /// For an empty map, a number of splits that does not divide the width, and rays without end.
    pub fn new(
        camera: &Camera,
        towards_light: Vec3,
        distance_limit: f64,
        [width, height]: [usize; 2],
        splits: usize,
    ) -> Result<Self, Failure> {
        assert!(width > 0 && height > 0 && splits > 0 && width % splits == 0, "texels of the splits");
        let l = towards_light.normalised();
        let entries = camera.clip_from_world.columns.as_flattened();
        if !l.length().is_finite() || entries.iter().any(|entry| !entry.is_finite()) {
            return Err(Failure::Impossible);
        }
        let reach = camera.far.min(distance_limit);
        assert!(reach.is_finite(), "rays without end");
        if camera.is_orthographic() {
            return Self::orthographic(camera, l, reach, [width, height]);
        }
        if let Some(failure) = light_in_view(camera, l) {
            return Err(failure);
        }
        let axes = axes(l, bisectrix(camera, l));
        let corners = camera.frustum(reach).map(|corner| coordinates(axes, corner - camera.eye));
        let [least, far] = range(corners.iter().map(|corner| corner[0]));
        let near = least.max(far * LEAST_NEAR);
        let step = (far / near).powf((splits as f64).recip());
        Ok(Self {
            origin: camera.eye,
            axes,
            near,
            far,
            ratio: far / least,
            y: range(corners.iter().map(|corner| corner[1] / corner[0])),
            z: range(corners.iter().map(|corner| corner[2] / corner[0])),
            orthographic: None,
            bounds: (0..=splits)
                .map(|k| if k == splits { far } else { near * step.powi(k as i32) })
                .collect(),
            width,
            height,
        })
    }

    fn orthographic(camera: &Camera, l: Vec3, reach: f64, size: [usize; 2]) -> Result<Self, Failure> {
        let w = camera.forward;
        if w.without(l).length() < PARALLEL {
            return Err(Failure::ParallelView);
        }
        let axes = axes(l, w.without(l).normalised());
        let drift = Drift { z_over_x: w.dot(axes[2]) / w.dot(axes[0]), x_over_t: w.dot(axes[0]) };
        let corners = camera.frustum(reach).map(|corner| coordinates(axes, corner - camera.eye));
        let [near, far] = range(corners.iter().map(|corner| corner[0]));
        Ok(Self {
            origin: camera.eye,
            axes,
            near,
            far,
            ratio: if near > 0.0 { far / near } else { f64::INFINITY },
            y: range(corners.iter().map(|corner| corner[1])),
            z: range(corners.iter().map(|corner| corner[2] - corner[0] * drift.z_over_x)),
            orthographic: Some(drift),
            bounds: vec![near, far],
            width: size[0],
            height: size[1],
        })
    }

    /// [`Failure::Oblique`] if a perspective camera's farthest column is more than `greatest` times as
    /// far as its nearest.
    #[must_use]
    pub fn oblique(&self, greatest: f64) -> Option<Failure> {
        (self.orthographic.is_none() && self.ratio > greatest).then_some(Failure::Oblique(self.ratio))
    }

    /// X, Y and Z of a world point, metres.
    #[must_use]
    pub fn coordinates(&self, point: Vec3) -> [f64; 3] {
        coordinates(self.axes, point - self.origin)
    }

    /// What of a world point is constant along its view ray: Y/X and Z/X, or Y and `Z − X drift`.
    #[must_use]
    pub fn slopes(&self, point: Vec3) -> [f64; 2] {
        let [x, y, z] = self.coordinates(point);
        match self.orthographic {
            None => [y / x, z / x],
            Some(drift) => [y, z - x * drift.z_over_x],
        }
    }

    /// Depth in [0, 1] of the second of the [`Self::slopes`].
    #[must_use]
    pub fn depth(&self, z: f64) -> f64 {
        (GUARD[0] + (GUARD[1] - GUARD[0]) * (z - self.z[0]) / (self.z[1] - self.z[0])).clamp(0.0, 1.0)
    }

    /// The first of the [`Self::slopes`] at the centre of a row.
    #[must_use]
    pub fn row_slope(&self, j: usize) -> f64 {
        self.y[0] + (self.y[1] - self.y[0]) * (j as f64 + 0.5) / self.height as f64
    }

    /// The two rows about the first of the [`Self::slopes`], and the share of the second in [0, 1].
    #[must_use]
    pub fn rows(&self, slope: f64) -> (usize, usize, f64) {
        let v = (slope - self.y[0]) / (self.y[1] - self.y[0]);
        let last = self.height - 1;
        let y = (v * self.height as f64 - 0.5).clamp(0.0, last as f64);
        let first = (y.floor() as usize).min(last.saturating_sub(1));
        (first, (first + 1).min(last), y - first as f64)
    }

    /// X at a place between columns, metres: 0 is the first edge, `width` the last.
    #[must_use]
    pub fn x_of(&self, column: f64) -> f64 {
        let splits = self.bounds.len() - 1;
        let texels = (self.width / splits) as f64;
        let split = ((column / texels).floor() as usize).min(splits - 1);
        let u = column / texels - split as f64;
        let (a, b) = (self.bounds[split], self.bounds[split + 1]);
        if self.orthographic.is_some() {
            return a + (b - a) * u;
        }
        // The solution of u = b (X − a) / ((b − a) X).
        a * b / (b - u * (b - a))
    }

    /// The column, with a fraction, at an X (metres); `width` at the last edge and beyond.
    #[must_use]
    pub fn column(&self, x: f64) -> f64 {
        if x <= self.near {
            return 0.0;
        }
        let splits = self.bounds.len() - 1;
        let texels = (self.width / splits) as f64;
        let split = self.bounds[1..splits].iter().filter(|&&bound| bound <= x).count();
        let (a, b) = (self.bounds[split], self.bounds[split + 1]);
        let u = if self.orthographic.is_some() { (x - a) / (b - a) } else { b * (x - a) / ((b - a) * x) };
        ((split as f64 + u) * texels).min(self.width as f64)
    }

    /// The distances of the edges of a row's texels along a view ray with these [`Self::slopes`],
    /// metres from the eye, or for an orthographic camera from where X is 0. The first is 0 for a
    /// perspective camera: its texel also stands for the stretch before the row.
    #[must_use]
    pub fn edges(&self, slopes: [f64; 2]) -> Vec<f64> {
        let metres = match self.orthographic {
            None => (1.0 + slopes[0] * slopes[0] + slopes[1] * slopes[1]).sqrt(),
            Some(drift) => drift.x_over_t.recip(),
        };
        let mut edges: Vec<f64> = (0..=self.width).map(|i| self.x_of(i as f64) * metres).collect();
        if self.orthographic.is_none() {
            edges[0] = 0.0;
        }
        edges
    }

    /// Metres of the reference ray of a row over which X grows by one, for the weights of the
    /// prefiltering: of the bisectrix of the row's view rays that cross a texel fastest and slowest.
    #[must_use]
    pub fn reference_length(&self, j: usize) -> f64 {
        if let Some(drift) = self.orthographic {
            return drift.x_over_t.recip();
        }
        // Angles in the row's plane, against the light ray's normal.
        let side = 1.0_f64.hypot(self.row_slope(j));
        let [from, to] = self.z.map(|z| (z / side).atan());
        let fastest = 0.0_f64.clamp(from, to);
        let slowest = if to.abs() > from.abs() { to } else { from };
        side / (0.5 * (fastest + slowest)).cos()
    }

    /// The weights of a row's texels in the prefiltering: lengths on the reference ray, metres, for an
    /// extinction of 0, otherwise what of the light is taken there.
    #[must_use]
    pub fn reference_weights(&self, j: usize, extinction: f64) -> Vec<f64> {
        let metres = self.reference_length(j);
        let first = if self.orthographic.is_some() { self.near * metres } else { 0.0 };
        let edge = |i: usize| if i == 0 { 0.0 } else { self.x_of(i as f64) * metres - first };
        let weight = |i: usize| {
            let (from, to) = (edge(i), edge(i + 1));
            if extinction == 0.0 {
                return to - from;
            }
            (-extinction * from).exp() * -(-extinction * (to - from)).exp_m1()
        };
        (0..self.width).map(weight).collect()
    }

    /// The rectified map of a directional light's shadow maps, row-major; `edge` as in
    /// [`super::rectify`].
    #[must_use]
    pub fn rectify(&self, maps: &[ShadowMap<'_>], edge: f64) -> Vec<RectifiedTexel> {
        let views = ShadowViews::new(maps);
        crate::parallel::rows(self.height, |j| {
            let slope = self.row_slope(j);
            let texel = |i: usize| {
                let x = self.x_of(i as f64 + 0.5);
                let y = if self.orthographic.is_some() { slope } else { slope * x };
                let on_light_ray = self.origin + self.axes[0] * x + self.axes[1] * y;
                views.look_up(on_light_ray, edge, |blocker| {
                    blocker.map_or(1.0, |blocker| {
                        // On the light ray, so that X is that of the texel.
                        let z = (blocker - self.origin).dot(self.axes[2]);
                        let slope = self.orthographic.map_or(z / x, |drift| z - x * drift.z_over_x);
                        self.depth(slope)
                    })
                })
            };
            (0..self.width).map(texel).collect::<Vec<_>>()
        })
        .concat()
    }

    /// Exact visibility of the part of a view ray in the medium over a rectified map (row-major),
    /// interpolated between the two rows about it.
    ///
    /// # Panics
    /// If the map has another size.
    #[must_use]
    pub fn visibility<T: Copy + Into<f64>>(&self, map: &[T], ray: &ViewRay, extinction: f64) -> Visibility {
        assert_eq!(map.len(), self.width * self.height, "size of the rectified map");
        let slopes = self.slopes(ray.at(1.0));
        // Where the ray begins, in the distances of the edges.
        let start = self.orthographic.map_or(0.0, |drift| self.coordinates(ray.origin)[0] / drift.x_over_t);
        let stretch = Stretch {
            z: self.depth(slopes[1]).clamp(GUARD[0], GUARD[1]),
            begin: start + ray.begin,
            end: start + ray.end,
            extinction,
        };
        let edges = self.edges(slopes);
        let (first, second, share) = self.rows(slopes[0]);
        let at = |j: usize| stretch_visibility(&map[j * self.width..(j + 1) * self.width], &edges, stretch);
        let (a, b) = (at(first), at(second));
        Visibility {
            average: a.average * (1.0 - share) + b.average * share,
            weighted: a.weighted * (1.0 - share) + b.weighted * share,
        }
    }
}

/// The exact picture over projective rows, of every `stride`-th pixel in x and y.
///
/// # Panics
/// For a map or depth buffer of another size than stated, and a stride of 0.
#[must_use]
pub fn projective_picture<T: Copy + Into<f64> + Sync>(
    scene: &Scene<'_>,
    projective: &Projective,
    map: &[T],
    start: Start,
    stride: usize,
) -> Picture {
    let extinction = scene.medium.extinction;
    scene.evaluate(stride, start, |ray| projective.visibility(map, ray, extinction))
}

/// The normalised sum of the two corner rays that are farthest apart as seen along the light.
fn bisectrix(camera: &Camera, l: Vec3) -> Vec3 {
    let corners = camera.corners().map(|corner| corner.without(l).normalised());
    let mut best = (f64::INFINITY, corners[0]);
    for i in 0..4 {
        for j in 0..i {
            let cosine = corners[i].dot(corners[j]);
            if cosine < best.0 {
                best = (cosine, (corners[i] + corners[j]).normalised());
            }
        }
    }
    best.1
}

fn axes(l: Vec3, x: Vec3) -> [Vec3; 3] {
    let z = -l;
    [x, z.cross(x), z]
}

fn coordinates(axes: [Vec3; 3], v: Vec3) -> [f64; 3] {
    axes.map(|axis| v.dot(axis))
}

#[cfg(test)]
mod tests;
