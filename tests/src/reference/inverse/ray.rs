// SPDX-License-Identifier: MIT OR Apache-2.0
//! The box in the world, and the rays of a picture.

use crate::linear::{Mat4, Vec3};
use crate::parallel;
use crate::reference::camera::Camera;

fn point(matrix: &Mat4, p: Vec3) -> Vec3 {
    let [x, y, z, w] = matrix.apply_point(p);
    Vec3::new(x, y, z) * w.recip()
}

fn direction(matrix: &Mat4, d: Vec3) -> Vec3 {
    let [x, y, z, _] = matrix.apply_direction(d);
    Vec3::new(x, y, z)
}

/// Where the box 0..1 of a volume is in the world.
#[derive(Clone, Copy, Debug)]
pub struct VolumeBox {
    /// Affine; metres.
    pub world_from_unit: Mat4,
    /// Its inverse.
    pub unit_from_world: Mat4,
}

impl VolumeBox {
    /// None for a matrix without an inverse.
    #[must_use]
    pub fn new(world_from_unit: Mat4) -> Option<Self> {
        Some(Self { world_from_unit, unit_from_world: world_from_unit.inverse()? })
    }

    /// The point of the world that has these coordinates of the box.
    #[must_use]
    pub fn world(&self, unit: Vec3) -> Vec3 {
        point(&self.world_from_unit, unit)
    }

    /// The coordinates that a point of the world has in the box.
    #[must_use]
    pub fn unit(&self, world: Vec3) -> Vec3 {
        point(&self.unit_from_world, world)
    }

    /// A direction of the world in coordinates of the box, per metre.
    #[must_use]
    pub fn unit_direction(&self, world: Vec3) -> Vec3 {
        direction(&self.unit_from_world, world)
    }

    /// A gradient by coordinates of the box as one by metres of the world: the transposed inverse.
    #[must_use]
    pub fn world_gradient(&self, unit: Vec3) -> Vec3 {
        let [x, y, z] = [0, 1, 2].map(|row| self.unit_from_world.row3(row));
        x * unit.x + y * unit.y + z * unit.z
    }

    /// From corner (0, 0, 0) to corner (1, 1, 1), metres.
    #[must_use]
    pub fn diagonal(&self) -> f64 {
        direction(&self.world_from_unit, Vec3::new(1.0, 1.0, 1.0)).length()
    }

    /// The metres along a ray between which it is in the part of the box that lies between two corners, in coordinates
    /// of the box, and within its depth; none where there is nothing in between.
    #[must_use]
    pub fn clip(&self, ray: &Ray, corners: [Vec3; 2]) -> Option<[f64; 2]> {
        let from = self.unit(ray.origin).to_array();
        let along = self.unit_direction(ray.direction).to_array();
        let [low, high] = corners.map(Vec3::to_array);
        let (mut begin, mut end) = (0.0_f64, ray.depth);
        for axis in 0..3 {
            if along[axis] == 0.0 {
                if from[axis] < low[axis] || from[axis] > high[axis] {
                    return None;
                }
                continue;
            }
            let [a, b] = [low, high].map(|side| (side[axis] - from[axis]) / along[axis]);
            begin = begin.max(a.min(b));
            end = end.min(a.max(b));
        }
        (begin < end).then_some([begin, end])
    }
}

/// A view ray.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// On the near plane; world, metres.
    pub origin: Vec3,
    /// Unit vector, world.
    pub direction: Vec3,
    /// Where it meets a surface, metres from its origin; infinite without one.
    pub depth: f64,
}

/// A picture's camera and what ends its rays.
#[derive(Clone, Debug)]
pub struct View {
    /// Clip space to the world; perspective or parallel.
    pub world_from_clip: Mat4,
    /// Depth-buffer value of the near plane: 0, or 1 for reversed z.
    pub near_depth: f64,
    /// Pixels across and down.
    pub size: [usize; 2],
    /// Metres along each pixel's ray from the near plane to a surface, row after row; none: no surfaces.
    pub depth: Option<Vec<f64>>,
}

impl View {
    /// Of a camera, without surfaces.
    #[must_use]
    pub fn new(camera: &Camera, size: [usize; 2]) -> Self {
        Self {
            world_from_clip: camera.world_from_clip,
            near_depth: 1.0 - camera.far_depth,
            size,
            depth: None,
        }
    }

    /// The ray through a place of the picture, from the near plane to infinity.
    #[must_use]
    pub fn through(&self, [x, y]: [f64; 2]) -> Ray {
        let origin = point(&self.world_from_clip, Vec3::new(x, y, self.near_depth));
        let further = point(&self.world_from_clip, Vec3::new(x, y, 0.5));
        Ray { origin, direction: (further - origin).normalised(), depth: f64::INFINITY }
    }

    /// The ray through a pixel's middle.
    #[must_use]
    pub fn ray(&self, x: usize, y: usize) -> Ray {
        let ray = self.through(Camera::pixel_ndc(x, y, self.size[0], self.size[1]));
        let depth = self.depth.as_ref().map_or(f64::INFINITY, |depth| depth[y * self.size[0] + x]);
        Ray { depth, ..ray }
    }

    /// Something of every pixel's ray, row after row.
    #[must_use]
    pub fn rays<T: Send>(&self, of: impl Fn(&Ray) -> T + Sync) -> Vec<T> {
        let [width, height] = self.size;
        let row = |y: usize| -> Vec<T> { (0..width).map(|x| of(&self.ray(x, y))).collect() };
        parallel::rows(height, row).into_iter().flatten().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::sheared_box;
    use super::*;
    use crate::reference::camera::{OrthographicView, View as Perspective};

    #[test]
    fn rays_begin_on_the_near_plane_and_meet_what_is_projected() {
        let (eye, target, up) =
            (Vec3::new(1.0, 2.0, 5.0), Vec3::new(0.0, 0.5, 0.0), Vec3::new(0.0, 1.0, 0.0));
        let (near, far) = (0.5, f64::INFINITY);
        for reversed in [false, true] {
            let perspective = Perspective { eye, target, up, fov_y: 0.8, aspect: 1.5, near, far, reversed };
            let orthographic =
                OrthographicView { eye, target, up, half_height: 2.0, aspect: 1.5, depth: 9.0, reversed };
            for camera in [Camera::perspective(&perspective), Camera::orthographic(&orthographic)] {
                let view =
                    View { depth: Some((0..6).map(f64::from).collect()), ..View::new(&camera, [3, 2]) };
                let rays = view.rays(|ray| *ray);
                for (index, ray) in rays.iter().enumerate() {
                    assert_eq!(ray.depth, index as f64);
                    let near = if camera.is_orthographic() { 0.0 } else { near };
                    assert!(((ray.origin - eye).dot(camera.forward) - near).abs() < 1e-12);
                    assert!(ray.direction.dot(camera.forward) > 0.5);
                    let [x, y, _] = camera.project(ray.origin + ray.direction * 3.0).expect("in front");
                    let [u, v] = Camera::pixel_ndc(index % 3, index / 3, 3, 2);
                    assert!((x - u).abs() < 1e-12 && (y - v).abs() < 1e-12);
                }
            }
        }
    }

    #[test]
    fn clipped_rays_end_on_faces_and_at_surfaces() {
        let volume = sheared_box();
        let through = volume.world(Vec3::new(0.3, 0.6, 0.45));
        let direction = Vec3::new(0.3, -0.5, 0.8).normalised();
        let whole = [Vec3::default(), Vec3::new(1.0, 1.0, 1.0)];
        let ray = Ray { origin: through - direction * 20.0, direction, depth: f64::INFINITY };
        let [begin, end] = volume.clip(&ray, whole).expect("through the box");
        for distance in [begin, end] {
            let unit = volume.unit(ray.origin + direction * distance).to_array();
            let least = unit.iter().map(|u| u.abs().min((1.0 - u).abs())).fold(1.0, f64::min);
            assert!(least < 1e-12 && unit.iter().all(|u| (-1e-12..1.0 + 1e-12).contains(u)));
        }
        assert_eq!(volume.clip(&Ray { depth: 20.0, ..ray }, whole), Some([begin, 20.0]));
        assert_eq!(volume.clip(&Ray { depth: begin, ..ray }, whole), None);
        let inside = Ray { origin: through, direction, depth: f64::INFINITY };
        let [at_once, after] = volume.clip(&inside, whole).expect("from inside");
        assert!(at_once == 0.0 && (after - (end - 20.0)).abs() < 1e-12);
        assert_eq!(volume.clip(&Ray { direction: -direction, ..ray }, whole), None);
    }

    #[test]
    fn gradients_go_to_the_world_by_the_transposed_inverse() {
        let volume = sheared_box();
        let field = |world: Vec3| {
            let unit = volume.unit(world);
            2.0 * unit.x - 3.0 * unit.y + 0.7 * unit.z
        };
        let gradient = volume.world_gradient(Vec3::new(2.0, -3.0, 0.7));
        let place = Vec3::new(0.3, -1.0, 0.2);
        for way in [Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.0, 1.0)] {
            assert!((field(place + way) - field(place) - gradient.dot(way)).abs() < 1e-12);
        }
    }
}
