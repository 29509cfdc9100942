// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pictures of a light at a point: the truth by its shadow maps without rectification, and the
//! pictures over rows.
//!
//! `L = albedo σ I ∫ e^(−σ (t + d)) p(cos) f V / (d² + radius²) dt`, `d` the distance from the light,
//! `f` the fall-off with the angle times the light texture.

use super::airlight::Airlight;
use super::light_texture::LightTexture;
use super::local_light::LocalLight;
use super::local_rows::{LocalRows, Over, Weights};
use super::picture::{Light, Medium, Picture, Scene, Start, ViewRay};
use super::quadrature::integrate;
use super::shadow_map::ShadowMap;
use super::views::{LitRun, ShadowViews, pieces};
use super::visibility::Visibility;
use crate::linear::Vec3;
use crate::reference::camera::Camera;
use crate::reference::phase::henyey_greenstein;

/// What a picture of a light at a point is evaluated for.
#[derive(Clone, Copy, Debug)]
pub struct LocalScene<'a> {
    /// The camera, of any kind for the truth, perspective for rows.
    pub camera: &'a Camera,
    /// The light.
    pub light: LocalLight,
    /// What passes of it, by the place in its shadow map; none for everything.
    pub texture: Option<LightTexture<'a>>,
    /// The medium.
    pub medium: Medium,
    /// The depth buffer, row-major, row 0 at the top.
    pub depth: &'a [f32],
    /// Width of the picture, pixels.
    pub width: usize,
    /// Height of the picture, pixels.
    pub height: usize,
}

impl LocalScene<'_> {
    /// The part of a pixel's view ray that lies in the medium.
    #[must_use]
    pub fn ray(&self, x: usize, y: usize, start: Start) -> ViewRay {
        self.scene().ray(x, y, start)
    }

    /// The scene without its light, for the walk over its pixels.
    fn scene(&self) -> Scene<'_> {
        Scene {
            camera: self.camera,
            light: Light { direction: Vec3::new(0.0, 1.0, 0.0), radiance: [0.0; 3] },
            medium: self.medium,
            depth: self.depth,
            width: self.width,
            height: self.height,
        }
    }

    /// The picture by the shadow maps themselves (one of a spot, six of a point light; nearest texel, no
    /// bias, lit outside of them) of every `stride`-th pixel: lit stretches exactly, the integral over
    /// each by adaptive quadrature. Of each pixel `average` is the lit share of the ray's length and
    /// `weighted` that of its radiance, both without the texture; only `radiance` has it.
    ///
    /// # Panics
    /// For sizes that differ from those stated, a singular matrix, a ray without end, a stride of 0.
    #[must_use]
    pub fn truth(&self, maps: &[ShadowMap<'_>], start: Start, stride: usize) -> Picture {
        let views = ShadowViews::new(maps);
        self.scene().evaluate_radiance(stride, start, |ray| {
            let runs = views.lit_runs(ray);
            let clear =
                self.gathered(&views, ray, &[LitRun { from: ray.begin, to: ray.end, view: None }], false);
            let lit = self.gathered(&views, ray, &runs, false);
            let with_texture =
                if self.texture.is_some() { self.gathered(&views, ray, &runs, true) } else { lit };
            let length: f64 = runs.iter().map(|run| run.to - run.from).sum();
            let share = |part: f64, whole: f64| if whole > 0.0 { part / whole } else { 1.0 };
            let visibility =
                Visibility { average: share(length, ray.length()), weighted: share(lit[0], clear[0]) };
            let colour = self.medium.albedo * self.medium.extinction;
            (visibility, std::array::from_fn(|i| colour * self.light.intensity[i] * with_texture[i]))
        })
    }

    /// The integral of the equation over some stretches, without its constant factors.
    fn gathered(&self, views: &ShadowViews<'_>, ray: &ViewRay, runs: &[LitRun], textured: bool) -> [f64; 3] {
        let Medium { extinction, g, .. } = self.medium;
        let integrand = |t: f64, view: Option<usize>| {
            let point = ray.at(t);
            let from_light = point - self.light.position;
            let d = from_light.length();
            let towards_light = if d > 0.0 { from_light * -d.recip() } else { Vec3::default() };
            let phase = henyey_greenstein(ray.direction.dot(towards_light), g);
            let taken = (-extinction * (t - ray.begin + d)).exp();
            let fall_off = if d > 0.0 { self.light.fall_off(from_light) } else { 1.0 };
            let value = phase * taken * fall_off / (d * d + self.light.radius * self.light.radius);
            match self.texture {
                Some(texture) if textured => {
                    texture.at(view.map(|view| views.clip_from_world(view)), point).map(|f| f * value)
                }
                _ => [value; 3],
            }
        };
        let mut sum = [0.0; 3];
        let towards = self.light.position - ray.origin;
        let across = towards.without(ray.direction).length();
        let geometry = Airlight {
            distance: towards.length(),
            theta: across.atan2(towards.dot(ray.direction)),
            radius: self.light.radius,
            extinction,
        };
        for run in runs {
            let mut places = geometry.pieces(run.from, run.to);
            if let Some(texture) = self.texture.filter(|_| textured) {
                let view = run.view.map(|view| views.clip_from_world(view));
                places =
                    pieces([places, texture.creases(view, ray, run.from, run.to)].concat(), run.from, run.to);
            }
            places.extend(self.light.creases(ray));
            for piece in pieces(places, run.from, run.to).windows(2) {
                let value = integrate(|t| integrand(t, run.view), piece[0], piece[1], 1e-9);
                for channel in 0..3 {
                    sum[channel] += value[channel];
                }
            }
        }
        sum
    }

    /// The picture over rows of every `stride`-th pixel. Of each pixel `average` and `weighted` are both
    /// the mean of fall-off and visibility over the covered columns, averaged over the channels.
    ///
    /// # Panics
    /// For sizes that differ from those stated, and a stride of 0.
    #[must_use]
    pub fn over_rows<T: Copy + Into<f64> + Sync>(
        &self,
        rows: &LocalRows,
        over: &Over<'_, T>,
        weights: Weights,
        stride: usize,
    ) -> Picture {
        self.scene().evaluate_radiance(stride, Start::Eye, |ray| {
            let mean = rows.mean(over, ray).iter().sum::<f64>() / 3.0;
            (Visibility { average: mean, weighted: mean }, rows.radiance(over, ray, weights))
        })
    }
}

#[cfg(test)]
mod tests;
