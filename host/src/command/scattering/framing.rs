// SPDX-License-Identifier: MIT OR Apache-2.0
//! Cameras, light and air, with what was not said taken from the mesh.

use super::flags::Options;
use crate::Lighting;
use crate::command::CommandError;
use crate::command::parse::{DepthSpelling, Projection};
use crate::core::{Camera, CameraError, OrthographicView, PerspectiveView, View};
use crate::data::Bounds;
use crate::scattering::Medium;
use crate::{StageError, scenes};
use glam::Vec3;

/// What a directional light gives a surface that faces it.
const RADIANCE: Vec3 = Vec3::new(12.0, 10.5, 8.4);
/// Field of view, degrees.
const FIELD_OF_VIEW: f32 = 45.0;
/// Optical depth of the air.
const OPTICAL_DEPTH: f32 = 0.7;

/// The views, left before right, and the air.
pub struct Framing {
    /// One view, or those of two eyes.
    pub views: Vec<View>,
    /// Their cameras.
    pub cameras: Vec<Camera>,
    /// The light.
    pub light: Lighting,
    /// The air.
    pub medium: Medium,
}

impl Framing {
    /// Takes what was not said from the box around the mesh.
    ///
    /// # Errors
    /// Misuse: values that no camera or medium can have.
    pub fn new(flags: &Options, bounds: &Bounds) -> Result<Self, CommandError> {
        if let (DepthSpelling::Infinite, Some(near), Some(far)) = (flags.depth_range, flags.near, flags.far)
            && near >= far
        {
            // Where there is no far plane the camera does not mind where the air ends.
            return Err(StageError::Camera(CameraError::Planes { near, far }).into());
        }
        let (view, extent, limit) = match flags.camera {
            Projection::Perspective => perspective(flags, bounds),
            Projection::Orthographic => orthographic(flags, bounds),
        };
        let camera = |view: &View| {
            Camera::new(view, flags.size).map_err(|error| CommandError::from(StageError::Camera(error)))
        };
        let views = match flags.stereo {
            None => vec![view],
            Some(apart) => {
                let right = camera(&view)?.clip_from_world.row(0).truncate().normalize_or_zero();
                vec![moved(view, right * (-0.5 * apart)), moved(view, right * (0.5 * apart))]
            }
        };
        let extinction = flags.extinction.unwrap_or(OPTICAL_DEPTH / extent);
        Ok(Self {
            cameras: views.iter().map(camera).collect::<Result<_, _>>()?,
            views,
            light: flags
                .light
                .lighting(flags.radiance.unwrap_or_else(|| flags.light.radiance_as(RADIANCE, bounds))),
            medium: Medium::new(extinction, Vec3::splat(flags.albedo), flags.g, limit)?,
        })
    }
}

/// The view, the length of air that it is to show, and the limit of distances; metres.
fn perspective(flags: &Options, bounds: &Bounds) -> (View, f32, f32) {
    let field_of_view = flags.fov.unwrap_or(FIELD_OF_VIEW);
    let framing = scenes::framing(bounds, field_of_view.clamp(0.1, 170.0));
    let eye = flags.eye.unwrap_or(framing.eye);
    let target = flags.target.unwrap_or(framing.target);
    // With an eye of the user's the planes must still hold the whole mesh.
    let distance = (bounds.center() - eye).length();
    let end = flags.far.unwrap_or(distance + 2.0 * bounds.radius().max(1e-3));
    let near = flags.near.unwrap_or(end * 1e-3);
    let (depth, far) = flags.depth_range.range(end);
    let view = PerspectiveView { eye, target, field_of_view, near, far, depth };
    // Rays to the corners of the far plane are longer than the plane is far; without a plane the limit is the end.
    let longest = if far.is_finite() { 4.0 } else { 1.0 };
    (view.into(), end, limit(end * longest))
}

fn orthographic(flags: &Options, bounds: &Bounds) -> (View, f32, f32) {
    let radius = bounds.radius().max(1e-3);
    let eye = flags.eye.unwrap_or_else(|| scenes::framing(bounds, FIELD_OF_VIEW).eye);
    let target = flags.target.unwrap_or(bounds.center());
    let height = flags.height.unwrap_or(2.5 * radius);
    let distance = (bounds.center() - eye).length();
    let near = flags.near.unwrap_or(distance - 1.5 * radius);
    let far = flags.far.unwrap_or(distance + 1.5 * radius);
    let (depth, far) = flags.depth_range.range(far);
    let view = OrthographicView { eye, target, height, near, far, depth };
    (view.into(), (far - near).max(1e-3), limit((far - near) * 4.0))
}

/// A limit of distances for planes that may still turn out to be impossible.
fn limit(metres: f32) -> f32 {
    if metres.is_finite() && metres > 0.0 { metres.min(1e7) } else { 1.0 }
}

/// The view from an eye elsewhere that looks the same way.
fn moved(view: View, by: Vec3) -> View {
    match view {
        View::Perspective(view) => {
            PerspectiveView { eye: view.eye + by, target: view.target + by, ..view }.into()
        }
        View::Orthographic(view) => {
            OrthographicView { eye: view.eye + by, target: view.target + by, ..view }.into()
        }
    }
}
