// SPDX-License-Identifier: MIT OR Apache-2.0
//! The picture without rectification: every view ray through the original shadow map, texel by
//! texel, exact in f64. What a method over the rectified map differs from this by is the error of
//! rectification.

use super::picture::{Picture, Scene, Start};
use super::shadow_map::ShadowMap;
use super::visibility::Visibility;
use crate::linear::Vec3;

/// The exact picture by the shadow map itself (nearest texel, no bias, lit outside of it), of
/// every `stride`-th pixel in x and y.
///
/// # Panics
/// If the shadow map's matrix is not orthographic, a view ray has no end, sizes differ from those
/// stated, or the stride is 0.
#[must_use]
pub fn shadow_map_picture(scene: &Scene<'_>, shadow_map: &ShadowMap<'_>, stride: usize) -> Picture {
    assert_eq!(shadow_map.depth.len(), shadow_map.width * shadow_map.height);
    let [x, y, z, w] = shadow_map.clip_from_world.row(3);
    assert!([x, y, z] == [0.0; 3] && w > 0.0, "an orthographic shadow map");
    scene.evaluate(stride, Start::Eye, |ray| {
        assert!(ray.end.is_finite(), "a view ray without end");
        let run = Run::new(shadow_map, ray.origin, ray.direction);
        run.visibility(ray.end, scene.medium.extinction)
    })
}

/// A view ray in the shadow map: texel coordinates and depth, affine in the distance.
struct Run<'a> {
    map: &'a ShadowMap<'a>,
    start: [f64; 3],
    slope: [f64; 3],
    /// 1 where depth grows away from the light, −1 where it falls.
    away: f64,
}

impl<'a> Run<'a> {
    fn new(map: &'a ShadowMap<'a>, eye: Vec3, direction: Vec3) -> Self {
        let start = map.project(eye);
        let [x, y, z, _] = map.clip_from_world.apply_direction(direction);
        let w = map.clip_from_world.row(3)[3];
        let slope = [0.5 * x / w * map.width as f64, -0.5 * y / w * map.height as f64, z / w];
        let away = if map.far_depth > 0.5 { 1.0 } else { -1.0 };
        Self { map, start, slope, away }
    }

    fn visibility(&self, distance: f64, extinction: f64) -> Visibility {
        let mut means = Means::new(distance, extinction);
        let size = [self.map.width as f64, self.map.height as f64];
        // The part of the ray inside the map.
        let (mut enter, mut leave) = (0.0_f64, distance);
        for ((start, slope), size) in self.start.into_iter().zip(self.slope).zip(size) {
            if slope == 0.0 {
                if start < 0.0 || start >= size {
                    leave = f64::NEG_INFINITY;
                }
                continue;
            }
            let (a, b) = (-start / slope, (size - start) / slope);
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
        if enter >= leave {
            means.lit(0.0, distance);
            return means.finish();
        }
        means.lit(0.0, enter);
        let mut texel = [0, 1].map(|axis| {
            let at = self.start[axis] + self.slope[axis] * enter;
            at.floor().clamp(0.0, size[axis] - 1.0)
        });
        let mut from = enter;
        while from < leave {
            // Where the ray leaves this texel, and across which edge.
            let edge = [0, 1].map(|axis| match self.slope[axis] {
                slope if slope > 0.0 => (texel[axis] + 1.0 - self.start[axis]) / slope,
                slope if slope < 0.0 => (texel[axis] - self.start[axis]) / slope,
                _ => f64::INFINITY,
            });
            let axis = usize::from(edge[1] < edge[0]);
            let to = edge[axis].clamp(from, leave);
            self.texel(&mut means, texel, from, to);
            from = to;
            texel[axis] += self.slope[axis].signum();
            if texel[axis] < 0.0 || texel[axis] >= size[axis] {
                break;
            }
        }
        means.lit(from, distance);
        means.finish()
    }

    /// The lit part of the ray between two distances over one texel: depth is affine there.
    fn texel(&self, means: &mut Means, texel: [f64; 2], from: f64, to: f64) {
        let Some(stored) = self.map.texel(texel[0] as i64, texel[1] as i64) else {
            means.lit(from, to);
            return;
        };
        let behind = |t: f64| self.away * (self.start[2] + self.slope[2] * t - stored);
        let crossing = || ((stored - self.start[2]) / self.slope[2]).clamp(from, to);
        match (behind(from) <= 0.0, behind(to) <= 0.0) {
            (true, true) => means.lit(from, to),
            (true, false) => means.lit(from, crossing()),
            (false, true) => means.lit(crossing(), to),
            (false, false) => {}
        }
    }
}

/// Both means of visibility, from the lit intervals in order; adjoining ones become one.
struct Means {
    distance: f64,
    extinction: f64,
    run: (f64, f64),
    length: f64,
    weight: f64,
}

impl Means {
    fn new(distance: f64, extinction: f64) -> Self {
        Self { distance, extinction, run: (0.0, 0.0), length: 0.0, weight: 0.0 }
    }

    fn lit(&mut self, from: f64, to: f64) {
        if to <= from {
            return;
        }
        if from == self.run.1 {
            self.run.1 = to;
        } else {
            self.flush();
            self.run = (from, to);
        }
    }

    fn flush(&mut self) {
        let (from, to) = self.run;
        self.length += to - from;
        let taken = -(-self.extinction * (to - from)).exp_m1();
        self.weight += (-self.extinction * from).exp() * taken;
    }

    fn finish(mut self) -> Visibility {
        self.flush();
        if self.distance <= 0.0 {
            return Visibility { average: 1.0, weighted: 1.0 };
        }
        let average = self.length / self.distance;
        let total = -(-self.extinction * self.distance).exp_m1();
        let weighted = if total == 0.0 { average } else { self.weight / total };
        Visibility { average, weighted }
    }
}

#[cfg(test)]
mod tests;
