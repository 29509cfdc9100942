// SPDX-License-Identifier: MIT OR Apache-2.0
//! Light that single scattering sends to the viewer, from far lights by fine marching, and pictures of one light at a time.

use super::grid::{Basis, Grid, place};
use super::matrix::{Matrix, Medium, Part, Property, Weights};
use super::ray::{Ray, VolumeBox};
use super::steps::Sample;
use crate::linear::Vec3;
use crate::parallel;
use std::f64::consts::PI;

/// A part of the surroundings, as a direction.
#[derive(Clone, Copy, Debug)]
pub struct DirectionalLight {
    /// Unit vector TOWARDS the light.
    pub towards: Vec3,
    /// One channel.
    pub radiance: f64,
    /// What it takes of all directions, steradians.
    pub solid_angle: f64,
}

/// Transmittance from a point of the world out of the box in a direction, by the midpoint rule of as many steps.
#[must_use]
pub fn transmittance_to(
    volume: &VolumeBox,
    extinction: &Grid,
    point: Vec3,
    towards: Vec3,
    steps: usize,
) -> f64 {
    transmittance_within(volume, extinction, point, towards, f64::INFINITY, steps)
}

/// The same as far as a distance, metres.
#[must_use]
pub fn transmittance_within(
    volume: &VolumeBox,
    extinction: &Grid,
    point: Vec3,
    towards: Vec3,
    distance: f64,
    steps: usize,
) -> f64 {
    let ray = Ray { origin: point, direction: towards, depth: distance };
    let whole = [Vec3::default(), Vec3::new(1.0, 1.0, 1.0)];
    let Some([begin, end]) = volume.clip(&ray, whole) else { return 1.0 };
    let step = (end - begin) / steps as f64;
    let at = |i: usize| volume.unit(point + towards * (begin + (i as f64 + 0.5) * step));
    let sum: f64 = (0..steps).map(|i| extinction.at(Basis::Trilinear, at(i))).sum();
    (-sum * step).exp()
}

/// A light at a point of the world.
#[derive(Clone, Copy, Debug)]
pub struct LocalLight {
    /// Metres.
    pub position: Vec3,
    /// Nearer than this its light does not grow, metres.
    pub radius: f64,
    /// Radiant intensity of one channel.
    pub intensity: f64,
    /// Unit vector along which a spot shines, and the cosines of the angles from it up to which it shines fully and at all.
    pub cone: Option<(Vec3, [f64; 2])>,
}

impl LocalLight {
    /// Irradiance at normal incidence without a medium: as in `core/light`.
    #[must_use]
    pub fn irradiance(&self, point: Vec3) -> f64 {
        let way = point - self.position;
        let fall = self.cone.map_or(1.0, |(axis, [inner, outer])| {
            let part = ((way.normalised().dot(axis) - outer) / (inner - outer)).clamp(0.0, 1.0);
            part * part * (3.0 - 2.0 * part)
        });
        self.intensity * fall / (way.dot(way) + self.radius * self.radius)
    }
}

/// What [`scattered_grid`] says of a light at a point, without surfaces.
#[must_use]
pub fn local_grid(
    volume: &VolumeBox,
    extinction: &Grid,
    light: &LocalLight,
    size: [usize; 3],
    steps: usize,
) -> Grid {
    let value = |index: usize| {
        let point = volume.world(place(size, index));
        let way = light.position - point;
        let (towards, distance) = (way.normalised(), way.length());
        let through = transmittance_within(volume, extinction, point, towards, distance, steps);
        light.irradiance(point) / (4.0 * PI) * through
    };
    Grid { size, values: parallel::rows(size.iter().product(), value) }
}

/// Light that an albedo of 1 would scatter in every direction at a point of the world, radiance. `visible` is the share of
/// the light in a direction that surfaces let come to a point, both of the world.
#[must_use]
pub fn scattered(
    volume: &VolumeBox,
    extinction: &Grid,
    lights: &[DirectionalLight],
    point: Vec3,
    steps: usize,
    visible: impl Fn(Vec3, Vec3) -> f64,
) -> f64 {
    let of_light = |light: &DirectionalLight| {
        let through = transmittance_to(volume, extinction, point, light.towards, steps);
        light.radiance * light.solid_angle / (4.0 * PI) * visible(point, light.towards) * through
    };
    lights.iter().map(of_light).sum()
}

/// [`scattered`] at every value of a grid.
#[must_use]
pub fn scattered_grid(
    volume: &VolumeBox,
    extinction: &Grid,
    lights: &[DirectionalLight],
    size: [usize; 3],
    steps: usize,
    visible: impl Fn(Vec3, Vec3) -> f64 + Sync,
) -> Grid {
    let value = |index: usize| {
        scattered(volume, extinction, lights, volume.world(place(size, index)), steps, &visible)
    };
    Grid { size, values: parallel::rows(size.iter().product(), value) }
}

/// The matrix T whose columns are pictures of the medium in each light alone: `volumes` hold the light that each scatters
/// where it has radiance 1, `albedo` is trilinear, and both are taken at the samples before they are multiplied.
///
/// Its one part has a value a light. With albedo 1 in a grid of one value, the volumes may be products with an albedo.
#[must_use]
pub fn light_columns(rays: &[Vec<Sample>], extinction: &Grid, albedo: &Grid, volumes: &[Grid]) -> Matrix {
    // Albedo is the known factor here and the light the unknown one.
    let part = Part { property: Property::Albedo, size: albedo.size, basis: Basis::Trilinear };
    let columns: Vec<Vec<f64>> = volumes
        .iter()
        .map(|scattered| {
            let medium = Medium { extinction: extinction.clone(), scattered: scattered.clone() };
            Matrix::new(rays, &medium, &[part]).apply(&albedo.values)
        })
        .collect();
    let row = |k: usize| columns.iter().enumerate().map(|(j, column)| (j, column[k])).collect();
    Matrix {
        parts: vec![Part { size: [volumes.len(), 1, 1], ..part }],
        rows: (0..rays.len()).map(row).collect(),
        transmittance: rays.iter().map(|ray| Weights::new(ray, extinction).transmittance).collect(),
    }
}

#[cfg(test)]
mod tests;
