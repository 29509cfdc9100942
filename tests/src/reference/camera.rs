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
mod tests;
