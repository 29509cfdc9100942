// SPDX-License-Identifier: MIT OR Apache-2.0
//! A cone of ash below a plume, under a sky: a background, since none of it hides any of what is above height 0.

use super::super::transmittance::sky::Sky;
use crate::data::fractal_noise;
use glam::Vec3;

/// Height of the rim of the crater, metres, below 0.
const RIM: f32 = -0.02;
/// Radius of the crater, metres.
const CRATER: f32 = 0.75;
/// Farther away all is haze, metres.
const FAR: f32 = 60.0;

/// The cone about the y axis.
pub struct Mountain<'a> {
    /// Towards it, and its irradiance.
    pub sun: (Vec3, Vec3),
    /// Above it.
    pub sky: &'a Sky,
}

impl Mountain<'_> {
    /// Height at a place, metres.
    fn height(x: f32, z: f32) -> f32 {
        let away = x.hypot(z);
        // Steep above and flat below, a bowl inside; gullies run down.
        let flank = (away - CRATER).max(0.0);
        let cone = RIM - 4.6 * (1.0 - (-flank / 6.5).exp());
        let bowl = (CRATER - away).max(0.0);
        let turn = Vec3::new(x, 0.0, z) / away.max(0.2);
        let gully = fractal_noise(41, 3.2 * turn + Vec3::Y * 0.12 * away, 4) - 0.5;
        let rough = fractal_noise(42, Vec3::new(1.3 * x, 0.0, 1.3 * z), 4) - 0.5;
        let least = (flank / 0.6).min(1.0);
        (cone - 0.6 * bowl + least * (0.9 * (flank * 0.35).min(1.0) * gully + 0.28 * rough)).min(RIM)
    }

    /// Radiance along a ray.
    pub fn radiance(&self, eye: Vec3, way: Vec3) -> Vec3 {
        let (sun, irradiance) = self.sun;
        let sky = self.sky.radiance(way, sun);
        let Some(distance) = Self::hit(eye, way) else { return sky };
        let at = eye + distance * way;
        let step = 0.02 + 0.002 * distance;
        let slope = |x: f32, z: f32| {
            (Self::height(at.x + x, at.z + z) - Self::height(at.x - x, at.z - z)) / (2.0 * step)
        };
        let normal = Vec3::new(-slope(step, 0.0), 1.0, -slope(0.0, step)).normalize();
        let shadow = if Self::shaded(at, sun) { 0.0 } else { 1.0 };
        let grain = 0.7 + 0.6 * fractal_noise(43, 5.0 * at, 3);
        let ash = grain * Vec3::new(0.085, 0.078, 0.075);
        let direct = irradiance * (normal.dot(sun).max(0.0) * shadow / std::f32::consts::PI);
        let lit = ash * (direct + (0.5 + 0.5 * normal.y) * (self.sky.zenith + self.sky.horizon) * 0.9);
        let haze = self.sky.radiance(Vec3::new(way.x, 0.03, way.z).normalize(), sun);
        haze.lerp(lit, (-0.035 * distance).exp())
    }

    fn hit(eye: Vec3, way: Vec3) -> Option<f32> {
        if way.y > -1e-3 && eye.y > 0.0 {
            return None;
        }
        // Nothing is higher than the rim.
        let mut near = ((RIM - eye.y) / way.y).max(0.0);
        while near < FAR {
            let at = eye + near * way;
            let above = at.y - Self::height(at.x, at.z);
            if above < 1e-3 * near {
                return Some(near);
            }
            near += (0.45 * above).max(4e-4 * near);
        }
        None
    }

    fn shaded(at: Vec3, sun: Vec3) -> bool {
        let mut along = 0.06;
        while along < 6.0 {
            let here = at + along * sun;
            if here.y > RIM {
                return false;
            }
            if here.y < Self::height(here.x, here.z) {
                return true;
            }
            along *= 1.25;
        }
        false
    }
}
