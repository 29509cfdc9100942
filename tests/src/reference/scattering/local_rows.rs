// SPDX-License-Identifier: MIT OR Apache-2.0
//! Rows of a light at a point: half-planes about the axis through the eye and the light, with columns
//! linear in the angle at the light. Bounds are searched for.

mod bounds;

use std::f64::consts::PI;

use self::bounds::{cone, greatest};
use super::airlight::Airlight;
use super::frame::Frame;
use super::light_texture::LightTexture;
use super::local_light::LocalLight;
use super::picture::{Medium, ViewRay};
use super::shadow_map::{RectifiedTexel, ShadowMap};
use super::slice::{GUARD, Rectification};
use super::views::ShadowViews;
use crate::linear::Vec3;
use crate::reference::camera::Camera;
use crate::reference::phase::henyey_greenstein;

/// Width in radians of a slice without light.
const TINY: f64 = 1e-4;

/// The eye is at the light, or one of them is nowhere: there are no rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EyeAtLight;

/// One row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalSlice {
    /// Azimuth, radians.
    pub phi: f64,
    /// Least angle at the eye between the light and the slice's view rays in the picture, radians.
    pub theta_min: f64,
    /// Greatest such angle, radians.
    pub theta_max: f64,
    /// Least angle at the light between the eye and the light rays of the row, radians.
    pub alpha_min: f64,
    /// Greatest such angle, radians.
    pub alpha_max: f64,
    /// Whether no light reaches the slice's view rays: the bounds of alpha are then arbitrary.
    pub dark: bool,
}

impl LocalSlice {
    /// Depth in [0, 1] of an angle at the eye.
    #[must_use]
    pub fn depth(&self, theta: f64) -> f64 {
        let unit = (theta - self.theta_min) / (self.theta_max - self.theta_min);
        (GUARD[0] + (GUARD[1] - GUARD[0]) * unit).clamp(0.0, 1.0)
    }

    /// The angle at the light at a place between the columns of a row of `width`, radians.
    #[must_use]
    pub fn alpha(&self, column: f64, width: usize) -> f64 {
        self.alpha_min + (self.alpha_max - self.alpha_min) * column / width as f64
    }
}

/// The rows of one camera and light at a point.
#[derive(Clone, Debug, PartialEq)]
pub struct LocalRows {
    /// The frame, about the axis from the eye to the light.
    pub frame: Frame,
    /// Distance from the eye to the light, metres.
    pub distance: f64,
    /// The light.
    pub light: LocalLight,
    /// Azimuths: `phi_min`, `phi_max`, whether they wrap, and the texels of a row. Its slices hold the
    /// bounds of theta; the columns are those of [`Self::slices`].
    pub angles: Rectification,
    /// The rows. A caller may replace them by those that it read back.
    pub slices: Vec<LocalSlice>,
}

/// A view ray about the light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalRay {
    /// Azimuth, radians.
    pub phi: f64,
    /// Angle at the eye from the light, radians.
    pub theta: f64,
    /// Distance from the eye to the light, metres.
    pub distance: f64,
}

impl LocalRay {
    /// The angle at the light, radians, between the eye and the ray's point at the distance `t` (metres).
    #[must_use]
    pub fn alpha(&self, t: f64) -> f64 {
        (t * self.theta.sin()).atan2(self.distance - t * self.theta.cos())
    }

    /// The distance from the eye, metres, of the ray's point at an angle at the light; infinite where
    /// the ray never gets there.
    #[must_use]
    pub fn t(&self, alpha: f64) -> f64 {
        if self.theta + alpha >= PI {
            return f64::INFINITY;
        }
        self.distance * alpha.sin() / (self.theta + alpha).sin()
    }
}

impl LocalRows {
    /// The rows of a camera, a light, the greatest distance along view rays (metres, may be infinite if
    /// the far plane is not) and a map of `width` texels in `height` rows.
    ///
    /// # Errors
    /// [`EyeAtLight`].
    ///
    /// # Panics
    /// For an empty map, and if neither the far plane nor the limit is finite.
    pub fn new(
        camera: &Camera,
        light: LocalLight,
        distance_limit: f64,
        [width, height]: [usize; 2],
    ) -> Result<Self, EyeAtLight> {
        let towards = light.position - camera.eye;
        let distance = towards.length();
        // Not a number is not at least anything either.
        if !(1e-4..f64::INFINITY).contains(&distance) {
            return Err(EyeAtLight);
        }
        let angles = Rectification::new(camera, towards, distance_limit, width, height);
        let frame = angles.frame;
        let slices = crate::parallel::rows(height, |j| {
            let slice = angles.slices[j];
            let end = |theta: f64| {
                let along = frame.direction(slice.phi, theta).dot(camera.forward);
                let far = if along > 0.0 { camera.far / along } else { f64::INFINITY };
                far.min(distance_limit)
            };
            let reach = greatest(slice.theta_min, slice.theta_max, |theta| {
                LocalRay { phi: slice.phi, theta, distance }.alpha(end(theta))
            });
            let (alpha_min, alpha_max, dark) = match cone(&frame, &light, slice.phi) {
                Some((low, high)) if low < reach => (low, high.min(reach), false),
                _ => (reach.min(PI - TINY), reach.min(PI - TINY) + TINY, true),
            };
            let (theta_min, theta_max) = (slice.theta_min, slice.theta_max);
            LocalSlice { phi: slice.phi, theta_min, theta_max, alpha_min, alpha_max, dark }
        });
        Ok(Self { frame, distance, light, angles, slices })
    }

    /// Texels of a row.
    #[must_use]
    pub fn width(&self) -> usize {
        self.angles.width
    }

    /// Unit direction, from the light, of a light ray of an azimuth and an angle at the light.
    #[must_use]
    pub fn light_ray(&self, phi: f64, alpha: f64) -> Vec3 {
        light_ray(&self.frame, phi, alpha)
    }

    /// The rectified map of the light's shadow maps, row-major; `edge` as in [`super::rectify`].
    #[must_use]
    pub fn rectify(&self, maps: &[ShadowMap<'_>], edge: f64) -> Vec<RectifiedTexel> {
        let views = ShadowViews::new(maps);
        crate::parallel::rows(self.slices.len(), |j| {
            let slice = &self.slices[j];
            let texel = |i: usize| {
                let alpha = slice.alpha(i as f64 + 0.5, self.width());
                let on_light_ray = self.light.position + self.light_ray(slice.phi, alpha);
                views.look_up(on_light_ray, edge, |blocker| {
                    blocker.map_or(1.0, |blocker| slice.depth(self.frame.polar(blocker).theta))
                })
            };
            (0..self.width()).map(texel).collect::<Vec<_>>()
        })
        .concat()
    }

    /// The angular fall-off times the light texture of every texel's light ray, row-major.
    #[must_use]
    pub fn fall_off(&self, maps: &[ShadowMap<'_>], texture: Option<&LightTexture<'_>>) -> Vec<[f64; 3]> {
        let views = ShadowViews::new(maps);
        crate::parallel::rows(self.slices.len(), |j| {
            let slice = &self.slices[j];
            let texel = |i: usize| {
                let direction = self.light_ray(slice.phi, slice.alpha(i as f64 + 0.5, self.width()));
                let point = self.light.position + direction;
                let view = views.view_of(point).map(|view| views.clip_from_world(view));
                let passes = texture.map_or([1.0; 3], |texture| texture.at(view, point));
                passes.map(|passes| passes * self.light.fall_off(direction))
            };
            (0..self.width()).map(texel).collect::<Vec<_>>()
        })
        .concat()
    }

    /// A view ray from the eye, of a unit direction, about the light.
    #[must_use]
    pub fn ray(&self, direction: Vec3) -> LocalRay {
        let polar = self.frame.polar_direction(direction);
        LocalRay { phi: polar.phi, theta: polar.theta, distance: self.distance }
    }

    /// The columns of row `j`, with fractions, that a ray of a length (metres) covers from the first on.
    #[must_use]
    pub fn covered(&self, j: usize, ray: LocalRay, end: f64) -> f64 {
        let slice = &self.slices[j];
        let unit = (ray.alpha(end) - slice.alpha_min) / (slice.alpha_max - slice.alpha_min);
        unit.clamp(0.0, 1.0) * self.width() as f64
    }

    /// The mean over the covered columns of row `j` of fall-off and visibility: a texel is lit if and
    /// only if the ray's depth is at most its own. 0 where the ray covers nothing.
    #[must_use]
    pub fn row_mean<T: Copy + Into<f64>>(
        &self,
        over: &Over<'_, T>,
        j: usize,
        ray: LocalRay,
        end: f64,
    ) -> [f64; 3] {
        let covered = self.covered(j, ray, end);
        let mut mean = [0.0; 3];
        self.lit_columns(over, j, ray, covered, |from, to, fall_off| {
            for channel in 0..3 {
                mean[channel] += fall_off[channel] * (to - from) / covered;
            }
        });
        mean
    }

    /// Every covered and lit column of row `j`: where it begins and ends, in columns, and its fall-off.
    fn lit_columns<T: Copy + Into<f64>>(
        &self,
        over: &Over<'_, T>,
        j: usize,
        ray: LocalRay,
        covered: f64,
        mut each: impl FnMut(f64, f64, [f64; 3]),
    ) {
        let width = self.width();
        assert!(over.map.len() == width * self.slices.len() && over.fall_off.len() == over.map.len());
        let z = self.slices[j].depth(ray.theta).clamp(GUARD[0], GUARD[1]);
        for i in 0..width {
            let (from, to) = (i as f64, (i as f64 + 1.0).min(covered));
            if to > from && z <= over.map[j * width + i].into() {
                each(from, to, over.fall_off[j * width + i]);
            }
        }
    }

    /// Radiance that row `j` gives to a ray of a length (metres), with the mean of fall-off and
    /// visibility taken out of the airlight integral, as the shaders have it.
    #[must_use]
    pub fn row_radiance_factored<T: Copy + Into<f64>>(
        &self,
        over: &Over<'_, T>,
        j: usize,
        ray: LocalRay,
        end: f64,
    ) -> [f64; 3] {
        let slice = &self.slices[j];
        let (from, to) = (ray.t(slice.alpha_min).min(end), ray.t(slice.alpha_max).min(end));
        let airlight = self.airlight(&over.medium, ray, from, to);
        let mean = self.row_mean(over, j, ray, end);
        std::array::from_fn(|channel| self.colour(&over.medium, channel) * airlight * mean[channel])
    }

    /// The same with each column's own airlight integral.
    #[must_use]
    pub fn row_radiance<T: Copy + Into<f64>>(
        &self,
        over: &Over<'_, T>,
        j: usize,
        ray: LocalRay,
        end: f64,
    ) -> [f64; 3] {
        let slice = &self.slices[j];
        let t = |column: f64| ray.t(slice.alpha(column, self.width())).min(end);
        let mut sum = [0.0; 3];
        self.lit_columns(over, j, ray, self.covered(j, ray, end), |from, to, fall_off| {
            let airlight = self.airlight(&over.medium, ray, t(from), t(to));
            for channel in 0..3 {
                sum[channel] += fall_off[channel] * airlight;
            }
        });
        std::array::from_fn(|channel| self.colour(&over.medium, channel) * sum[channel])
    }

    /// Radiance of a view ray from the eye over the map, interpolated between the two rows about it.
    #[must_use]
    pub fn radiance<T: Copy + Into<f64>>(
        &self,
        over: &Over<'_, T>,
        view: &ViewRay,
        weights: Weights,
    ) -> [f64; 3] {
        let ray = self.ray(view.direction);
        let (first, second, share) = self.angles.rows(ray.phi);
        let at = |j: usize| match weights {
            Weights::Factored => self.row_radiance_factored(over, j, ray, view.end),
            Weights::Exact => self.row_radiance(over, j, ray, view.end),
        };
        let (a, b) = (at(first), at(second));
        std::array::from_fn(|channel| a[channel] * (1.0 - share) + b[channel] * share)
    }

    /// The mean of fall-off and visibility of a view ray, interpolated between the two rows about it.
    #[must_use]
    pub fn mean<T: Copy + Into<f64>>(&self, over: &Over<'_, T>, view: &ViewRay) -> [f64; 3] {
        let ray = self.ray(view.direction);
        let (first, second, share) = self.angles.rows(ray.phi);
        let (a, b) = (self.row_mean(over, first, ray, view.end), self.row_mean(over, second, ray, view.end));
        std::array::from_fn(|channel| a[channel] * (1.0 - share) + b[channel] * share)
    }

    /// The airlight integral of a ray between two distances, with the medium's phase function.
    fn airlight(&self, medium: &Medium, ray: LocalRay, from: f64, to: f64) -> f64 {
        let airlight = Airlight {
            distance: self.distance,
            theta: ray.theta,
            radius: self.light.radius,
            extinction: medium.extinction,
        };
        airlight.quadrature(|cosine| henyey_greenstein(cosine, medium.g), from, to)
    }

    fn colour(&self, medium: &Medium, channel: usize) -> f64 {
        medium.albedo * medium.extinction * self.light.intensity[channel]
    }
}

/// What rows are evaluated over.
#[derive(Clone, Copy, Debug)]
pub struct Over<'a, T> {
    /// The rectified map, row-major.
    pub map: &'a [T],
    /// Fall-off and light texture of every texel, row-major: [`LocalRows::fall_off`].
    pub fall_off: &'a [[f64; 3]],
    /// The medium.
    pub medium: Medium,
}

/// How the means of the columns enter the radiance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weights {
    /// The plain mean over the covered columns times the airlight integral, as the shaders have it.
    Factored,
    /// Each column with its own airlight integral.
    Exact,
}

fn light_ray(frame: &Frame, phi: f64, alpha: f64) -> Vec3 {
    frame.radial(phi) * alpha.sin() - frame.l * alpha.cos()
}

#[cfg(test)]
mod tests;
