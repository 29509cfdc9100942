// SPDX-License-Identifier: MIT OR Apache-2.0
//! How far an eye stands back, and how high a picture by parallel rays is, so that given points are in the picture.

use glam::Vec3;

/// Share of the picture that points fill at most.
pub const FILLED: f32 = 0.98;

/// A picture around a place.
pub struct Fit {
    /// What lies in its middle, metres.
    pub center: Vec3,
    /// Unit vector from there to the eye; not upright.
    pub from: Vec3,
    /// Width to height.
    pub aspect: f32,
}

impl Fit {
    /// Right and up of the eye.
    fn across(&self) -> [Vec3; 2] {
        let right = Vec3::Y.cross(self.from).normalize();
        [right, self.from.cross(right)]
    }

    /// Half the height of the picture that just holds a point, metres.
    fn half_height(&self, point: Vec3) -> f32 {
        let [right, up] = self.across();
        let from = point - self.center;
        (from.dot(right).abs() / self.aspect).max(from.dot(up).abs())
    }

    /// The height of a picture by parallel rays that holds all points, metres.
    pub fn height(&self, points: impl IntoIterator<Item = Vec3>) -> f32 {
        2.0 * points.into_iter().map(|point| self.half_height(point)).fold(1e-4, f32::max) / FILLED
    }

    /// How far from the middle the eye sees all points, metres. `field_of_view`: vertical, degrees.
    pub fn distance(&self, points: impl IntoIterator<Item = Vec3>, field_of_view: f32) -> f32 {
        let tangent = FILLED * (0.5 * field_of_view.to_radians()).tan();
        let away = |point: Vec3| (point - self.center).dot(self.from) + self.half_height(point) / tangent;
        points.into_iter().map(away).fold(1e-3, f32::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::{Camera, DepthRange, OrthographicView, PerspectiveView, View};
    use crate::data::Bounds;

    #[test]
    fn boxes_fill_the_picture_and_no_more() {
        for (size, aspect) in
            [(Vec3::new(6.0, 3.0, 5.0), 1.8), (Vec3::new(2.0, 5.0, 2.0), 1.8), (Vec3::ONE, 0.5)]
        {
            let bounds = Bounds { min: Vec3::ZERO, max: size };
            let (target, near, far, depth) = (bounds.center(), 0.1, 100.0, DepthRange::Forward);
            let from = Vec3::new(-0.4, 0.1, 1.0).normalize();
            let fit = Fit { center: target, from, aspect };
            let eye = target + from * fit.distance(bounds.corners(), 40.0);
            let height = fit.height(bounds.corners());
            let views: [View; 2] = [
                PerspectiveView { eye, target, field_of_view: 40.0, near, far, depth }.into(),
                OrthographicView { eye, target, height, near, far, depth }.into(),
            ];
            for view in views {
                let camera = Camera::new(&view, [(1000.0 * aspect) as u32, 1000]).expect("a camera");
                let seen = bounds.corners().map(|corner| camera.clip_from_world.project_point3(corner));
                let most = seen.iter().map(|at| at.x.abs().max(at.y.abs())).fold(0.0, f32::max);
                assert!((most - FILLED).abs() < 0.01, "{size} fills {most}");
            }
        }
    }
}
