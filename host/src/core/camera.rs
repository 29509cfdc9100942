// SPDX-License-Identifier: MIT OR Apache-2.0
//! The camera uniform of `core/camera`, and cameras built from what people say.

mod error;
mod view;

pub use error::CameraError;
pub use view::{DepthRange, OrthographicView, PerspectiveView, View};

use encase::ShaderType;
use glam::dcamera::rh::{proj::directx, view as looking};
use glam::{DMat4, DVec3, Mat4, Vec2, Vec3};

/// The uniform `Camera` of `core/camera`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct Camera {
    /// World to clip.
    pub clip_from_world: Mat4,
    /// Clip to world.
    pub world_from_clip: Mat4,
    /// Position of the eye, metres.
    pub eye: Vec3,
    /// Clip depth of the near plane.
    pub near_depth: f32,
    /// Pixels.
    pub viewport: Vec2,
    /// Clip depth of the far plane.
    pub far_depth: f32,
    /// 0 perspective, 1 orthographic.
    pub projection: u32,
}

impl Camera {
    /// A camera of either kind; matrices are composed and inverted in f64.
    ///
    /// # Errors
    /// [`CameraError`] where the view is degenerate.
    pub fn new(of: &View, viewport: [u32; 2]) -> Result<Self, CameraError> {
        match of {
            View::Perspective(view) => Self::perspective(view, viewport),
            View::Orthographic(view) => Self::orthographic(view, viewport),
        }
    }

    /// The same with a direction, of any length, that is up in the picture as far as the view allows.
    ///
    /// # Errors
    /// [`CameraError`] where the view is degenerate.
    pub fn with_up(of: &View, up: Vec3, viewport: [u32; 2]) -> Result<Self, CameraError> {
        let view = look_up(of.eye(), of.target(), up)?;
        match of {
            View::Perspective(of) => Self::perspective_from(of, view, viewport),
            View::Orthographic(of) => Self::orthographic_from(of, view, viewport),
        }
    }

    /// A perspective camera; matrices are composed and inverted in f64.
    ///
    /// # Errors
    /// [`CameraError`] where the view is degenerate.
    pub fn perspective(of: &PerspectiveView, viewport: [u32; 2]) -> Result<Self, CameraError> {
        Self::perspective_from(of, look(of.eye, of.target)?, viewport)
    }

    fn perspective_from(of: &PerspectiveView, view: DMat4, viewport: [u32; 2]) -> Result<Self, CameraError> {
        if !(of.field_of_view >= 0.1 && of.field_of_view <= 170.0) {
            return Err(CameraError::FieldOfView { degrees: of.field_of_view });
        }
        if !(of.near > 0.0 && of.near.is_finite() && of.far > of.near) {
            return Err(CameraError::Planes { near: of.near, far: of.far });
        }
        let aspect = aspect(viewport)?;
        let fov = f64::from(of.field_of_view).to_radians();
        let near = f64::from(of.near);
        let projection = if of.far.is_finite() {
            directx::perspective(fov, aspect, near, f64::from(of.far))
        } else {
            directx::perspective_infinite(fov, aspect, near)
        };
        Ok(Self::of(projection, view, of.eye, of.depth, viewport, 0))
    }

    /// An orthographic camera; matrices are composed and inverted in f64.
    ///
    /// # Errors
    /// [`CameraError`] where the view is degenerate.
    pub fn orthographic(of: &OrthographicView, viewport: [u32; 2]) -> Result<Self, CameraError> {
        Self::orthographic_from(of, look(of.eye, of.target)?, viewport)
    }

    fn orthographic_from(
        of: &OrthographicView,
        view: DMat4,
        viewport: [u32; 2],
    ) -> Result<Self, CameraError> {
        if !(of.height > 0.0 && of.height.is_finite()) {
            return Err(CameraError::Height(of.height));
        }
        if !(of.near.is_finite() && of.far.is_finite() && of.near < of.far) {
            return Err(CameraError::OrthographicPlanes { near: of.near, far: of.far });
        }
        let up = 0.5 * f64::from(of.height);
        let right = up * aspect(viewport)?;
        let projection = directx::orthographic(-right, right, -up, up, f64::from(of.near), f64::from(of.far));
        Ok(Self::of(projection, view, of.eye, of.depth, viewport, 1))
    }

    fn of(
        projection: DMat4,
        view: DMat4,
        eye: Vec3,
        depth: DepthRange,
        [width, height]: [u32; 2],
        kind: u32,
    ) -> Self {
        // Reversing is depth' = w - depth in clip space.
        let reverse = DMat4::from_cols_array(&[
            1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 1.0, 1.0,
        ]);
        let (projection, near_depth, far_depth) = match depth {
            DepthRange::Forward => (projection, 0.0, 1.0),
            DepthRange::Reversed => (reverse * projection, 1.0, 0.0),
        };
        let clip_from_world = projection * view;
        Self {
            clip_from_world: clip_from_world.as_mat4(),
            world_from_clip: clip_from_world.inverse().as_mat4(),
            eye,
            near_depth,
            viewport: Vec2::new(width as f32, height as f32),
            far_depth,
            projection: kind,
        }
    }

    /// True where near is 1 and far 0.
    pub fn is_reversed(&self) -> bool {
        self.far_depth < self.near_depth
    }
}

fn look(eye: Vec3, target: Vec3) -> Result<DMat4, CameraError> {
    let forward = forward(eye, target)?;
    let up = if forward.cross(DVec3::Y).length() < 1e-4 { DVec3::NEG_Z } else { DVec3::Y };
    Ok(looking::look_to_mat4(eye.as_dvec3(), forward, up))
}

fn look_up(eye: Vec3, target: Vec3, up: Vec3) -> Result<DMat4, CameraError> {
    let forward = forward(eye, target)?;
    let along = up.as_dvec3().normalize_or_zero();
    if !(up.is_finite() && forward.cross(along).length() > 1e-4) {
        return Err(CameraError::Up { up });
    }
    Ok(looking::look_to_mat4(eye.as_dvec3(), forward, along))
}

fn forward(eye: Vec3, target: Vec3) -> Result<DVec3, CameraError> {
    let direction = (target - eye).as_dvec3();
    if !(direction.is_finite() && eye.is_finite() && direction.length() > 1e-6) {
        return Err(CameraError::Direction { eye, target });
    }
    Ok(direction.normalize())
}

fn aspect([width, height]: [u32; 2]) -> Result<f64, CameraError> {
    if width == 0 || height == 0 {
        return Err(CameraError::Viewport { width, height });
    }
    Ok(f64::from(width) / f64::from(height))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn view() -> PerspectiveView {
        PerspectiveView {
            eye: Vec3::new(1.0, 2.0, 3.0),
            target: Vec3::ZERO,
            field_of_view: 50.0,
            near: 0.1,
            far: 50.0,
            depth: DepthRange::Forward,
        }
    }

    #[test]
    fn near_and_far_planes_have_the_stated_depths() {
        for depth in [DepthRange::Forward, DepthRange::Reversed] {
            let view = PerspectiveView { depth, ..view() };
            let camera = Camera::perspective(&view, [64, 32]).unwrap();
            let forward = (view.target - view.eye).normalize();
            for (distance, expected) in [(view.near, camera.near_depth), (view.far, camera.far_depth)] {
                let clip = camera.clip_from_world * (view.eye + forward * distance).extend(1.0);
                assert!(
                    (clip.z / clip.w - expected).abs() < 1e-4,
                    "{depth:?} {distance}: {}",
                    clip.z / clip.w
                );
            }
        }
    }

    #[test]
    fn degenerate_views_are_refused() {
        let wrong = [
            PerspectiveView { target: view().eye, ..view() },
            PerspectiveView { field_of_view: 0.0, ..view() },
            PerspectiveView { field_of_view: f32::NAN, ..view() },
            PerspectiveView { near: 0.0, ..view() },
            PerspectiveView { far: 0.05, ..view() },
            PerspectiveView { eye: Vec3::new(f32::INFINITY, 0.0, 0.0), ..view() },
        ];
        for view in wrong {
            assert!(Camera::perspective(&view, [64, 32]).is_err(), "{view:?}");
        }
        assert!(Camera::perspective(&view(), [0, 32]).is_err());
    }

    #[test]
    fn orthographic_views_have_their_height_and_depths() {
        for depth in [DepthRange::Forward, DepthRange::Reversed] {
            let (eye, target) = (Vec3::new(1.0, 2.0, 3.0), Vec3::new(1.0, 2.0, -3.0));
            let of = OrthographicView { eye, target, height: 4.0, near: -1.0, far: 9.0, depth };
            let camera = Camera::orthographic(&of, [64, 32]).unwrap();
            let corner =
                |along: f32| camera.clip_from_world.project_point3(eye + Vec3::new(4.0, 2.0, -along));
            assert!((corner(-1.0) - Vec3::new(1.0, 1.0, camera.near_depth)).length() < 1e-6);
            assert!((corner(9.0) - Vec3::new(1.0, 1.0, camera.far_depth)).length() < 1e-6);
            for wrong in [
                OrthographicView { height: 0.0, ..of },
                OrthographicView { height: f32::NAN, ..of },
                OrthographicView { far: f32::INFINITY, ..of },
                OrthographicView { near: 9.0, ..of },
                OrthographicView { target: eye, ..of },
            ] {
                assert!(Camera::new(&wrong.into(), [64, 32]).is_err(), "{wrong:?}");
            }
            assert!(Camera::orthographic(&of, [64, 0]).is_err());
        }
    }

    #[test]
    fn up_is_up_in_the_picture() {
        let of: View = view().into();
        assert_eq!(Camera::with_up(&of, 3.0 * Vec3::Y, [64, 32]), Camera::new(&of, [64, 32]));
        for up in [Vec3::X, Vec3::new(-1.0, -2.0, 0.5), -Vec3::Y] {
            let camera = Camera::with_up(&of, up, [64, 32]).unwrap();
            let seen = camera.clip_from_world.project_point3(Vec3::ZERO + 0.1 * up);
            assert!(seen.x.abs() < 1e-5 && seen.y > 0.01, "{up}: {seen}");
        }
        for wrong in [Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0), Vec3::NAN, Vec3::INFINITY] {
            assert!(matches!(Camera::with_up(&of, wrong, [64, 32]), Err(CameraError::Up { .. })), "{wrong}");
        }
    }
}
