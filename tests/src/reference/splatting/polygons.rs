// SPDX-License-Identifier: MIT OR Apache-2.0
//! Opaque triangles in a medium: every ray is tried against every triangle. No shadow maps, no heights.

use super::Scene;
use crate::linear::Vec3;
use crate::parallel;
use crate::reference::camera::Camera;
use crate::reference::light::Light;
use crate::reference::phase::henyey_greenstein;
use std::f64::consts::PI;

/// A triangle of one colour.
#[derive(Clone, Copy, Debug)]
pub struct Triangle {
    /// Its corners, metres.
    pub corners: [Vec3; 3],
    /// Normals at the corners, to either side.
    pub normals: [Vec3; 3],
    /// Linear RGB.
    pub color: [f64; 3],
}

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    /// Metres.
    pub distance: f64,
    /// Unit, to the side from which the ray comes.
    pub normal: Vec3,
    /// Linear RGB.
    pub color: [f64; 3],
}

impl Triangle {
    /// Where a ray of unit direction meets it, by the planes through its edges and the origin.
    fn hit(&self, origin: Vec3, direction: Vec3) -> Option<Hit> {
        let [a, b, c] = self.corners;
        let plane = (b - a).cross(c - a);
        let slope = plane.dot(direction);
        if slope.abs() < 1e-14 {
            return None;
        }
        let distance = plane.dot(a - origin) / slope;
        if distance <= 0.0 {
            return None;
        }
        let point = origin + direction * distance;
        let square = plane.dot(plane);
        let share = |from: Vec3, to: Vec3| (to - from).cross(point - from).dot(plane) / square;
        let shares = [share(b, c), share(c, a), share(a, b)];
        if shares.iter().any(|share| *share < 0.0) {
            return None;
        }
        let mut normal = Vec3::default();
        for (share, own) in shares.iter().zip(self.normals) {
            normal = normal + own * *share;
        }
        let normal = normal.normalised();
        // To the side of the face that is seen.
        let face = if slope < 0.0 { plane } else { plane * -1.0 };
        let normal = if normal.dot(face) >= 0.0 { normal } else { normal * -1.0 };
        Some(Hit { distance, normal, color: self.color })
    }
}

/// What surfaces do with light, by Phong.
#[derive(Clone, Copy, Debug)]
pub struct Reflection {
    /// Share of diffuse reflection.
    pub diffuse: f64,
    /// Share of mirror-like reflection.
    pub specular: f64,
    /// Its exponent.
    pub shininess: f64,
}

/// A medium with surfaces in it.
#[derive(Clone, Debug)]
pub struct Mixed<'a> {
    /// The medium and the light.
    pub scene: Scene<'a>,
    /// Surfaces.
    pub triangles: &'a [Triangle],
    /// What they do with light.
    pub reflection: Reflection,
}

impl Mixed<'_> {
    /// The first surface along a ray.
    #[must_use]
    pub fn first(&self, origin: Vec3, direction: Vec3) -> Option<Hit> {
        let hits = self.triangles.iter().filter_map(|triangle| triangle.hit(origin, direction));
        hits.min_by(|a, b| a.distance.total_cmp(&b.distance))
    }

    fn limit(&self, point: Vec3) -> f64 {
        match self.scene.light {
            Light::Directional { .. } => f64::INFINITY,
            Light::Spot { position, .. } | Light::Point { position, .. } => (position - point).length(),
        }
    }

    /// Whether no surface lies between a point and the light.
    #[must_use]
    pub fn sees_light(&self, point: Vec3) -> bool {
        let blocker = self.first(point, self.scene.light.towards(point));
        blocker.is_none_or(|hit| hit.distance >= self.limit(point))
    }

    /// What arrives of the light at a point that is not on a surface, as a share of its radiance or intensity.
    fn arriving(&self, point: Vec3) -> f64 {
        let clear = self.scene.light.irradiance(point);
        if clear <= 0.0 || !self.sees_light(point) {
            return 0.0;
        }
        let towards = self.scene.light.towards(point);
        clear * (-self.scene.optical_depth(point, towards, self.limit(point))).exp()
    }

    /// Radiance of the surface that a ray meets.
    fn surface(&self, origin: Vec3, direction: Vec3, hit: &Hit) -> [f64; 3] {
        // Off the surface by next to nothing, so that it does not shadow itself.
        let point = origin + direction * hit.distance + hit.normal * 1e-6;
        let towards = self.scene.light.towards(point);
        let cosine = hit.normal.dot(towards);
        let arriving = if cosine > 0.0 { self.arriving(point) } else { 0.0 };
        let mirrored = hit.normal * (2.0 * cosine) - towards;
        let gloss = mirrored.dot(direction * -1.0).max(0.0).powf(self.reflection.shininess);
        let light = |channel: usize| self.scene.radiance[channel] * arriving / PI;
        [0, 1, 2].map(|channel| {
            let ambient = self.scene.medium.ambient[channel];
            let diffuse =
                hit.color[channel] * (ambient + light(channel) * self.reflection.diffuse * cosine.max(0.0));
            diffuse + light(channel) * self.reflection.specular * gloss
        })
    }

    /// Radiance, linear RGB, and transmittance along a ray.
    #[must_use]
    pub fn ray(&self, origin: Vec3, direction: Vec3) -> [f64; 4] {
        let hit = self.first(origin, direction);
        let (mut sum, mut transmittance) = ([0.0; 3], 1.0_f64);
        if let Some([begin, end]) = self.scene.field.stretch(origin, direction) {
            let end = hit.map_or(end, |hit| hit.distance.min(end));
            let steps = ((end - begin) / self.scene.step).ceil().max(0.0);
            let step = (end - begin) / steps.max(1.0);
            for i in 0..steps as u32 {
                let point = origin + direction * (begin + (f64::from(i) + 0.5) * step);
                let value = self.scene.field.at(point).min(1.0);
                if value <= 0.0 {
                    continue;
                }
                let through = (-self.scene.medium.extinction * value * step).exp();
                let towards = self.scene.light.towards(point);
                let phase = henyey_greenstein(towards.dot(direction), self.scene.medium.g);
                let arriving = self.arriving(point);
                for (channel, sum) in sum.iter_mut().enumerate() {
                    let [none, full] = self.scene.medium.albedo.map(|albedo| albedo[channel]);
                    let source =
                        self.scene.medium.ambient[channel] + self.scene.radiance[channel] * arriving * phase;
                    *sum += transmittance * (1.0 - through) * (none + (full - none) * value) * source;
                }
                transmittance *= through;
            }
        }
        let Some(hit) = hit else { return [sum[0], sum[1], sum[2], transmittance] };
        let surface = self.surface(origin, direction, &hit);
        let all = |channel: usize| sum[channel] + transmittance * surface[channel];
        [all(0), all(1), all(2), 0.0]
    }

    /// All pixels, row after row.
    #[must_use]
    pub fn picture(&self, camera: &Camera, [width, height]: [usize; 2]) -> Vec<[f64; 4]> {
        let row = |y: usize| -> Vec<[f64; 4]> {
            let pixel = |x: usize| {
                let ndc = Camera::pixel_ndc(x, y, width, height);
                self.ray(camera.origin(ndc), camera.ray(ndc))
            };
            (0..width).map(pixel).collect()
        };
        parallel::rows(height, row).into_iter().flatten().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_meet_triangles_where_they_are() {
        let corners = [Vec3::new(0.0, 0.0, 2.0), Vec3::new(1.0, 0.0, 2.0), Vec3::new(0.0, 1.0, 2.0)];
        let up = Vec3::new(0.0, 0.0, 1.0);
        for corners in [corners, [corners[0], corners[2], corners[1]]] {
            let triangle = Triangle { corners, normals: [up; 3], color: [1.0; 3] };
            let hit = |x, y| triangle.hit(Vec3::new(x, y, 0.0), up);
            let found = hit(0.2, 0.3).expect("a hit");
            assert!((found.distance - 2.0).abs() < 1e-12 && (found.normal + up).length() < 1e-12);
            for (x, y) in [(-0.01, 0.3), (0.3, -0.01), (0.6, 0.6)] {
                assert!(hit(x, y).is_none());
            }
            assert!(triangle.hit(Vec3::new(0.2, 0.3, 3.0), up).is_none());
        }
    }
}
