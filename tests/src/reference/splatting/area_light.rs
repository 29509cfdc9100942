// SPDX-License-Identifier: MIT OR Apache-2.0
//! Shadows of square lights, ray by ray.

use crate::linear::Vec3;

/// A square light that faces what it shines on.
#[derive(Clone, Copy, Debug)]
pub enum Square {
    /// Far away; as wide as `angle`, radians, across its sides.
    Far {
        /// Unit vector TOWARDS its middle.
        towards: Vec3,
        /// From side to side, radians.
        angle: f64,
    },
    /// Near.
    Near {
        /// Its middle.
        middle: Vec3,
        /// Unit vector across it.
        facing: Vec3,
        /// Its side, metres.
        side: f64,
    },
}

fn across(axis: Vec3) -> [Vec3; 2] {
    let other = if axis.y.abs() > 0.9 { Vec3::new(1.0, 0.0, 0.0) } else { Vec3::new(0.0, 1.0, 0.0) };
    let first = axis.cross(other).normalised();
    [first, axis.cross(first)]
}

impl Square {
    /// Share of the light, of the midpoints of `samples` x `samples` squares of it, that a point sees past what is `blocked`: of a ray
    /// from a point in a direction up to a distance, metres.
    #[must_use]
    pub fn seen(&self, point: Vec3, samples: u32, blocked: impl Fn(Vec3, Vec3, f64) -> bool) -> f64 {
        let mut seen = 0_u32;
        for i in 0..samples * samples {
            let [u, v] = [i % samples, i / samples].map(|i| (f64::from(i) + 0.5) / f64::from(samples) - 0.5);
            let (direction, distance) = match *self {
                Self::Far { towards, angle } => {
                    let width = 2.0 * (angle / 2.0).tan();
                    let [right, up] = across(towards);
                    ((towards + right * (u * width) + up * (v * width)).normalised(), f64::INFINITY)
                }
                Self::Near { middle, facing, side } => {
                    let [right, up] = across(facing);
                    let way = middle + right * (u * side) + up * (v * side) - point;
                    (way.normalised(), way.length())
                }
            };
            seen += u32::from(!blocked(point, direction, distance));
        }
        f64::from(seen) / f64::from(samples * samples)
    }
}

/// Whether a ray meets a ball within a distance.
#[must_use]
pub fn meets_ball(middle: Vec3, radius: f64, origin: Vec3, direction: Vec3, distance: f64) -> bool {
    let to = middle - origin;
    let along = to.dot(direction);
    let square = radius * radius - (to.dot(to) - along * along);
    square > 0.0 && along + square.sqrt() > 0.0 && along - square.sqrt() < distance
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_half_plane_casts_a_linear_ramp() {
        let up = Vec3::new(0.0, 1.0, 0.0);
        // The half-plane x < 0 at height 0, seen from 2 m below it.
        let blocked =
            |origin: Vec3, direction: Vec3, _: f64| (origin + direction * (-origin.y / direction.y)).x < 0.0;
        let far = Square::Far { towards: up, angle: 0.2 };
        let near = Square::Near { middle: up * 3.0, facing: up, side: 0.6 };
        for (light, width) in [(far, 4.0 * 0.1_f64.tan()), (near, 0.4)] {
            for share in [0.1, 0.5, 0.8] {
                let point = Vec3::new((share - 0.5) * width, -2.0, 0.0);
                let seen = light.seen(point, 200, blocked);
                assert!((seen - share).abs() < 0.006, "{light:?}: {seen} of {share}");
            }
        }
    }

    #[test]
    fn balls_block_what_they_hide() {
        let (o, d) = (Vec3::new(0.0, 0.0, 0.0), Vec3::new(1.0, 0.0, 0.0));
        assert!(meets_ball(Vec3::new(3.0, 0.9, 0.0), 1.0, o, d, 10.0));
        assert!(!meets_ball(Vec3::new(3.0, 1.1, 0.0), 1.0, o, d, 10.0));
        assert!(!meets_ball(Vec3::new(3.0, 0.0, 0.0), 1.0, o, d, 1.9));
        assert!(!meets_ball(Vec3::new(-3.0, 0.0, 0.0), 1.0, o, d, 10.0));
    }
}
