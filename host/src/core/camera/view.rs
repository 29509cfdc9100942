// SPDX-License-Identifier: MIT OR Apache-2.0
//! Views in the words of a person.

use glam::Vec3;

/// Which way clip depth runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DepthRange {
    /// Near 0, far 1.
    #[default]
    Forward,
    /// Near 1, far 0.
    Reversed,
}

/// A perspective view in the words of a person. World in metres, y up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PerspectiveView {
    /// Position of the eye.
    pub eye: Vec3,
    /// Point in the middle of the picture.
    pub target: Vec3,
    /// Vertical field of view, degrees.
    pub field_of_view: f32,
    /// Distance of the near plane, metres.
    pub near: f32,
    /// Distance of the far plane, metres; may be infinite.
    pub far: f32,
    /// Which way clip depth runs.
    pub depth: DepthRange,
}

/// An orthographic view in the words of a person. World in metres, y up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OrthographicView {
    /// Where distances of the planes are measured from.
    pub eye: Vec3,
    /// Point in the middle of the picture.
    pub target: Vec3,
    /// Height of the picture, metres.
    pub height: f32,
    /// Distance of the near plane, metres; negative behind the eye.
    pub near: f32,
    /// Distance of the far plane, metres, finite.
    pub far: f32,
    /// Which way clip depth runs.
    pub depth: DepthRange,
}

/// A view of either kind.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum View {
    /// View rays leave the eye.
    Perspective(PerspectiveView),
    /// View rays are parallel.
    Orthographic(OrthographicView),
}

impl From<PerspectiveView> for View {
    fn from(view: PerspectiveView) -> Self {
        Self::Perspective(view)
    }
}

impl From<OrthographicView> for View {
    fn from(view: OrthographicView) -> Self {
        Self::Orthographic(view)
    }
}

impl View {
    /// Distance of the far plane, metres.
    pub fn far(&self) -> f32 {
        match self {
            Self::Perspective(view) => view.far,
            Self::Orthographic(view) => view.far,
        }
    }

    /// The perspective view, if it is one.
    pub fn perspective(&self) -> Option<PerspectiveView> {
        match self {
            Self::Perspective(view) => Some(*view),
            Self::Orthographic(_) => None,
        }
    }

    /// Position of the eye.
    pub fn eye(&self) -> Vec3 {
        match self {
            Self::Perspective(view) => view.eye,
            Self::Orthographic(view) => view.eye,
        }
    }

    /// Point in the middle of the picture.
    pub fn target(&self) -> Vec3 {
        match self {
            Self::Perspective(view) => view.target,
            Self::Orthographic(view) => view.target,
        }
    }
}
