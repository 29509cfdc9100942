// SPDX-License-Identifier: MIT OR Apache-2.0
//! Perspective and orthographic cameras in f64: right-handed, y up, clip depth 0..1, pixel (0, 0) at
//! the top left. Both directions of z, and for a perspective camera a far plane at infinity.

use crate::linear::{Mat4, Vec3};

/// What a perspective camera is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Position of the eye, world, metres.
    pub eye: Vec3,
    /// A point that the camera looks at.
    pub target: Vec3,
    /// A direction that is upwards in the picture.
    pub up: Vec3,
    /// Vertical angle of view, radians.
    pub fov_y: f64,
    /// Width over height of the picture.
    pub aspect: f64,
    /// Distance of the near plane along the forward direction, metres.
    pub near: f64,
    /// Distance of the far plane along the forward direction, metres; may be infinite.
    pub far: f64,
    /// Reversed z: near plane at depth 1, far plane at 0.
    pub reversed: bool,
}

/// What an orthographic camera is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrthographicView {
    /// Centre of the near plane, world, metres.
    pub eye: Vec3,
    /// A point that the camera looks at.
    pub target: Vec3,
    /// A direction that is upwards in the picture.
    pub up: Vec3,
    /// Half of what the picture shows from bottom to top, metres.
    pub half_height: f64,
    /// Width over height of the picture.
    pub aspect: f64,
    /// Distance from the near plane to the far plane, metres.
    pub depth: f64,
    /// Reversed z: near plane at depth 1, far plane at 0.
    pub reversed: bool,
}

/// A camera. View rays begin at the eye of a perspective camera, on the near plane of an
/// orthographic one; distances count from there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// World to clip.
    pub clip_from_world: Mat4,
    /// Its inverse.
    pub world_from_clip: Mat4,
    /// Depth-buffer value of the far plane: 1, or 0 for reversed z.
    pub far_depth: f64,
    /// Position of the eye, world, metres; of an orthographic camera the centre of its near plane.
    pub eye: Vec3,
    /// Unit normal of the image plane, into the scene.
    pub forward: Vec3,
    /// Unit direction of growing picture x.
    pub right: Vec3,
    /// Unit direction of falling picture y (upwards).
    pub up: Vec3,
    /// Distance of the near plane from the eye along `forward`, metres; 0 for an orthographic camera.
    pub near: f64,
    /// Distance of the far plane from the eye along `forward`, metres; may be infinite for a
    /// perspective camera.
    pub far: f64,
}

impl Camera {
    /// The camera of a view.
    ///
    /// # Panics
    /// If the view is degenerate (eye at the target, `up` along the view, no angle of view …).
    #[must_use]
    pub fn perspective(view: &View) -> Self {
        let forward = (view.target - view.eye).normalised();
        let right = forward.cross(view.up).normalised();
        let up = right.cross(forward);
        let scale = (0.5 * view.fov_y).tan().recip();
        let row = |d: Vec3, s: f64| [s * d.x, s * d.y, s * d.z, -s * d.dot(view.eye)];
        // depth(ζ) = slope + offset / ζ at the distance ζ along forward.
        let (near, far) = (view.near, view.far);
        let (slope, offset) = match (view.reversed, far.is_infinite()) {
            (false, false) => (far / (far - near), -far * near / (far - near)),
            (false, true) => (1.0, -near),
            (true, false) => (-near / (far - near), far * near / (far - near)),
            (true, true) => (0.0, near),
        };
        let mut depth = row(forward, slope);
        depth[3] += offset;
        let clip_from_world =
            Mat4::from_rows([row(right, scale / view.aspect), row(up, scale), depth, row(forward, 1.0)]);
        Self {
            clip_from_world,
            world_from_clip: clip_from_world.inverse().expect("a camera that is not degenerate"),
            far_depth: if view.reversed { 0.0 } else { 1.0 },
            eye: view.eye,
            forward,
            right,
            up,
            near,
            far,
        }
    }

    /// The camera of an orthographic view.
    ///
    /// # Panics
    /// If the view is degenerate (eye at the target, `up` along the view, nothing in view …).
    #[must_use]
    pub fn orthographic(view: &OrthographicView) -> Self {
        let forward = (view.target - view.eye).normalised();
        let right = forward.cross(view.up).normalised();
        let up = right.cross(forward);
        let row = |d: Vec3, s: f64| [s * d.x, s * d.y, s * d.z, -s * d.dot(view.eye)];
        let mut depth = row(forward, if view.reversed { -view.depth.recip() } else { view.depth.recip() });
        if view.reversed {
            depth[3] += 1.0;
        }
        let clip_from_world = Mat4::from_rows([
            row(right, (view.half_height * view.aspect).recip()),
            row(up, view.half_height.recip()),
            depth,
            [0.0, 0.0, 0.0, 1.0],
        ]);
        Self {
            clip_from_world,
            world_from_clip: clip_from_world.inverse().expect("a camera that is not degenerate"),
            far_depth: if view.reversed { 0.0 } else { 1.0 },
            eye: view.eye,
            forward,
            right,
            up,
            near: 0.0,
            far: view.depth,
        }
    }

    /// Whether all view rays are parallel.
    #[must_use]
    pub fn is_orthographic(&self) -> bool {
        let [x, y, z, w] = self.clip_from_world.row(3);
        Vec3::new(x, y, z).length() <= 1e-12 * w.abs()
    }

    /// The camera of a matrix, for the depth-buffer value of its far plane (1, or 0 for reversed
    /// z); everything else is found from the matrix. None for a matrix that is singular or not
    /// that of a perspective or orthographic camera. A far plane that the precision of an f32 matrix cannot tell
    /// from infinity (beyond 3e6 times the near plane, forward z) counts as infinite.
    #[must_use]
    pub fn from_matrix(clip_from_world: Mat4, far_depth: f64) -> Option<Self> {
        let world_from_clip = clip_from_world.inverse()?;
        let (row_x, row_y, row_w) =
            (clip_from_world.row3(0), clip_from_world.row3(1), clip_from_world.row3(3));
        if row_w.length() <= 1e-12 * clip_from_world.row(3)[3].abs() {
            return Self::from_orthographic(clip_from_world, world_from_clip, far_depth);
        }
        // The eye is the point whose clip x, y and w vanish: the image of clip (0, 0, 1, 0).
        let [x, y, z, w] = world_from_clip.apply([0.0, 0.0, 1.0, 0.0]);
        let eye = Vec3::new(x, y, z) * w.recip();
        let scale = row_w.length();
        let forward = row_w.normalised();
        let right = row_x.without(forward).normalised();
        let up = row_y.without(forward).without(right).normalised();
        // clip z = slope ζ + offset, clip w = scale ζ at the distance ζ along forward.
        let slope = clip_from_world.row3(2).dot(forward) / scale;
        let offset = clip_from_world.apply_point(eye)[2] / scale;
        let plane = |depth: f64| offset / (depth - slope);
        let near = plane(1.0 - far_depth);
        let far = plane(far_depth);
        let resolution = if far_depth > 0.5 { 3e-7 } else { 1e-12 };
        let infinite = (far_depth - slope).abs() < resolution || !far.is_finite() || far < near;
        let camera = Self {
            clip_from_world,
            world_from_clip,
            far_depth,
            eye,
            forward,
            right,
            up,
            near,
            far: if infinite { f64::INFINITY } else { far },
        };
        let numbers = [eye, forward, right, up].map(|v| v.dot(v));
        (numbers.iter().all(|n| n.is_finite()) && near > 0.0).then_some(camera)
    }

    fn from_orthographic(clip_from_world: Mat4, world_from_clip: Mat4, far_depth: f64) -> Option<Self> {
        let at = |depth: f64| {
            let [x, y, z, w] = world_from_clip.apply([0.0, 0.0, depth, 1.0]);
            Vec3::new(x, y, z) * w.recip()
        };
        let eye = at(1.0 - far_depth);
        let far = (at(far_depth) - eye).length();
        let forward = (at(far_depth) - eye).normalised();
        let sign = clip_from_world.row(3)[3].signum();
        let right = (clip_from_world.row3(0) * sign).without(forward).normalised();
        let up = (clip_from_world.row3(1) * sign).without(forward).without(right).normalised();
        let camera =
            Self { clip_from_world, world_from_clip, far_depth, eye, forward, right, up, near: 0.0, far };
        let numbers = [eye, forward, right, up].map(|v| v.dot(v));
        (numbers.iter().all(|n| n.is_finite()) && far.is_finite()).then_some(camera)
    }

    /// Normalised device coordinates (x right, y up, −1 to 1) of a pixel's centre.
    #[must_use]
    pub fn pixel_ndc(x: usize, y: usize, width: usize, height: usize) -> [f64; 2] {
        [(x as f64 + 0.5) / width as f64 * 2.0 - 1.0, 1.0 - (y as f64 + 0.5) / height as f64 * 2.0]
    }

    /// Unit direction of the view ray through a place of the picture.
    #[must_use]
    pub fn ray(&self, ndc: [f64; 2]) -> Vec3 {
        if self.is_orthographic() {
            return self.forward;
        }
        let [x, y, z, w] = self.world_from_clip.apply([ndc[0], ndc[1], 1.0 - self.far_depth, 1.0]);
        let direction = (Vec3::new(x, y, z) - self.eye * w).normalised();
        if direction.dot(self.forward) < 0.0 { -direction } else { direction }
    }

    /// Where the view ray through a place of the picture begins, world, metres.
    #[must_use]
    pub fn origin(&self, ndc: [f64; 2]) -> Vec3 {
        if !self.is_orthographic() {
            return self.eye;
        }
        let [x, y, z, w] = self.world_from_clip.apply([ndc[0], ndc[1], 1.0 - self.far_depth, 1.0]);
        Vec3::new(x, y, z) * w.recip()
    }

    /// The eight corners of the part of the frustum that ends `reach` metres from the eye along
    /// `forward`: four of the near plane, then four of that end, each in the order of [`Self::corners`].
    #[must_use]
    pub fn frustum(&self, reach: f64) -> [Vec3; 8] {
        let ndc = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        std::array::from_fn(|i| {
            let direction = self.ray(ndc[i % 4]);
            let along = if i < 4 { self.near } else { reach };
            self.origin(ndc[i % 4]) + direction * (along / direction.dot(self.forward))
        })
    }

    /// Unit direction of the view ray through a pixel's centre.
    #[must_use]
    pub fn pixel_ray(&self, x: usize, y: usize, width: usize, height: usize) -> Vec3 {
        self.ray(Self::pixel_ndc(x, y, width, height))
    }

    /// Whether a depth-buffer value is that of the far plane (or beyond): nothing was drawn.
    #[must_use]
    pub fn is_far(&self, depth: f64) -> bool {
        is_far(depth, self.far_depth)
    }

    /// Distance from the beginning of the view ray, metres, of what the depth buffer holds at a place of the picture;
    /// infinite on a far plane at infinity.
    #[must_use]
    pub fn distance(&self, ndc: [f64; 2], depth: f64) -> f64 {
        if self.is_far(depth) {
            return self.far / self.ray(ndc).dot(self.forward);
        }
        let [x, y, z, w] = self.world_from_clip.apply([ndc[0], ndc[1], depth, 1.0]);
        (Vec3::new(x, y, z) * w.recip() - self.origin(ndc)).length()
    }

    /// Normalised device coordinates and depth of a world point; none behind the eye.
    #[must_use]
    pub fn project(&self, point: Vec3) -> Option<[f64; 3]> {
        let [x, y, z, w] = self.clip_from_world.apply_point(point);
        (w > 0.0).then(|| [x / w, y / w, z / w])
    }

    /// Unit directions of a perspective camera's rays through the picture's corners: bottom left, bottom right, top
    /// right, top left.
    #[must_use]
    pub fn corners(&self) -> [Vec3; 4] {
        [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|ndc| self.ray(ndc))
    }

    /// Unit normals, inward, of the side planes of a perspective camera's frustum: bottom, right, top, left.
    #[must_use]
    pub fn side_normals(&self) -> [Vec3; 4] {
        let corners = self.corners();
        [0, 1, 2, 3].map(|i| {
            let normal = corners[i].cross(corners[(i + 1) % 4]).normalised();
            if normal.dot(corners[(i + 2) % 4]) < 0.0 { -normal } else { normal }
        })
    }
}

/// Whether a depth is at or beyond that of the far plane, `far_depth` (1, or 0 for reversed z), or
/// not finite.
#[must_use]
pub fn is_far(depth: f64, far_depth: f64) -> bool {
    if far_depth > 0.5 {
        depth >= far_depth || !depth.is_finite()
    } else {
        depth <= far_depth || !depth.is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn views() -> impl Iterator<Item = View> {
        [(false, 80.0), (true, 80.0), (false, f64::INFINITY), (true, f64::INFINITY)].into_iter().map(
            |(reversed, far)| View {
                eye: Vec3::new(3.0, 2.0, -7.0),
                target: Vec3::new(-1.0, 0.5, 4.0),
                up: Vec3::new(0.0, 1.0, 0.0),
                fov_y: 0.9,
                aspect: 1.6,
                near: 0.1,
                far,
                reversed,
            },
        )
    }

    fn close(a: f64, b: f64, tolerance: f64) -> bool {
        a == b || (a - b).abs() <= tolerance * (1.0 + b.abs())
    }

    #[test]
    fn matrix_alone_gives_the_camera_again() {
        for view in views() {
            let camera = Camera::perspective(&view);
            let rounded = camera.clip_from_world.columns.as_flattened();
            let rounded: [f64; 16] = std::array::from_fn(|i| f64::from(rounded[i] as f32));
            for (matrix, tolerance) in [(camera.clip_from_world, 1e-10), (Mat4::from(rounded), 1e-4)] {
                let found = Camera::from_matrix(matrix, camera.far_depth).expect("a camera");
                assert!(close(found.near, view.near, tolerance), "{}", found.near);
                assert!(close(found.far, view.far, 20.0 * tolerance), "{}", found.far);
                for (a, b) in [
                    (found.eye, camera.eye),
                    (found.forward, camera.forward),
                    (found.right, camera.right),
                    (found.up, camera.up),
                ] {
                    assert!((a - b).length() < tolerance);
                }
            }
        }
        let identity = Camera::perspective(&views().next().expect("one")).world_from_clip;
        assert!(Camera::from_matrix(identity * Mat4::from([0.0_f64; 16]), 1.0).is_none());
    }

    #[test]
    fn depth_and_pixel_lead_back_to_the_point() {
        for view in views() {
            let camera = Camera::perspective(&view);
            for (x, y, distance) in [(0, 0, 0.5), (63, 47, 10.0), (20, 30, 60.0)] {
                let direction = camera.pixel_ray(x, y, 64, 48);
                let point = camera.eye + direction * distance;
                let [u, v, depth] = camera.project(point).expect("in front");
                let ndc = Camera::pixel_ndc(x, y, 64, 48);
                assert!(close(u, ndc[0], 1e-10) && close(v, ndc[1], 1e-10));
                assert!(close(camera.distance(ndc, depth), distance, 1e-9));
            }
            let sky = camera.distance([0.3, 0.2], camera.far_depth);
            let expected = view.far / camera.ray([0.3, 0.2]).dot(camera.forward);
            assert!(close(sky, expected, 1e-12));
        }
    }

    #[test]
    fn top_left_is_up_and_left() {
        for view in views() {
            let camera = Camera::perspective(&view);
            let ray = camera.pixel_ray(0, 0, 64, 48);
            assert!(ray.dot(camera.up) > 0.3 && ray.dot(camera.right) < -0.3);
            assert!(close(ray.length(), 1.0, 1e-14));
        }
    }

    #[test]
    fn side_normals_tell_the_picture_as_projection_does() {
        for view in views() {
            let camera = Camera::perspective(&view);
            let normals = camera.side_normals();
            for i in 0..1000 {
                let t = f64::from(i);
                let direction = Vec3::new((1.7 * t).sin(), (2.3 * t).cos(), (0.7 * t + 1.0).sin());
                let inside = camera
                    .project(camera.eye + direction)
                    .is_some_and(|p| p[0].abs() <= 1.0 && p[1].abs() <= 1.0);
                let by_normals = normals.iter().all(|n| n.dot(direction) >= 0.0);
                assert_eq!(inside, by_normals, "{direction:?}");
            }
        }
    }

    #[test]
    fn orthographic_camera_is_found_from_its_matrix_and_leads_back_to_points() {
        for reversed in [false, true] {
            let view = OrthographicView {
                eye: Vec3::new(3.0, 2.0, -7.0),
                target: Vec3::new(-1.0, 0.5, 4.0),
                up: Vec3::new(0.0, 1.0, 0.0),
                half_height: 4.0,
                aspect: 1.6,
                depth: 30.0,
                reversed,
            };
            let camera = Camera::orthographic(&view);
            assert!(camera.is_orthographic());
            let found = Camera::from_matrix(camera.clip_from_world, camera.far_depth).expect("a camera");
            for (a, b) in [
                (found.eye, camera.eye),
                (found.forward, camera.forward),
                (found.right, camera.right),
                (found.up, camera.up),
            ] {
                assert!((a - b).length() < 1e-12);
            }
            assert!(close(found.far, 30.0, 1e-12) && found.near == 0.0);
            for (x, y, distance) in [(0, 0, 0.5), (63, 47, 10.0), (20, 30, 29.0)] {
                let ndc = Camera::pixel_ndc(x, y, 64, 48);
                let point = camera.origin(ndc) + camera.ray(ndc) * distance;
                let [u, v, depth] = camera.project(point).expect("in front");
                assert!(close(u, ndc[0], 1e-12) && close(v, ndc[1], 1e-12));
                assert!(close(camera.distance(ndc, depth), distance, 1e-12));
            }
            assert!(close(camera.distance([0.1, 0.2], camera.far_depth), 30.0, 1e-12));
            let top_left = camera.origin([-1.0, 1.0]) - camera.eye;
            assert!(close(top_left.dot(camera.right), -6.4, 1e-12));
            assert!(close(top_left.dot(camera.up), 4.0, 1e-12));
            assert!(top_left.dot(camera.forward).abs() < 1e-12);
            let far = camera.frustum(12.0)[7];
            assert!((far - camera.eye - top_left - camera.forward * 12.0).length() < 1e-12);
        }
        for view in views() {
            let camera = Camera::perspective(&view);
            assert!(!camera.is_orthographic());
            for (i, corner) in camera.frustum(9.0).into_iter().enumerate() {
                let [x, y, _] = camera.project(corner).expect("in front");
                assert!(close(x.abs(), 1.0, 1e-9) && close(y.abs(), 1.0, 1e-9));
                let along = (corner - camera.eye).dot(camera.forward);
                assert!(close(along, if i < 4 { 0.1 } else { 9.0 }, 1e-9));
            }
        }
    }
}
