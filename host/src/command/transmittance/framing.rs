// SPDX-License-Identifier: MIT OR Apache-2.0
//! Camera and light around a medium, with what was not said taken from its box.

use super::flags::Options;
use super::medium::Medium;
use crate::StageError;
use crate::command::CommandError;
use crate::command::parse::Projection;
use crate::core::{Camera, DepthRange, Light, OrthographicView, PerspectiveView, View};
use crate::data::Bounds;
use crate::transmittance::MediumLighting;
use glam::Vec3;

/// Share of the picture that the box of the medium fills at most.
const FILLED: f32 = 0.98;
/// Of a perspective camera, vertical, degrees.
const FIELD_OF_VIEW: f32 = 35.0;
/// From the medium to the eye.
const FROM: Vec3 = Vec3::new(-0.4, 0.1, 1.0);

/// What the passes are given.
pub struct Framing {
    /// The camera.
    pub camera: Camera,
    /// The light, whose map holds the medium.
    pub light: Light,
    /// How the medium scatters.
    pub lighting: MediumLighting,
}

impl Framing {
    /// Takes what was not said from the box of the medium.
    ///
    /// # Errors
    /// Misuse: values that no camera or medium can have.
    pub fn new(flags: &Options, medium: &Medium) -> Result<Self, CommandError> {
        let target = flags.target.unwrap_or(medium.framed.center());
        let [width, height] = flags.size.map(|side| side as f32);
        let (fov, aspect) = (flags.fov.unwrap_or(FIELD_OF_VIEW), width / height);
        let distance = distance(&medium.framed, fov.clamp(0.1, 170.0), aspect);
        let eye = flags.eye.unwrap_or(target + FROM.normalize() * distance);
        let away = (medium.bounds.center() - eye).length();
        let radius = medium.bounds.radius().max(1e-4);
        let far = away + 1.1 * radius;
        let depth = DepthRange::Forward;
        let view: View = match flags.camera {
            Projection::Perspective => {
                let near = (away - 1.1 * radius).max(1e-3 * far);
                PerspectiveView { eye, target, field_of_view: fov, near, far, depth }.into()
            }
            Projection::Orthographic => {
                let height = flags.height.unwrap_or(extent(&medium.framed, aspect));
                OrthographicView { eye, target, height, near: away - 1.1 * radius, far, depth }.into()
            }
        };
        let camera = Camera::new(&view, flags.size).map_err(StageError::Camera)?;
        let light = medium.light(flags.light.lighting(flags.radiance)).map_err(StageError::Light)?;
        Ok(Self {
            camera,
            light,
            // Rays to the corners of the far plane are longer than the plane is far.
            lighting: MediumLighting::new(flags.albedo, flags.g, (4.0 * far).min(1e7))?,
        })
    }
}

/// Right and up of an eye that looks from where it is put.
fn across() -> [Vec3; 2] {
    let back = FROM.normalize();
    let right = Vec3::Y.cross(back).normalize();
    [right, back.cross(right)]
}

/// The height of a picture by parallel rays that holds a box, metres. `aspect`: width to height.
fn extent(bounds: &Bounds, aspect: f32) -> f32 {
    let [right, up] = across();
    let half = bounds.corners().map(|corner| {
        let from = corner - bounds.center();
        (from.dot(right).abs() / aspect).max(from.dot(up).abs())
    });
    2.0 * half.into_iter().fold(1e-4, f32::max) / FILLED
}

/// How far from the middle of a box the eye sees all of it. `field_of_view`: vertical, degrees; `aspect`: width to height.
fn distance(bounds: &Bounds, field_of_view: f32, aspect: f32) -> f32 {
    let back = FROM.normalize();
    let [right, up] = across();
    let tangent = FILLED * (0.5 * field_of_view.to_radians()).tan();
    let corner = |corner: Vec3| {
        let from = corner - bounds.center();
        let across = (from.dot(right).abs() / aspect).max(from.dot(up).abs());
        from.dot(back) + across / tangent
    };
    bounds.corners().map(corner).into_iter().fold(1e-3, f32::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_fill_the_picture_and_no_more() {
        for (size, aspect) in
            [(Vec3::new(6.0, 3.0, 5.0), 1.8), (Vec3::new(2.0, 5.0, 2.0), 1.8), (Vec3::ONE, 0.5)]
        {
            let bounds = Bounds { min: Vec3::ZERO, max: size };
            let eye = bounds.center() + FROM.normalize() * distance(&bounds, 40.0, aspect);
            let (target, near, far, depth) = (bounds.center(), 0.1, 100.0, DepthRange::Forward);
            let views: [View; 2] = [
                PerspectiveView { eye, target, field_of_view: 40.0, near, far, depth }.into(),
                OrthographicView { eye, target, height: extent(&bounds, aspect), near, far, depth }.into(),
            ];
            for view in views {
                let camera = Camera::new(&view, [(1000.0 * aspect) as u32, 1000]).expect("a camera");
                let seen = bounds.corners().map(|corner| camera.clip_from_world.project_point3(corner));
                let most = seen.iter().map(|at| at.x.abs().max(at.y.abs())).fold(0.0, f32::max);
                assert!((most - FILLED).abs() < 0.01, "{size} fills {most}");
            }
        }
    }
}
