// SPDX-License-Identifier: MIT OR Apache-2.0
//! Random numbers, directions, cameras and lights.

use airlight_tests::linear;
use airlight_tests::reference::camera::{self, Camera as ReferenceCamera};

/// Uniform random numbers, the same from run to run.
pub struct Random(pub u64);

impl Random {
    /// In [0, 1).
    pub fn unit(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// In [low, high).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// In [low, high), the logarithm uniform.
    pub fn magnitude(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    /// 0 .. count − 1.
    pub fn below(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }

    /// All 32 bits.
    pub fn bits(&mut self) -> u32 {
        (self.unit() * 4_294_967_296.0) as u32
    }

    /// A unit vector.
    pub fn direction(&mut self) -> linear::Vec3 {
        loop {
            let v = [0; 3].map(|_| self.between(-1.0, 1.0));
            let v = linear::Vec3::from(v);
            if (0.01..1.0).contains(&v.length()) {
                return v.normalised();
            }
        }
    }

    /// A perspective camera: any direction, any depth convention.
    pub fn camera(&mut self, aspect: f64) -> ReferenceCamera {
        let eye = self.direction() * self.between(0.0, 30.0);
        ReferenceCamera::perspective(&camera::View {
            eye,
            target: eye + self.direction(),
            up: self.direction(),
            fov_y: self.between(0.2, 2.2),
            aspect,
            near: 0.1,
            far: if self.unit() < 0.3 { f64::INFINITY } else { self.between(5.0, 200.0) },
            reversed: self.unit() < 0.5,
        })
    }

    /// A direction towards a light: in the picture, behind, at a corner, an edge or the middle of it,
    /// at right angles to the view, or anywhere.
    pub fn light(&mut self, camera: &ReferenceCamera) -> linear::Vec3 {
        let inside = [self.between(-1.0, 1.0), self.between(-1.0, 1.0)];
        match self.below(10) {
            0 | 1 => camera.ray(inside),
            2 | 3 => -camera.ray(inside),
            4 => camera.ray([inside[0].signum(), inside[1]]),
            5 => camera.ray([inside[0].signum(), inside[1].signum()]),
            6 if inside[0] > 0.0 => camera.forward,
            6 => -camera.forward,
            7 => camera.up,
            _ => self.direction(),
        }
    }
}
