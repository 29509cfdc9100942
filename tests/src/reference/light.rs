// SPDX-License-Identifier: MIT OR Apache-2.0
//! Irradiance of lights in clear air: inverse squares, cones, and the views of shadow maps.

use crate::linear::{Mat4, Vec3};

/// A light at infinity or at a point.
#[derive(Clone, Copy, Debug)]
pub enum Light {
    /// At infinity.
    Directional {
        /// Unit vector TOWARDS it.
        towards: Vec3,
    },
    /// At a point, into a cone.
    Spot {
        /// Where it is.
        position: Vec3,
        /// Unit vector along which it shines.
        axis: Vec3,
        /// Half angle of full light, radians.
        inner: f64,
        /// Half angle of no light, radians.
        outer: f64,
        /// Softens the fall-off, metres.
        radius: f64,
    },
    /// At a point, everywhere.
    Point {
        /// Where it is.
        position: Vec3,
        /// Softens the fall-off, metres.
        radius: f64,
    },
}

impl Light {
    /// Unit vector from `point` TOWARDS the light.
    #[must_use]
    pub fn towards(&self, point: Vec3) -> Vec3 {
        match self {
            Self::Directional { towards } => *towards,
            Self::Spot { position, .. } | Self::Point { position, .. } => (*position - point).normalised(),
        }
    }

    /// Angular fall-off at an angle from the axis, radians: the cubic Hermite blend of the cosines.
    #[must_use]
    pub fn cone(&self, angle: f64) -> f64 {
        let Self::Spot { inner, outer, .. } = self else { return 1.0 };
        if angle <= *inner {
            1.0
        } else if angle >= *outer {
            0.0
        } else {
            let t = (angle.cos() - outer.cos()) / (inner.cos() - outer.cos());
            3.0 * t.powi(2) - 2.0 * t.powi(3)
        }
    }

    /// Irradiance at normal incidence for unit radiance or intensity.
    #[must_use]
    pub fn irradiance(&self, point: Vec3) -> f64 {
        match self {
            Self::Directional { .. } => 1.0,
            Self::Spot { position, axis, radius, .. } => {
                let away = point - *position;
                let angle = away.cross(*axis).length().atan2(away.dot(*axis));
                self.cone(angle) / (away.dot(away) + radius * radius)
            }
            Self::Point { position, radius } => {
                let away = point - *position;
                1.0 / (away.dot(away) + radius * radius)
            }
        }
    }
}

/// The first of several views that contains a point, the point's normalised device coordinates there, and how far it is
/// inside or outside of the nearest border of any view that was tried, in units of half the view.
#[must_use]
pub fn first_view(clip_from_world: &[Mat4], point: Vec3) -> (Option<(usize, [f64; 3])>, f64) {
    let mut margin = f64::INFINITY;
    for (view, matrix) in clip_from_world.iter().enumerate() {
        let [x, y, z, w] = matrix.apply_point(point);
        margin = margin.min(w.abs());
        if w <= 0.0 {
            continue;
        }
        let reach = (x / w).abs().max((y / w).abs());
        margin = margin.min((reach - 1.0).abs());
        if reach <= 1.0 {
            return (Some((view, [x / w, y / w, z / w])), margin);
        }
    }
    (None, margin)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cone_is_full_inside_dark_outside_and_half_between() {
        let light = Light::Spot {
            position: Vec3::new(0.0, 2.0, 0.0),
            axis: Vec3::new(0.0, -1.0, 0.0),
            inner: 0.0,
            outer: 60_f64.to_radians(),
            radius: 0.0,
        };
        // Half way between the cosines 1 and 0.5.
        let angle = 0.75_f64.acos();
        assert!((light.cone(angle) - 0.5).abs() < 1e-12);
        let at = Vec3::new(2.0 * angle.tan(), 0.0, 0.0);
        let square = 4.0 / 0.75_f64.powi(2);
        assert!((light.irradiance(at) * square - 0.5).abs() < 1e-12);
        assert_eq!(light.irradiance(Vec3::new(0.0, 4.0, 0.0)), 0.0);
        assert!((light.irradiance(Vec3::new(0.0, 1.0, 0.0)) - 1.0).abs() < 1e-12);
    }
}
