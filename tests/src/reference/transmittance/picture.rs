// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pictures of media lit by a directional light, single scattering: a march from the eye by short steps, and from each of
//! them a march to the light; and balls, sorted and blended, each lit as its middle is.

use crate::linear::{Mat4, Vec3};
use crate::parallel;
use crate::reference::camera::Camera;
use crate::reference::phase::henyey_greenstein;

/// Extinction on a grid in a box.
pub struct Grid<'a> {
    /// Voxels along x, y and z.
    pub size: [usize; 3],
    /// 1/m, one a voxel, x fastest.
    pub values: &'a [f32],
    /// World, metres, to the box 0..1.
    pub unit_from_world: Mat4,
    /// Trilinear, else the nearest voxel.
    pub linear: bool,
}

impl Grid<'_> {
    fn voxel(&self, index: [i64; 3]) -> f64 {
        let clamped = |axis: usize| index[axis].clamp(0, self.size[axis] as i64 - 1) as usize;
        f64::from(self.values[(clamped(2) * self.size[1] + clamped(1)) * self.size[0] + clamped(0)])
    }

    /// Extinction at a point, 1/m; 0 outside of the box.
    #[must_use]
    pub fn extinction(&self, point: Vec3) -> f64 {
        let [x, y, z, _] = self.unit_from_world.apply_point(point);
        let unit = [x, y, z];
        if unit.iter().any(|u| !(0.0..=1.0).contains(u)) {
            return 0.0;
        }
        let at: [f64; 3] = std::array::from_fn(|axis| unit[axis] * self.size[axis] as f64);
        if !self.linear {
            return self.voxel(at.map(|a| a.floor() as i64));
        }
        let first = at.map(|a| (a - 0.5).floor());
        let mut sum = 0.0;
        for corner in 0..8_usize {
            let upper = [corner & 1, corner >> 1 & 1, corner >> 2].map(|bit| bit as f64);
            let weight: f64 = (0..3).map(|a| 1.0 - (at[a] - 0.5 - first[a] - upper[a]).abs()).product();
            sum += weight * self.voxel(std::array::from_fn(|a| (first[a] + upper[a]) as i64));
        }
        sum
    }
}

/// A ball of even extinction.
#[derive(Clone, Copy, Debug)]
pub struct Ball {
    /// Its middle, metres.
    pub middle: Vec3,
    /// Metres.
    pub radius: f64,
    /// 1/m.
    pub extinction: f64,
}

impl Ball {
    /// Optical depth of the part of a ray from `from` to `to` metres that lies in the ball.
    fn optical_depth(&self, origin: Vec3, direction: Vec3, from: f64, to: f64) -> f64 {
        let along = (self.middle - origin).dot(direction);
        let off = (self.middle - origin - direction * along).length();
        let half = (self.radius * self.radius - off * off).max(0.0).sqrt();
        self.extinction * ((along + half).min(to) - (along - half).max(from)).max(0.0)
    }
}

/// What a medium is seen with.
pub struct View<'a> {
    /// The camera.
    pub camera: &'a Camera,
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Depth buffer, row by row.
    pub depth: &'a [f32],
    /// Rays end here, metres.
    pub distance_limit: f64,
    /// Unit vector TOWARDS the light.
    pub light: Vec3,
    /// Irradiance at normal incidence.
    pub radiance: [f64; 3],
    /// Single-scattering albedo.
    pub albedo: [f64; 3],
    /// Mean cosine of the phase function.
    pub g: f64,
}

impl View<'_> {
    /// Origin, direction and length of the view ray of a pixel.
    fn ray(&self, x: usize, y: usize) -> (Vec3, Vec3, f64) {
        let ndc = Camera::pixel_ndc(x, y, self.width, self.height);
        let distance = self.camera.distance(ndc, f64::from(self.depth[y * self.width + x]));
        (self.camera.origin(ndc), self.camera.ray(ndc), distance.min(self.distance_limit))
    }

    fn pixels(&self, pixel: impl Fn(usize, usize) -> [f64; 4] + Sync) -> Vec<f64> {
        let row = |y| (0..self.width).flat_map(|x| pixel(x, y)).collect::<Vec<_>>();
        parallel::rows(self.height, row).concat()
    }

    fn source(&self, direction: Vec3) -> [f64; 3] {
        let phase = henyey_greenstein(direction.dot(self.light), self.g);
        std::array::from_fn(|c| self.albedo[c] * self.radiance[c] * phase)
    }

    /// Radiance and transmittance of every pixel through a medium that lies within `radius` metres of `centre`. `step`: metres
    /// of a step from the eye and to the light, samples in their middles.
    #[must_use]
    pub fn marched(
        &self,
        extinction: impl Fn(Vec3) -> f64 + Sync,
        (centre, radius): (Vec3, f64),
        step: f64,
    ) -> Vec<f64> {
        // The part of a ray that lies in the ball around the medium.
        let inside = |origin: Vec3, direction: Vec3, limit: f64| {
            let along = (centre - origin).dot(direction);
            let off = (centre - origin - direction * along).length();
            let half = (radius * radius - off * off).max(0.0).sqrt();
            ((along - half).max(0.0), (along + half).min(limit))
        };
        let optical_depth = |origin: Vec3, direction: Vec3| {
            let (from, to) = inside(origin, direction, f64::INFINITY);
            let steps = ((to - from) / step).ceil().max(1.0) as usize;
            let length = (to - from).max(0.0) / steps as f64;
            let at = |i: usize| extinction(origin + direction * (from + (i as f64 + 0.5) * length));
            (0..steps).map(at).sum::<f64>() * length
        };
        self.pixels(|x, y| {
            let (origin, direction, distance) = self.ray(x, y);
            let (from, to) = inside(origin, direction, distance);
            let steps = ((to - from) / step).ceil().max(1.0) as usize;
            let length = (to - from).max(0.0) / steps as f64;
            let (mut passed, mut lit) = (0.0, 0.0);
            for i in 0..steps {
                let point = origin + direction * (from + (i as f64 + 0.5) * length);
                let here = extinction(point) * length;
                if here > 0.0 {
                    lit += here * (-(passed + 0.5 * here) - optical_depth(point, self.light)).exp();
                    passed += here;
                }
            }
            let [red, green, blue] = self.source(direction).map(|source| source * lit);
            [red, green, blue, (-passed).exp()]
        })
    }

    /// Transmittance from the light to the middle of each ball.
    #[must_use]
    pub fn at_middles(&self, balls: &[Ball]) -> Vec<f64> {
        let of = |ball: &Ball| -> f64 {
            balls.iter().map(|b| b.optical_depth(ball.middle, self.light, 0.0, f64::INFINITY)).sum()
        };
        balls.iter().map(|ball| (-of(ball)).exp()).collect()
    }

    /// Radiance and transmittance of every pixel through balls, each of even light `lit`, blended from the farthest middle
    /// to the nearest, depths being distances from the plane of the eye.
    #[must_use]
    pub fn blended(&self, balls: &[Ball], lit: &[f64]) -> Vec<f64> {
        let depth = |ball: &Ball| (ball.middle - self.camera.eye).dot(self.camera.forward);
        let mut order: Vec<usize> = (0..balls.len()).collect();
        order.sort_by(|a, b| depth(&balls[*b]).total_cmp(&depth(&balls[*a])));
        self.pixels(|x, y| {
            let (origin, direction, distance) = self.ray(x, y);
            let source = self.source(direction);
            let mut pixel = [0.0, 0.0, 0.0, 1.0];
            for i in &order {
                let through = (-balls[*i].optical_depth(origin, direction, 0.0, distance)).exp();
                for (value, source) in pixel.iter_mut().zip(source) {
                    *value = *value * through + source * lit[*i] * (1.0 - through);
                }
                pixel[3] *= through;
            }
            pixel
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::camera::OrthographicView;

    fn camera() -> Camera {
        Camera::orthographic(&OrthographicView {
            eye: Vec3::new(0.0, 0.0, 5.0),
            target: Vec3::default(),
            up: Vec3::new(0.0, 1.0, 0.0),
            half_height: 1.0,
            aspect: 1.0,
            depth: 10.0,
            reversed: false,
        })
    }

    fn view<'a>(camera: &'a Camera, depth: &'a [f32]) -> View<'a> {
        View {
            camera,
            width: 8,
            height: 8,
            depth,
            distance_limit: 100.0,
            light: Vec3::new(0.0, 1.0, 0.0),
            radiance: [3.0, 2.0, 1.0],
            albedo: [0.5, 1.0, 0.9],
            g: 0.4,
        }
    }

    /// A box of 2 m, light from above: T_light depends on the height alone.
    #[test]
    fn an_even_box_is_its_closed_form() {
        let (camera, depth) = (camera(), [1.0; 64]);
        let view = view(&camera, &depth);
        let inside = |p: Vec3| p.to_array().iter().all(|c| c.abs() <= 1.0);
        let found = view.marched(|p| 0.7 * f64::from(u8::from(inside(p))), (Vec3::default(), 1.8), 0.002);
        for (i, pixel) in found.chunks_exact(4).enumerate() {
            let below = 2.0 * ((i / 8) as f64 + 0.5) / 8.0;
            let lit = (-0.7 * below).exp() * (1.0 - (-1.4_f64).exp());
            let expected = view.source(Vec3::new(0.0, 0.0, -1.0)).map(|source| source * lit);
            assert!((pixel[0] - expected[0]).abs() < 2e-3 * expected[0], "{pixel:?}, {expected:?}");
            assert!((pixel[3] - (-1.4_f64).exp()).abs() < 2e-3);
        }
    }

    /// One ball, blended and marched.
    #[test]
    fn a_thin_ball_is_the_same_both_ways() {
        let (camera, depth) = (camera(), [1.0; 64]);
        let view = view(&camera, &depth);
        let ball = Ball { middle: Vec3::new(0.1, 0.0, 0.2), radius: 0.8, extinction: 0.01 };
        let marched = view.marched(
            |p| if (p - ball.middle).length() <= 0.8 { 0.01 } else { 0.0 },
            (ball.middle, 0.9),
            0.002,
        );
        let blended = view.blended(&[ball], &view.at_middles(&[ball]));
        for (a, b) in marched.iter().zip(&blended) {
            assert!((a - b).abs() < 1e-2 * a + 2e-5, "{a} {b}");
        }
    }
}
