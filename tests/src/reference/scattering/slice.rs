// SPDX-License-Identifier: MIT OR Apache-2.0
//! Rows and slices of `docs/src/rectification.md`. Where the page has closed forms, the bounds are
//! searched for here: angles by bisection of the clip-space side tests, radii and sines by sampling
//! the slice and refining.

use std::f64::consts::PI;

use super::frame::Frame;
use crate::linear::Vec3;
use crate::reference::camera::Camera;

/// Depths of the least and greatest angle of a slice; beyond them lie the guard bands.
pub const GUARD: [f64; 2] = [0.05, 0.95];

/// A slice whose plane is that of a side of the frustum within this (sine of the angle between the
/// planes) takes no bound from that side, whose test would be the sign of rounding errors.
const SAME_PLANE: f64 = 1e-4;

/// One row of the rectified map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slice {
    /// Azimuth, radians.
    pub phi: f64,
    /// Least angle of the slice's view rays in the picture, radians.
    pub theta_min: f64,
    /// Greatest angle, radians.
    pub theta_max: f64,
    /// Greatest radius, metres.
    pub r_max: f64,
    /// Least `sin(theta)` over the slice, but at least 0.1.
    pub k_min: f64,
    /// Greatest `sin(theta)` over the slice.
    pub k_max: f64,
}

impl Slice {
    /// Depth in [0, 1] of an angle, of blockers and view rays alike.
    #[must_use]
    pub fn depth(&self, theta: f64) -> f64 {
        let unit = (theta - self.theta_min) / (self.theta_max - self.theta_min);
        (GUARD[0] + (GUARD[1] - GUARD[0]) * unit).clamp(0.0, 1.0)
    }

    /// The inverse of [`Self::depth`], radians; beyond the bounds for depths in the guard bands.
    #[must_use]
    pub fn theta(&self, depth: f64) -> f64 {
        let unit = (depth - GUARD[0]) / (GUARD[1] - GUARD[0]);
        self.theta_min + (self.theta_max - self.theta_min) * unit
    }

    /// `k` of the reference ray of the prefiltering's weights: the sine halfway between the angles of the rays that
    /// cross a texel fastest and slowest, at least 0.1 (thesis 4.3.2, the bisectrix).
    #[must_use]
    pub fn k(&self) -> f64 {
        let right_angle = 0.5 * PI;
        let fastest = right_angle.clamp(self.theta_min, self.theta_max);
        let from_right_angle = |theta: f64| (theta - right_angle).abs();
        let slowest = if from_right_angle(self.theta_min) > from_right_angle(self.theta_max) {
            self.theta_min
        } else {
            self.theta_max
        };
        (0.5 * (fastest + slowest)).sin().max(0.1)
    }

    /// Radius that a texel of a row of `width` covers, metres.
    #[must_use]
    pub fn texel(&self, width: usize) -> f64 {
        self.r_max / width as f64
    }
}

/// The rectification of one camera, light and map.
#[derive(Clone, Debug, PartialEq)]
pub struct Rectification {
    /// The polar frame.
    pub frame: Frame,
    /// Whether the rows go round the full circle and wrap.
    pub full_circle: bool,
    /// Azimuth of the first row, radians; −π for the full circle.
    pub phi_min: f64,
    /// Azimuth of the last row, radians; π, which is the first row again, for the full circle.
    pub phi_max: f64,
    /// Texels of a row, `W`.
    pub width: usize,
    /// The rows, `H` of them. A caller may replace them by those that it read back.
    pub slices: Vec<Slice>,
}

impl Rectification {
    /// The rectification of a camera, a direction towards the light, the greatest distance along
    /// view rays (metres, may be infinite if the far plane is not) and a map of `width` texels in
    /// `height` rows.
    ///
    /// # Panics
    /// For an empty map, and if neither the far plane nor `distance_limit` is finite.
    #[must_use]
    pub fn new(
        camera: &Camera,
        towards_light: Vec3,
        distance_limit: f64,
        width: usize,
        height: usize,
    ) -> Self {
        assert!(width > 0 && height > 0, "an empty map");
        assert!(camera.far.is_finite() || distance_limit.is_finite(), "rays without end");
        let frame = Frame::new(camera, towards_light);
        let sides = camera.side_normals().map(|n| n.dot(frame.l));
        let least = sides.into_iter().fold(f64::INFINITY, f64::min);
        let greatest = sides.into_iter().fold(f64::NEG_INFINITY, f64::max);
        let full_circle = least > -1e-3 || greatest < 1e-3;
        let corners = camera.corners().map(|d| frame.polar_direction(d).phi);
        let (phi_min, phi_max) = if full_circle {
            (-PI, PI)
        } else {
            (
                corners.into_iter().fold(f64::INFINITY, f64::min),
                corners.into_iter().fold(f64::NEG_INFINITY, f64::max),
            )
        };
        let steps = if full_circle { height } else { (height - 1).max(1) };
        let slices = crate::parallel::rows(height, |j| {
            let phi = phi_min + (phi_max - phi_min) * j as f64 / steps as f64;
            slice(camera, &frame, phi, distance_limit)
        });
        Self { frame, full_circle, phi_min, phi_max, width, slices }
    }

    /// The two rows about an azimuth (radians), and the share of the second in [0, 1].
    #[must_use]
    pub fn rows(&self, phi: f64) -> (usize, usize, f64) {
        let height = self.slices.len();
        let unit = (phi - self.phi_min) / (self.phi_max - self.phi_min);
        if self.full_circle {
            let y = unit * height as f64;
            let first = y.floor();
            let row = |y: f64| (y as i64).rem_euclid(height as i64) as usize;
            (row(first), row(first + 1.0), y - first)
        } else {
            let last = height - 1;
            let y = (unit * last as f64).clamp(0.0, last as f64);
            let first = (y.floor() as usize).min(last.saturating_sub(1));
            (first, (first + 1).min(last), y - first as f64)
        }
    }
}

fn slice(camera: &Camera, frame: &Frame, phi: f64, distance_limit: f64) -> Slice {
    let (theta_min, theta_max) = angles(camera, frame, phi);
    let (theta_min, theta_max) = if theta_max - theta_min < 1e-3 {
        let middle = (0.5 * (theta_min + theta_max)).clamp(5e-4, PI - 5e-4);
        (middle - 5e-4, middle + 5e-4)
    } else {
        (theta_min, theta_max)
    };
    let k_max = greatest(f64::sin, theta_min, theta_max);
    let k_min = -greatest(|theta| -theta.sin(), theta_min, theta_max);
    // Where a ray meets the far plane, its distance from the axis.
    let reach = |theta: f64| {
        let direction = frame.direction(phi, theta);
        let along = direction.dot(camera.forward);
        if along <= 0.0 || camera.far.is_infinite() {
            return f64::INFINITY;
        }
        let end = camera.eye + direction * (camera.far / along);
        frame.polar(end).r.copysign(theta.sin())
    };
    let limited = if k_max > 0.0 { distance_limit * k_max } else { 0.0 };
    let r_max = greatest(reach, theta_min, theta_max).min(limited);
    Slice { phi, theta_min, theta_max, r_max, k_min: k_min.max(0.1), k_max: k_max.max(0.1) }
}

/// The angles of the rays of a slice that pass every side of the frustum. Each side lets pass all
/// rays from some angle on, or all up to one; past each other they cross where the slice misses
/// the picture.
fn angles(camera: &Camera, frame: &Frame, phi: f64) -> (f64, f64) {
    let clip = |direction: Vec3| camera.clip_from_world.apply_direction(direction);
    let radial = clip(frame.radial(phi));
    let axial = clip(frame.l);
    let (mut theta_min, mut theta_max) = (0.0_f64, PI);
    for (axis, sign) in [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0)] {
        let normal = camera.clip_from_world.row3(3) + camera.clip_from_world.row3(axis) * sign;
        let test = |v: [f64; 4]| (v[3] + sign * v[axis]) / normal.length();
        let (towards, outwards) = (test(axial), test(radial));
        if towards == 0.0 || towards.hypot(outwards) < SAME_PLANE {
            continue;
        }
        let passes = |theta: f64| test(clip(frame.direction(phi, theta))) >= 0.0;
        let (mut below, mut above) = (0.0, PI);
        for _ in 0..60 {
            let middle = 0.5 * (below + above);
            if passes(middle) == (towards > 0.0) {
                below = middle;
            } else {
                above = middle;
            }
        }
        if towards > 0.0 {
            theta_max = theta_max.min(below);
        } else {
            theta_min = theta_min.max(above);
        }
    }
    (theta_min, theta_max)
}

/// The greatest value of a function of one peak or none between two angles, ends included.
fn greatest(function: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    const SAMPLES: i32 = 64;
    let at = |i: f64| from + (to - from) * i / f64::from(SAMPLES);
    let (mut best, mut value) = (0, f64::NEG_INFINITY);
    for i in 0..=SAMPLES {
        let found = function(at(f64::from(i)));
        if found > value {
            (best, value) = (i, found);
        }
    }
    let (mut low, mut high) = (at(f64::from((best - 1).max(0))), at(f64::from((best + 1).min(SAMPLES))));
    for _ in 0..60 {
        let (left, right) = ((2.0 * low + high) / 3.0, (low + 2.0 * high) / 3.0);
        let (at_left, at_right) = (function(left), function(right));
        value = value.max(at_left).max(at_right);
        if at_left < at_right { low = left } else { high = right }
    }
    value
}

#[cfg(test)]
mod tests;
