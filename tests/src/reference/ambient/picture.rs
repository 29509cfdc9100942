// SPDX-License-Identifier: MIT OR Apache-2.0
//! Reference pictures: every pixel traced, shaded with the truth and with the three approximations.

use super::directions::Pattern;
use super::environment::{Environment, Rgb};
use super::scene::Scene;
use super::shade::{Approximations, Brightness, approximations, outgoing};
use super::visibility::{Angle, Reach, Statistics, trace};
use crate::linear::Vec3;
use crate::parallel;
use crate::reference::camera::Camera;
use std::f64::consts::TAU;

/// What pictures are computed with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Directions of visibility at each pixel.
    pub directions: u32,
    /// Directions of each light integral (Eq. 3.7 and 3.9).
    pub light_directions: u32,
    /// How far occluders reach.
    pub reach: Reach,
    /// How far points are lifted along their normals before they look around, metres: 0 for points that lie on the
    /// triangles, more for points from a depth buffer.
    pub lift: f64,
    /// Angle of the cones.
    pub angle: Angle,
    /// Factor of the light.
    pub brightness: Brightness,
}

/// A point to be shaded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// World, metres.
    pub position: Vec3,
    /// Unit vector.
    pub normal: Vec3,
}

/// A shaded pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pixel {
    /// What it shows.
    pub surface: Surface,
    /// Visibility there.
    pub statistics: Statistics,
    /// What it sends out.
    pub truth: Rgb,
    /// What the methods make of that.
    pub approximations: Approximations,
}

/// What a camera sees of a scene through the middles of its pixels, row by row from the top; none where that is nothing.
#[must_use]
pub fn surfaces(scene: &Scene, camera: &Camera, width: usize, height: usize) -> Vec<Option<Surface>> {
    let row = |y: usize| -> Vec<_> {
        let pixel = |x: usize| {
            let ndc = Camera::pixel_ndc(x, y, width, height);
            let direction = camera.ray(ndc);
            let hit = scene.hit(camera.origin(ndc), direction)?;
            Some(Surface { position: scene.position(&hit), normal: scene.normal(&hit, direction) })
        };
        (0..width).map(pixel).collect()
    };
    parallel::rows(height, row).into_iter().flatten().collect()
}

/// The points of a picture shaded, in order; `width` of them are one piece of work. The patterns of neighbours are turned
/// against each other, the same in every picture.
///
/// # Panics
/// If `width` is 0.
#[must_use]
pub fn picture(
    scene: &Scene,
    environment: &Environment,
    surfaces: &[Option<Surface>],
    width: usize,
    settings: &Settings,
) -> Vec<Option<Pixel>> {
    let directions = Pattern::new(settings.directions);
    let light_directions = Pattern::new(settings.light_directions);
    let shade = |place: usize, surface: Surface| {
        let Surface { position, normal } = surface;
        // Fractions of the golden section.
        let turn = TAU * (place as f64 * 0.618_033_988_749_894_9).fract();
        let point = position + normal * settings.lift;
        let samples = trace(scene, point, normal, &directions, turn, settings.reach);
        let statistics = Statistics::of(normal, &samples);
        Pixel {
            surface,
            statistics,
            truth: outgoing(environment, normal, &samples),
            approximations: approximations(
                environment,
                normal,
                &statistics,
                settings.angle,
                settings.brightness,
                &light_directions,
            ),
        }
    };
    let row = |y: usize| -> Vec<_> {
        let begin = y * width;
        let end = surfaces.len().min(begin + width);
        (begin..end).map(|place| surfaces[place].map(|surface| shade(place, surface))).collect()
    };
    parallel::rows(surfaces.len().div_ceil(width), row).into_iter().flatten().collect()
}
