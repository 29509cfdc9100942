// SPDX-License-Identifier: MIT OR Apache-2.0
//! Scenes for the unit tests of this folder.

use crate::linear::{Mat4, Vec3};
use crate::reference::camera::{Camera, View};

/// Uniform numbers in [0, 1).
pub(super) struct Random(pub u64);

impl Random {
    pub(super) fn unit(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    pub(super) fn direction(&mut self) -> Vec3 {
        loop {
            let v = Vec3::new(self.between(-1.0, 1.0), self.between(-1.0, 1.0), self.between(-1.0, 1.0));
            if (0.01..1.0).contains(&v.length()) {
                return v.normalised();
            }
        }
    }

    pub(super) fn camera(&mut self) -> Camera {
        let eye = self.direction() * self.between(0.0, 30.0);
        Camera::perspective(&View {
            eye,
            target: eye + self.direction(),
            up: self.direction(),
            fov_y: self.between(0.2, 2.2),
            aspect: self.between(0.5, 2.5),
            near: 0.1,
            far: if self.unit() < 0.3 { f64::INFINITY } else { self.between(5.0, 200.0) },
            reversed: self.unit() < 0.5,
        })
    }

    /// A camera and a direction towards the light, which is in the picture (or its antipode is) for
    /// one in four each.
    pub(super) fn camera_and_light(&mut self) -> (Camera, Vec3) {
        let camera = self.camera();
        let ndc = [self.between(-1.0, 1.0), self.between(-1.0, 1.0)];
        let light = match (self.unit() * 4.0) as u32 {
            0 => camera.ray(ndc),
            1 => -camera.ray(ndc),
            _ => self.direction(),
        };
        (camera, light)
    }
}

/// The clip matrix of an orthographic light: `half` metres to every side of `centre` and along the
/// light.
pub(super) fn light_matrix(towards_light: Vec3, centre: Vec3, half: f64, far_depth: f64) -> Mat4 {
    let l = towards_light.normalised();
    let other = if l.y.abs() > 0.9 { Vec3::new(0.0, 0.0, -1.0) } else { Vec3::new(0.0, 1.0, 0.0) };
    let right = other.cross(l).normalised();
    let up = l.cross(right);
    let row = |d: Vec3, s: f64, shift: f64| [s * d.x, s * d.y, s * d.z, shift - s * d.dot(centre)];
    let along = if far_depth > 0.5 { -0.5 } else { 0.5 };
    Mat4::from_rows([
        row(right, 1.0 / half, 0.0),
        row(up, 1.0 / half, 0.0),
        row(l, along / half, 0.5),
        [0.0, 0.0, 0.0, 1.0],
    ])
}

/// A shadow map of a horizontal roof over x > 0 at the height 5, rendered texel by texel.
pub(super) fn roof(clip_from_world: Mat4, far_depth: f64, side: usize) -> Vec<f32> {
    let world_from_clip = clip_from_world.inverse().expect("regular");
    (0..side * side)
        .map(|i| {
            let u = ((i % side) as f64 + 0.5) / side as f64 * 2.0 - 1.0;
            let v = 1.0 - ((i / side) as f64 + 0.5) / side as f64 * 2.0;
            let [near, far] = [0.0, 1.0].map(|z| world_from_clip.apply([u, v, z, 1.0]));
            let t = (5.0 - near[1]) / (far[1] - near[1]);
            let x = near[0] + (far[0] - near[0]) * t;
            (if x > 0.0 { t } else { far_depth }) as f32
        })
        .collect()
}

/// A shadow map of a horizontal plate over x > 0 at a height, of a light that looks down on it from a
/// position; rendered texel by texel.
pub(super) fn plate(light: &Camera, height: f64, side: usize) -> Vec<f32> {
    (0..side * side)
        .map(|i| {
            let ndc = Camera::pixel_ndc(i % side, i / side, side, side);
            let (origin, direction) = (light.origin(ndc), light.ray(ndc));
            let t = (height - origin.y) / direction.y;
            let hit = origin + direction * t;
            let depth =
                light.project(hit).filter(|_| t > 0.0 && hit.x > 0.0).map_or(light.far_depth, |p| p[2]);
            depth as f32
        })
        .collect()
}

/// The clip spaces of a light at a point that looks into all six directions.
pub(super) fn faces(position: Vec3, reversed: bool) -> [Camera; 6] {
    let x = Vec3::new(1.0, 0.0, 0.0);
    let y = Vec3::new(0.0, 1.0, 0.0);
    let z = Vec3::new(0.0, 0.0, 1.0);
    [(x, y), (-x, y), (y, z), (-y, z), (z, y), (-z, y)].map(|(forward, up)| {
        Camera::perspective(&View {
            eye: position,
            target: position + forward,
            up,
            fov_y: 0.5 * std::f64::consts::PI,
            aspect: 1.0,
            near: 0.05,
            far: 100.0,
            reversed,
        })
    })
}

/// The mean of a function over the midpoints of equal steps from one place to another.
pub(super) fn stepped(from: f64, to: f64, steps: usize, function: impl Fn(f64) -> f64) -> f64 {
    let step = (to - from) / steps as f64;
    (0..steps).map(|i| function(from + (i as f64 + 0.5) * step)).sum::<f64>() / steps as f64
}
