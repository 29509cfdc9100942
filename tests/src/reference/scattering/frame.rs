// SPDX-License-Identifier: MIT OR Apache-2.0
//! The frame of the angle map: polar coordinates about the axis through the eye along the light.

use crate::linear::Vec3;
use crate::reference::camera::Camera;

/// `docs/src/rectification.md`, "Frame". `(a, b, l)` is orthonormal and right-handed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// The eye, world, metres.
    pub eye: Vec3,
    /// Unit vector towards the light.
    pub l: Vec3,
    /// Unit vector of azimuth 0.
    pub a: Vec3,
    /// Unit vector of azimuth π/2, `l × a`.
    pub b: Vec3,
}

/// A point in the frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Polar {
    /// Distance from the axis, metres.
    pub r: f64,
    /// Azimuth, radians, (−π, π].
    pub phi: f64,
    /// Angle from the direction towards the light, radians, [0, π].
    pub theta: f64,
}

impl Frame {
    /// The frame of a camera and a direction towards the light (of any length).
    #[must_use]
    pub fn new(camera: &Camera, towards_light: Vec3) -> Self {
        let l = towards_light.normalised();
        let forward = camera.forward.without(l);
        let axis = if forward.length() < 1e-3 { camera.right.without(l) } else { forward };
        let a = axis.normalised();
        Self { eye: camera.eye, l, a, b: l.cross(a) }
    }

    /// A world point in the frame.
    #[must_use]
    pub fn polar(&self, point: Vec3) -> Polar {
        self.polar_direction(point - self.eye)
    }

    /// The end of a vector from the eye in the frame.
    #[must_use]
    pub fn polar_direction(&self, v: Vec3) -> Polar {
        let h = v.dot(self.l);
        let r = (v - self.l * h).length();
        Polar { r, phi: v.dot(self.b).atan2(v.dot(self.a)), theta: r.atan2(h) }
    }

    /// The unit vector at right angles to the light of an azimuth.
    #[must_use]
    pub fn radial(&self, phi: f64) -> Vec3 {
        self.a * phi.cos() + self.b * phi.sin()
    }

    /// The unit direction of a view ray.
    #[must_use]
    pub fn direction(&self, phi: f64, theta: f64) -> Vec3 {
        self.l * theta.cos() + self.radial(phi) * theta.sin()
    }

    /// The world point of polar coordinates, `theta` in (0, π).
    #[must_use]
    pub fn point(&self, polar: Polar) -> Vec3 {
        self.eye + self.radial(polar.phi) * polar.r + self.l * (polar.r / polar.theta.tan())
    }
}
