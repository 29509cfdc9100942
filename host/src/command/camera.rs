// SPDX-License-Identifier: MIT OR Apache-2.0
//! The eye around a volume or particles: its flags, and what was not said of them.

use super::fit::Fit;
use super::parse::{self, Projection};
use crate::core::{DepthRange, OrthographicView, PerspectiveView, View};
use glam::{Quat, Vec3};

/// Of a perspective camera, vertical, degrees.
const FIELD_OF_VIEW: f32 = 35.0;

/// Flags of the camera.
#[derive(clap::Args, Clone, Debug)]
pub struct CameraFlags {
    /// How view rays run.
    #[arg(long, value_enum, default_value = "perspective")]
    pub camera: Projection,
    /// Position of the eye, metres [default: frames what is there].
    #[arg(long, value_name = "X,Y,Z", value_parser = parse::vector, allow_hyphen_values = true)]
    pub eye: Option<Vec3>,
    /// Point in the middle of the picture, metres [default: the middle of what is there].
    #[arg(long, value_name = "X,Y,Z", value_parser = parse::vector, allow_hyphen_values = true)]
    pub target: Option<Vec3>,
    /// Vertical field of view of a perspective camera, degrees [default: 35].
    #[arg(long, value_name = "DEG", value_parser = parse::number, allow_hyphen_values = true)]
    pub fov: Option<f32>,
    /// Height of the picture of an orthographic camera, metres [default: frames what is there].
    #[arg(long, value_name = "M", value_parser = parse::number, allow_hyphen_values = true)]
    pub height: Option<f32>,
}

/// What is to be seen, and from where.
pub struct Subject<'a> {
    /// What lies in the middle of the picture, metres.
    pub center: Vec3,
    /// Points whose convex hull is to be in the picture, metres.
    pub points: &'a [Vec3],
    /// Middle and radius of a ball that lies between near and far plane, metres.
    pub ball: (Vec3, f32),
    /// From the middle to the eye, of any length; not upright.
    pub from: Vec3,
    /// By how much the eye goes round the upright axis through the target, degrees.
    pub turn: f64,
}

impl CameraFlags {
    /// What is wrong with these flags together, in the form of [`Projection::framing_rules`].
    pub fn rules(&self) -> [(bool, &'static str, &'static str); 2] {
        self.camera.framing_rules(self.fov.is_some(), self.height.is_some())
    }

    /// The view, with what was not said taken from the subject.
    pub fn view(&self, subject: &Subject<'_>, [width, height]: [u32; 2]) -> View {
        let points = || subject.points.iter().copied();
        let target = self.target.unwrap_or(subject.center);
        let field_of_view = self.fov.unwrap_or(FIELD_OF_VIEW);
        let aspect = width as f32 / height as f32;
        let fit = Fit { center: subject.center, from: subject.from.normalize(), aspect };
        let distance = fit.distance(points(), field_of_view.clamp(0.1, 170.0));
        let eye = self.eye.unwrap_or(target + fit.from * distance);
        let eye = match subject.turn % 360.0 {
            0.0 => eye,
            turn => target + Quat::from_rotation_y(turn.to_radians() as f32) * (eye - target),
        };
        let (middle, radius) = subject.ball;
        let away = middle.distance(eye);
        let far = away + 1.1 * radius;
        let depth = DepthRange::Forward;
        match self.camera {
            Projection::Perspective => {
                let near = (away - 1.1 * radius).max(1e-3 * far);
                PerspectiveView { eye, target, field_of_view, near, far, depth }.into()
            }
            Projection::Orthographic => {
                let height = self.height.unwrap_or_else(|| fit.height(points()));
                OrthographicView { eye, target, height, near: away - 1.1 * radius, far, depth }.into()
            }
        }
    }
}

/// Where points come when they go all the way round the upright axis through `center`, so that their convex hull holds all of it.
pub fn all_around(center: Vec3, points: impl IntoIterator<Item = Vec3>) -> Vec<Vec3> {
    const AROUND: u16 = 32;
    let ring = |point: Vec3| {
        let radius = (point - center).with_y(0.0).length() / (std::f32::consts::PI / f32::from(AROUND)).cos();
        (0..AROUND).map(move |step| {
            let (sine, cosine) = (std::f32::consts::TAU * f32::from(step) / f32::from(AROUND)).sin_cos();
            Vec3::new(center.x + radius * sine, point.y, center.z + radius * cosine)
        })
    };
    points.into_iter().flat_map(ring).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::core::Camera;

    #[test]
    fn points_stay_in_the_picture_however_the_eye_turns() {
        let flags =
            CameraFlags { camera: Projection::Perspective, eye: None, target: None, fov: None, height: None };
        let center = Vec3::new(1.0, 2.0, 3.0);
        let corners = [Vec3::new(4.0, 1.0, 3.5), Vec3::new(-2.0, 3.0, 2.5)];
        let points = all_around(center, corners);
        for camera in [Projection::Perspective, Projection::Orthographic] {
            let flags = CameraFlags { camera, ..flags.clone() };
            for turn in [0.0, 10.0, 85.0, 191.0, 36000.0 + 300.0] {
                let from = Vec3::new(-0.4, 0.1, 1.0);
                let subject = Subject { center, points: &points, ball: (center, 4.0), from, turn };
                let camera = Camera::new(&flags.view(&subject, [40, 30]), [40, 30]).unwrap();
                for corner in corners {
                    let seen = camera.clip_from_world.project_point3(corner);
                    assert!(
                        seen.x.abs() < 1.0 && seen.y.abs() < 1.0 && (0.0..1.0).contains(&seen.z),
                        "{seen}"
                    );
                }
            }
        }
    }
}
