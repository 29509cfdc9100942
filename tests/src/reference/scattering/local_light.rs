// SPDX-License-Identifier: MIT OR Apache-2.0
//! Lights at a point.

use super::picture::ViewRay;
use crate::linear::Vec3;

/// Which way a light at a point shines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cone {
    /// Everywhere.
    Point,
    /// Into a cone.
    Spot {
        /// The reverse of the axis along which it shines, of any length.
        direction: Vec3,
        /// Cosines of the half angles inside which it shines fully, and outside which not at all.
        cosines: [f64; 2],
    },
}

/// A light at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalLight {
    /// Where it is, world, metres.
    pub position: Vec3,
    /// Radius, metres, positive: irradiance is `I f / (d² + radius²)`.
    pub radius: f64,
    /// Radiant intensity I, scene-linear RGB.
    pub intensity: [f64; 3],
    /// Which way it shines.
    pub cone: Cone,
}

impl LocalLight {
    /// The fall-off with the angle, [0, 1], of a light ray's direction (from the light, any length).
    #[must_use]
    pub fn fall_off(&self, direction: Vec3) -> f64 {
        let Cone::Spot { direction: reverse, cosines: [inner, outer] } = self.cone else { return 1.0 };
        let cosine = -direction.normalised().dot(reverse.normalised());
        if cosine <= outer {
            return 0.0;
        }
        let x = ((cosine - outer) / (inner - outer)).clamp(0.0, 1.0);
        if inner > outer { x * x * (3.0 - 2.0 * x) } else { 1.0 }
    }

    /// The distances, metres from a view ray's origin, at which it may enter or leave the inner and
    /// outer cone.
    #[must_use]
    pub fn creases(&self, ray: &ViewRay) -> Vec<f64> {
        let Cone::Spot { direction, cosines } = self.cone else { return Vec::new() };
        let axis = -direction.normalised();
        let (start, slope) = (ray.origin - self.position, ray.direction);
        // (v·axis)² = cos² v·v at v = start + t slope.
        cosines
            .into_iter()
            .flat_map(|cosine| {
                let form = |u: Vec3, v: Vec3| u.dot(axis) * v.dot(axis) - cosine * cosine * u.dot(v);
                let (a, b, c) = (form(slope, slope), form(start, slope), form(start, start));
                let root = (b * b - a * c).max(0.0).sqrt();
                [(-b - root) / a, (-b + root) / a]
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fall_off_is_smooth_between_the_cones() {
        let (inner, outer) = (0.3_f64, 0.5_f64);
        let spot = |inner: f64, outer: f64| LocalLight {
            position: Vec3::default(),
            radius: 0.1,
            intensity: [1.0; 3],
            cone: Cone::Spot { direction: Vec3::new(0.0, 2.0, 0.0), cosines: [inner.cos(), outer.cos()] },
        };
        let at =
            |angle: f64| spot(inner, outer).fall_off(Vec3::new(3.0 * angle.sin(), -3.0 * angle.cos(), 0.0));
        assert_eq!([at(0.0), at(0.299), at(0.501), at(3.0)], [1.0, 1.0, 0.0, 0.0]);
        let half = (0.5 * (inner.cos() + outer.cos())).acos();
        assert!((at(half) - 0.5).abs() < 1e-12);
        let sharp = spot(0.4, 0.4);
        assert_eq!(sharp.fall_off(Vec3::new(0.3_f64.sin(), -0.3_f64.cos(), 0.0)), 1.0);
        assert_eq!(sharp.fall_off(Vec3::new(0.5_f64.sin(), -0.5_f64.cos(), 0.0)), 0.0);
    }
}
