// SPDX-License-Identifier: MIT OR Apache-2.0
//! Why a camera is impossible.

use glam::Vec3;

/// What makes a camera impossible.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CameraError {
    /// Eye and target coincide, or one of them is not finite.
    #[error("eye {eye} and target {target} give no direction: they must be finite and apart")]
    Direction {
        /// Position of the eye.
        eye: Vec3,
        /// Point looked at.
        target: Vec3,
    },
    /// What should be up runs along the view, or is no direction.
    #[error("up {up} is impossible: it must be finite, not zero, and not along the view from eye to target")]
    Up {
        /// What should be up.
        up: Vec3,
    },
    /// The field of view is not an angle that a picture can have.
    #[error("field of view {degrees} degrees is impossible: it must lie between 0.1 and 170")]
    FieldOfView {
        /// The vertical angle, in degrees.
        degrees: f32,
    },
    /// The depth range is empty.
    #[error("near plane {near} m and far plane {far} m are impossible: 0 < near < far is needed")]
    Planes {
        /// Distance of the near plane.
        near: f32,
        /// Distance of the far plane.
        far: f32,
    },
    /// The depth range of an orthographic view is empty.
    #[error(
        "near plane {near} m and far plane {far} m are impossible for an orthographic view: \
         near < far is needed, both finite"
    )]
    OrthographicPlanes {
        /// Distance of the near plane.
        near: f32,
        /// Distance of the far plane.
        far: f32,
    },
    /// An orthographic picture has no height.
    #[error(
        "a picture of {0} m is impossible: the height of an orthographic view must be positive and finite"
    )]
    Height(f32),
    /// The picture has no pixels.
    #[error("a picture of {width}x{height} pixels is impossible: both must be at least 1")]
    Viewport {
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
    },
}
