// SPDX-License-Identifier: MIT OR Apache-2.0
//! What the picture shows of what was found, with the environment behind it.

use super::flags::{MethodSpelling, ShowSpelling};
use crate::core::Camera;
use crate::data::Environment;
use glam::{DMat4, DVec3, Vec3};
use std::f32::consts::FRAC_PI_2;

/// What was found of a surface in a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// Radiance towards the eye, linear RGB.
    pub radiance: Vec3,
    /// Share of the hemisphere that is open, 0..1.
    pub open: f32,
    /// Mean of the open directions; 0 where none is.
    pub mean: Vec3,
}

impl Seen {
    /// Numbers of it. Angles: degrees.
    pub fn numbers(&self, show: ShowSpelling, method: MethodSpelling) -> Vec3 {
        match show {
            ShowSpelling::Shaded => self.radiance,
            ShowSpelling::Openness => Vec3::splat(self.open),
            ShowSpelling::BentNormals => self.mean.normalize_or_zero(),
            ShowSpelling::Angles => Vec3::splat(angle(self.mean.length(), method).to_degrees()),
        }
    }
}

/// Half angle of the cone of a mean direction of such a length, radians: by Eq. 3.6 with `--method cones`, else exact; 0 without length.
fn angle(length: f32, method: MethodSpelling) -> f32 {
    let cosine = (2.0 * length - 1.0).clamp(0.0, 1.0);
    match method {
        _ if length <= 0.0 => 0.0,
        MethodSpelling::Cones => (1.0 - cosine) * FRAC_PI_2,
        _ => cosine.acos(),
    }
}

/// View rays of a camera through the middles of its pixels.
pub struct Rays {
    world_from_clip: DMat4,
    depths: [f64; 2],
    size: [u32; 2],
}

impl Rays {
    /// Of a camera whose planes are not at infinity.
    pub fn of(camera: &Camera) -> Self {
        Self {
            world_from_clip: camera.world_from_clip.as_dmat4(),
            depths: [camera.near_depth, camera.far_depth].map(f64::from),
            size: camera.viewport.to_array().map(|side| side as u32),
        }
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Where the ray of a pixel begins, on the near plane, and its unit direction.
    pub fn at(&self, x: u32, y: u32) -> [DVec3; 2] {
        let [width, height] = self.size.map(f64::from);
        let (x, y) = (2.0 * (f64::from(x) + 0.5) / width - 1.0, 1.0 - 2.0 * (f64::from(y) + 0.5) / height);
        let [near, far] = self.depths.map(|z| self.world_from_clip.project_point3(DVec3::new(x, y, z)));
        [near, (far - near).normalize_or(DVec3::NEG_Z)]
    }
}

/// Surfaces before the environment: linear RGBA, rows from the top, alpha 1.
pub fn before(seen: &[Option<Seen>], environment: &Environment, camera: &Camera) -> Vec<f32> {
    let rays = Rays::of(camera);
    let [width, _] = rays.size();
    let pixel = |(place, seen): (u32, &Option<Seen>)| {
        let behind = || {
            let [_, direction] = rays.at(place % width, place / width);
            environment.radiance_between(direction.as_vec3())
        };
        seen.map_or_else(behind, |seen| seen.radiance).extend(1.0).to_array()
    };
    (0..).zip(seen).flat_map(pixel).collect()
}

/// Numbers as RGB, rows from the top; 0 where nothing is seen.
pub fn numbers(seen: &[Option<Seen>], show: ShowSpelling, method: MethodSpelling) -> Vec<f32> {
    let pixel = |seen: &Option<Seen>| seen.map_or(Vec3::ZERO, |seen| seen.numbers(show, method)).to_array();
    seen.iter().flat_map(pixel).collect()
}

/// Numbers as a picture to look at, RGB of 8 bits: bent normals from -1..1, angles from 0 to 90 degrees, openness from 0..1; black where
/// nothing is seen.
pub fn bytes(seen: &[Option<Seen>], show: ShowSpelling, method: MethodSpelling) -> Vec<u8> {
    let shade = |value: f32| match show {
        ShowSpelling::BentNormals => 0.5 + 0.5 * value,
        ShowSpelling::Angles => value / 90.0,
        ShowSpelling::Shaded | ShowSpelling::Openness => value,
    };
    let byte = |value: f32| (shade(value).clamp(0.0, 1.0) * 255.0).round() as u8;
    let pixel =
        |seen: &Option<Seen>| seen.map_or([0; 3], |seen| seen.numbers(show, method).to_array().map(byte));
    seen.iter().flat_map(pixel).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::core::{DepthRange, OrthographicView, PerspectiveView, View};

    #[test]
    fn angles_are_those_of_open_and_of_narrow_places() {
        for (length, cones, exact) in
            [(0.0, 0.0, 0.0), (0.3, 90.0, 90.0), (0.75, 45.0, 60.0), (1.0, 0.0, 0.0)]
        {
            for (method, expected) in [(MethodSpelling::Cones, cones), (MethodSpelling::ExactCones, exact)] {
                let found = angle(length, method).to_degrees();
                assert!((found - expected).abs() < 1e-3, "{length} {method:?}: {found}");
            }
        }
    }

    #[test]
    fn rays_go_through_the_middles_of_pixels() {
        let (eye, target) = (Vec3::new(1.0, 2.0, 3.0), Vec3::new(1.0, 2.0, -4.0));
        let (near, far, depth) = (0.5, 20.0, DepthRange::Forward);
        let views: [View; 2] = [
            PerspectiveView { eye, target, field_of_view: 90.0, near, far, depth }.into(),
            OrthographicView { eye, target, height: 2.0, near, far, depth }.into(),
        ];
        // The pixel in the upper right corner of 4 x 2.
        let expected = [[[1.75, 2.25, 2.5], [1.5, 0.5, -1.0]], [[2.5, 2.5, 2.5], [0.0, 0.0, -1.0]]]
            .map(|ray| ray.map(DVec3::from));
        for (view, [origin, direction]) in views.iter().zip(expected) {
            let rays = Rays::of(&Camera::new(view, [4, 2]).unwrap());
            let [from, towards] = rays.at(3, 0);
            assert!(
                from.distance(origin) < 1e-4 && towards.distance(direction.normalize()) < 1e-5,
                "{from} {towards}"
            );
        }
    }
}
